/* Bounds of single results, and what they take in. */
#include "core/moments/bounds.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/analysis.h"
#include "tests/unit/made_file.h"
#include "tests/unit/mesh_random.h"
#include "tests/unit/mesh_truth.h"
#include "tests/unit/report_of.h"

/* Both ways to compute, one after the other. */
static const enum mp_precision_wish WISH[2] = {MP_WISH_CERTIFIED, MP_WISH_EXACT};

static struct mp_report report(const struct mesh *m, enum mp_precision_wish wish,
			       struct mp_request request)
{
	struct mp_report r;

	request.precision = wish;
	report_of_ascii(m, &request, &r);
	return r;
}

static void check_symmetry(const double max[3], enum mp_symmetry symmetry, double least,
			   double most)
{
	const double min[3] = {0, 0, 0};
	struct mesh m = {0};

	mesh_box(&m, min, max);
	for (int i = 0; i < 2; i++) {
		struct mp_report r = report(&m, WISH[i], request_plain());

		assert_int_equal(r.principal.symmetry, symmetry);
		assert_true(r.bounds.axes >= least && r.bounds.axes < most);
		mp_report_free(&r);
	}
	mesh_free(&m);
}

static void test_bound_of_axes_is_of_those_that_are_determined(void **unused)
{
	const double cube[3] = {1, 1, 1}, rod[3] = {1, 1, 2}, box[3] = {1, 2, 3};

	(void)unused;
	check_symmetry(cube, MP_SYMMETRY_SPHERICAL, acos(-1) / 2, 1.5708);
	check_symmetry(rod, MP_SYMMETRY_AXIAL, 0, 1e-12);
	check_symmetry(box, MP_SYMMETRY_NONE, 0, 1e-12);
}

static void test_nothing_is_nothing_for_certain(void **unused)
{
	const double min[3] = {1, 2, 3.3}, max[3] = {4, 7, 3.3};
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, min, max); /* flat */
	for (int i = 0; i < 2; i++) {
		struct mp_report r = report(&m, WISH[i], request_plain());

		assert_true(r.total.volume_defined && r.total.volume == 0 && r.bounds.volume == 0);
		assert_true(r.bounds.area > 0 && r.bounds.area < 1e-13);
		mp_report_free(&r);
	}
	mesh_free(&m);
}

/* A weighed mass is what was given, whatever the volume is off by. */
static void test_weighed_mass_has_no_error(void **unused)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};

	(void)unused;
	request.density_kind = MP_DENSITY_FROM_MASS;
	request.density = 0.7;
	mesh_torus(&m, 3, 1, 17, 9);
	for (int i = 0; i < 2; i++) {
		struct mp_report r = report(&m, WISH[i], request);

		assert_true(r.total.mass == 0.7 && r.bounds.mass == 0);
		mp_report_free(&r);
	}
	mesh_free(&m);
}

/* An error of the density, from changing its unit, is one of the mass. */
static void test_error_of_the_density_is_taken_in(void **unused)
{
	const double min[3] = {0, 0, 0}, max[3] = {1, 2, 4};
	struct mp_request request = request_plain();
	struct mesh m = {0};

	(void)unused;
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 0.5;
	request.density_error = 0x1p-30;
	mesh_box(&m, min, max);
	for (int i = 0; i < 2; i++) {
		struct mp_report r = report(&m, WISH[i], request);

		assert_true(r.total.mass == 4);
		assert_true(r.bounds.mass >= 0x1p-28 && r.bounds.mass < 0x1.001p-28);
		assert_true(r.bounds.inertia >= 0x1p-30 * r.total.inertia[0][0]);
		assert_true(r.bounds.inertia_origin >= 0x1p-30 * r.inertia_origin[0][0]);
		assert_true(r.bounds.moments >= 0x1p-30 * r.principal.moments[2]);
		mp_report_free(&r);
	}
	mesh_free(&m);
}

static void add_quotient(struct truth_quotient *io, const struct truth_quotient *x)
{
	mpf_t other;

	mpf_mul(io->num, io->num, x->den);
	mpf_init2(other, mpf_get_prec(io->num));
	mpf_mul(other, x->num, io->den);
	mpf_add(io->num, io->num, other);
	mpf_mul(io->den, io->den, x->den);
	mpf_clear(other);
}

static void multiply_quotient(struct truth_quotient *io, const struct truth_quotient *by)
{
	mpf_mul(io->num, io->num, by->num);
	mpf_mul(io->den, io->den, by->den);
}

/* Two bodies of different density: mass and centroid of the whole are those of the masses. */
static void check_named(double worst[2], struct truth part[2], uint64_t *state)
{
	const struct made_range names[] = {{0, "light"}, {12, "heavy"}, {24, NULL}};
	struct mp_named_density densities[2] = {{"light", 5, random_between(state, 1, 2), 3, 0},
						{"heavy", 5, random_between(state, 5, 9), 7, 0}};
	struct mp_request request = request_plain();
	struct random_mesh random;
	struct mp_error err;
	struct mp_report r;

	mesh_random_boxes(&random, state);
	request.named = densities;
	request.named_count = 2;
	if (made_report(&(struct made_file){.mesh = &random.mesh, .parts = names}, 1, &request, &r,
			&err))
		fail_msg("%s", err.text);
	for (int i = 0; i < 2; i++) {
		const struct truth_density d = {densities[i].density, densities[i].divisor, 0};
		struct mesh half = {random.mesh.tri + 12 * i, 12, 12};

		truth_find(&part[i], &half, &d);
	}
	for (int k = 0; k < 3; k++) { /* before the masses are added */
		multiply_quotient(&part[0].centroid[k], &part[0].mass);
		multiply_quotient(&part[1].centroid[k], &part[1].mass);
		add_quotient(&part[0].centroid[k], &part[1].centroid[k]);
	}
	add_quotient(&part[0].mass, &part[1].mass);
	worst[0] = fmax(worst[0], truth_ratio(&part[0].mass, r.total.mass, r.bounds.mass));
	for (int k = 0; k < 3; k++) {
		struct truth_quotient *c = &part[0].centroid[k];

		mpf_mul(c->num, c->num, part[0].mass.den);
		mpf_mul(c->den, c->den, part[0].mass.num);
		worst[1] = fmax(worst[1], truth_ratio(c, r.total.centroid[k], r.bounds.centroid));
	}
	mp_report_free(&r);
	mesh_free(&random.mesh);
}

static void test_named_densities_are_bounded_too(void **unused)
{
	struct truth part[2];
	double worst[2] = {0, 0}; /* error/bound of mass and centroid */
	uint64_t state = 7;

	(void)unused;
	truth_init(&part[0]);
	truth_init(&part[1]);
	for (int i = 0; i < 200; i++)
		check_named(worst, part, &state);
	truth_clear(&part[0]);
	truth_clear(&part[1]);
	for (int i = 0; i < 2; i++)
		assert_true(worst[i] > 1e-3 && worst[i] <= 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_bound_of_axes_is_of_those_that_are_determined),
	    cmocka_unit_test(test_nothing_is_nothing_for_certain),
	    cmocka_unit_test(test_weighed_mass_has_no_error),
	    cmocka_unit_test(test_error_of_the_density_is_taken_in),
	    cmocka_unit_test(test_named_densities_are_bounded_too),
	};

	return cmocka_run_group_tests_name("bounds_cases", tests, NULL, NULL);
}
