#include "core/moments/principal.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/report_of.h"

/* A small generator of our own, so that every run and platform sees the same numbers. */
static double random_unit(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) / 9007199254740992.0;
}

static void random_rotation(uint64_t *state, double r[3][3])
{
	double q[4], length = 0;

	for (int i = 0; i < 4; i++) {
		q[i] = 2 * random_unit(state) - 1;
		length += q[i] * q[i];
	}
	for (int i = 0; i < 4; i++)
		q[i] /= sqrt(length);
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		r[i][i] = 1 - 2 * (q[1 + j] * q[1 + j] + q[1 + k] * q[1 + k]);
		r[i][j] = 2 * (q[1 + i] * q[1 + j] - q[0] * q[1 + k]);
		r[i][k] = 2 * (q[1 + i] * q[1 + k] + q[0] * q[1 + j]);
	}
}

/* Rows of ${r} are the axes of ${moments}. */
static void tensor(const double moments[3], double r[3][3], double out[3][3])
{
	for (int i = 0; i < 3; i++) {
		for (int j = i; j < 3; j++) {
			long double sum = 0;

			for (int k = 0; k < 3; k++)
				sum += (long double)moments[k] * r[k][i] * r[k][j];
			out[i][j] = out[j][i] = (double)sum;
		}
	}
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* What holds whatever the tensor: order, orthogonality, handedness, signs, the quaternion. */
static void assert_conventions(const struct mp_principal *p)
{
	const double *q = p->quaternion;
	double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];

	assert_true(p->moments[0] <= p->moments[1] && p->moments[1] <= p->moments[2]);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			assert_near(dot(p->axes[i], p->axes[j]), i == j, 1e-15);
		assert_near(p->axes[0][(i + 1) % 3] * p->axes[1][(i + 2) % 3] -
				p->axes[0][(i + 2) % 3] * p->axes[1][(i + 1) % 3],
			    p->axes[2][i], 1e-15);
	}
	for (int i = 0; i < 2; i++) {
		double top = 0, most = 0;

		for (int k = 0; k < 3; k++) {
			if (fabs(p->axes[i][k]) > most) {
				most = fabs(p->axes[i][k]);
				top = p->axes[i][k];
			}
		}
		assert_true(top > 0);
	}
	assert_near(norm, 1, 1e-15);
	assert_true(q[0] >= 0);
	for (int i = 0; i < 3; i++) { /* R x = x + 2 w (v x x) + 2 v x (v x x) */
		double x[3] = {i == 0, i == 1, i == 2}, t[3];

		for (int k = 0; k < 3; k++)
			t[k] = 2 * (q[1 + (k + 1) % 3] * x[(k + 2) % 3] -
				    q[1 + (k + 2) % 3] * x[(k + 1) % 3]);
		for (int k = 0; k < 3; k++)
			assert_near(x[k] + q[0] * t[k] + q[1 + (k + 1) % 3] * t[(k + 2) % 3] -
					q[1 + (k + 2) % 3] * t[(k + 1) % 3],
				    p->axes[i][k], 2e-15);
	}
}

static void test_diagonal_tensor_is_exact(void **state)
{
	static const double INERTIA[3][3] = {{7.02, 0, 0}, {0, 10.8, 0}, {0, 0, 13.5}};
	static const double WANT_QUATERNION[4] = {1, 0, 0, 0};
	struct mp_principal p;

	(void)state;
	mp_principal_find(INERTIA, 1e-13, &p);
	assert_conventions(&p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_NONE);
	for (int i = 0; i < 3; i++)
		assert_true(p.moments[i] == INERTIA[i][i] && p.axes[i][i] == 1);
	assert_memory_equal(p.quaternion, WANT_QUATERNION, sizeof WANT_QUATERNION);
}

static void test_moments_are_sorted_and_right_handed(void **state)
{
	static const double INERTIA[3][3] = {{3, 0, 0}, {0, 1, 0}, {0, 0, 2}};
	static const double WANT[3][3] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
	struct mp_principal p;

	(void)state;
	mp_principal_find(INERTIA, 1e-13, &p);
	assert_conventions(&p);
	for (int i = 0; i < 9; i++)
		assert_true(p.axes[i / 3][i % 3] == WANT[i / 3][i % 3]);
}

/* [[2,1,0],[1,2,0],[0,0,5]]: 1, 3, 5 along (1,-1,0), (1,1,0), (0,0,1). */
static void test_closed_form(void **state)
{
	static const double INERTIA[3][3] = {{2, 1, 0}, {1, 2, 0}, {0, 0, 5}};
	struct mp_principal p;

	(void)state;
	mp_principal_find(INERTIA, 1e-13, &p);
	assert_conventions(&p);
	assert_near(p.moments[0], 1, 1e-15);
	assert_near(p.moments[1], 3, 1e-15);
	assert_near(p.moments[2], 5, 1e-15);
	assert_near(fabs(p.axes[0][0]), sqrt(0.5), 1e-15);
	assert_near(p.axes[0][0], -p.axes[0][1], 1e-15);
	assert_near(p.axes[1][0], p.axes[1][1], 1e-15);
	assert_near(fabs(p.axes[2][2]), 1, 1e-15);
}

static void test_random_rotations(void **state)
{
	uint64_t seed = 7;

	(void)state;
	for (int n = 0; n < 20000; n++) {
		double r[3][3], inertia[3][3], moments[3] = {1 + random_unit(&seed), 3, 4};
		struct mp_principal p;

		random_rotation(&seed, r);
		tensor(moments, r, inertia);
		mp_principal_find((const double(*)[3])inertia, 1e-13, &p);
		assert_conventions(&p);
		assert_int_equal(p.symmetry, MP_SYMMETRY_NONE);
		for (int i = 0; i < 3; i++) {
			assert_near(p.moments[i], moments[i], 1e-14);
			assert_near(fabs(dot(p.axes[i], r[i])), 1, 1e-14);
		}
	}
}

/* A needle: two large moments that nearly agree and a very small one. */
static void test_needle(void **state)
{
	static const double GAP[] = {1e-3, 1e-6, 1e-9, 1e-11};
	uint64_t seed = 11;

	(void)state;
	for (size_t n = 0; n < sizeof GAP / sizeof *GAP; n++) {
		double r[3][3], inertia[3][3], moments[3] = {1e-8, 1, 1 + GAP[n]};
		struct mp_principal p;

		random_rotation(&seed, r);
		tensor(moments, r, inertia);
		mp_principal_find((const double(*)[3])inertia, 1e-14, &p);
		assert_conventions(&p);
		assert_int_equal(p.symmetry, MP_SYMMETRY_NONE);
		for (int i = 0; i < 3; i++) {
			assert_near(p.moments[i], moments[i], 3e-15);
			/* Davis and Kahan: the axis moves by the rounding over the gap */
			assert_near(fabs(dot(p.axes[i], r[i])), 1, 1e-15 + 1e-30 / GAP[n] / GAP[n]);
		}
	}
}

static void test_residual_is_small_for_near_double_moments(void **state)
{
	uint64_t seed = 13;

	(void)state;
	for (int n = 0; n < 2000; n++) {
		double r[3][3], inertia[3][3];
		double gap = pow(10, -16 * random_unit(&seed)), moments[3] = {1, 1 + gap, 1.5};
		struct mp_principal p;

		random_rotation(&seed, r);
		tensor(moments, r, inertia);
		mp_principal_find((const double(*)[3])inertia, 0, &p);
		assert_conventions(&p);
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				assert_near(dot(inertia[k], p.axes[i]), p.moments[i] * p.axes[i][k],
					    4e-15);
	}
}

static void test_axial_low_pair_takes_projected_x(void **state)
{
	uint64_t seed = 17;

	(void)state;
	for (int n = 0; n < 2000; n++) {
		double r[3][3], inertia[3][3], moments[3] = {2, 2, 3};
		struct mp_principal p;

		random_rotation(&seed, r);
		tensor(moments, r, inertia);
		mp_principal_find((const double(*)[3])inertia, 1e-13, &p);
		assert_conventions(&p);
		assert_int_equal(p.symmetry, MP_SYMMETRY_AXIAL);
		assert_near(fabs(dot(p.axes[2], r[2])), 1, 1e-14);
		/* e1 lies in the plane of the distinct axis and X: its other neighbour is e2 */
		if (fabs(r[2][0]) < 0.89)
			assert_near(p.axes[1][0], 0, 1e-15);
		else if (fabs(r[2][0]) > 0.91)
			assert_near(p.axes[1][1], 0, 1e-15);
	}
}

static void test_axial_high_pair(void **state)
{
	static const double ALONG_X[3][3] = {{1, 0, 0}, {0, 2, 0}, {0, 0, 2}};
	static const double ALONG_Z[3][3] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 1}};
	static const double WANT_Z[3][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
	struct mp_principal p;

	(void)state;
	mp_principal_find(ALONG_X, 1e-14, &p);
	assert_conventions(&p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_AXIAL);
	for (int i = 0; i < 3; i++)
		assert_true(p.axes[i][i] == 1);
	mp_principal_find(ALONG_Z, 1e-14, &p);
	assert_conventions(&p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_AXIAL);
	for (int i = 0; i < 9; i++)
		assert_true(p.axes[i / 3][i % 3] == WANT_Z[i / 3][i % 3]);
}

static void test_spherical_takes_world_axes(void **state)
{
	double inertia[3][3] = {{2, 1e-16, -1e-16}, {1e-16, 2 + 4e-16, 0}, {-1e-16, 0, 2 - 4e-16}};
	struct mp_principal p;

	(void)state;
	mp_principal_find((const double(*)[3])inertia, 2e-14, &p);
	assert_conventions(&p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_SPHERICAL);
	for (int i = 0; i < 9; i++)
		assert_true(p.axes[i / 3][i % 3] == (i % 4 == 0));
}

static void test_tolerance_decides_the_class(void **state)
{
	static const double INERTIA[3][3] = {{1, 0, 0}, {0, 1.25, 0}, {0, 0, 2}};
	struct mp_principal p;

	(void)state;
	mp_principal_find(INERTIA, 0.2499, &p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_NONE);
	mp_principal_find(INERTIA, 0.25, &p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_AXIAL);
	mp_principal_find(INERTIA, 0.75, &p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_SPHERICAL);
}

static void test_extreme_scales(void **state)
{
	static const double SCALE[] = {1e-300, 1e-150, 1e150, 1e300, DBL_MAX / 4};
	static const double BASE[3][3] = {{2, 1, 0.5}, {1, 3, 0.25}, {0.5, 0.25, 4}};
	struct mp_principal unit;

	(void)state;
	mp_principal_find(BASE, 1e-13, &unit);
	for (size_t n = 0; n < sizeof SCALE / sizeof *SCALE; n++) {
		double inertia[3][3];
		struct mp_principal p;

		for (int i = 0; i < 9; i++)
			inertia[i / 3][i % 3] = BASE[i / 3][i % 3] / 4 * SCALE[n];
		mp_principal_find((const double(*)[3])inertia, 1e-14 * SCALE[n], &p);
		assert_conventions(&p);
		for (int i = 0; i < 9; i++)
			assert_near(p.axes[i / 3][i % 3], unit.axes[i / 3][i % 3], 1e-14);
		for (int i = 0; i < 3; i++)
			assert_near(p.moments[i] / SCALE[n], unit.moments[i] / 4, 1e-15);
	}
}

static void test_zero_tensor_is_spherical(void **state)
{
	static const double ZERO[3][3] = {{0}};
	struct mp_principal p;

	(void)state;
	mp_principal_find(ZERO, 0, &p);
	assert_conventions(&p);
	assert_int_equal(p.symmetry, MP_SYMMETRY_SPHERICAL);
	for (int i = 0; i < 3; i++)
		assert_true(p.moments[i] == 0 && p.axes[i][i] == 1);
}

/* Half a turn: w is 0 and Shepperd's other branches are taken. */
static void test_quaternion_of_half_turns(void **state)
{
	uint64_t seed = 19;
	int branch[4] = {0};

	(void)state;
	for (int n = 0; n < 5000; n++) {
		double r[3][3], inertia[3][3], moments[3] = {1, 2, 2.5};
		struct mp_principal p;
		int top = 0;

		random_rotation(&seed, r);
		tensor(moments, r, inertia);
		mp_principal_find((const double(*)[3])inertia, 1e-13, &p);
		assert_conventions(&p);
		for (int i = 1; i < 4; i++)
			if (fabs(p.quaternion[i]) > fabs(p.quaternion[top]))
				top = i;
		branch[top]++;
	}
	for (int i = 0; i < 4; i++)
		assert_true(branch[i] > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_diagonal_tensor_is_exact),
	    cmocka_unit_test(test_moments_are_sorted_and_right_handed),
	    cmocka_unit_test(test_closed_form),
	    cmocka_unit_test(test_random_rotations),
	    cmocka_unit_test(test_needle),
	    cmocka_unit_test(test_residual_is_small_for_near_double_moments),
	    cmocka_unit_test(test_axial_low_pair_takes_projected_x),
	    cmocka_unit_test(test_axial_high_pair),
	    cmocka_unit_test(test_spherical_takes_world_axes),
	    cmocka_unit_test(test_tolerance_decides_the_class),
	    cmocka_unit_test(test_extreme_scales),
	    cmocka_unit_test(test_zero_tensor_is_spherical),
	    cmocka_unit_test(test_quaternion_of_half_turns),
	};

	return cmocka_run_group_tests_name("principal", tests, NULL, NULL);
}
