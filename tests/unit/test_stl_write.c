#include "core/stl/stl_write.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double zero[3];

static float number(const uint8_t *at)
{
	const uint32_t bits =
	    (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
	float f;

	memcpy(&f, &bits, sizeof f);
	return f;
}

/* A heap copy of the exact size, so that a byte too many is seen. */
static uint8_t *facet(const double corner[3][3], const double origin[3])
{
	uint8_t *out = malloc(MP_STL_FACET);

	assert_non_null(out);
	assert_true(mp_stl_write_facet(out, corner, origin));
	return out;
}

static void assert_normal(const double corner[3][3], float x, float y, float z)
{
	uint8_t *out = facet(corner, zero);

	assert_true(number(out) == x && number(out + 4) == y && number(out + 8) == z);
	free(out);
}

static void test_head(void **state)
{
	uint8_t *out = malloc(MP_STL_HEAD);

	(void)state;
	assert_non_null(out);
	mp_stl_write_head(out, 0x01020304);
	assert_memory_equal(out + 80, "\x04\x03\x02\x01", 4);
	assert_memory_not_equal(out, "solid", 5);
	free(out);
}

static void test_corners_are_nearest_floats(void **state)
{
	static const double corner[3][3] = {{1e6 + 0.1, 2, -3}, {1e6 + 1.1, 2, -3}, {1e6, 5.3, -3}};
	static const double origin[3] = {1e6, 0, -3};
	uint8_t *out = facet(corner, origin);

	(void)state;
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			assert_true(number(out + 12 + 12 * i + 4 * k) ==
				    (float)(corner[i][k] - origin[k]));
	assert_memory_equal(out + 48, "\0\0", 2);
	free(out);
}

static void test_normals_of_any_size(void **state)
{
	static const double sizes[] = {1, 1e-300, 1e-150, 1e37, 0x1p-1021};

	(void)state;
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
		const double s = sizes[i];
		const double corner[3][3] = {{0, 0, 0}, {0, s, 0}, {0, 0, s}};

		assert_normal(corner, 1, 0, 0);
	}
}

static void test_no_normal_where_there_is_no_area(void **state)
{
	static const double line[3][3] = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}};
	static const double point[3][3] = {{7, 7, 7}, {7, 7, 7}, {7, 7, 7}};

	(void)state;
	assert_normal(line, 0, 0, 0);
	assert_normal(point, 0, 0, 0);
}

static void test_what_float32_does_not_hold(void **state)
{
	double corner[3][3] = {{0, 0, 0}, {(double)FLT_MAX, 0, 0}, {0, 1, 0}};
	uint8_t out[MP_STL_FACET];

	(void)state;
	assert_true(mp_stl_write_facet(out, (const double(*)[3])corner, zero));
	corner[2][1] = 2 * (double)FLT_MAX;
	assert_false(mp_stl_write_facet(out, (const double(*)[3])corner, zero));
	corner[2][1] = -DBL_MAX;
	assert_false(mp_stl_write_facet(out, (const double(*)[3])corner, zero));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_head),
	    cmocka_unit_test(test_corners_are_nearest_floats),
	    cmocka_unit_test(test_normals_of_any_size),
	    cmocka_unit_test(test_no_normal_where_there_is_no_area),
	    cmocka_unit_test(test_what_float32_does_not_hold),
	};

	return cmocka_run_group_tests_name("stl_write", tests, NULL, NULL);
}
