#include "core/moments/bounds.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/analysis.h"
#include "tests/unit/mesh_random.h"
#include "tests/unit/mesh_truth.h"
#include "tests/unit/report_of.h"

/*
 * Every bound of every report against exact arithmetic.  A sanitizer makes GMP and the analysis
 * many times slower, and sees as much in fewer meshes.
 */
#ifdef MP_SANITIZED
enum { MESHES = 1500, AROUND = 100 };
#else
enum { MESHES = 12000, AROUND = 708 };
#endif

enum field { VOLUME, AREA, MASS, CENTROID, INERTIA, ORIGIN, MOMENTS, AXES, RADII, FIELDS };

static const char *const NAMES[FIELDS] = {"volume",
					  "surface_area",
					  "mass",
					  "centroid",
					  "inertia",
					  "inertia_about_origin",
					  "principal_moments",
					  "principal_axes_rad",
					  "radii_of_gyration"};

struct tally {
	long seen[FIELDS], broken[FIELDS];
	double worst[FIELDS];
};

static void count(struct tally *t, enum field f, double bound, double ratio)
{
	assert_true(isfinite(bound) && bound >= 0);
	t->seen[f]++;
	t->broken[f] += !(ratio <= 1);
	t->worst[f] = fmax(t->worst[f], ratio);
}

static void check_tensor(struct tally *t, enum field f, struct truth_quotient exact[3][3],
			 const double value[3][3], double bound)
{
	double worst = 0;

	for (int i = 0; i < 9; i++)
		worst = fmax(worst, truth_ratio(&exact[i / 3][i % 3], value[i / 3][i % 3], bound));
	count(t, f, bound, worst);
}

static void check_axes(struct tally *t, struct truth *o, const struct mp_report *r)
{
	const struct mp_principal *p = &r->principal;
	bool low = p->moments[1] - p->moments[0] < p->moments[2] - p->moments[1];
	double worst = 0;

	if (p->symmetry == MP_SYMMETRY_SPHERICAL)
		assert_true(r->bounds.axes >= acos(-1) / 2);
	for (int k = 0; k < 3; k++) {
		double angle;

		if (p->symmetry == MP_SYMMETRY_SPHERICAL ||
		    (p->symmetry == MP_SYMMETRY_AXIAL && k != (low ? 2 : 0)))
			continue;
		angle = asin(fmin(truth_sine(o->axis[k], p->axes[k]), 1));
		worst = fmax(worst, angle * (1 - 1e-15) / r->bounds.axes);
	}
	count(t, AXES, r->bounds.axes, worst);
}

static void check_principal(struct tally *t, struct truth *o, const struct mp_report *r)
{
	double moments = 0, radii = 0;

	for (int k = 0; k < 3; k++) {
		moments = fmax(moments, truth_ratio_root(o->moment[k], r->principal.moments[k],
							 r->bounds.moments));
		radii = fmax(radii, truth_ratio_root(o->radius[k], r->radii_of_gyration[k],
						     r->bounds.radii));
	}
	count(t, MOMENTS, r->bounds.moments, moments);
	if (r->radii_defined)
		count(t, RADII, r->bounds.radii, radii);
	check_axes(t, o, r);
}

static void check_solid(struct tally *t, struct truth *o, const struct mp_report *r)
{
	const struct mp_bounds *b = &r->bounds;
	const struct mp_mass *m = &r->total;
	double centroid = 0;

	if (m->volume_defined)
		count(t, VOLUME, b->volume, truth_ratio(&o->volume, m->volume, b->volume));
	if (m->volume_defined && m->volume != 0)
		assert_int_equal(o->sign, m->volume > 0 ? 1 : -1);
	if (o->sign == 0)
		assert_true(!m->centroid_defined && m->volume == 0);
	if (o->sign == 0)
		return;
	if (m->mass_defined)
		count(t, MASS, b->mass, truth_ratio(&o->mass, m->mass, b->mass));
	for (int k = 0; k < 3 && m->centroid_defined; k++)
		centroid =
		    fmax(centroid, truth_ratio(&o->centroid[k], m->centroid[k], b->centroid));
	if (m->centroid_defined)
		count(t, CENTROID, b->centroid, centroid);
	if (r->inertia_origin_defined)
		check_tensor(t, ORIGIN, o->about_origin, (const double(*)[3])r->inertia_origin,
			     b->inertia_origin);
	if (!m->inertia_defined)
		return;
	check_tensor(t, INERTIA, o->central, (const double(*)[3])m->inertia, b->inertia);
	check_principal(t, o, r);
}

static struct truth_density draw_density(struct mp_request *request, uint64_t *state)
{
	struct truth_density d = {1, 1, 0};

	*request = request_plain();
	if (random_chance(state, 0.3))
		return d;
	if (random_chance(state, 0.3)) {
		request->density_kind = MP_DENSITY_FROM_MASS;
		request->density = d.mass = random_between(state, 1e-3, 1e3);
		return d;
	}
	request->density_kind = MP_DENSITY_GIVEN;
	request->density = d.value = random_between(state, 1e-3, 1e4);
	request->density_divisor = d.divisor = random_between(state, 1, 1e9);
	return d;
}

/* Turned, sheared, mirrored, flattened to a thousandth, far away; not quite singular at times. */
static void draw_map(struct mp_request *request, uint64_t *state)
{
	double size = exp(random_between(state, -8, 8)), far = exp(random_between(state, -5, 15));
	double(*row)[4] = request->transform;
	struct mp_affine map;

	request->has_transform = random_chance(state, 0.5);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			row[i][k] = random_chance(state, 0.2) && i != k
					? 0
					: size * random_between(state, -1, 1);
	for (int i = 0; i < 3; i++)
		row[i][3] = random_chance(state, 0.5) ? far * random_between(state, -1, 1) : 0;
	if (random_chance(state, 0.1))
		for (int k = 0; k < 3; k++)
			row[2][k] = row[1][k] + random_between(state, -1e-3, 1e-3) * row[0][k];
	if (random_chance(state, 0.1)) /* only axes and signs change */
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				row[i][k] = k == (i + 1) % 3 ? (i == 2 ? -size : size) : 0;
	request->has_transform =
	    request->has_transform && mp_affine_set(&map, (const double(*)[4])row);
}

static void check_report(struct tally *t, struct truth *o, const struct mesh *mesh,
			 const struct mp_request *request, bool narrow)
{
	struct mp_report r;

	if (narrow)
		report_of_binary(mesh, request, &r);
	else
		report_of_ascii(mesh, request, &r);
	if (request->precision == MP_WISH_CERTIFIED)
		assert_int_equal(r.precision, MP_PRECISION_CERTIFIED);
	if (r.total.area_defined)
		count(t, AREA, r.bounds.area,
		      truth_ratio_root(o->area, r.total.area, r.bounds.area));
	if (r.topology.closed)
		check_solid(t, o, &r);
	mp_report_free(&r);
}

/* t: certified, and what is chosen by itself */
static void check_mesh(struct tally t[2], struct truth *o, uint64_t *state)
{
	struct mp_request request;
	struct truth_density density = draw_density(&request, state);
	struct random_mesh random;

	mesh_random(&random, state);
	if (random.mesh.count > 4 && random_chance(state, 0.02))
		random.mesh.count--; /* open: it has an area */
	draw_map(&request, state);
	truth_find_mapped(o, &random.mesh,
			  request.has_transform ? (const double(*)[4])request.transform : NULL,
			  &density);
	request.precision = MP_WISH_CERTIFIED;
	check_report(&t[0], o, &random.mesh, &request, random.narrow);
	request.precision = MP_WISH_PRECISION_AUTO;
	if (random_chance(state, 0.25))
		check_report(&t[1], o, &random.mesh, &request, random.narrow);
	mesh_free(&random.mesh);
}

static void say(const char *precision, const struct tally *t)
{
	for (int f = 0; f < FIELDS; f++)
		print_message("# %s %-20s %6ld checked, %ld beyond, worst error/bound %.3g\n",
			      precision, NAMES[f], t->seen[f], t->broken[f], t->worst[f]);
}

/*
 * The worst error/bound of a field is between 1e-3 and 1: the bounds hold, and say something.
 */
static void test_no_result_is_beyond_its_bound(void **unused)
{
	struct tally t[2];
	uint64_t state = 20061;
	struct truth o;

	(void)unused;
	memset(t, 0, sizeof t);
	truth_init(&o);
	for (int i = 0; i < MESHES; i++)
		check_mesh(t, &o, &state);
	truth_clear(&o);
	say("certified", &t[0]);
	say("auto     ", &t[1]);
	for (int f = 0; f < FIELDS; f++) {
		assert_int_equal(t[0].broken[f], 0);
		assert_int_equal(t[1].broken[f], 0);
		assert_true(t[0].seen[f] > MESHES * 3 / 4 && t[1].seen[f] > MESHES / 8);
		assert_true(t[0].worst[f] > 1e-3);
	}
}

/* Many blocks: bounds grow with the sums, not with their number. */
static void test_bounds_of_a_large_mesh(void **unused)
{
	const struct truth_density density = {1, 1, 0};
	struct tally t = {0};
	struct mp_report r;
	struct mesh m = {0};
	struct truth o;

	(void)unused;
	mesh_torus(&m, 3, 1, 250, 160);
	report_of_ascii(&m, NULL, &r);
	truth_init(&o);
	truth_find(&o, &m, &density);
	count(&t, AREA, r.bounds.area, truth_ratio_root(o.area, r.total.area, r.bounds.area));
	check_solid(&t, &o, &r);
	for (int f = 0; f < FIELDS; f++)
		assert_true(t.seen[f] == 1 && t.broken[f] == 0);
	assert_true(r.bounds.volume <= 1e-14 * r.total.volume);
	assert_true(r.bounds.area <= 1e-14 * r.total.area);
	assert_true(r.bounds.mass <= 1e-14 * r.total.mass);
	assert_true(r.bounds.centroid <= 1e-13);
	assert_true(r.bounds.inertia <= 1e-12 * r.total.inertia[0][0]);
	assert_true(r.bounds.moments <= 2e-12 * r.principal.moments[2]);
	assert_true(r.bounds.radii <= 2e-12);
	truth_clear(&o);
	mp_report_free(&r);
	mesh_free(&m);
}

/*
 * As files have them: float32, far from the origin, a part with a cavity, flat.  Exact numbers are
 * rounded once at any size.
 */
static void test_bounds_of_a_million_triangles(void **unused)
{
	static const enum mp_precision_wish wish[2] = {MP_WISH_CERTIFIED, MP_WISH_EXACT};
	const struct truth_density density = {1, 1, 0};
	struct mesh m = {0};
	struct truth o;

	(void)unused;
	mesh_torus(&m, 300, 100, AROUND, AROUND / 2);
	mesh_torus(&m, 300, 40, AROUND, AROUND / 2);
	mesh_flip(&m, m.count / 2);
	mesh_scale(&m, 0, 1, 1, 0.01);
	mesh_move(&m, 0, 40000, -7000, 300);
	for (size_t i = 0; i < 9 * m.count; i++)
		m.tri[i / 9][i % 9] = (double)(float)m.tri[i / 9][i % 9];
	truth_init(&o);
	truth_find(&o, &m, &density);
	for (int w = 0; w < 2; w++) {
		struct mp_request request = request_plain();
		struct tally t = {0};
		struct mp_report r;

		request.precision = wish[w];
		report_of_binary(&m, &request, &r);
		assert_int_equal(r.precision, w == 0 ? MP_PRECISION_CERTIFIED : MP_PRECISION_EXACT);
		check_solid(&t, &o, &r);
		for (int f = 0; f < FIELDS; f++)
			assert_true(f == AREA || (t.seen[f] == 1 && t.broken[f] == 0));
		assert_true(r.bounds.volume <= 1e-13 * r.total.volume);
		mp_report_free(&r);
	}
	truth_clear(&o);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_no_result_is_beyond_its_bound),
	    cmocka_unit_test(test_bounds_of_a_large_mesh),
	    cmocka_unit_test(test_bounds_of_a_million_triangles),
	};

	return cmocka_run_group_tests_name("bounds", tests, NULL, NULL);
}
