#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/report_of.h"

static struct mp_request wish(enum mp_precision_wish precision)
{
	struct mp_request request = request_plain();

	request.precision = precision;
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 2700;
	request.density_divisor = 1e9;
	return request;
}

/* A sphere far away and a box with a cavity, so that bodies and offsets take part. */
static void make(struct mesh *m)
{
	static const double out[2][3] = {{0, 0, 0}, {40, 30, 20}},
			    in[2][3] = {{5, 6, 7}, {9, 9, 9}};
	size_t from;

	mesh_box(m, out[0], out[1]);
	from = m->count;
	mesh_box(m, in[0], in[1]);
	mesh_flip(m, from);
	from = m->count;
	mesh_sphere(m, 3.7, 24, 12);
	mesh_move(m, from, 1e5, -2e5, 3e5);
}

static void shuffle(struct mesh *m, unsigned seed)
{
	for (size_t i = m->count - 1; i > 0; i--) {
		size_t j = (size_t)(seed = seed * 1103515245 + 12345) % (i + 1);
		double swap[9], turned[9];

		memcpy(swap, m->tri[i], sizeof swap);
		memcpy(m->tri[i], m->tri[j], sizeof swap);
		memcpy(m->tri[j], swap, sizeof swap);
		memcpy(turned, m->tri[i] + 3, 6 * sizeof(double)); /* b c a */
		memcpy(turned + 6, m->tri[i], 3 * sizeof(double));
		memcpy(m->tri[i], turned, sizeof turned);
	}
}

static void same(const struct mp_report *a, const struct mp_report *b)
{
	assert_true(a->total.volume == b->total.volume && a->total.mass == b->total.mass);
	assert_memory_equal(a->total.centroid, b->total.centroid, sizeof a->total.centroid);
	assert_memory_equal(a->total.inertia, b->total.inertia, sizeof a->total.inertia);
	assert_memory_equal(a->inertia_origin, b->inertia_origin, sizeof a->inertia_origin);
	assert_memory_equal(&a->principal, &b->principal, sizeof a->principal);
}

static void the_order_of_triangles_changes_no_bit(void **state)
{
	struct mp_request request = wish(MP_WISH_EXACT);
	struct mesh m = {0};
	struct mp_report first, r;

	(void)state;
	make(&m);
	report_of_binary(&m, &request, &first);
	assert_int_equal(first.precision, MP_PRECISION_EXACT);
	for (unsigned i = 1; i < 20; i++) {
		shuffle(&m, i);
		report_of_binary(&m, &request, &r);
		same(&first, &r);
		mp_report_free(&r);
	}
	mp_report_free(&first);
	mesh_free(&m);
}

static void exact_and_certified_agree_within_both_bounds(void **state)
{
	struct mp_request exact = wish(MP_WISH_EXACT), certified = wish(MP_WISH_CERTIFIED);
	struct mesh m = {0};
	struct mp_report a, b;

	(void)state;
	make(&m);
	report_of_binary(&m, &exact, &a);
	report_of_binary(&m, &certified, &b);
	assert_int_equal(b.precision, MP_PRECISION_CERTIFIED);
	assert_near(a.total.volume, b.total.volume, a.bounds.volume + b.bounds.volume);
	assert_near(a.total.mass, b.total.mass, a.bounds.mass + b.bounds.mass);
	for (int k = 0; k < 3; k++) {
		assert_near(a.total.centroid[k], b.total.centroid[k],
			    a.bounds.centroid + b.bounds.centroid);
		assert_near(a.principal.moments[k], b.principal.moments[k],
			    a.bounds.moments + b.bounds.moments);
	}
	for (int i = 0; i < 9; i++)
		assert_near(a.total.inertia[i / 3][i % 3], b.total.inertia[i / 3][i % 3],
			    a.bounds.inertia + b.bounds.inertia);
	assert_true(a.bounds.volume <= b.bounds.volume && a.bounds.inertia < b.bounds.inertia);
	assert_true(a.bounds.volume <= 1.2e-16 * a.total.volume);
	assert_int_equal(a.bodies_listed, 3);
	assert_true(a.body[0].mass.volume == 24000 && a.body[1].mass.volume == -24);
	mp_report_free(&a);
	mp_report_free(&b);
	mesh_free(&m);
}

static void auto_is_exact_for_small_meshes_only(void **state)
{
	struct mp_request request = wish(MP_WISH_PRECISION_AUTO);
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	make(&m);
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.precision, MP_PRECISION_EXACT);
	mp_report_free(&r);
	mesh_sphere(&m, 1, 200, 100);
	mesh_move(&m, m.count - 200 * 99 * 2, 5000, 0, 0);
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.precision, MP_PRECISION_CERTIFIED);
	mp_report_free(&r);
	request.precision = MP_WISH_EXACT;
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.precision, MP_PRECISION_EXACT);
	mp_report_free(&r);
	mesh_free(&m);
}

static void points_axes_and_a_weighed_mass_are_exact_too(void **state)
{
	static const double low[3] = {1, 2, 3}, high[3] = {4, 8, 15};
	struct mp_request request = wish(MP_WISH_EXACT);
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, low, high); /* 3 x 6 x 12, volume 216 */
	request.density_kind = MP_DENSITY_FROM_MASS;
	request.density = 432;
	request.has_about = request.has_axis = true;
	memcpy(request.about, low, sizeof low);
	memcpy(request.axis_origin, low, sizeof low);
	request.axis_direction[2] = 5;
	report_of_binary(&m, &request, &r);
	assert_true(r.density == 2 && r.total.mass == 432);
	assert_true(r.inertia_about[2][2] == 432 * (9 + 36) / 3.0);
	assert_true(r.inertia_about[0][1] == -432 * 18 / 4.0);
	assert_true(r.axis.moment == 6480 && r.axis.radius_of_gyration == sqrt(15));
	assert_true(r.bounds.volume == 0 && r.bounds.inertia == 0);
	mp_report_free(&r);
	mesh_free(&m);
}

static void a_volume_of_nothing_and_open_meshes_stay_as_they_are(void **state)
{
	static const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0.5}, c[3] = {0, 1, 0.25};
	struct mp_request request = wish(MP_WISH_EXACT);
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, a, b, c);
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.precision, MP_PRECISION_CERTIFIED); /* nothing to be exact about */
	assert_false(r.total.volume_defined);
	mp_report_free(&r);
	mesh_triangle(&m, a, c, b);
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume_defined && r.total.volume == 0 && r.bounds.volume == 0);
	assert_int_equal(r.precision, MP_PRECISION_EXACT);
	assert_true(MP_WARNED(&r, MP_WARN_ZERO_VOLUME));
	mp_report_free(&r);
	mesh_free(&m);
}

/* Two far tetrahedra wound against each other: the sums cancel down to less than their bound. */
static void what_rounding_takes_for_nothing_is_told_from_it(void **state)
{
	static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1},
			    tiny[3] = {0x1p-20, 0x1p-20, 0x1p-20};
	struct mp_request request = wish(MP_WISH_EXACT);
	struct mesh m = {0};
	struct mp_report r;
	size_t from;

	(void)state;
	mesh_box(&m, low, high);
	from = m.count;
	mesh_box(&m, low, high);
	mesh_flip(&m, from);
	mesh_move(&m, from, 4, 0, 0);
	from = m.count;
	mesh_box(&m, low, tiny);
	mesh_move(&m, from, 2, 2, 2);
	request.density_kind = MP_DENSITY_NONE;
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.precision, MP_PRECISION_EXACT);
	assert_true(r.total.volume == 0x1p-60 && r.bounds.volume == 0);
	assert_true(r.total.centroid_defined && !MP_WARNED(&r, MP_WARN_ZERO_VOLUME));
	assert_true(r.body[2].mass.volume == 0x1p-60);
	assert_int_equal(r.body[2].orientation, MP_ORIENTATION_OUTWARD);
	mp_report_free(&r);
	mesh_free(&m);
}

/* What is open as a whole may have closed bodies. */
static void bodies_of_an_open_mesh_are_exact(void **state)
{
	static const double low[3] = {0, 0, 0}, high[3] = {3, 1, 1}, a[3] = {9, 0, 0},
			    b[3] = {9, 1, 0}, c[3] = {9, 0, 1};
	struct mp_request request = wish(MP_WISH_EXACT);
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_triangle(&m, a, b, c);
	mesh_box(&m, low, high);
	request.density = 7;
	request.density_divisor = 3;
	report_of_binary(&m, &request, &r);
	assert_false(r.total.volume_defined);
	assert_true(r.body[1].mass.volume == 3 && r.body[1].mass.mass == 7);
	mp_report_free(&r);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(the_order_of_triangles_changes_no_bit),
	    cmocka_unit_test(exact_and_certified_agree_within_both_bounds),
	    cmocka_unit_test(auto_is_exact_for_small_meshes_only),
	    cmocka_unit_test(points_axes_and_a_weighed_mass_are_exact_too),
	    cmocka_unit_test(what_rounding_takes_for_nothing_is_told_from_it),
	    cmocka_unit_test(bodies_of_an_open_mesh_are_exact),
	    cmocka_unit_test(a_volume_of_nothing_and_open_meshes_stay_as_they_are),
	};

	return cmocka_run_group_tests_name("report_exact", tests, NULL, NULL);
}
