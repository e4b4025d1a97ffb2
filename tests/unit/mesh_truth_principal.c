#include "tests/unit/mesh_truth.h"

/* Eigenvalues in 512 bits: Jacobi's rotations, which are as good as their arithmetic. */
enum { BITS = 512, SWEEPS = 16 };

struct rotation {
	mpf_t c, s, t, x, y, a[3][3];
};

static void each(struct rotation *r, int clear)
{
	mpf_ptr all[14] = {r->c, r->s, r->t, r->x, r->y};

	for (int i = 0; i < 9; i++)
		all[5 + i] = r->a[i / 3][i % 3];
	for (int i = 0; i < 14; i++) {
		if (clear)
			mpf_clear(all[i]);
		else
			mpf_init2(all[i], BITS);
	}
}

/* u, v = c*u - s*v, s*u + c*v */
static void mix(struct rotation *r, mpf_t u, mpf_t v)
{
	mpf_mul(r->x, r->c, u);
	mpf_mul(r->y, r->s, v);
	mpf_sub(r->x, r->x, r->y);
	mpf_mul(r->y, r->s, u);
	mpf_mul(v, v, r->c);
	mpf_add(v, v, r->y);
	mpf_set(u, r->x);
}

/* tan of the angle: sign(theta)/(|theta| + sqrt(theta^2 + 1)), theta = (aqq - app)/(2 apq) */
static void set_angle(struct rotation *r, int p, int q)
{
	int sign;

	mpf_sub(r->t, r->a[q][q], r->a[p][p]);
	mpf_div(r->t, r->t, r->a[p][q]);
	mpf_div_2exp(r->t, r->t, 1);
	sign = mpf_sgn(r->t);
	mpf_mul(r->x, r->t, r->t);
	mpf_add_ui(r->x, r->x, 1);
	mpf_sqrt(r->x, r->x);
	mpf_abs(r->t, r->t);
	mpf_add(r->t, r->t, r->x);
	mpf_ui_div(r->t, 1, r->t);
	if (sign < 0)
		mpf_neg(r->t, r->t);
	mpf_mul(r->x, r->t, r->t);
	mpf_add_ui(r->x, r->x, 1);
	mpf_sqrt(r->x, r->x);
	mpf_ui_div(r->c, 1, r->x);
	mpf_mul(r->s, r->t, r->c);
}

static long exponent(const mpf_t x)
{
	long e;

	(void)mpf_get_d_2exp(&e, x);
	return e;
}

/* Is it 0, or nothing beside the moments? */
static int negligible(const struct rotation *r, int p, int q)
{
	mpf_srcptr x = r->a[p][q];
	long largest = exponent(r->a[0][0]);

	for (int k = 1; k < 3; k++)
		if (exponent(r->a[k][k]) > largest)
			largest = exponent(r->a[k][k]);
	return mpf_sgn(x) == 0 || exponent(x) < largest - BITS;
}

static void rotate(struct rotation *r, mpf_t axis[3][3], int p, int q)
{
	if (negligible(r, p, q))
		return;
	set_angle(r, p, q);
	for (int k = 0; k < 3; k++)
		mix(r, r->a[k][p], r->a[k][q]);
	for (int k = 0; k < 3; k++) {
		mix(r, r->a[p][k], r->a[q][k]);
		mix(r, axis[p][k], axis[q][k]);
	}
	mpf_set_ui(r->a[p][q], 0);
	mpf_set_ui(r->a[q][p], 0);
}

static void sort(struct truth *o)
{
	static const int PAIR[3] = {0, 1, 0};

	for (int i = 0; i < 3; i++) {
		int p = PAIR[i];

		if (mpf_cmp(o->moment[p], o->moment[p + 1]) <= 0)
			continue;
		mpf_swap(o->moment[p], o->moment[p + 1]);
		for (int k = 0; k < 3; k++)
			mpf_swap(o->axis[p][k], o->axis[p + 1][k]);
	}
}

void truth_find_principal(struct truth *o)
{
	struct rotation r;

	each(&r, 0);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			mpf_div(r.a[i][j], o->central[i][j].num, o->central[i][j].den);
			mpf_set_ui(o->axis[i][j], i == j);
		}
	for (int sweep = 0; sweep < SWEEPS; sweep++) {
		rotate(&r, o->axis, 0, 1);
		rotate(&r, o->axis, 0, 2);
		rotate(&r, o->axis, 1, 2);
	}
	for (int k = 0; k < 3; k++)
		mpf_set(o->moment[k], r.a[k][k]);
	sort(o);
	for (int k = 0; k < 3; k++) {
		mpf_mul(r.x, o->moment[k], o->mass.den);
		mpf_div(r.x, r.x, o->mass.num);
		if (mpf_sgn(r.x) < 0)
			mpf_set_ui(r.x, 0);
		mpf_sqrt(o->radius[k], r.x);
	}
	each(&r, 1);
}

double truth_ratio_root(const mpf_t exact, double x, double bound)
{
	double ratio;
	mpf_t error, most;

	mpf_init2(error, BITS);
	mpf_init2(most, BITS);
	mpf_set_d(error, x);
	mpf_sub(error, error, exact);
	mpf_abs(error, error);
	mpf_set_d(most, bound);
	ratio = truth_over(error, most);
	mpf_clear(error);
	mpf_clear(most);
	return ratio;
}

/* |axis x other|/|other|; |axis| is 1 */
double truth_sine(mpf_t axis[3], const double other[3])
{
	mpf_t v[3], x, y, square, length;
	mpf_ptr all[7] = {v[0], v[1], v[2], x, y, square, length};
	double sine;

	for (int i = 0; i < 7; i++)
		mpf_init2(all[i], BITS);
	for (int k = 0; k < 3; k++)
		mpf_set_d(v[k], other[k]);
	for (int k = 0; k < 3; k++) {
		mpf_mul(x, v[k], v[k]);
		mpf_add(length, length, x);
		mpf_mul(x, axis[(k + 1) % 3], v[(k + 2) % 3]);
		mpf_mul(y, axis[(k + 2) % 3], v[(k + 1) % 3]);
		mpf_sub(x, x, y);
		mpf_mul(x, x, x);
		mpf_add(square, square, x);
	}
	mpf_div(square, square, length);
	mpf_sqrt(square, square);
	sine = mpf_get_d(square);
	for (int i = 0; i < 7; i++)
		mpf_clear(all[i]);
	return sine;
}
