#include "tests/unit/mesh_truth.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "tests/unit/oracle.h"

enum {
	EXACT = 16384, /* bits: no product here has more, so that nothing is rounded */
	ROOT = 320     /* bits of what is irrational */
};

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
static const int PLACE[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

struct sums {
	mpz_t a0, a1[3], a2[6];
	mpz_t origin[3];
	mpf_t area;
	long unit; /* whole numbers are of 2^unit */
};

static void each_quotient(struct truth *o, void (*use)(mpf_t, mp_bitcnt_t))
{
	struct truth_quotient *q[2 + 3 + 18] = {&o->volume, &o->mass};

	for (int k = 0; k < 3; k++)
		q[2 + k] = &o->centroid[k];
	for (int i = 0; i < 9; i++) {
		q[5 + i] = &o->central[i / 3][i % 3];
		q[14 + i] = &o->about_origin[i / 3][i % 3];
	}
	for (int i = 0; i < 23; i++) {
		use(q[i]->num, EXACT);
		use(q[i]->den, EXACT);
	}
}

static void clear(mpf_t x, mp_bitcnt_t bits)
{
	(void)bits;
	mpf_clear(x);
}

static void each_root(struct truth *o, void (*use)(mpf_t, mp_bitcnt_t))
{
	use(o->area, ROOT);
	for (int i = 0; i < 3; i++) {
		use(o->moment[i], ROOT);
		use(o->radius[i], ROOT);
		for (int j = 0; j < 3; j++)
			use(o->axis[i][j], ROOT);
	}
}

void truth_init(struct truth *o)
{
	each_quotient(o, mpf_init2);
	each_root(o, mpf_init2);
}

void truth_clear(struct truth *o)
{
	each_quotient(o, clear);
	each_root(o, clear);
}

static long lower_bit(long low, double x)
{
	int e;

	return frexp(x, &e) != 0 && e - 53 < low ? e - 53 : low;
}

static long lowest_bit(const struct mesh *m)
{
	long low = LONG_MAX;

	for (size_t i = 0; i < 9 * m->count; i++)
		low = lower_bit(low, m->tri[i / 9][i % 9]);
	return low == LONG_MAX ? 0 : low;
}

static long lowest_bit_of_map(const double row[3][4])
{
	long low = LONG_MAX;

	for (int i = 0; i < 12; i++)
		low = lower_bit(low, row[i / 4][i % 4]);
	return low < 0 ? low : 0;
}

static void whole(mpz_t out, double x, long unit)
{
	int e;
	double fraction = frexp(x, &e);

	mpz_set_d(out, ldexp(fraction, 53));
	if (fraction != 0)
		mpz_mul_2exp(out, out, (mp_bitcnt_t)(e - 53 - unit));
}

static void add_area(struct sums *s, mpz_t n[3])
{
	mpz_t sum;
	mpf_t root;

	mpz_init(sum);
	mpf_init2(root, ROOT);
	for (int k = 0; k < 3; k++)
		mpz_addmul(sum, n[k], n[k]);
	mpf_set_z(root, sum);
	mpf_sqrt(root, root);
	mpf_add(s->area, s->area, root);
	mpz_clear(sum);
	mpf_clear(root);
}

/* q: corners about the origin, s: scratch. */
static void add_triangle(struct sums *out, mpz_t q[9], mpz_t e[6], mpz_t n[3], mpz_t x[4])
{
	for (int k = 0; k < 6; k++)
		mpz_sub(e[k], q[3 + k], q[k % 3]);
	for (int k = 0; k < 3; k++) {
		mpz_mul(n[k], e[(k + 1) % 3], e[3 + (k + 2) % 3]);
		mpz_submul(n[k], e[(k + 2) % 3], e[3 + (k + 1) % 3]);
	}
	add_area(out, n);
	mpz_set_ui(x[0], 0);
	for (int k = 0; k < 3; k++)
		mpz_addmul(x[0], q[k], n[k]);
	mpz_add(out->a0, out->a0, x[0]);
	for (int k = 0; k < 3; k++) {
		mpz_add(x[1 + k], q[k], q[3 + k]);
		mpz_add(x[1 + k], x[1 + k], q[6 + k]);
		mpz_addmul(out->a1[k], x[0], x[1 + k]);
	}
	for (int k = 0; k < 6; k++) {
		int i = AXES[k][0], j = AXES[k][1];

		mpz_mul(e[0], x[1 + i], x[1 + j]);
		for (int c = 0; c < 9; c += 3)
			mpz_addmul(e[0], q[c + i], q[c + j]);
		mpz_addmul(out->a2[k], x[0], e[0]);
	}
}

/* Corner ${x} as whole numbers of 2^${unit}, on the way 2^${fine} those of the map. */
static void map_corner(mpz_t out[3], const double x[3], const double row[3][4], long unit,
		       long fine)
{
	mpz_t from, factor;

	mpz_init(from);
	mpz_init(factor);
	for (int i = 0; i < 3; i++) {
		whole(out[i], row[i][3], unit);
		for (int k = 0; k < 3; k++) {
			whole(from, x[k], unit - fine);
			whole(factor, row[i][k], fine);
			mpz_addmul(out[i], from, factor);
		}
	}
	mpz_clear(from);
	mpz_clear(factor);
}

static void get_triangle(mpz_t q[9], const double tri[9], const double (*row)[4], bool turned,
			 long unit, long fine)
{
	static const int CORNER[2][3] = {{0, 1, 2}, {0, 2, 1}};

	for (int c = 0; c < 3; c++) {
		const double *x = &tri[3 * CORNER[turned][c]];

		if (row != NULL)
			map_corner(q + 3 * c, x, row, unit, fine);
		else
			for (int k = 0; k < 3; k++)
				whole(q[3 * c + k], x[k], unit);
	}
}

static bool mirrors(const double (*row)[4])
{
	bool negative;
	mpq_t det;

	if (row == NULL)
		return false;
	mpq_init(det);
	oracle_determinant(row, det);
	negative = mpq_sgn(det) < 0;
	mpq_clear(det);
	return negative;
}

static void find_sums(struct sums *s, const struct mesh *m, const double (*row)[4])
{
	mpz_t scratch[22], *q = scratch, *e = scratch + 9, *n = scratch + 15, *x = scratch + 18;
	long fine = row != NULL ? lowest_bit_of_map(row) : 0;
	bool turned = mirrors(row);

	for (int i = 0; i < 22; i++)
		mpz_init(scratch[i]);
	mpz_init(s->a0);
	mpf_init2(s->area, ROOT);
	for (int k = 0; k < 6; k++)
		mpz_init(s->a2[k]);
	s->unit = lowest_bit(m);
	s->unit = (row != NULL && s->unit > 0 ? 0 : s->unit) + fine;
	for (int k = 0; k < 3; k++) {
		mpz_init(s->a1[k]);
		mpz_init(s->origin[k]);
	}
	for (size_t i = 0; i < m->count; i++) {
		get_triangle(q, m->tri[i], row, turned, s->unit, fine);
		for (int k = 0; k < 9; k++) {
			if (i == 0 && k < 3)
				mpz_set(s->origin[k], q[k]);
			mpz_sub(q[k], q[k], s->origin[k % 3]);
		}
		add_triangle(s, q, e, n, x);
	}
	for (int i = 0; i < 22; i++)
		mpz_clear(scratch[i]);
}

static void clear_sums(struct sums *s)
{
	mpz_clear(s->a0);
	mpf_clear(s->area);
	for (int k = 0; k < 6; k++)
		mpz_clear(s->a2[k]);
	for (int k = 0; k < 3; k++) {
		mpz_clear(s->a1[k]);
		mpz_clear(s->origin[k]);
	}
}

/* x * 2^(unit * power) */
static void shift(mpf_t x, const struct sums *s, int power)
{
	long by = s->unit * power;

	if (by >= 0)
		mpf_mul_2exp(x, x, (mp_bitcnt_t)by);
	else
		mpf_div_2exp(x, x, (mp_bitcnt_t)-by);
}

static void set_mass(struct truth *o, const struct truth_density *density)
{
	mpf_set_d(o->mass.num, density->mass);
	mpf_set_ui(o->mass.den, 1);
	if (density->mass != 0)
		return;
	mpf_abs(o->mass.num, o->volume.num);
	mpf_set_d(o->mass.den, density->value);
	mpf_mul(o->mass.num, o->mass.num, o->mass.den);
	mpf_set_d(o->mass.den, density->divisor);
	mpf_mul(o->mass.den, o->mass.den, o->volume.den);
}

/* mass * num/(80*a0^2) in units of length^2 */
static void set_entry(struct truth_quotient *q, const struct truth *o, const struct sums *s,
		      mpz_t num, int sign)
{
	mpz_t den;

	mpz_init(den);
	mpz_mul(den, s->a0, s->a0);
	mpz_mul_ui(den, den, 80);
	mpf_set_z(q->den, den);
	mpf_mul(q->den, q->den, o->mass.den);
	mpf_set_z(q->num, num);
	shift(q->num, s, 2);
	mpf_mul(q->num, q->num, o->mass.num);
	if (sign < 0)
		mpf_neg(q->num, q->num);
	mpz_clear(den);
}

static void set_tensor(struct truth_quotient out[3][3], const struct truth *o, const struct sums *s,
		       mpz_t moment[6])
{
	mpz_t x;

	mpz_init(x);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			if (i != j)
				mpz_set(x, moment[PLACE[i][j]]);
			else
				mpz_add(x, moment[(i + 1) % 3], moment[(i + 2) % 3]);
			set_entry(&out[i][j], o, s, x, i == j ? 1 : -1);
		}
	mpz_clear(x);
}

/* 4*a0*a2 - 5*a1*a1, and 5*r*r more about the origin, r = 4*a0*centroid */
static void set_second(struct truth *o, const struct sums *s)
{
	mpz_t moment[6], r[3], x;

	mpz_init(x);
	for (int k = 0; k < 3; k++) {
		mpz_init(r[k]);
		mpz_mul(r[k], s->a0, s->origin[k]);
		mpz_mul_ui(r[k], r[k], 4);
		mpz_add(r[k], r[k], s->a1[k]);
		mpf_set_z(o->centroid[k].num, r[k]);
		mpf_set_z(o->centroid[k].den, s->a0);
		mpf_mul_ui(o->centroid[k].den, o->centroid[k].den, 4);
		shift(o->centroid[k].num, s, 1);
		if (o->sign < 0)
			mpf_neg(o->centroid[k].num, o->centroid[k].num);
		mpf_abs(o->centroid[k].den, o->centroid[k].den);
	}
	for (int k = 0; k < 6; k++) {
		mpz_init(moment[k]);
		mpz_mul(moment[k], s->a0, s->a2[k]);
		mpz_mul_ui(moment[k], moment[k], 4);
		mpz_mul(x, s->a1[AXES[k][0]], s->a1[AXES[k][1]]);
		mpz_submul_ui(moment[k], x, 5);
	}
	set_tensor(o->central, o, s, moment);
	for (int k = 0; k < 6; k++) {
		mpz_mul(x, r[AXES[k][0]], r[AXES[k][1]]);
		mpz_addmul_ui(moment[k], x, 5);
	}
	set_tensor(o->about_origin, o, s, moment);
	for (int k = 0; k < 6; k++)
		mpz_clear(moment[k]);
	for (int k = 0; k < 3; k++)
		mpz_clear(r[k]);
	mpz_clear(x);
}

void truth_find(struct truth *o, const struct mesh *m, const struct truth_density *density)
{
	truth_find_mapped(o, m, NULL, density);
}

void truth_find_mapped(struct truth *o, const struct mesh *m, const double row[3][4],
		       const struct truth_density *density)
{
	struct sums s;

	find_sums(&s, m, row);
	o->sign = mpz_sgn(s.a0);
	mpf_set_z(o->volume.num, s.a0);
	shift(o->volume.num, &s, 3);
	mpf_set_ui(o->volume.den, 6);
	mpf_div_ui(o->area, s.area, 2);
	shift(o->area, &s, 2);
	if (o->sign != 0) {
		set_mass(o, density);
		set_second(o, &s);
		truth_find_principal(o);
	}
	clear_sums(&s);
}

double truth_over(const mpf_t error, const mpf_t most)
{
	double ratio;
	mpf_t q;

	if (mpf_sgn(error) == 0 || mpf_sgn(most) == 0)
		return mpf_sgn(error) == 0 ? 0 : INFINITY;
	mpf_init2(q, 64);
	mpf_div(q, error, most);
	ratio = mpf_get_d(q); /* towards 0 */
	mpf_clear(q);
	return mpf_cmp(error, most) > 0 ? fmax(ratio, nextafter(1, 2)) : ratio;
}

double truth_ratio(const struct truth_quotient *exact, double x, double bound)
{
	mpf_t error, most;
	double ratio;

	mpf_init2(error, EXACT);
	mpf_init2(most, EXACT);
	mpf_set_d(error, x);
	mpf_mul(error, error, exact->den);
	mpf_sub(error, error, exact->num);
	mpf_abs(error, error);
	mpf_set_d(most, bound);
	mpf_mul(most, most, exact->den);
	ratio = truth_over(error, most);
	mpf_clear(error);
	mpf_clear(most);
	return ratio;
}
