#include "core/report/report.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/analysis.h"
#include "tests/unit/report_of.h"

static const double ORIGIN[3] = {0, 0, 0};

/* A cube from (at, at, at), ${side} long; inward if ${inward}. */
static void cube(struct mesh *m, double at, double side, bool inward)
{
	const double min[3] = {at, at, at}, max[3] = {at + side, at + side, at + side};
	size_t from = m->count;

	mesh_box(m, min, max);
	if (inward)
		mesh_flip(m, from);
}

static void assert_warnings(const struct mp_report *r, uint64_t want)
{
	if (r->warnings != want)
		fail_msg("warnings %#llx, not %#llx", (unsigned long long)r->warnings,
			 (unsigned long long)want);
}

#define BIT(w) (UINT64_C(1) << (w))

static void test_hollow_cube(void **state)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 4, false);
	cube(&m, 1, 2, true);
	report_of_binary(&m, NULL, &r);
	assert_true(r.total.volume == 64 - 8 && r.total.area == 96 + 24);
	assert_true(r.total.inertia[0][0] == (64 * 32 - 8 * 8) / 12.0);
	assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
	assert_int_equal(r.solid, MP_YES);
	assert_int_equal(r.overlapping, MP_NO);
	assert_warnings(&r, 0);
	assert_int_equal(r.bodies_listed, 2);
	assert_true(r.body[0].mass.volume == 64 && r.body[1].mass.volume == -8);
	assert_true(r.body[1].mass.mass == 8 && r.body[1].mass.inertia[0][0] == 64 / 12.0);
	assert_int_equal(r.body[0].orientation, MP_ORIENTATION_OUTWARD);
	assert_int_equal(r.body[1].orientation, MP_ORIENTATION_INWARD);
	assert_true(!r.body[0].cavity && r.body[1].cavity);
	assert_true(r.body[1].nest.decided && r.body[1].nest.depth == 1);
	assert_int_equal(r.body[1].nest.parent, 0);
	assert_int_equal(r.body[1].first, 12);
	assert_int_equal(r.body[1].triangles, 12);
	assert_true(r.body[1].box.min[2] == 1 && r.body[1].box.max[2] == 3);
	assert_true(r.body[1].watertight);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_cavity_wound_outward_counts_twice(void **state)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 4, false);
	cube(&m, 1, 2, false);
	report_of_binary(&m, NULL, &r);
	assert_true(r.total.volume == 64 + 8);
	assert_int_equal(r.orientation, MP_ORIENTATION_MIXED);
	assert_int_equal(r.solid, MP_NO);
	assert_false(r.body[1].cavity);
	assert_warnings(&r, BIT(MP_WARN_MIXED_BODIES) | BIT(MP_WARN_CAVITY_OUTWARD));
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_inside_out_is_the_solid_it_means(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 4, true);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 0.5;
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume == -64 && r.total.mass == 32);
	assert_true(r.total.inertia[0][0] == 32 * 32 / 12.0 && r.total.centroid[1] == 2);
	assert_true(r.principal.moments[0] == 32 * 32 / 12.0);
	assert_int_equal(r.principal.symmetry, MP_SYMMETRY_SPHERICAL);
	assert_int_equal(r.orientation, MP_ORIENTATION_INWARD);
	assert_int_equal(r.solid, MP_NO);
	assert_warnings(&r, BIT(MP_WARN_INSIDE_OUT));
	assert_false(r.body[0].cavity); /* it lies in nothing */
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_hollow_cube_inside_out(void **state)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 4, true);
	cube(&m, 1, 2, false);
	report_of_binary(&m, NULL, &r);
	assert_true(r.total.volume == -56 && r.total.mass == 56);
	assert_int_equal(r.orientation, MP_ORIENTATION_INWARD);
	assert_warnings(&r, BIT(MP_WARN_INSIDE_OUT));
	mp_report_free(&r);
	mesh_flip(&m, 12); /* now both inward: the inner one counts twice again */
	report_of_binary(&m, NULL, &r);
	assert_true(r.total.volume == -72);
	assert_int_equal(r.orientation, MP_ORIENTATION_MIXED);
	assert_warnings(&r, BIT(MP_WARN_INSIDE_OUT) | BIT(MP_WARN_MIXED_BODIES) |
				BIT(MP_WARN_CAVITY_OUTWARD));
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_two_cubes_apart_are_a_solid(void **state)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 1, false);
	cube(&m, 1, 1, false); /* they touch in a corner: one vertex, two bodies */
	report_of_binary(&m, NULL, &r);
	assert_true(r.total.volume == 2 && r.total.centroid[0] == 1);
	assert_true(r.total.inertia[0][1] == -0.5); /* 2 * 0.5^2 of the parallel axes */
	assert_int_equal(r.overlapping, MP_NO);
	assert_int_equal(r.solid, MP_YES);
	assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
	assert_warnings(&r, BIT(MP_WARN_NON_MANIFOLD_VERTEX));
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_opposite_cubes_have_no_volume_together(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0.1, 1, false);
	cube(&m, 5.3, 1, true);
	mesh_scale(&m, 12, 1, 1, 1);
	request.precision = MP_WISH_CERTIFIED; /* in doubles, 1.1 - 0.1 and 6.3 - 5.3 differ */
	report_of_ascii(&m, &request, &r);
	assert_true(r.total.volume_defined && !r.total.centroid_defined);
	assert_near(r.total.volume, 0, 1e-15);
	assert_int_equal(r.orientation, MP_ORIENTATION_MIXED);
	assert_int_equal(r.solid, MP_NO);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Two cubes on one edge are one body; against each other, it has moments but no volume. */
static void test_body_without_volume_has_moments(void **state)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 1, false);
	cube(&m, 0, 1, true);
	mesh_move(&m, 12, 1, 1, 0);
	cube(&m, 4, 2, false);
	report_of_binary(&m, NULL, &r);
	assert_int_equal(r.topology.bodies, 2);
	assert_true(r.body[0].mass.volume == 0 && !r.body[0].mass.centroid_defined);
	assert_near(r.total.volume, 8, 1e-13);
	/* 8*5 + 0.5 - 1.5 over 8, and in z 8*5 + 0.5 - 0.5 */
	assert_near(r.total.centroid[0], 39 / 8., 1e-13);
	assert_near(r.total.centroid[2], 5, 1e-13);
	/* integral of xx: 8*(25 + 1/3) + 1/3 - 7/3; of zz: 8*(25 + 1/3) */
	assert_near(r.inertia_origin[0][0], 16 * (25 + 1 / 3.) - 2, 1e-11);
	assert_true(r.bounds.centroid < 1e-12 && r.bounds.inertia < 1e-11);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Beside an open part, so that only the body's own sums say what it is. */
static void test_collinear_body_is_not_out_of_range(void **state)
{
	const double a[3] = {0.5, 1, 1.5}, b[3] = {0, 2, 1}, c[3] = {1, 0, 2};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 4, 1, false);
	m.count--;
	mesh_triangle(&m, a, b, c);
	report_of_binary(&m, NULL, &r);
	assert_int_equal(r.topology.degenerate_triangles, 1);
	assert_true(r.body[1].mass.volume_defined && r.body[1].mass.volume == 0);
	assert_warnings(&r, BIT(MP_WARN_OPEN) | BIT(MP_WARN_DEGENERATE));
	mp_report_free(&r);
	mesh_free(&m);
}

/* Its products cancel in doubles: an area below their rounding is 0 within the bound, not lost. */
static void test_sliver_has_an_area(void **state)
{
	const double a[3] = {-0.3390545887818574, 1.1761698145259567, 0.040823439638797365};
	const double b[3] = {-0.6781091775637148, 1.8963407983886706, 0.9716272534621918};
	const double c[3] = {0, 0.45599883066324265, -0.8899803741845971};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, b, c, a);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.topology.degenerate_triangles, 0);
	assert_true(r.total.area_defined);
	assert_near(r.total.area, 5.5e-17, r.bounds.area);
	assert_true(r.bounds.area < 1e-14);
	assert_warnings(&r, BIT(MP_WARN_OPEN));
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_overlapping_boxes_are_no_solid(void **state)
{
	struct mesh m = {0};
	struct mp_request request = request_plain();
	struct mp_report r;

	(void)state;
	cube(&m, 0, 2, false);
	cube(&m, 1, 2, false);
	report_of_binary(&m, NULL, &r);
	assert_int_equal(r.overlapping, MP_YES);
	assert_true(r.overlaps.decided && r.overlaps.count == 1 && r.overlaps.listed == 1);
	assert_int_equal(r.solid, MP_NO);
	assert_warnings(&r, BIT(MP_WARN_OVERLAPPING));
	assert_false(r.self.asked);
	mp_report_free(&r);
	request.self_intersections = true;
	request.defects = 3;
	report_of_binary(&m, &request, &r);
	assert_true(r.self.decided && r.self.count > 3 && r.self.listed == 3);
	assert_true(r.topology.truncated);
	assert_warnings(&r, BIT(MP_WARN_OVERLAPPING) | BIT(MP_WARN_SELF_INTERSECTING) |
				BIT(MP_WARN_DEFECTS_TRUNCATED));
	mp_report_free(&r);
	mesh_free(&m);
}

/* Tiny parts far apart: each is summed about itself, so the whole loses nothing. */
static void test_small_bodies_far_apart(void **state)
{
	const double side[3] = {0.37, 0.53, 0.71};
	struct mesh m = {0};
	struct mp_report r;
	double volume = 0, area = 0;

	(void)state;
	mesh_box(&m, ORIGIN, side);
	mesh_box(&m, ORIGIN, side);
	mesh_move(&m, 12, 1e7, 1e7, 1e7);
	for (int i = 0; i < 2; i++) { /* of the boxes as rounded */
		double edge[3];

		for (int k = 0; k < 3; k++)
			edge[k] = (i == 0 ? side[k] : (side[k] + 1e7) - 1e7);
		volume += edge[0] * edge[1] * edge[2];
		area += 2 * (edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0]);
	}
	report_of_ascii(&m, NULL, &r);
	assert_relative(r.total.volume, volume, 3e-16);
	assert_relative(r.total.area, area, 3e-16);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_open_box_has_an_area_and_no_volume(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 2, false);
	m.count -= 2; /* the side at x = 2 is gone */
	request.density_kind = MP_DENSITY_FROM_MASS;
	request.density = 1;
	request.has_about = request.has_axis = true;
	request.axis_direction[2] = 1;
	report_of_binary(&m, &request, &r);
	assert_false(r.total.volume_defined || r.total.mass_defined || r.total.centroid_defined ||
		     r.total.inertia_defined || r.inertia_origin_defined ||
		     r.inertia_about_defined || r.axis_defined || r.radii_defined);
	assert_true(r.has_density && !r.density_defined);
	assert_true(r.total.volume == 0 && r.total.mass == 0 && r.density == 0);
	assert_true(r.total.area_defined && r.total.area == 20);
	assert_true(r.surface_centroid_defined && r.surface_centroid[1] == 1);
	assert_true(r.closure_defect[0] == -4 && r.closure_defect[1] == 0);
	assert_int_equal(r.orientation, MP_ORIENTATION_NONE);
	assert_int_equal(r.solid, MP_NO);
	assert_int_equal(r.body[0].orientation, MP_ORIENTATION_NONE);
	assert_false(r.body[0].mass.volume_defined);
	assert_true(r.body[0].mass.area == 20);
	assert_warnings(&r, BIT(MP_WARN_OPEN));
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_flipped_facet_is_a_matter_of_winding(void **state)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 2, false);
	mesh_flip(&m, 11);
	report_of_ascii(&m, NULL, &r);
	assert_false(r.total.volume_defined);
	assert_int_equal(r.solid, MP_NO);
	assert_int_equal(r.topology.misoriented_edges, 3);
	assert_warnings(&r, BIT(MP_WARN_WINDING));
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_only_so_many_bodies_are_listed(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	for (int i = 0; i < 10; i++)
		cube(&m, 3 * i, 1, false);
	for (request.bodies = 0; request.bodies < 12; request.bodies += 3) {
		uint32_t want = request.bodies < 10 ? request.bodies : 10;

		report_of_binary(&m, &request, &r);
		assert_int_equal(r.topology.bodies, 10);
		assert_int_equal(r.bodies_listed, want);
		assert_true(r.total.volume == 10);
		assert_int_equal(r.solid, MP_YES);
		for (uint32_t i = 0; i < want; i++)
			assert_true(r.body[i].first == 12 * i && r.body[i].mass.volume == 1);
		mp_report_free(&r);
	}
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_hollow_cube),
	    cmocka_unit_test(test_cavity_wound_outward_counts_twice),
	    cmocka_unit_test(test_inside_out_is_the_solid_it_means),
	    cmocka_unit_test(test_hollow_cube_inside_out),
	    cmocka_unit_test(test_two_cubes_apart_are_a_solid),
	    cmocka_unit_test(test_opposite_cubes_have_no_volume_together),
	    cmocka_unit_test(test_body_without_volume_has_moments),
	    cmocka_unit_test(test_collinear_body_is_not_out_of_range),
	    cmocka_unit_test(test_sliver_has_an_area),
	    cmocka_unit_test(test_overlapping_boxes_are_no_solid),
	    cmocka_unit_test(test_small_bodies_far_apart),
	    cmocka_unit_test(test_open_box_has_an_area_and_no_volume),
	    cmocka_unit_test(test_flipped_facet_is_a_matter_of_winding),
	    cmocka_unit_test(test_only_so_many_bodies_are_listed),
	};

	return cmocka_run_group_tests_name("report", tests, NULL, NULL);
}
