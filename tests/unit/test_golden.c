#include "core/analysis.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/report_of.h"

static const double ORIGIN[3] = {0, 0, 0};

static void assert_tensor(const double value[3][3], const double want[3][3], double tolerance)
{
	for (int i = 0; i < 9; i++)
		assert_near(value[i / 3][i % 3], want[i / 3][i % 3], tolerance);
}

/* The worked example of the paper on the triangular pyramid, its misprints corrected. */
static void test_wedge_of_the_paper(void **state)
{
	static const double ABOUT_ORIGIN[3][3] = {
	    {68.9, -50, -16}, {-50, 166.4, -10}, {-16, -10, 222.5}};
	static const double ABOUT_CENTROID[3][3] = {
	    {0.3445, 1 / 6.0, 0.16 / 3}, {1 / 6.0, 0.8320, 0.1 / 3}, {0.16 / 3, 0.1 / 3, 1.1125}};
	static const double CENTROID[3] = {10, 6.25, 2};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_wedge(&m, 40, 25, 8);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 1e-5;
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume_defined && r.total.mass_defined && r.total.inertia_defined);
	assert_true(r.total.volume == 4000 / 3.0 && r.total.mass == 0.04 / 3);
	assert_true(r.density_defined && r.density == 1e-5);
	for (int k = 0; k < 3; k++)
		assert_true(r.total.centroid[k] == CENTROID[k]);
	assert_tensor((const double(*)[3])r.total.inertia, ABOUT_CENTROID, 2e-16);
	assert_true(r.inertia_origin_defined);
	for (int i = 0; i < 9; i++)
		assert_relative(r.inertia_origin[i / 3][i % 3],
				0.04 / 3 * ABOUT_ORIGIN[i / 3][i % 3], 3e-16);
	assert_relative(r.total.area, 500 + 100 + 160 + sqrt(500 * 500 + 100 * 100 + 160 * 160),
			2e-16);
	assert_int_equal(r.solid, MP_YES);
	assert_int_equal(r.warnings, 0);
	mp_report_free(&r);
	mesh_free(&m);
}

/* The example of the HTTP contract. */
static void test_box_of_the_contract(void **state)
{
	const double max[3] = {40, 30, 20};
	static const double CENTRAL[3][3] = {{7.02, 0, 0}, {0, 10.8, 0}, {0, 0, 13.5}};
	static const double ABOUT_ORIGIN[3][3] = {
	    {28.08, -19.44, -12.96}, {-19.44, 43.2, -9.72}, {-12.96, -9.72, 54}};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 2700;
	request.density_divisor = 1e9;
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume == 24000 && r.total.area == 5200 && r.total.mass == 0.0648);
	for (int k = 0; k < 3; k++) {
		assert_true(r.total.centroid[k] == max[k] / 2);
		assert_true(r.surface_centroid_defined && r.surface_centroid[k] == max[k] / 2);
		assert_true(r.box.min[k] == 0 && r.box.max[k] == max[k]);
		assert_true(r.closure_defect[k] == 0);
		assert_true(r.principal.moments[k] == CENTRAL[k][k]);
		assert_relative(r.radii_of_gyration[k], sqrt(CENTRAL[k][k] / 0.0648), 2e-16);
	}
	assert_tensor((const double(*)[3])r.total.inertia, CENTRAL, 0);
	assert_tensor((const double(*)[3])r.inertia_origin, ABOUT_ORIGIN, 0);
	assert_true(r.radii_defined && r.density == 2700 / 1e9);
	assert_int_equal(r.principal.symmetry, MP_SYMMETRY_NONE);
	assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
	assert_int_equal(r.solid, MP_YES);
	assert_int_equal(r.overlapping, MP_NO);
	assert_int_equal(r.triangles, 12);
	assert_int_equal(r.notes.bytes, 684);
	assert_int_equal(r.bodies_listed, 1);
	assert_int_equal(r.warnings, 0);
	assert_false(r.inertia_about_defined || r.axis_defined);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_weighed_mass_gives_the_density(void **state)
{
	const double max[3] = {4, 3, 2};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	request.density_kind = MP_DENSITY_FROM_MASS;
	request.density = 0.7;
	report_of_binary(&m, &request, &r);
	assert_true(r.has_density && r.density_defined && r.density == 0.7 / 24);
	assert_true(r.total.mass == 0.7);
	assert_relative(r.total.inertia[0][0], 0.7 * (9 + 4) / 12, 2e-16);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_without_a_density_mass_is_volume(void **state)
{
	const double max[3] = {4, 3, 2};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	report_of_binary(&m, NULL, &r);
	assert_false(r.has_density);
	assert_false(r.density_defined);
	assert_true(r.total.mass_defined && r.total.mass == 24 && r.total.inertia[2][2] == 50);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_inertia_about_point_and_axis(void **state)
{
	const double max[3] = {4, 3, 2};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	request.has_about = request.has_axis = true;
	memcpy(request.about, max, sizeof max);
	request.axis_origin[0] = 10;
	request.axis_direction[2] = -1e-200;
	report_of_binary(&m, &request, &r);
	/* the far corner sees what the origin sees */
	assert_true(r.inertia_about_defined && r.axis_defined);
	assert_tensor((const double(*)[3])r.inertia_about, (const double(*)[3])r.inertia_origin, 0);
	assert_true(r.inertia_about[0][0] == 24 * (9 + 4) / 3.0);
	assert_true(r.inertia_about[0][1] == -24 * 2 * 1.5);
	/* I_C + m (8^2 + 1.5^2) */
	assert_true(r.axis.direction[2] == -1 && r.axis.origin[0] == 10);
	assert_true(r.axis.moment == 50 + 24 * (64 + 2.25));
	assert_true(r.axis.radius_defined);
	assert_relative(r.axis.radius_of_gyration, sqrt(50 / 24.0 + 66.25), 2e-16);
	mp_report_free(&r);
	request.axis_direction[0] = request.axis_direction[1] = 3e300;
	request.axis_direction[2] = 3e300;
	memset(request.axis_origin, 0, sizeof request.axis_origin);
	report_of_binary(&m, &request, &r);
	for (int k = 0; k < 3; k++)
		assert_relative(r.axis.direction[k], sqrt(1 / 3.0), 2e-16);
	/* d I d with the tensor about the origin, which the axis passes through */
	assert_relative(
	    r.axis.moment,
	    (r.inertia_origin[0][0] + r.inertia_origin[1][1] + r.inertia_origin[2][2] +
	     2 * (r.inertia_origin[0][1] + r.inertia_origin[1][2] + r.inertia_origin[2][0])) /
		3,
	    4e-16);
	mp_report_free(&r);
	mesh_free(&m);
}

/* As text every coordinate is a double: exact on a grid, however far away. */
static void test_far_away_nothing_is_lost(void **state)
{
	struct mesh m = {0};
	struct mp_report near, far;

	(void)state;
	mesh_torus(&m, 3, 1, 24, 15);
	for (size_t i = 0; i < 9 * m.count; i++)
		m.tri[i / 9][i % 9] = nearbyint(ldexp(m.tri[i / 9][i % 9], 30)) * 0x1p-30;
	report_of_ascii(&m, NULL, &near);
	mesh_move(&m, 0, 1e6, -2e6, 3e6);
	report_of_ascii(&m, NULL, &far);
	assert_true(near.total.volume == far.total.volume && near.total.area == far.total.area);
	assert_memory_equal(near.total.inertia, far.total.inertia, sizeof near.total.inertia);
	assert_relative(far.total.centroid[0], 1e6 + near.total.centroid[0], 1e-15);
	assert_relative(far.total.centroid[1], -2e6 + near.total.centroid[1], 1e-15);
	mp_report_free(&near);
	mp_report_free(&far);
	mesh_free(&m);
}

static void test_float32_far_away_nothing_is_lost(void **state)
{
	const double max[3] = {40.25, 30.5, 20.75};
	struct mesh m = {0};
	struct mp_report near, far;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	report_of_binary(&m, NULL, &near);
	mesh_move(&m, 0, 1e6, 1e6, -1e6);
	report_of_binary(&m, NULL, &far);
	assert_true(near.total.volume == 40.25 * 30.5 * 20.75);
	assert_true(near.total.volume == far.total.volume);
	assert_memory_equal(near.total.inertia, far.total.inertia, sizeof near.total.inertia);
	for (int k = 0; k < 3; k++)
		assert_true(far.total.centroid[k] == (k == 2 ? -1e6 : 1e6) + max[k] / 2);
	mp_report_free(&near);
	mp_report_free(&far);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_wedge_of_the_paper),
	    cmocka_unit_test(test_box_of_the_contract),
	    cmocka_unit_test(test_weighed_mass_gives_the_density),
	    cmocka_unit_test(test_without_a_density_mass_is_volume),
	    cmocka_unit_test(test_inertia_about_point_and_axis),
	    cmocka_unit_test(test_far_away_nothing_is_lost),
	    cmocka_unit_test(test_float32_far_away_nothing_is_lost),
	};

	return cmocka_run_group_tests_name("golden", tests, NULL, NULL);
}
