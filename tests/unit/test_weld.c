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

static void shuffle(struct mesh *m, uint64_t *seed)
{
	for (size_t i = m->count - 1; i > 0; i--) {
		size_t j = (size_t)(next(seed) % (i + 1));
		double swap[9], turned[9];

		memcpy(swap, m->tri[i], sizeof swap);
		memcpy(m->tri[i], m->tri[j], sizeof swap);
		memcpy(m->tri[j], swap, sizeof swap);
		memcpy(turned, m->tri[i] + 3, 6 * sizeof(double)); /* b c a */
		memcpy(turned + 6, m->tri[i], 3 * sizeof(double));
		memcpy(m->tri[i], turned, sizeof turned);
	}
}

/* Coordinates that are multiples of 1/64, so that what is added to them is not lost in a float. */
static void coarsen(struct mesh *m)
{
	for (size_t i = 0; i < 9 * m->count; i++)
		m->tri[i / 9][i % 9] = round(64 * m->tri[i / 9][i % 9]) / 64;
}

/* Every corner by up to ${k} steps of 2^-16 upwards, and some corner of every place not at all. */
static void jitter(struct mesh *m, unsigned k, uint64_t *seed)
{
	struct mesh was = {0};

	was.tri = malloc(m->count * sizeof *m->tri);
	assert_non_null(was.tri);
	memcpy(was.tri, m->tri, m->count * sizeof *m->tri);
	for (size_t c = 0; c < 3 * m->count; c++) {
		const double *p = was.tri[c / 3] + 3 * (c % 3);
		bool first = true;

		for (size_t d = 0; d < c && first; d++)
			first = memcmp(p, was.tri[d / 3] + 3 * (d % 3), 3 * sizeof *p) != 0;
		for (int i = 0; i < 3 && !first; i++)
			m->tri[c / 3][3 * (c % 3) + (size_t)i] +=
			    (double)(next(seed) % (k + 1)) * 0x1p-16;
	}
	mesh_free(&was);
}

/* A torus and a box with a cavity. */
static void make(struct mesh *m)
{
	static const double out[2][3] = {{40, 0, 0}, {80, 30, 20}},
			    in[2][3] = {{45, 6, 7}, {49, 9, 9}};
	size_t from;

	mesh_torus(m, 20, 6, 14, 9);
	coarsen(m);
	mesh_box(m, out[0], out[1]);
	from = m->count;
	mesh_box(m, in[0], in[1]);
	mesh_flip(m, from);
}

static void same_solid(const struct mp_report *a, const struct mp_report *b)
{
	assert_true(a->total.volume == b->total.volume);
	assert_near(a->total.area, b->total.area, a->bounds.area + b->bounds.area);
	assert_memory_equal(a->total.centroid, b->total.centroid, sizeof a->total.centroid);
	assert_memory_equal(a->total.inertia, b->total.inertia, sizeof a->total.inertia);
	assert_memory_equal(&a->box, &b->box, sizeof a->box);
	assert_int_equal(a->topology.vertices, b->topology.vertices);
	assert_int_equal(a->topology.edges, b->topology.edges);
	assert_int_equal(a->topology.bodies, b->topology.bodies);
	assert_int_equal(a->solid, b->solid);
}

static void what_was_torn_by_rounding_is_what_it_was(void **state)
{
	static const enum mp_precision_wish wishes[] = {MP_WISH_EXACT, MP_WISH_CERTIFIED,
							MP_WISH_PRECISION_AUTO};
	struct mesh whole = {0}, torn = {0};
	uint64_t seed = 77;

	(void)state;
	make(&whole);
	make(&torn);
	jitter(&torn, 4, &seed);
	for (size_t i = 0; i < 3; i++) {
		struct mp_request request = request_plain();
		struct mp_report a, b, open;

		request.precision = wishes[i];
		report_of_binary(&whole, &request, &a);
		report_of_binary(&torn, &request, &open);
		assert_true(a.topology.watertight && a.solid != MP_NO && !a.repaired);
		assert_false(open.topology.closed || open.total.volume_defined);
		request.weld = 0x1p-12;
		report_of_binary(&torn, &request, &b);
		same_solid(&a, &b);
		assert_int_equal(a.precision, b.precision);
		assert_int_equal(b.welded_vertices, open.topology.vertices - a.topology.vertices);
		assert_int_equal(a.warnings, b.warnings);
		mp_report_free(&a);
		mp_report_free(&b);
		mp_report_free(&open);
	}
	mesh_free(&whole);
	mesh_free(&torn);
}

static void the_order_of_facets_and_corners_changes_nothing(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report first, r;
	uint64_t seed = 4711;

	(void)state;
	make(&m);
	jitter(&m, 60, &seed); /* by far not all of it hangs together again */
	request.precision = MP_WISH_EXACT;
	request.weld = 0x1p-11;
	report_of_binary(&m, &request, &first);
	assert_true(first.welded_vertices > 0 && first.topology.vertices > 160);
	for (int i = 0; i < 10; i++) {
		shuffle(&m, &seed);
		report_of_binary(&m, &request, &r);
		same_solid(&first, &r);
		assert_int_equal(first.welded_vertices, r.welded_vertices);
		assert_int_equal(first.topology.boundary_edges, r.topology.boundary_edges);
		assert_int_equal(first.topology.degenerate_triangles,
				 r.topology.degenerate_triangles);
		mp_report_free(&r);
	}
	mp_report_free(&first);
	mesh_free(&m);
}

static void places_are_the_smallest_and_triangles_stay_in_order(void **state)
{
	static const double corner[][3] = {{0, 0, 0},     {4, 0, 0},    {0, 4, 0},
					   {-0.25, 0, 0}, {0.25, 0, 1}, {4, 4, 4}};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, corner[0], corner[1], corner[2]);
	mesh_triangle(&m, corner[1], corner[3], corner[4]);
	mesh_triangle(&m, corner[5], corner[2], corner[1]);
	request.weld = 0.3;
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.welded_vertices, 1);
	assert_int_equal(r.triangles, 3);
	for (int t = 0; t < 3; t++) {
		for (int k = 0; k < 3; k++) {
			const double *want = m.tri[t] + 3 * k;
			double got[3];

			mp_vertices_get(r.vertices, r.tri[t][k], got);
			if (want[0] == 0 && want[1] == 0)
				want = corner[3];
			assert_memory_equal(got, want, sizeof got);
		}
	}
	assert_true(r.box.min[0] == -0.25);
	mp_report_free(&r);
	mesh_free(&m);
}

static void what_collapses_is_degenerate(void **state)
{
	static const double low[3] = {0, 0, 0}, high[3] = {8, 8, 0.125};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, low, high);
	request.weld = 0.25;
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.welded_vertices, 4);
	assert_int_equal(r.topology.degenerate_triangles, 8);
	assert_true(MP_WARNED(&r, MP_WARN_DEGENERATE));
	assert_int_equal(r.topology.vertices, 4);
	assert_true(r.topology.closed && r.total.volume_defined && r.total.volume == 0);
	assert_true(r.total.area == 128 && r.box.max[2] == 0);
	mp_report_free(&r);
	mesh_free(&m);
}

static void flipping_and_welding_go_together(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report a, b;
	uint64_t seed = 12;

	(void)state;
	make(&m);
	jitter(&m, 3, &seed);
	request.weld = 0x1p-12;
	report_of_binary(&m, &request, &a);
	request.flip = true;
	report_of_binary(&m, &request, &b);
	assert_true(a.total.volume > 0 && a.total.volume == -b.total.volume);
	assert_int_equal(b.flipped_triangles, m.count);
	mp_report_free(&a);
	mp_report_free(&b);
	mesh_free(&m);
}

static void every_allocation_may_fail(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	uint64_t seed = 3;

	(void)state;
	make(&m);
	jitter(&m, 3, &seed);
	request.weld = 0x1p-12;
	report_without_memory(&m, &request, 1000);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(what_was_torn_by_rounding_is_what_it_was),
	    cmocka_unit_test(the_order_of_facets_and_corners_changes_nothing),
	    cmocka_unit_test(places_are_the_smallest_and_triangles_stay_in_order),
	    cmocka_unit_test(what_collapses_is_degenerate),
	    cmocka_unit_test(flipping_and_welding_go_together),
	    cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests_name("weld", tests, NULL, NULL);
}
