#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>
#include <gmp.h>

#include "core/geometry/predicates.h"
#include "core/geometry/predicates_exact.h"

static uint64_t state = 88172645463325252u;

static uint64_t random64(void)
{
	state ^= state << 13;
	state ^= state >> 7;
	state ^= state << 17;
	return state;
}

/* Any finite double, every exponent as likely as any other, zeros and denormals among them. */
static double any_double(void)
{
	for (;;) {
		uint64_t bits = random64();
		double x;

		if (random64() % 16 == 0)
			bits &= 0x800fffffffffffffu;
		if (random64() % 16 == 0)
			bits &= 0x8000000000000000u;
		memcpy(&x, &bits, sizeof x);
		if (isfinite(x))
			return x;
	}
}

static double unit(void)
{
	return (double)(random64() >> 11) * 0x1p-53;
}

/* det of rows (b-a), (c-a), (d-a) in rationals */
static int slow_orient3d(const double *a, const double *b, const double *c, const double *d)
{
	const double *row[3] = {b, c, d};
	mpq_t m[3][3], t, s, det;
	int sign;

	mpq_inits(t, s, det, NULL);
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++) {
			mpq_init(m[i][k]);
			mpq_set_d(m[i][k], row[i][k]);
			mpq_set_d(t, a[k]);
			mpq_sub(m[i][k], m[i][k], t);
		}
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		mpq_mul(t, m[0][i], m[1][j]);
		mpq_mul(s, m[0][j], m[1][i]);
		mpq_sub(t, t, s);
		mpq_mul(t, t, m[2][k]);
		mpq_add(det, det, t);
	}
	sign = mpq_sgn(det);
	for (int i = 0; i < 9; i++)
		mpq_clear(m[i / 3][i % 3]);
	mpq_clears(t, s, det, NULL);
	return sign;
}

/* The same with z = 0 and a point above gives the plane case. */
static int slow_orient2d(const double *a, const double *b, const double *c)
{
	double p[3] = {a[0], a[1], 0}, q[3] = {b[0], b[1], 0}, r[3] = {c[0], c[1], 0};
	double up[3] = {a[0], a[1], 1};

	return slow_orient3d(p, q, r, up);
}

static int slow_collinear(const double *a, const double *b, const double *c)
{
	for (int k = 0; k < 3; k++) {
		int l = (k + 1) % 3;
		double p[2] = {a[k], a[l]}, q[2] = {b[k], b[l]}, r[2] = {c[k], c[l]};

		if (slow_orient2d(p, q, r) != 0)
			return 0;
	}
	return 1;
}

/* Every way to compute, so that the exact ones are tested where the filter would decide. */
static void check2d(const double *a, const double *b, const double *c)
{
	int want = slow_orient2d(a, b, c);

	assert_int_equal(mp_orient2d(a, b, c), want);
	assert_int_equal(mp_orient2d(b, a, c), -want);
	assert_int_equal(mp_orient2d(b, c, a), want);
	assert_int_equal(mp_exact_orient2d(a, b, c), want);
	assert_int_equal(mp_wide_orient2d(a, b, c), want);
}

static void check3d(const double *a, const double *b, const double *c, const double *d)
{
	int want = slow_orient3d(a, b, c, d);

	assert_int_equal(mp_orient3d(a, b, c, d), want);
	assert_int_equal(mp_orient3d(b, a, c, d), -want);
	assert_int_equal(mp_orient3d(a, b, d, c), -want);
	assert_int_equal(mp_exact_orient3d(a, b, c, d), want);
	assert_int_equal(mp_wide_orient3d(a, b, c, d), want);
	assert_int_equal(mp_collinear(a, b, c), slow_collinear(a, b, c));
}

static void simple_signs(void **unused)
{
	const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
	const double x2[3] = {2, 0, 0}, low[3] = {5, 5, -1};

	(void)unused;
	assert_int_equal(mp_orient2d(o, x, y), 1);
	assert_int_equal(mp_orient2d(o, y, x), -1);
	assert_int_equal(mp_orient2d(o, x, x2), 0);
	assert_int_equal(mp_orient3d(o, x, y, z), 1);
	assert_int_equal(mp_orient3d(o, x, y, low), -1);
	assert_int_equal(mp_orient3d(o, x, y, x2), 0);
	assert_int_equal(mp_collinear(o, x, x2), 1);
	assert_int_equal(mp_collinear(o, o, y), 1);
	assert_int_equal(mp_collinear(z, z, z), 1);
	assert_int_equal(mp_collinear(o, x, y), 0);
}

static void random_points_agree_with_rationals(void **unused)
{
	double p[4][3];

	(void)unused;
	for (int n = 0; n < 20000; n++) {
		for (int i = 0; i < 12; i++)
			p[i / 3][i % 3] = unit() * (n % 2 ? 1 : 1e6) - 0.5;
		check3d(p[0], p[1], p[2], p[3]);
		check2d(p[0], p[1], p[2]);
	}
}

/* Points on a line or in a plane, rounded, then some coordinates moved by an ulp. */
static void nearly_degenerate_points_agree_with_rationals(void **unused)
{
	double p[4][3];

	(void)unused;
	for (int n = 0; n < 100000; n++) {
		double s = unit(), t = unit(),
		       size = ldexp(1, (int)(random64() % 40) - (n % 7 ? 20 : 540));

		for (int k = 0; k < 3; k++) {
			p[0][k] = unit() * size;
			p[1][k] = n % 3 ? unit() * size : unit();
			p[2][k] = n % 2 ? unit() * size : p[0][k] + t * (p[1][k] - p[0][k]);
			p[3][k] = p[0][k] + s * (p[1][k] - p[0][k]) + t * (p[2][k] - p[0][k]);
		}
		for (int i = 0; n % 5 && i < 12; i++)
			if (random64() % 4 == 0)
				p[i / 3][i % 3] =
				    nextafter(p[i / 3][i % 3], unit() < 0.5 ? -9 : 9e9);
		check3d(p[0], p[1], p[2], p[3]);
		check2d(p[0], p[1], p[2]);
	}
}

/* Small integers, so that exact zeros are frequent; scaled to the ends of the range. */
static void lattice_points_agree_with_rationals_at_every_scale(void **unused)
{
	const int scales[] = {0, 1000, -1074, -540, 505, -330, 290, -1022};
	double p[4][3];

	(void)unused;
	for (int n = 0; n < 30000; n++) {
		int e = scales[n % 8];

		for (int i = 0; i < 12; i++) {
			double v = (double)(int)(random64() % 5) - 2;

			p[i / 3][i % 3] = ldexp(v, n % 64 < 56 ? e : scales[random64() % 8]);
		}
		check3d(p[0], p[1], p[2], p[3]);
		check2d(p[0], p[1], p[2]);
	}
}

static void any_doubles_agree_with_rationals(void **unused)
{
	double p[4][3];

	(void)unused;
	for (int n = 0; n < 20000; n++) {
		for (int i = 0; i < 12; i++)
			p[i / 3][i % 3] = any_double();
		if (n % 3 == 0) { /* collinear through a power of two */
			for (int k = 0; k < 3; k++) {
				p[0][k] = 0;
				p[1][k] = ldexp(p[1][k], -3);
				p[2][k] = p[1][k] * 2;
			}
		}
		check3d(p[0], p[1], p[2], p[3]);
		check2d(p[0], p[1], p[2]);
	}
}

static void extremes(void **unused)
{
	const double m = DBL_MAX, d = 0x1p-1074;
	const double a[3] = {-m, -m, -m}, b[3] = {m, m, m}, c[3] = {d, d, d}, e[3] = {d, d, 2 * d};
	const double o[3] = {0, 0, 0}, f[3] = {m, -m, d}, g[3] = {-d, 0.0, -0.0};

	(void)unused;
	check3d(a, b, c, e);
	check3d(a, b, f, g);
	check3d(o, c, e, g);
	check3d(a, f, c, g);
	check2d(a, b, f);
	check2d(a, b, c);
	check2d(o, b, e);
	assert_int_equal(mp_collinear(a, b, c), 1);
	assert_int_equal(mp_collinear(a, b, e), 0);
	assert_int_equal(mp_collinear(o, c, g), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(simple_signs),
	    cmocka_unit_test(random_points_agree_with_rationals),
	    cmocka_unit_test(nearly_degenerate_points_agree_with_rationals),
	    cmocka_unit_test(lattice_points_agree_with_rationals_at_every_scale),
	    cmocka_unit_test(any_doubles_agree_with_rationals),
	    cmocka_unit_test(extremes),
	};

	return cmocka_run_group_tests_name("predicates", tests, NULL, NULL);
}
