#include "core/moments/principal.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/report_of.h"

/*
 * The classes of symmetry and their axes, of parts as they lie, far away, turned, and large or
 * small; by both kinds of sums.
 */
static const double still[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
/* 3-4-5 about z, then about x: 25 times a rotation, so that whole numbers stay whole. */
static const double turned[3][3] = {{15, -20, 0}, {12, 9, -20}, {16, 12, 15}};

struct place {
	const double (*turn)[3];
	double length; /* of the rows of turn */
	double move[3], scale;
};

static const struct place places[] = {
    {still, 1, {0, 0, 0}, 1},
    {still, 1, {-3.5, 7, 100}, 1},
    {still, 1, {0x1p30, -0x1p31, 0x1p29}, 1}, /* nothing is lost in moving */
    {turned, 25, {0, 0, 0}, 1},
    {turned, 25, {0x1p30, -0x1p31, 0x1p29}, 1},
    {still, 1, {0, 0, 0}, 0x1p-30},
    {turned, 25, {5, 6, 7}, 0x1p30},
};

static void put(struct mesh *m, const struct place *p)
{
	for (size_t i = 0; i < 3 * m->count; i++) {
		double *x = m->tri[i / 3] + i % 3 * 3, y[3];

		for (int k = 0; k < 3; k++)
			y[k] = p->turn[k][0] * x[0] + p->turn[k][1] * x[1] + p->turn[k][2] * x[2];
		for (int k = 0; k < 3; k++)
			x[k] = (y[k] + p->move[k]) * p->scale;
	}
}

/* The part's own axis ${k}, where it lies. */
static void own_axis(const struct place *p, int k, double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = p->turn[i][k] / p->length;
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The sine of the angle between two lines; their cosine would tell nothing of small ones. */
static double sine(const double a[3], const double b[3])
{
	double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2],
	       z = a[0] * b[1] - a[1] * b[0];

	return sqrt(x * x + y * y + z * z);
}

static void check_frame(const struct mp_principal *p)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			assert_near(dot(p->axes[i], p->axes[j]), i == j, 1e-15);
	assert_true(p->moments[0] <= p->moments[1] && p->moments[1] <= p->moments[2]);
}

/* One of the free axes is X, or Y where X lies along the axis that stands alone, projected. */
static void check_free_axes(const struct mp_principal *p, int alone)
{
	const double *axis = p->axes[alone];
	int world = fabs(axis[0]) > 0.9 ? 1 : 0, first = alone == 0 ? 1 : 0;
	double want[3];

	for (int k = 0; k < 3; k++)
		want[k] = (k == world) - axis[world] * axis[k];
	assert_near(sine(p->axes[first], want) / sqrt(dot(want, want)), 0, 1e-14);
}

/* ${alone}: the row of the axis that stands alone, which is the part's own axis ${own}. */
static void check_axial(const struct mesh *part, int alone, int own)
{
	for (size_t i = 0; i < 2 * (sizeof places / sizeof places[0]); i++) {
		struct mp_request request = request_plain();
		const struct place *p = &places[i / 2];
		struct mesh m = {0};
		struct mp_report r;
		double axis[3];

		for (size_t t = 0; t < part->count; t++)
			mesh_triangle(&m, part->tri[t], part->tri[t] + 3, part->tri[t] + 6);
		put(&m, p);
		request.precision = i % 2 == 0 ? MP_WISH_CERTIFIED : MP_WISH_EXACT;
		report_of_ascii(&m, &request, &r);
		own_axis(p, own, axis);
		if (r.principal.symmetry != MP_SYMMETRY_AXIAL)
			fail_msg("place %zu: class %d", i, r.principal.symmetry);
		check_frame(&r.principal);
		assert_true(r.bounds.axes < 1e-9);
		if (!(sine(r.principal.axes[alone], axis) <= r.bounds.axes + 1e-15))
			fail_msg("place %zu: off by %g, bound %g", i,
				 sine(r.principal.axes[alone], axis), r.bounds.axes);
		check_free_axes(&r.principal, alone);
		mp_report_free(&r);
		mesh_free(&m);
	}
}

static void a_cube_is_spherical_wherever_it_lies(void **unused)
{
	static const double min[3] = {-1, -1, -1}, max[3] = {1, 1, 1};

	(void)unused;
	for (size_t i = 0; i < 2 * (sizeof places / sizeof places[0]); i++) {
		struct mp_request request = request_plain();
		struct mesh m = {0};
		struct mp_report r;

		mesh_box(&m, min, max);
		put(&m, &places[i / 2]);
		request.precision = i % 2 == 0 ? MP_WISH_CERTIFIED : MP_WISH_EXACT;
		report_of_ascii(&m, &request, &r);
		assert_int_equal(r.principal.symmetry, MP_SYMMETRY_SPHERICAL);
		for (int k = 0; k < 9; k++)
			assert_true(r.principal.axes[k / 3][k % 3] == (k % 4 == 0));
		assert_true(r.bounds.axes >= acos(-1) / 2); /* nothing is known of them */
		assert_relative(r.principal.moments[2], r.principal.moments[0], 1e-12);
		mp_report_free(&r);
		mesh_free(&m);
	}
}

static void a_disc_stands_on_its_axis(void **unused)
{
	static const double min[3] = {-4, -4, -1}, max[3] = {4, 4, 1};
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, min, max);
	check_axial(&m, 2, 2);
	mesh_free(&m);
}

static void a_needle_turns_about_its_length(void **unused)
{
	static const double min[3] = {-4096, -1, -1}, max[3] = {4096, 1, 1};
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, min, max);
	check_axial(&m, 0, 0);
	mesh_free(&m);
}

/* Corners of a hexagon are not where they belong by half an ulp: the moments differ a little. */
static void a_round_bar_is_axial_as_far_as_doubles_go(void **unused)
{
	struct mp_report r;
	struct mesh m = {0};

	(void)unused;
	mesh_torus(&m, 5, 1, 36, 12);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.principal.symmetry, MP_SYMMETRY_AXIAL);
	assert_near(r.principal.axes[2][2], 1, 1e-15);
	check_free_axes(&r.principal, 2);
	mp_report_free(&r);
	mesh_free(&m);
}

/* What a file rounds is no symmetry of the mesh as stored: 2^-20 of the length is seen. */
static void nearly_is_not_axial(void **unused)
{
	static const double min[3] = {-1, -1, -4}, max[3] = {1, 1 + 0x1p-20, 4};
	struct mp_report r;
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, min, max);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.principal.symmetry, MP_SYMMETRY_NONE);
	assert_true(r.bounds.axes < 1e-8);
	for (int k = 0; k < 3; k++)
		assert_near(fabs(r.principal.axes[k][2 - k]), 1, 1e-12);
	mp_report_free(&r);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_cube_is_spherical_wherever_it_lies),
	    cmocka_unit_test(a_disc_stands_on_its_axis),
	    cmocka_unit_test(a_needle_turns_about_its_length),
	    cmocka_unit_test(a_round_bar_is_axial_as_far_as_doubles_go),
	    cmocka_unit_test(nearly_is_not_axial),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
