#include "core/moments/moments.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/decoder.h"
#include "tests/unit/report_of.h"

/* A copy of exactly the block, so that a sanitizer sees what a kernel reads behind it. */
static void add(struct mp_moments *m, const struct mesh *mesh)
{
	for (size_t at = 0; at < mesh->count; at += MP_BLOCK) {
		size_t count = mesh->count - at < MP_BLOCK ? mesh->count - at : MP_BLOCK;
		double(*block)[9] = malloc(count * sizeof *block);

		assert_non_null(block);
		memcpy(block, mesh->tri + at, count * sizeof *block);
		mp_moments_add(m, (const double(*)[9])block, count);
		free(block);
	}
}

static void sum(struct mp_moments *m, const struct mesh *mesh)
{
	mp_moments_begin(m);
	add(m, mesh);
}

static struct mp_solid solve(const struct mesh *mesh)
{
	struct mp_moments m;
	struct mp_solid solid;

	sum(&m, mesh);
	mp_moments_solve(&m, &solid);
	return solid;
}

/* The same with the second pass where the first one asks for it. */
static struct mp_solid solve_twice(const struct mesh *mesh)
{
	struct mp_moments m, second;
	struct mp_solid solid;

	sum(&m, mesh);
	mp_moments_solve(&m, &solid);
	assert_true(solid.again);
	mp_moments_begin_again(&second, &m);
	add(&second, mesh);
	mp_moments_solve(&second, &solid);
	return solid;
}

static void assert_box(const struct mp_solid *s, const double min[3], const double max[3],
		       double tolerance)
{
	double side[3], volume;

	for (int k = 0; k < 3; k++)
		side[k] = max[k] - min[k];
	volume = side[0] * side[1] * side[2];
	assert_true(s->in_range && s->area_in_range && s->has_centroid && s->has_surface_centroid);
	assert_relative((double)s->volume, volume, tolerance);
	assert_relative((double)s->area,
			2 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]), tolerance);
	for (int k = 0; k < 3; k++) {
		assert_near((double)s->centroid[k], (min[k] + max[k]) / 2, tolerance * side[k]);
		assert_near((double)s->surface_centroid[k], (min[k] + max[k]) / 2,
			    tolerance * side[k]);
		assert_relative((double)s->cov[k], side[k] * side[k] / 12, tolerance);
		assert_near((double)s->cov[3 + k], 0, tolerance * side[k] * side[(k + 1) % 3]);
		assert_near((double)s->vector_area[k], 0, 0);
	}
}

/* Twice the same sheet, front and back, from other corners: nothing but rounding noise. */
static void test_two_sided_sheet_has_no_volume(void **state)
{
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	for (int i = 0; i < 100; i++) {
		int row = i / 10, column = i % 10;
		double x = 0.37 * column, y = 0.53 * row, h = 0.41;
		const double a[3] = {x, y, 0.1 * x + 0.7 * y};
		const double b[3] = {x + h, y, 0.1 * (x + h) + 0.7 * y};
		const double c[3] = {x, y + h, 0.1 * x + 0.7 * (y + h)};

		mesh_triangle(&m, a, b, c);
		mesh_triangle(&m, c, b, a);
	}
	s = solve_twice(&m);
	assert_true(s.in_range && s.volume == 0 && !s.has_centroid);
	assert_relative((double)s.area, 100 * 0.41 * 0.41 * sqrt(1 + 0.01 + 0.49), 1e-14);
	mesh_free(&m);
}

static void test_flat_box_has_no_volume(void **state)
{
	const double min[3] = {1, 2, 3.3}, max[3] = {4, 7, 3.3};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_box(&m, min, max);
	s = solve(&m);
	assert_true(s.in_range && s.volume == 0 && !s.has_centroid && !s.again);
	assert_relative((double)s.area, 30, 1e-15);
	mesh_free(&m);
}

static void test_thin_plate_keeps_its_volume(void **state)
{
	struct mesh m = {0};
	struct mp_solid s;
	const double min[3] = {-500, -500, 0}, max[3] = {500, 500, 1e-6};

	(void)state;
	mesh_box(&m, min, max);
	s = solve(&m);
	assert_box(&s, min, max, 1e-15);
	mesh_free(&m);
}

/* A stray triangle without area, far away, comes first: the reference must not stay with it. */
static void test_stray_first_vertex_is_left(void **state)
{
	const double min[3] = {0.1, 0.2, 0.3}, max[3] = {1.2, 1.5, 1.1};
	const double far[3] = {1e8 + 0.3, -1e8, 3e7};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_triangle(&m, far, far, min);
	mesh_box(&m, min, max);
	s = solve_twice(&m);
	assert_box(&s, min, max, 1e-14);
	assert_false(s.again);
	mesh_free(&m);
}

/* Not so far that the volume is in doubt: the second moments suffer first. */
static void test_reference_at_some_distance_is_left(void **state)
{
	const double min[3] = {0.1, 0.2, 0.3}, max[3] = {1.2, 1.5, 1.1}, far[3] = {300, 200, 100};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_triangle(&m, far, far, min);
	mesh_box(&m, min, max);
	s = solve_twice(&m);
	assert_box(&s, min, max, 2e-15);
	mesh_free(&m);
}

/* Scaled to the stray vertex the cube is nothing: no answer rather than a wrong one. */
static void test_lost_beside_a_stray_vertex_is_out_of_range(void **state)
{
	const double min[3] = {0, 0, 0}, max[3] = {1, 1, 1}, far[3] = {1e300, -1e300, 1e300};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_triangle(&m, far, far, min);
	mesh_box(&m, min, max);
	s = solve_twice(&m);
	assert_false(s.in_range);
	mesh_free(&m);
}

static void test_tiny_area_wants_a_second_pass(void **state)
{
	static const double SIZE[] = {1e-78, 1e-160, 1e-200};

	(void)state;
	for (size_t i = 0; i < sizeof SIZE / sizeof *SIZE; i++) {
		const double a[3] = {0, 0, 1}, b[3] = {SIZE[i], 0, 1}, c[3] = {0, SIZE[i], 1};
		struct mesh m = {0};
		struct mp_solid s;

		mesh_triangle(&m, a, b, c);
		s = solve(&m);
		assert_true(s.area_again);
		s = solve_twice(&m);
		assert_true(s.area_in_range);
		assert_relative((double)(s.area / SIZE[i] / SIZE[i]), 0.5, 4e-16);
		mesh_free(&m);
	}
}

static void test_range_of_scales(void **state)
{
	static const double SCALE[] = {1e-320, 1e-300, 1e-160, 1e-100, 1e-78, 1e-63,
				       1e78,   1e100,  1e153,  1e200,  1e307};

	(void)state;
	for (size_t i = 0; i < sizeof SCALE / sizeof *SCALE; i++) {
		double side[3] = {4 * SCALE[i], 3 * SCALE[i], 2 * SCALE[i]};
		struct mesh m = {0};
		struct mp_solid s;
		const double min[3] = {0, 0, 0};

		mesh_box(&m, min, side);
		s = solve_twice(&m);
		assert_true(s.in_range && s.area_in_range && s.has_centroid);
		for (int k = 0; k < 3; k++) { /* back to about 1 by exact quotients */
			assert_near((double)(s.centroid[k] / side[k]), 0.5, 2e-16);
			assert_relative((double)(s.cov[k] / side[k] / side[k]), 1 / 12.0, 2e-16);
		}
		assert_near((double)(s.volume / side[0] / side[1] / side[2]), 1, 3e-16);
		assert_near((double)(s.area / side[0] / side[1]), 2 + 2 * (2 / 3.0) + 2 * (2 / 4.0),
			    SCALE[i] > 1e-310 ? 1e-15 : 1e-3);
		mesh_free(&m);
	}
}

/* A needle's thin sides are scaled by themselves: their squares underflow beside the length. */
static void test_needle_of_extreme_proportions(void **state)
{
	const double min[3] = {0, 0, 0}, side[3] = {1e50, 1e-100, 2e-100};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_box(&m, min, side);
	s = solve_twice(&m);
	assert_box(&s, min, side, 4e-16);
	mesh_free(&m);
}

static void test_opposite_ends_of_the_range(void **state)
{
	const double min[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX}, max[3] = {DBL_MAX, DBL_MAX, DBL_MAX};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_box(&m, min, max);
	s = solve_twice(&m);
	assert_true(s.in_range && s.area_in_range);
	for (int k = 0; k < 3; k++) {
		assert_true(s.centroid[k] == 0);
		assert_relative((double)(s.cov[k] / DBL_MAX / DBL_MAX), 1 / 3.0, 2e-16);
	}
	assert_near((double)(s.volume / DBL_MAX / DBL_MAX / DBL_MAX), 8, 1e-18);
	mesh_free(&m);
}

static void test_areas_of_a_flat_mesh_are_scaled_too(void **state)
{
	const double a[3] = {0, 0, 1e290}, b[3] = {3e-100, 0, 1e290}, c[3] = {0, 4e-100, 1e290};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_triangle(&m, a, b, c);
	s = solve_twice(&m);
	assert_true(s.in_range && s.area_in_range && s.volume == 0);
	assert_relative((double)s.area, 6e-200, 4e-16);
	assert_relative((double)s.surface_centroid[0], 1e-100, 4e-16);
	assert_true(s.surface_centroid[2] == 1e290);
	assert_relative((double)s.vector_area[2], 6e-200, 4e-16);
	mesh_free(&m);
}

static void test_merged_parts_are_the_whole(void **state)
{
	const double box[4][3] = {{0, 0, 0}, {1, 2, 3}, {5, 5, 5}, {7, 6, 9}};
	const long double origin[3] = {3, 3, 3};
	struct mesh m[3] = {{0}};
	struct mp_merge merge;
	struct mp_solid whole, merged = {0};

	(void)state;
	mesh_box(&m[0], box[0], box[1]);
	mesh_box(&m[1], box[2], box[3]);
	mesh_box(&m[2], box[0], box[1]);
	mesh_box(&m[2], box[2], box[3]);
	mp_merge_begin(&merge, origin);
	for (int i = 0; i < 2; i++) {
		struct mp_solid part = solve(&m[i]);

		mp_merge_add(&merge, &part);
	}
	mp_merge_solve(&merge, &merged);
	whole = solve(&m[2]);
	assert_true(merged.volume == whole.volume && merged.has_centroid);
	for (int k = 0; k < 3; k++)
		assert_near((double)merged.centroid[k], (double)whole.centroid[k], 1e-18);
	for (int k = 0; k < 6; k++)
		assert_near((double)merged.cov[k], (double)whole.cov[k], 1e-17);
	for (int i = 0; i < 3; i++)
		mesh_free(&m[i]);
}

static void test_merged_opposites_have_no_volume(void **state)
{
	const double min[3] = {0, 0, 0}, max[3] = {1.1, 1.3, 1.7};
	const long double origin[3] = {0, 0, 0};
	struct mesh m = {0};
	struct mp_merge merge;
	struct mp_solid part, merged = {0};

	(void)state;
	mp_merge_begin(&merge, origin);
	mesh_box(&m, min, max);
	part = solve(&m);
	mp_merge_add(&merge, &part);
	mesh_flip(&m, 0);
	mesh_move(&m, 0, 10.1, 0, 0);
	part = solve(&m);
	mp_merge_add(&merge, &part);
	mp_merge_solve(&merge, &merged);
	assert_true(merged.volume == 0 && !merged.has_centroid);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_two_sided_sheet_has_no_volume),
	    cmocka_unit_test(test_flat_box_has_no_volume),
	    cmocka_unit_test(test_thin_plate_keeps_its_volume),
	    cmocka_unit_test(test_stray_first_vertex_is_left),
	    cmocka_unit_test(test_reference_at_some_distance_is_left),
	    cmocka_unit_test(test_lost_beside_a_stray_vertex_is_out_of_range),
	    cmocka_unit_test(test_tiny_area_wants_a_second_pass),
	    cmocka_unit_test(test_range_of_scales),
	    cmocka_unit_test(test_needle_of_extreme_proportions),
	    cmocka_unit_test(test_opposite_ends_of_the_range),
	    cmocka_unit_test(test_areas_of_a_flat_mesh_are_scaled_too),
	    cmocka_unit_test(test_merged_parts_are_the_whole),
	    cmocka_unit_test(test_merged_opposites_have_no_volume),
	};

	return cmocka_run_group_tests_name("moments_range", tests, NULL, NULL);
}
