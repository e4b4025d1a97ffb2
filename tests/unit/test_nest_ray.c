#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/bodies/containment.h"
#include "soup.h"

static void points_on_triangles(void **unused)
{
	const struct mp_corners t = {{{0, 0, 0}, {4, 0, 0}, {0, 0, 4}}};
	const struct mp_corners flat = {{{0, 0, 0}, {2, 2, 2}, {1, 1, 1}}};
	const double on[4][3] = {{0, 0, 0}, {2, 0, 2}, {1, 0, 1}, {4, 0, 0}};
	const double off[4][3] = {{3, 0, 2}, {1, 0x1p-1074, 1}, {-1, 0, 0}, {4, 0, 4}};
	const double middle[3] = {1.5, 1.5, 1.5}, beside[3] = {1.5, 1.5, 1};

	(void)unused;
	for (int i = 0; i < 4; i++) {
		assert_true(mp_on_triangle(&t, on[i]));
		assert_false(mp_on_triangle(&t, off[i]));
	}
	assert_true(mp_on_triangle(&flat, middle));
	assert_false(mp_on_triangle(&flat, beside));
}

/* What all triangles say of a point: 1, 0, or -1 for on the surface. */
static int winding(const struct soup *s, const double p[3])
{
	int sum = 0;

	for (size_t i = 0; i < s->count; i++) {
		struct mp_corners t;

		memcpy(&t, s->tri[i], sizeof t);
		if (mp_on_triangle(&t, p))
			return -1;
		sum += mp_ray_crossing(&t, p);
	}
	return sum;
}

/* Whole and half coordinates: rays run through corners, along edges and inside faces. */
static void points_of_a_grid_against_a_box(void **unused)
{
	struct soup s = {0};

	(void)unused;
	soup_cube(&s, 1, 1, 1, 2);
	for (int i = 0; i < 9 * 9 * 9; i++) {
		const int at[3] = {i % 9, i / 9 % 9, i / 81};
		double p[3] = {at[0] / 2.0, at[1] / 2.0, at[2] / 2.0};
		double d = 0;

		for (int k = 0; k < 3; k++)
			d = fmax(d, fabs(p[k] - 2));
		assert_int_equal(winding(&s, p), d < 1 ? 1 : d > 1 ? 0 : -1);
	}
	soup_free(&s);
}

static void points_of_a_grid_against_an_octahedron(void **unused)
{
	const double e[6][3] = {{2, 0, 0},  {-2, 0, 0}, {0, 2, 0},
				{0, -2, 0}, {0, 0, 2},  {0, 0, -2}};
	struct soup s = {0};

	(void)unused;
	for (int i = 0; i < 8; i++) {
		const double *x = e[i & 1], *y = e[2 + (i >> 1 & 1)], *z = e[4 + (i >> 2)];
		bool odd = (i ^ i >> 1 ^ i >> 2) & 1;

		soup_add(&s, x, odd ? z : y, odd ? y : z);
	}
	for (int i = 0; i < 13 * 13 * 13; i++) {
		const int at[3] = {i % 13 - 6, i / 13 % 13 - 6, i / 169 - 6};
		double p[3] = {at[0] / 2.0, at[1] / 2.0, at[2] / 2.0};
		double d = fabs(p[0]) + fabs(p[1]) + fabs(p[2]);

		assert_int_equal(winding(&s, p), d < 2 ? 1 : d > 2 ? 0 : -1);
	}
	soup_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(points_on_triangles),
	    cmocka_unit_test(points_of_a_grid_against_a_box),
	    cmocka_unit_test(points_of_a_grid_against_an_octahedron),
	};

	return cmocka_run_group_tests_name("nest_ray", tests, NULL, NULL);
}
