/* The affine map itself: points, boxes, what it is, and areas. */
#include "core/affine/affine.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/mesh_random.h"
#include "tests/unit/oracle.h"
#include "tests/unit/soup.h"

typedef const double (*rows)[4];

static struct mp_affine map_of(const double row[3][4])
{
	struct mp_affine a;

	assert_true(mp_affine_set(&a, row));
	return a;
}

/* Of any size, sums that cancel, ties and subnormal results among them. */
static double draw(uint64_t *state, int kind)
{
	double x = random_between(state, -1, 1);

	switch (kind) {
	case 0:
		return x;
	case 1:
		return ldexp(x, (int)(random_bits(state) % 2000) - 1000);
	case 2:
		return (double)((int)(random_bits(state) % 17) - 8) * 0.125;
	default:
		return ldexp(x, -540);
	}
}

static void test_coordinates_are_the_nearest_doubles(void **unused)
{
	uint64_t state = 7;
	mpq_t exact;

	(void)unused;
	mpq_init(exact);
	for (int n = 0; n < 40000; n++) {
		double row[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, x[3], y[3];
		struct mp_affine a;

		for (int k = 0; k < 12; k++)
			row[k / 4][k % 4] = draw(&state, n % 4);
		for (int k = 0; k < 3; k++)
			x[k] = draw(&state, n % 4);
		if (n % 3 == 0) /* what is left after cancelling */
			row[0][3] = -(row[0][0] * x[0] + row[0][1] * x[1] + row[0][2] * x[2]);
		if (!mp_affine_set(&a, (rows)row) || !mp_affine_point(&a, x, y))
			continue;
		for (int i = 0; i < 3; i++) {
			oracle_coordinate(row[i], x, exact);
			assert_true(oracle_is_nearest(exact, y[i]) &&
				    !(y[i] == 0 && signbit(y[i])));
		}
	}
	mpq_clear(exact);
}

static void test_halves_go_to_the_even_neighbour(void **unused)
{
	const double row[3][4] = {{1, 0, 0, 0x1p53}, {0, 1, 0, 0x1p53}, {0, 0, 1, -0x1p53}};
	const double x[3] = {1, 3, 0x1.8p-1022};
	struct mp_affine a = map_of(row);
	double y[3];

	(void)unused;
	assert_true(mp_affine_point(&a, x, y));
	assert_true(y[0] == 0x1p53 && y[1] == 0x1p53 + 4 && y[2] == -0x1p53);
}

static void test_beyond_the_doubles_is_said(void **unused)
{
	const double row[3][4] = {{2, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
	const double top[3] = {DBL_MAX, 1, 1}, half[3] = {DBL_MAX / 2, 1, 1};
	const double back[3][4] = {{2, 0, 0, -DBL_MAX}, {0, 1, 0, 0}, {0, 0, 1, 0}};
	struct mp_affine a = map_of(row), b = map_of(back);
	double y[3];

	(void)unused;
	assert_false(mp_affine_point(&a, top, y));
	assert_true(mp_affine_point(&a, half, y) && y[0] == DBL_MAX);
	assert_true(mp_affine_point(&b, top, y) && y[0] == DBL_MAX); /* on the way it was more */
}

static void test_what_a_map_is(void **unused)
{
	const double identity[3][4] = {{1, 0, -0.0, 0}, {0, 1, 0, 0}, {-0.0, 0, 1, 0}};
	const double moved[3][4] = {{1, 0, 0, 1e-300}, {0, 1, 0, 0}, {0, 0, 1, 0}};
	const double swapped[3][4] = {{0, 25.4, 0, 1}, {-25.4, 0, 0, 0}, {0, 0, -25.4, 3}};
	const double stretched[3][4] = {{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 1, 0}};
	const double sheared[3][4] = {{1, 1, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
	const double twice[3][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}};
	struct mp_affine a = map_of(identity);

	(void)unused;
	assert_true(mp_affine_is_identity(&a) && a.factor == 1 && !a.mirrors);
	assert_true(a.size.mid == 1 && a.size.rad == 0);
	a = map_of(moved);
	assert_true(!mp_affine_is_identity(&a) && a.factor == 1);
	a = map_of(swapped);
	assert_true(a.mirrors && a.factor == 25.4);
	a = map_of(stretched);
	assert_true(a.factor == 0 && a.size.mid == 4 && a.size.rad == 0);
	a = map_of(sheared);
	assert_true(a.factor == 0 && a.size.mid == 1);
	assert_false(mp_affine_set(&a, twice));
}

static void test_the_determinant_is_within_its_bound(void **unused)
{
	uint64_t state = 99;
	mpq_t exact, x;

	(void)unused;
	mpq_inits(exact, x, NULL);
	for (int n = 0; n < 20000; n++) {
		double row[3][4], mid, rad;
		struct mp_affine a;

		for (int k = 0; k < 12; k++)
			row[k / 4][k % 4] = draw(&state, n % 2 * 2);
		if (n % 5 == 0) /* nearly singular */
			for (int k = 0; k < 3; k++)
				row[2][k] = row[0][k] + row[1][k];
		oracle_determinant((rows)row, exact);
		assert_int_equal(mp_affine_set(&a, (rows)row), mpq_sgn(exact) != 0);
		if (mpq_sgn(exact) == 0)
			continue;
		assert_int_equal(a.mirrors, mpq_sgn(exact) < 0);
		mid = (double)a.size.mid;
		mpq_abs(exact, exact);
		mpq_set_d(x, mid);
		mpq_sub(exact, exact, x);
		mpq_set_d(x, (double)(a.size.mid - mid));
		mpq_sub(exact, exact, x);
		mpq_abs(exact, exact);
		rad = mp_round_up(a.size.rad);
		mpq_set_d(x, rad);
		assert_true(mpq_cmp(exact, x) <= 0);
		assert_true(rad <= 0x1p-60 * mid);
	}
	mpq_clears(exact, x, NULL);
}

/* Every vertex by itself is the slow way to the same box. */
static void test_a_box_is_that_of_the_mapped_vertices(void **unused)
{
	uint64_t state = 5;

	(void)unused;
	for (int n = 0; n < 200; n++) {
		struct soup soup = {0};
		struct built built;
		struct mp_box box, all, want = {{0}, {0}};
		struct mp_affine a;
		double row[3][4];

		soup_torus(&soup, 9, 7, 3, 1);
		for (int k = 0; k < 12; k++)
			row[k / 4][k % 4] =
			    draw(&state, n % 3 == 2 ? 2 : 0) * (k % 4 == 3 ? 1e6 : 1);
		if (!mp_affine_set(&a, (rows)row)) {
			soup_free(&soup);
			continue;
		}
		assert_int_equal(soup_build(&soup, 1, &built, NULL), 0);
		assert_true(mp_affine_box(&a, &built.mesh, NULL, built.mesh.triangles, &box) &&
			    mp_affine_box_of_all(&a, built.vertices, &all));
		for (size_t i = 0; i < 3 * soup.count; i++) {
			double y[3];

			assert_true(mp_affine_point(&a, &soup.tri[i / 3][i % 3 * 3], y));
			for (int k = 0; k < 3; k++) {
				want.min[k] = i == 0 ? y[k] : fmin(want.min[k], y[k]);
				want.max[k] = i == 0 ? y[k] : fmax(want.max[k], y[k]);
			}
		}
		assert_memory_equal(&box, &want, sizeof box);
		assert_memory_equal(&all, &want, sizeof box);
		built_free(&built);
		soup_free(&soup);
	}
}

/* Of a part of the triangles, in units where products leave the range of doubles. */
static void test_areas_of_extreme_sizes(void **unused)
{
	const double row[3][4] = {{2, 0, 0, 5}, {0, 3, 0, 0}, {0, 0, 1, 0}};
	const double min[3] = {0, 0, 0};
	const uint32_t order[2] = {1, 2};

	(void)unused;
	for (int e = -500; e <= 500; e += 100) {
		double size = ldexp(1, e), max[3] = {size, size, size};
		struct mp_affine a = map_of(row);
		struct soup soup = {0};
		struct built built;
		struct mp_solid s = {.area_in_range = true, .area_bound = 1};
		struct mp_box box = {{0, 0, 0}, {size, size, size}};
		long double want = 22.0L * size * size;

		soup_box(&soup, min, max);
		assert_int_equal(soup_build(&soup, 1, &built, NULL), 0);
		mp_affine_area(&a, &built.mesh, NULL, 12, &box, &s);
		assert_true(s.area_in_range && s.has_surface_centroid);
		assert_true(fabsl(s.area - want) <= s.area_bound && s.area_bound <= 1e-14L * want);
		assert_true(s.surface_centroid[0] == size + 5.0L);
		assert_true(s.vector_area[0] == 0 && s.vector_area[2] == 0);
		mp_affine_area(&a, &built.mesh, order, 2, &box, &s);
		assert_true(s.area_in_range && s.area > 0 && s.area < want / 2);
		built_free(&built);
		soup_free(&soup);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_coordinates_are_the_nearest_doubles),
	    cmocka_unit_test(test_halves_go_to_the_even_neighbour),
	    cmocka_unit_test(test_beyond_the_doubles_is_said),
	    cmocka_unit_test(test_what_a_map_is),
	    cmocka_unit_test(test_the_determinant_is_within_its_bound),
	    cmocka_unit_test(test_a_box_is_that_of_the_mapped_vertices),
	    cmocka_unit_test(test_areas_of_extreme_sizes),
	};

	return cmocka_run_group_tests_name("affine", tests, NULL, NULL);
}
