#include "core/moments/uncertainty.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/moments/moments.h"
#include "core/moments/solid.h"
#include "tests/unit/mesh_random.h"
#include "tests/unit/report_of.h"

/*
 * The estimate against what happens when vertices are moved at random.  Of 300 tries the rms is
 * known to about 4 %.
 */
#ifdef MP_SANITIZED
enum { MESHES = 15, TRIES = 300 };
#else
enum { MESHES = 120, TRIES = 300 };
#endif

/* A mesh by vertex numbers, as it is and as it is moved. */
struct shaken {
	struct mp_vertices *vertices;
	uint32_t (*tri)[3];
	uint32_t count;
	double (*at)[3];    /* of each vertex, moved */
	double (*moved)[9]; /* of each triangle */
	struct mp_mesh mesh;
	struct mp_solid solid; /* not moved */
};

static void solve(const double (*tri)[9], uint32_t count, struct mp_solid *out)
{
	struct mp_moments m, second;

	mp_moments_begin(&m);
	for (uint32_t t = 0; t < count; t++)
		mp_moments_add(&m, tri + t, 1);
	mp_moments_begin_again(&second, &m);
	for (uint32_t t = 0; t < count; t++)
		mp_moments_add(&second, tri + t, 1);
	mp_moments_solve(&second, out);
}

static void take(struct shaken *s, const struct mesh *m)
{
	static const uint8_t key[16] = {7};
	struct mp_error err;

	s->count = (uint32_t)m->count;
	s->tri = malloc(m->count * sizeof *s->tri);
	s->moved = malloc(m->count * sizeof *s->moved);
	s->vertices = mp_vertices_new(key, &err);
	assert_true(s->tri != NULL && s->moved != NULL && s->vertices != NULL);
	assert_int_equal(
	    mp_vertices_add(s->vertices, (const double(*)[9])m->tri, m->count, s->tri, &err), 0);
	s->at = malloc(mp_vertices_count(s->vertices) * sizeof *s->at);
	assert_non_null(s->at);
	s->mesh = (struct mp_mesh){
	    .vertices = s->vertices, .tri = (const uint32_t(*)[3])s->tri, .triangles = s->count};
	solve((const double(*)[9])m->tri, s->count, &s->solid);
}

static void drop(struct shaken *s)
{
	mp_vertices_free(s->vertices);
	free(s->tri);
	free(s->moved);
	free(s->at);
}

static struct mp_rounded_solid rounded(const struct shaken *s, const struct mesh *m)
{
	struct mp_rounded_solid r = {
	    .mesh = &s->mesh, .float32 = true, .volume = (double)s->solid.volume};

	for (int k = 0; k < 3; k++) {
		r.min[k] = r.max[k] = m->tri[0][k];
		r.centroid[k] = (double)s->solid.centroid[k];
	}
	for (size_t i = 0; i < 9 * m->count; i++) {
		double x = m->tri[i / 9][i % 9];

		r.min[i % 3] = fmin(r.min[i % 3], x);
		r.max[i % 3] = fmax(r.max[i % 3], x);
	}
	return r;
}

/* Half of what is between x and the next float32. */
static double half_gap(double x)
{
	float f = fabsf((float)x);

	return ((double)nextafterf(f, INFINITY) - (double)f) / 2;
}

static void shake(struct shaken *s, const struct mp_rounded_solid *r, uint64_t *state)
{
	for (uint32_t v = 0; v < mp_vertices_count(s->vertices); v++) {
		mp_vertices_get(s->vertices, v, s->at[v]);
		for (int k = 0; k < 3; k++) {
			double h = r->float32 ? half_gap(s->at[v][k]) : 0;

			s->at[v][k] += random_between(state, -h, h) +
				       random_between(state, -r->step / 2, r->step / 2);
		}
	}
	for (uint32_t i = 0; i < 9 * s->count; i++)
		s->moved[i / 9][i % 9] = s->at[s->tri[i / 9][i / 3 % 3]][i % 3];
}

/* What is seen over what is estimated: of the volume and of the coordinates of the centroid. */
static void compare(struct shaken *s, const struct mp_rounded_solid *r,
		    const struct mp_deviation *d, uint64_t *state, double ratio[4])
{
	long double sum[4] = {0};

	for (int i = 0; i < TRIES; i++) {
		struct mp_solid solid;
		long double off = 0;

		shake(s, r, state);
		solve((const double(*)[9])s->moved, s->count, &solid);
		off = solid.volume - s->solid.volume;
		sum[0] += off * off;
		for (int k = 0; k < 3; k++) {
			off = solid.centroid[k] - s->solid.centroid[k];
			sum[1 + k] += off * off;
		}
	}
	for (int k = 0; k < 4; k++)
		ratio[k] =
		    (double)(sqrtl(sum[k] / TRIES) / (k == 0 ? d->volume : d->centroid[k - 1]));
}

/* The factors between which every estimate has to be. */
static void check_mesh(const struct mesh *m, const struct mp_rounded_solid *how, uint64_t *state,
		       double low, double high, int *seen)
{
	struct mp_rounded_solid r;
	struct mp_deviation d;
	struct mp_error err;
	struct shaken s;
	double ratio[4];

	take(&s, m);
	r = rounded(&s, m);
	if (how != NULL) {
		r.float32 = how->float32;
		r.step = how->step;
	}
	assert_int_equal(mp_uncertainty_find(&r, &d, &err), 0);
	/* where the file leaves a tenth of the volume open, nothing is linear any more */
	if (s.solid.has_centroid && d.volume < 0.1L * fabsl(s.solid.volume)) {
		compare(&s, &r, &d, state, ratio);
		for (int k = 0; k < 4; k++)
			if (!(ratio[k] >= low && ratio[k] <= high))
				fail_msg("%u triangles, result %d: ratio %g", s.count, k, ratio[k]);
		++*seen;
	}
	drop(&s);
}

static void random_meshes_do_as_estimated(void **unused)
{
	uint64_t state = 31;
	int seen = 0;

	(void)unused;
	for (int i = 0; i < MESHES; i++) {
		struct random_mesh random;

		do {
			mesh_random(&random, &state);
			if (!random.narrow)
				mesh_free(&random.mesh);
		} while (!random.narrow);
		check_mesh(&random.mesh, NULL, &state, 0.6, 1.6, &seen);
		mesh_free(&random.mesh);
	}
	print_message("# %d of %d meshes\n", seen, MESHES);
	assert_true(seen > MESHES / 2);
}

static void plain_parts_do_exactly_as_estimated(void **unused)
{
	static const double min[3] = {0, 0, 0}, max[3] = {40, 30, 20};
	uint64_t state = 5;
	struct mesh m = {0};
	int seen = 0;

	(void)unused;
	mesh_box(&m, min, max);
	mesh_move(&m, 0, 1000, -70, 0.5);
	check_mesh(&m, NULL, &state, 0.8, 1.25, &seen);
	mesh_free(&m);
	mesh_torus(&m, 30, 8, 40, 12);
	mesh_move(&m, 0, 100, 20000, -3);
	check_mesh(&m, NULL, &state, 0.8, 1.25, &seen);
	mesh_free(&m);
	mesh_sphere(&m, 1, 24, 12);
	mesh_scale(&m, 0, 1e-4, 1, 1e3); /* each axis has its own steps */
	check_mesh(&m, NULL, &state, 0.8, 1.25, &seen);
	mesh_free(&m);
	assert_int_equal(seen, 3);
}

/* Four vertices to four triangles: the way for many vertices. */
static void loose_tetrahedra_do_as_estimated(void **unused)
{
	uint64_t state = 9;
	struct mesh m = {0};
	int seen = 0;

	(void)unused;
	for (int i = 0; i < 8; i++) {
		mesh_wedge(&m, 1 + i, 2, 3);
		mesh_move(&m, (size_t)(4 * i), 20.5 * i, 3.25 * i, 50);
	}
	check_mesh(&m, NULL, &state, 0.8, 1.25, &seen);
	assert_int_equal(seen, 1);
	mesh_free(&m);
}

static void quantisation_does_as_estimated(void **unused)
{
	const struct mp_rounded_solid coarse = {.float32 = true, .step = 0.01},
				      both = {.float32 = true, .step = 0.0005},
				      alone = {.float32 = false, .step = 0.01};
	uint64_t state = 11;
	struct mesh m = {0};
	int seen = 0;

	(void)unused;
	mesh_torus(&m, 30, 8, 30, 12);
	mesh_move(&m, 0, 5000, 0, 0);
	check_mesh(&m, &coarse, &state, 0.8, 1.25, &seen);
	check_mesh(&m, &both, &state, 0.8, 1.25, &seen);
	check_mesh(&m, &alone, &state, 0.8, 1.25, &seen);
	assert_int_equal(seen, 3);
	mesh_free(&m);
}

/* Out of the grid: coordinates that occur again and again would be rounded the same way. */
static void tilt(struct mesh *m)
{
	for (size_t i = 0; i < 6 * m->count; i++) {
		double *p = m->tri[i / 6] + i / 2 % 3 * 3;
		int a = i % 2 == 0 ? 0 : 1, b = a + 1;
		double x = p[a], y = p[b];

		p[a] = 0.8 * x - 0.6 * y;
		p[b] = 0.6 * x + 0.8 * y;
	}
}

/* Rounding as it happens, in place of random moves. */
static void parts_rounded_to_float32_are_off_as_estimated(void **unused)
{
	enum { PARTS = 200 };
	double sum[2] = {0};
	uint64_t state = 17;

	(void)unused;
	for (int i = 0; i < PARTS; i++) {
		struct mp_report exact, stored;
		struct mesh m = {0};
		double off;

		mesh_torus(&m, random_between(&state, 2, 9), 1, 20, 8);
		tilt(&m);
		mesh_move(&m, 0, random_between(&state, 0, 999), random_between(&state, 0, 99), 0);
		report_of_ascii(&m, NULL, &exact);
		report_of_binary(&m, NULL, &stored);
		assert_int_equal(exact.uncertainty.source, MP_ROUNDING_UNKNOWN);
		assert_false(exact.uncertainty.volume_defined);
		assert_int_equal(stored.uncertainty.source, MP_ROUNDING_FLOAT32);
		assert_true(stored.uncertainty.volume_defined);
		off = (stored.total.volume - exact.total.volume) / stored.uncertainty.volume;
		sum[0] += off * off;
		off = (stored.total.centroid[0] - exact.total.centroid[0]) /
		      stored.uncertainty.centroid; /* x has the largest steps */
		sum[1] += off * off;
		mp_report_free(&exact);
		mp_report_free(&stored);
		mesh_free(&m);
	}
	for (int k = 0; k < 2; k++) {
		print_message("# rms of error/estimate: %g\n", sqrt(sum[k] / PARTS));
		assert_true(sqrt(sum[k] / PARTS) > 0.6 && sqrt(sum[k] / PARTS) < 1.6);
	}
}

/* By powers of two, up to where a volume is no double any more. */
static void scaling_changes_no_digit(void **unused)
{
	uint64_t state = 23;
	struct mp_report one, other;
	struct mesh m = {0};

	(void)unused;
	mesh_sphere(&m, 1, 20, 9);
	mesh_move(&m, 0, random_between(&state, 1, 2), 9, 0);
	for (size_t i = 0; i < 9 * m.count; i++)
		m.tri[i / 9][i % 9] = (float)m.tri[i / 9][i % 9];
	report_of_binary(&m, NULL, &one);
	for (int e = -60; e <= 100; e += 40) {
		mesh_scale(&m, 0, ldexp(1, e), ldexp(1, e), ldexp(1, e));
		report_of_binary(&m, NULL, &other);
		assert_true(other.uncertainty.volume == ldexp(one.uncertainty.volume, 3 * e));
		assert_true(other.uncertainty.centroid == ldexp(one.uncertainty.centroid, e));
		mp_report_free(&other);
		mesh_scale(&m, 0, ldexp(1, -e), ldexp(1, -e), ldexp(1, -e));
	}
	mp_report_free(&one);
	mesh_free(&m);
}

static void mass_follows_the_density(void **unused)
{
	static const double min[3] = {0, 0, 0}, max[3] = {40, 30, 20};
	struct mp_request request = request_plain();
	struct mp_report r;
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, min, max);
	report_of_binary(&m, &request, &r);
	assert_true(r.uncertainty.volume_defined && r.uncertainty.centroid_defined);
	assert_false(r.uncertainty.mass_defined);
	mp_report_free(&r);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 2700;
	request.density_divisor = 1e9;
	report_of_binary(&m, &request, &r);
	assert_true(r.uncertainty.mass_defined);
	assert_relative(r.uncertainty.mass, r.uncertainty.volume * 2.7e-6, 1e-14);
	mp_report_free(&r);
	request.density_kind = MP_DENSITY_FROM_MASS;
	report_of_binary(&m, &request, &r);
	assert_true(r.uncertainty.mass_defined && r.uncertainty.mass == 0); /* it was weighed */
	mp_report_free(&r);
	m.count--; /* open */
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.uncertainty.source, MP_ROUNDING_FLOAT32);
	assert_false(r.uncertainty.volume_defined || r.uncertainty.mass_defined ||
		     r.uncertainty.centroid_defined);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Both sides of a sheet: there is no volume, but the next file may have one. */
static void a_volume_of_nothing_is_uncertain_too(void **unused)
{
	static const double min[3] = {0, 0, 0}, max[3] = {4, 3, 0};
	struct mp_report r;
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, min, max);
	mesh_move(&m, 0, 0, 0, 1);
	report_of_binary(&m, NULL, &r);
	assert_true(r.total.volume == 0 && r.uncertainty.volume_defined);
	assert_false(r.uncertainty.centroid_defined);
	mp_report_free(&r);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(random_meshes_do_as_estimated),
	    cmocka_unit_test(plain_parts_do_exactly_as_estimated),
	    cmocka_unit_test(loose_tetrahedra_do_as_estimated),
	    cmocka_unit_test(quantisation_does_as_estimated),
	    cmocka_unit_test(parts_rounded_to_float32_are_off_as_estimated),
	    cmocka_unit_test(scaling_changes_no_digit),
	    cmocka_unit_test(mass_follows_the_density),
	    cmocka_unit_test(a_volume_of_nothing_is_uncertain_too),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
