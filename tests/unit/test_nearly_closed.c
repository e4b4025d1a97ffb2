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

static uint64_t next(uint64_t *s)
{
	*s ^= *s << 13;
	*s ^= *s >> 7;
	*s ^= *s << 17;
	return *s;
}

/* Each corner by up to ${k} times ${step} along each axis, upwards; the first of each place not. */
static void tear(struct mesh *m, unsigned k, double step, uint64_t *seed)
{
	for (size_t c = 1; c < 3 * m->count; c++)
		for (size_t i = 0; i < 3 && next(seed) % 3 == 0; i++)
			m->tri[c / 3][3 * (c % 3) + i] += (double)(next(seed) % (k + 1)) * step;
}

static void make(struct mesh *m)
{
	mesh_torus(m, 20, 6, 24, 12);
	mesh_scale(m, 0, 10, 10, 10); /* up to 260 */
	for (size_t i = 0; i < 9 * m->count; i++)
		m->tri[i / 9][i % 9] = (double)(float)m->tri[i / 9][i % 9];
}

static double tolerance_of(const struct mesh *m, const struct mp_request *request, bool *watertight)
{
	struct mp_report r;
	double found;

	report_of_binary(m, request, &r);
	found = r.closes_at_tolerance;
	*watertight = r.topology.watertight;
	assert_int_equal(MP_WARNED(&r, MP_WARN_NEARLY_CLOSED), found > 0);
	mp_report_free(&r);
	return found;
}

static void what_rounding_tore_closes_at_what_is_said(void **state)
{
	const double ulp = 0x1p-15; /* of 256 .. 512 */
	struct mp_request request = request_plain();
	uint64_t seed = 6;

	(void)state;
	for (int i = 0; i < 20; i++) {
		/* half a step here: chains of such are shorter than 1 and 4 steps */
		unsigned k = i % 2 == 0 ? 1 : 4;
		struct mesh m = {0};
		bool watertight;
		double found;

		make(&m);
		tear(&m, 1, k == 1 ? ulp / 4 : 2 * ulp, &seed);
		request.weld = 0;
		found = tolerance_of(&m, &request, &watertight);
		assert_false(watertight);
		assert_true(found == k * ulp);
		request.weld = found;
		assert_true(tolerance_of(&m, &request, &watertight) == 0);
		assert_true(watertight);
		request.weld = found / 16;
		(void)tolerance_of(&m, &request, &watertight);
		assert_false(watertight);
		mesh_free(&m);
	}
}

static void wider_gaps_and_real_holes_are_not_explained(void **state)
{
	struct mesh m = {0};
	uint64_t seed = 7;
	bool watertight;

	(void)state;
	make(&m);
	assert_true(tolerance_of(&m, NULL, &watertight) == 0);
	assert_true(watertight);
	tear(&m, 1, 0x1p-12, &seed);
	assert_true(tolerance_of(&m, NULL, &watertight) == 0);
	m.count = 0;
	make(&m);
	tear(&m, 1, 0x1p-17, &seed);
	assert_true(tolerance_of(&m, NULL, &watertight) == 0x1p-15);
	m.count--; /* beside all that a triangle is missing */
	assert_true(tolerance_of(&m, NULL, &watertight) == 0);
	mesh_free(&m);
}

/*
 * The boundary alone would close, but welding all of it tears what is fine: a box so small that it
 * is welded to a needle, which then has its edges four times.
 */
static void all_of_the_mesh_is_welded_not_the_boundary_alone(void **state)
{
	static const double low[3] = {256, 0, 0}, high[3] = {300, 9, 9},
			    tiny[3] = {0x1p-17, 0x1p-17, 8};
	static const double zero[3] = {0, 0, 0};
	struct mesh m = {0};
	bool watertight;
	size_t needle;

	(void)state;
	mesh_box(&m, low, high);
	m.tri[0][1] += 0x1p-16; /* what is to be closed */
	assert_true(tolerance_of(&m, NULL, &watertight) == 0x1p-15);
	needle = m.count;
	mesh_box(&m, zero, tiny); /* collapses to a line: no edges, still fine */
	assert_true(tolerance_of(&m, NULL, &watertight) == 0x1p-15);
	m.count = needle;
	mesh_wedge(&m, 8, 0x1p-17, 8); /* collapses to two sides of one triangle: fine too */
	assert_true(tolerance_of(&m, NULL, &watertight) == 0x1p-15);
	mesh_wedge(&m, 8, 0x1p-17, 8); /* and another on top of it: edges of four */
	mesh_move(&m, needle + 4, 0, 0x1p-16, 0);
	assert_true(tolerance_of(&m, NULL, &watertight) == 0);
	mesh_free(&m);
}

/* A map of twice the size has twice the tolerance, and the same answer. */
static void maps_scale_the_tolerance(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	uint64_t seed = 6;
	bool watertight;

	(void)state;
	make(&m);
	tear(&m, 1, 0x1p-17, &seed);
	request.has_transform = true;
	for (int k = 0; k < 3; k++)
		request.transform[k][(k + 1) % 3] = 2;
	assert_true(tolerance_of(&m, &request, &watertight) == 0x1p-14);
	request.weld = 0x1p-14;
	assert_true(tolerance_of(&m, &request, &watertight) == 0);
	assert_true(watertight);
	mesh_free(&m);
}

static void sizes_at_the_ends_of_doubles_are_fine(void **state)
{
	static const double a[3] = {0, 0, 0}, b[3] = {DBL_MAX, 0, 0}, c[3] = {0, -DBL_MAX, 0},
			    d[3] = {5e-324, 0, 0}, e[3] = {0, 5e-324, 0};
	struct mp_report r;
	struct mesh m = {0};

	(void)state;
	mesh_triangle(&m, a, b, c);
	report_of_ascii(&m, NULL, &r);
	assert_true(r.closes_at_tolerance == 0);
	mp_report_free(&r);
	m.count = 0;
	mesh_triangle(&m, a, d, e);
	report_of_ascii(&m, NULL, &r);
	assert_true(r.closes_at_tolerance == 0);
	mp_report_free(&r);
	m.count = 0;
	mesh_triangle(&m, a, a, a);
	report_of_ascii(&m, NULL, &r);
	assert_true(r.closes_at_tolerance == 0);
	mp_report_free(&r);
	mesh_free(&m);
}

static void every_allocation_may_fail(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	uint64_t seed = 3;

	(void)state;
	make(&m);
	tear(&m, 1, 0x1p-17, &seed);
	report_without_memory(&m, &request, 1000);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(what_rounding_tore_closes_at_what_is_said),
	    cmocka_unit_test(wider_gaps_and_real_holes_are_not_explained),
	    cmocka_unit_test(all_of_the_mesh_is_welded_not_the_boundary_alone),
	    cmocka_unit_test(maps_scale_the_tolerance),
	    cmocka_unit_test(sizes_at_the_ends_of_doubles_are_fine),
	    cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests_name("nearly_closed", tests, NULL, NULL);
}
