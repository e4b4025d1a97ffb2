#include "oracle.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { UNIT = 1074 }; /* every double is an integer times 2^-UNIT, products 2^-2*UNIT */

void oracle_init(struct oracle *o)
{
	mpq_init(o->volume);
	for (int i = 0; i < 3; i++) {
		mpq_inits(o->centroid[i], o->first[i], NULL);
		for (int j = 0; j < 3; j++)
			mpq_inits(o->second[i][j], o->square[i][j], NULL);
	}
}

void oracle_clear(struct oracle *o)
{
	mpq_clear(o->volume);
	for (int i = 0; i < 3; i++) {
		mpq_clears(o->centroid[i], o->first[i], NULL);
		for (int j = 0; j < 3; j++)
			mpq_clears(o->second[i][j], o->square[i][j], NULL);
	}
}

/* out += six times the volume of the tetrahedron 0 a b c */
static void add_determinant(mpz_t out, mpz_t p[3][3])
{
	mpz_t t;

	mpz_init(t);
	mpz_set_ui(out, 0);
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		mpz_mul(t, p[1][j], p[2][k]);
		mpz_submul(t, p[1][k], p[2][j]);
		mpz_addmul(out, p[0][i], t);
	}
	mpz_clear(t);
}

void oracle_coordinate(const double row[4], const double x[3], mpq_t out)
{
	mpq_t a, b;

	mpq_inits(a, b, NULL);
	mpq_set_d(out, row[3]);
	for (int k = 0; k < 3; k++) {
		mpq_set_d(a, row[k]);
		mpq_set_d(b, x[k]);
		mpq_mul(a, a, b);
		mpq_add(out, out, a);
	}
	mpq_clears(a, b, NULL);
}

void oracle_determinant(const double (*row)[4], mpq_t out)
{
	mpq_t a, b;

	mpq_inits(a, b, NULL);
	mpq_set_ui(out, 0, 1);
	for (int turn = 0; turn < 6; turn++) {
		int step = turn < 3 ? 1 : 2; /* columns forwards, then backwards */

		mpq_set_d(a, row[0][turn % 3]);
		for (int i = 1; i < 3; i++) {
			mpq_set_d(b, row[i][(turn + i * step) % 3]);
			mpq_mul(a, a, b);
		}
		if (step == 1)
			mpq_add(out, out, a);
		else
			mpq_sub(out, out, a);
	}
	mpq_clears(a, b, NULL);
}

/* In units of 2^-2*UNIT. */
static void set_mapped(mpz_t out, const double (*row)[4], const double x[3], int i)
{
	mpq_t q;

	mpq_init(q);
	if (row != NULL)
		oracle_coordinate(row[i], x, q);
	else
		mpq_set_d(q, x[i]);
	mpq_mul_2exp(q, q, 2 * UNIT);
	mpz_set(out, mpq_numref(q));
	mpq_clear(q);
}

struct totals {
	mpz_t det, first[3], square[3][3]; /* 6, 24 and 120 times the integrals */
};

static void add_triangle(struct totals *sum, const double tri[9], const double (*row)[4])
{
	mpz_t p[3][3], det, s, t;

	mpz_inits(det, s, t, NULL);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 3; k++) {
			mpz_init(p[c][k]);
			set_mapped(p[c][k], row, &tri[3 * c], k);
		}
	add_determinant(det, p);
	mpz_add(sum->det, sum->det, det);
	for (int i = 0; i < 3; i++) {
		mpz_add(s, p[0][i], p[1][i]);
		mpz_add(s, s, p[2][i]);
		mpz_addmul(sum->first[i], det, s);
		for (int j = 0; j < 3; j++) {
			mpz_set_ui(s, 0);
			for (int a = 0; a < 3; a++)
				for (int b = 0; b < 3; b++) {
					mpz_mul(t, p[a][i], p[b][j]);
					mpz_addmul_ui(s, t, a == b ? 2 : 1);
				}
			mpz_addmul(sum->square[i][j], det, s);
		}
	}
	for (int c = 0; c < 3; c++)
		mpz_clears(p[c][0], p[c][1], p[c][2], NULL);
	mpz_clears(det, s, t, NULL);
}

static void set_quotient(mpq_t out, const mpz_t num, unsigned den, unsigned coordinates)
{
	mpq_set_z(out, num);
	mpz_set_ui(mpq_denref(out), den);
	mpq_canonicalize(out);
	mpq_div_2exp(out, out, 2 * UNIT * (mp_bitcnt_t)coordinates);
}

static void solve(struct oracle *o)
{
	mpq_t t;

	mpq_init(t);
	for (int i = 0; i < 3; i++) {
		mpq_set_ui(o->centroid[i], 0, 1);
		if (mpq_sgn(o->volume) != 0)
			mpq_div(o->centroid[i], o->first[i], o->volume);
	}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			mpq_mul(t, o->centroid[i], o->first[j]);
			mpq_sub(o->second[i][j], o->square[i][j], t);
		}
	mpq_clear(t);
}

void oracle_find(struct oracle *o, const double (*tri)[9], size_t count)
{
	oracle_find_mapped(o, tri, count, NULL);
}

/* Wound the other way, all integrals change their sign. */
static void wind(struct totals *sum, const double (*row)[4])
{
	mpq_t det;

	mpq_init(det);
	oracle_determinant(row, det);
	if (mpq_sgn(det) < 0) {
		mpz_neg(sum->det, sum->det);
		for (int i = 0; i < 9; i++) {
			mpz_neg(sum->square[i / 3][i % 3], sum->square[i / 3][i % 3]);
			if (i < 3)
				mpz_neg(sum->first[i], sum->first[i]);
		}
	}
	mpq_clear(det);
}

void oracle_find_mapped(struct oracle *o, const double (*tri)[9], size_t count,
			const double (*row)[4])
{
	struct totals sum;

	mpz_init(sum.det);
	for (int i = 0; i < 3; i++) {
		mpz_init(sum.first[i]);
		mpz_inits(sum.square[i][0], sum.square[i][1], sum.square[i][2], NULL);
	}
	for (size_t i = 0; i < count; i++)
		add_triangle(&sum, tri[i], row);
	if (row != NULL)
		wind(&sum, row);
	set_quotient(o->volume, sum.det, 6, 3);
	for (int i = 0; i < 3; i++) {
		set_quotient(o->first[i], sum.first[i], 24, 4);
		for (int j = 0; j < 3; j++)
			set_quotient(o->square[i][j], sum.square[i][j], 120, 5);
		mpz_clears(sum.square[i][0], sum.square[i][1], sum.square[i][2], NULL);
		mpz_clear(sum.first[i]);
	}
	mpz_clear(sum.det);
	solve(o);
}

/* integral of (x-P)_i*(x-P)_j, or about the centroid */
static void second_about(const struct oracle *o, const double *about, int i, int j, mpq_t out)
{
	mpq_t ri, rj;

	mpq_set(out, o->second[i][j]);
	if (about == NULL)
		return;
	mpq_inits(ri, rj, NULL);
	mpq_set_d(ri, about[i]);
	mpq_set_d(rj, about[j]);
	mpq_sub(ri, o->centroid[i], ri);
	mpq_sub(rj, o->centroid[j], rj);
	mpq_mul(ri, ri, rj);
	mpq_mul(ri, ri, o->volume);
	mpq_add(out, out, ri);
	mpq_clears(ri, rj, NULL);
}

void oracle_inertia(const struct oracle *o, const double *about, const mpq_t factor,
		    mpq_t out[3][3])
{
	mpq_t t;

	mpq_init(t);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			if (i == j) {
				second_about(o, about, (i + 1) % 3, (i + 1) % 3, out[i][i]);
				second_about(o, about, (i + 2) % 3, (i + 2) % 3, t);
				mpq_add(out[i][i], out[i][i], t);
			} else {
				second_about(o, about, i, j, out[i][j]);
				mpq_neg(out[i][j], out[i][j]);
			}
			mpq_mul(out[i][j], out[i][j], factor);
			if (mpq_sgn(o->volume) < 0)
				mpq_neg(out[i][j], out[i][j]);
		}
	mpq_clear(t);
}

void oracle_moment(const struct oracle *o, const double origin[3], const double d[3],
		   const mpq_t factor, mpq_t out)
{
	mpq_t tensor[3][3], di, dj, square;

	mpq_inits(di, dj, square, NULL);
	for (int i = 0; i < 3; i++)
		mpq_inits(tensor[i][0], tensor[i][1], tensor[i][2], NULL);
	oracle_inertia(o, origin, factor, tensor);
	mpq_set_ui(out, 0, 1);
	for (int i = 0; i < 3; i++) {
		mpq_set_d(di, d[i]);
		for (int j = 0; j < 3; j++) {
			mpq_set_d(dj, d[j]);
			mpq_mul(dj, di, dj);
			if (i == j)
				mpq_add(square, square, dj);
			mpq_mul(dj, dj, tensor[i][j]);
			mpq_add(out, out, dj);
		}
	}
	mpq_div(out, out, square);
	for (int i = 0; i < 3; i++)
		mpq_clears(tensor[i][0], tensor[i][1], tensor[i][2], NULL);
	mpq_clears(di, dj, square, NULL);
}

/* |x| against the number half way from ${a} >= 0 to the double above it. */
static int compare_middle(const mpq_t x, double a, int power)
{
	mpq_t middle, next;
	int order;

	mpq_inits(middle, next, NULL);
	mpq_set_d(middle, a);
	if (a == DBL_MAX) {
		mpq_set_ui(next, 1, 1);
		mpq_mul_2exp(next, next, DBL_MAX_EXP);
	} else {
		mpq_set_d(next, nextafter(a, HUGE_VAL));
	}
	mpq_add(middle, middle, next);
	mpq_div_2exp(middle, middle, 1);
	if (power == 2)
		mpq_mul(middle, middle, middle);
	mpq_abs(next, x);
	order = mpq_cmp(next, middle);
	mpq_clears(middle, next, NULL);
	return order;
}

static bool is_even(double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	return bits % 2 == 0;
}

bool oracle_is_nearest(const mpq_t x, double value)
{
	double size = fabs(value);
	int above = compare_middle(x, size, 1);
	int below = size == 0 ? 1 : compare_middle(x, nextafter(size, 0), 1);

	if (value != 0 && mpq_sgn(x) != (value > 0 ? 1 : -1))
		return false;
	return (above < 0 || (above == 0 && is_even(size))) &&
	       (below > 0 || (below == 0 && is_even(size)));
}

int oracle_range(const mpq_t x)
{
	if (compare_middle(x, DBL_MAX, 1) >= 0)
		return 1;
	return mpq_sgn(x) != 0 && compare_middle(x, nextafter(DBL_MIN, 0), 1) < 0 ? -1 : 0;
}

bool oracle_is_root(const mpq_t x, double root)
{
	if (root == 0)
		return mpq_sgn(x) == 0;
	return compare_middle(x, root, 2) <= 0 && compare_middle(x, nextafter(root, 0), 2) >= 0;
}
