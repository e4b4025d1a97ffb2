#include "core/report/report.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

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

static void test_two_sided_sheet_has_volume_zero(void **state)
{
	const double a[3] = {0.1, 0.2, 0.3}, b[3] = {1.1, 0.3, 0.7}, c[3] = {0.4, 1.3, 0.9};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, a, b, c);
	mesh_triangle(&m, b, a, c);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 3;
	report_of_ascii(&m, &request, &r);
	assert_true(r.topology.closed);
	assert_true(r.total.volume_defined && r.total.volume == 0);
	assert_true(r.total.mass_defined && r.total.mass == 0 && r.density_defined);
	assert_false(r.total.centroid_defined || r.total.inertia_defined ||
		     r.inertia_origin_defined);
	assert_true(r.surface_centroid_defined);
	assert_int_equal(r.orientation, MP_ORIENTATION_NONE);
	assert_int_equal(r.solid, MP_NO);
	assert_int_equal(r.body[0].orientation, MP_ORIENTATION_NONE);
	assert_true(MP_WARNED(&r, MP_WARN_ZERO_VOLUME));
	assert_false(MP_WARNED(&r, MP_WARN_OUT_OF_RANGE));
	mp_report_free(&r);
	request.density_kind = MP_DENSITY_FROM_MASS;
	report_of_ascii(&m, &request, &r);
	assert_false(r.density_defined || r.total.mass_defined);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_sheet_beside_a_cube_spoils_the_solid(void **state)
{
	const double a[3] = {5, 5, 5}, b[3] = {6, 5, 5}, c[3] = {5, 6, 5};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 2, false);
	mesh_triangle(&m, a, b, c);
	mesh_triangle(&m, b, a, c);
	report_of_binary(&m, NULL, &r);
	assert_true(r.total.volume == 8);
	assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
	assert_int_equal(r.body[1].orientation, MP_ORIENTATION_NONE);
	assert_int_equal(r.solid, MP_NO);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_nothing_but_degenerate_triangles(void **state)
{
	const double a[3] = {0.1, 0.2, 0.3}, b[3] = {1.1, 1.2, 1.3}, c[3] = {2.7, 1e-3, 5};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, a, a, b);
	mesh_triangle(&m, c, b, c);
	report_of_ascii(&m, NULL, &r);
	assert_true(r.total.area_defined && r.total.area == 0);
	assert_false(r.surface_centroid_defined);
	assert_int_equal(r.solid, MP_NO);
	assert_int_equal(r.bodies_listed, 0);
	assert_false(MP_WARNED(&r, MP_WARN_OUT_OF_RANGE));
	assert_true(MP_WARNED(&r, MP_WARN_DEGENERATE));
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_stray_degenerate_triangle_changes_nothing(void **state)
{
	const double far[3] = {1e9, 2e9, -3e9}, max[3] = {0.7, 0.9, 1.3};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, far, far, ORIGIN);
	mesh_box(&m, ORIGIN, max);
	report_of_ascii(&m, NULL, &r);
	assert_relative(r.total.volume, 0.7 * 0.9 * 1.3, 3e-16);
	for (int k = 0; k < 3; k++)
		assert_relative(r.total.centroid[k], max[k] / 2, 3e-16);
	assert_relative(r.total.inertia[0][0], 0.7 * 0.9 * 1.3 * (0.81 + 1.69) / 12, 3e-15);
	assert_relative(r.total.area, 2 * (0.63 + 1.17 + 0.91), 1e-14);
	assert_true(r.box.max[1] == 2e9 && r.body[0].box.max[1] == 0.9);
	assert_int_equal(r.solid, MP_YES);
	mp_report_free(&r);
	mesh_free(&m);
}

/* A side split by a vertex that its neighbour does not have: open by edges, shut by geometry. */
static void test_cracks_keep_the_volume(void **state)
{
	const double a[3] = {0, 0, 2}, b[3] = {2, 0, 2}, c[3] = {2, 2, 2}, d[3] = {0, 2, 2};
	const double middle[3] = {1, 0, 2};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	cube(&m, 0, 2, false);
	memmove(m.tri + 2, m.tri + 4, 8 * sizeof *m.tri); /* without the top */
	m.count -= 2;
	mesh_triangle(&m, a, middle, d);
	mesh_triangle(&m, middle, b, c);
	mesh_triangle(&m, middle, c, d);
	report_of_binary(&m, NULL, &r);
	assert_false(r.topology.closed);
	assert_true(r.topology.cracks_only);
	assert_true(r.total.volume_defined && r.total.volume == 8 && r.total.centroid[2] == 1);
	assert_true(r.closure_defect[0] == 0 && r.closure_defect[1] == 0);
	assert_int_equal(r.solid, MP_NO);
	assert_int_equal(r.orientation, MP_ORIENTATION_NONE);
	assert_true(MP_WARNED(&r, MP_WARN_CRACKS) && !MP_WARNED(&r, MP_WARN_OPEN));
	mp_report_free(&r);
	mesh_free(&m);
}

/* A lid that shares no edge with its box, for a vertex in the middle of every side of it. */
static void test_cracks_between_bodies_keep_the_volume(void **state)
{
	static const double RIM[9][3] = {{0, 0, 2}, {1, 0, 2}, {2, 0, 2}, {2, 1, 2}, {2, 2, 2},
					 {1, 2, 2}, {0, 2, 2}, {0, 1, 2}, {0, 0, 2}};
	const double middle[3] = {1, 1, 2}, far[3] = {1e8 / 3, 1e8 / 7, -1e8 / 9};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, far, far, ORIGIN); /* so that once is not enough */
	cube(&m, 0, 2, false);
	memmove(m.tri + 3, m.tri + 5, 8 * sizeof *m.tri); /* without the top */
	m.count -= 2;
	for (int i = 0; i < 8; i++)
		mesh_triangle(&m, middle, RIM[i], RIM[i + 1]);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.topology.bodies, 2);
	assert_true(r.topology.cracks_only && !r.topology.body[0].cracks_only);
	assert_true(r.total.volume_defined);
	assert_relative(r.total.volume, 8, 1e-15);
	for (int k = 0; k < 3; k++)
		assert_relative(r.total.centroid[k], 1, 1e-15);
	assert_false(r.body[0].mass.volume_defined || r.body[1].mass.volume_defined);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Two facets without area, back to back on a slanting line: nothing, not the noise of nothing. */
static void test_collinear_facets_have_no_area(void **state)
{
	/* once, twice and four times the same vector: exactly a line, though 3 times rounds */
	const double a[3] = {0.1, 0.7, 1 / 3.0}, b[3] = {0.2, 1.4, 2 / 3.0};
	const double c[3] = {0.4, 2.8, 4 / 3.0};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, a, b, c);
	mesh_triangle(&m, b, a, c);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.topology.degenerate_triangles, 2);
	assert_true(r.topology.closed && r.total.volume_defined && r.total.volume == 0);
	assert_true(r.total.area_defined && r.total.area == 0 && !r.surface_centroid_defined);
	assert_false(MP_WARNED(&r, MP_WARN_OUT_OF_RANGE));
	mp_report_free(&r);
	mesh_free(&m);
}

/* The smallest moment of a slanting needle drowns in the rounding and may come out below 0. */
static void test_needle_has_radii(void **state)
{
	const double side[3] = {1000, 1e-7, 1e-7};
	struct mp_report r;

	(void)state;
	for (int i = 1; i < 40; i++) {
		double c = cos(0.07 * i), s = sin(0.07 * i);
		struct mesh m = {0};

		mesh_box(&m, ORIGIN, side);
		for (size_t k = 0; k < 3 * m.count; k++) {
			double *v = m.tri[k / 3] + 3 * (k % 3), x = v[0], y = v[1];

			v[0] = c * x - s * y;
			v[1] = s * x + c * y;
		}
		report_of_ascii(&m, NULL, &r);
		assert_true(r.total.inertia_defined && r.radii_defined);
		assert_near(r.radii_of_gyration[0], 0, 1e-4);
		assert_relative(r.radii_of_gyration[1], 1000 / sqrt(12), 1e-5);
		mp_report_free(&r);
		mesh_free(&m);
	}
}

/* At every size: what a double can hold is right, what it cannot is not given and said so. */
static void test_results_at_the_ends_of_the_range(void **state)
{
	static const struct {
		double size;
		bool area, volume, inertia; /* in range */
	} CASE[] = {{1e-200, false, false, false}, {1e-150, true, false, false},
		    {1e-100, true, true, false},   {1e-60, true, true, true},
		    {1e60, true, true, true},      {1e100, true, true, false},
		    {1e150, true, false, false},   {1e200, false, false, false}};

	(void)state;
	for (size_t i = 0; i < sizeof CASE / sizeof *CASE; i++) {
		double s = CASE[i].size;
		struct mesh m = {0};
		struct mp_report r;

		cube(&m, 0, s, false);
		report_of_ascii(&m, NULL, &r);
		assert_int_equal(r.total.area_defined, CASE[i].area);
		assert_int_equal(r.total.volume_defined, CASE[i].volume);
		assert_int_equal(r.total.inertia_defined, CASE[i].inertia);
		assert_int_equal(r.inertia_origin_defined, CASE[i].inertia);
		assert_true(r.total.centroid_defined && r.surface_centroid_defined);
		assert_relative(r.total.centroid[1], s / 2, 3e-16);
		assert_relative(r.surface_centroid[1], s / 2, 3e-16);
		if (CASE[i].area)
			assert_relative(r.total.area, 6 * s * s, 5e-16);
		if (CASE[i].volume)
			assert_relative(r.total.volume, s * s * s, 5e-16);
		if (CASE[i].inertia)
			assert_relative(r.total.inertia[2][2], s * s * s * s * s / 6, 1e-15);
		assert_int_equal(MP_WARNED(&r, MP_WARN_OUT_OF_RANGE), !CASE[i].inertia);
		assert_false(MP_WARNED(&r, MP_WARN_ZERO_VOLUME));
		assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
		assert_int_equal(r.solid, MP_YES);
		mp_report_free(&r);
		mesh_free(&m);
	}
}

/* Two bodies of mixed winding can have a negative moment: no root is taken of it. */
static void test_negative_moments_have_no_radius(void **state)
{
	const double far[3] = {10, 0, 0}, max[3] = {11, 1, 1}, large[3] = {3, 3, 3};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, far, max);
	mesh_flip(&m, 0);
	mesh_move(&m, 0, 100, 0, 0);
	mesh_box(&m, ORIGIN, large);
	request.has_axis = true;
	request.axis_direction[1] = 1;
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume == 26 && r.total.inertia_defined);
	assert_true(r.total.inertia[1][1] < 0 && r.principal.moments[0] < 0);
	assert_false(r.radii_defined || r.axis.radius_defined);
	assert_true(r.radii_of_gyration[0] == 0 && r.axis.radius_of_gyration == 0);
	assert_true(r.axis_defined && r.axis.moment < 0);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Regular prisms are axial, cubes spherical, whatever the rounding of the coordinates. */
static void test_symmetry_survives_rounding(void **state)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_torus(&m, 3, 1, 24, 15);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.principal.symmetry, MP_SYMMETRY_AXIAL);
	assert_true(r.principal.axes[2][2] == 1);
	mp_report_free(&r);
	m.count = 0;
	cube(&m, 0.1, 0.7, false);
	mesh_scale(&m, 0, 1, 1, 1);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.principal.symmetry, MP_SYMMETRY_SPHERICAL);
	mp_report_free(&r);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_two_sided_sheet_has_volume_zero),
	    cmocka_unit_test(test_sheet_beside_a_cube_spoils_the_solid),
	    cmocka_unit_test(test_nothing_but_degenerate_triangles),
	    cmocka_unit_test(test_stray_degenerate_triangle_changes_nothing),
	    cmocka_unit_test(test_cracks_keep_the_volume),
	    cmocka_unit_test(test_cracks_between_bodies_keep_the_volume),
	    cmocka_unit_test(test_collinear_facets_have_no_area),
	    cmocka_unit_test(test_needle_has_radii),
	    cmocka_unit_test(test_results_at_the_ends_of_the_range),
	    cmocka_unit_test(test_negative_moments_have_no_radius),
	    cmocka_unit_test(test_symmetry_survives_rounding),
	};

	return cmocka_run_group_tests_name("report_limits", tests, NULL, NULL);
}
