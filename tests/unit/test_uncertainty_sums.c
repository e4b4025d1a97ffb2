#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/moments/uncertainty.h"
#include "tests/unit/mesh_random.h"

/* The sums behind the uncertainty: of what they are, by every kernel, and whoever shows the links.
 */
#ifdef MP_SANITIZED
enum { MESHES = 40 };
#else
enum { MESHES = 400 };
#endif

struct indexed {
	struct mp_vertices *vertices;
	uint32_t (*tri)[3];
	struct mp_mesh mesh;
};

static void take(struct indexed *s, const struct mesh *m)
{
	static const uint8_t key[16] = {9};
	double(*copy)[9] = malloc(m->count * sizeof *copy);

	s->tri = malloc(m->count * sizeof *s->tri);
	s->vertices = mp_vertices_new(key, NULL);
	assert_true(copy != NULL && s->tri != NULL && s->vertices != NULL);
	memcpy(copy, m->tri, m->count * sizeof *copy);
	assert_int_equal(
	    mp_vertices_add(s->vertices, (const double(*)[9])copy, m->count, s->tri, NULL), 0);
	mp_vertices_seal(s->vertices); /* coordinates end where their memory ends */
	s->mesh = (struct mp_mesh){.vertices = s->vertices,
				   .tri = (const uint32_t(*)[3])s->tri,
				   .triangles = (uint32_t)m->count};
	free(copy);
}

static void drop(struct indexed *s)
{
	mp_vertices_free(s->vertices);
	free(s->tri);
}

/* Any volume and centroid will do. */
static struct mp_rounded_solid describe(const struct indexed *s, const struct mesh *m)
{
	struct mp_rounded_solid r = {.mesh = &s->mesh, .float32 = true};

	for (int k = 0; k < 3; k++)
		r.min[k] = r.max[k] = m->tri[0][k];
	for (size_t i = 0; i < 9 * m->count; i++) {
		double x = m->tri[i / 9][i % 9];

		r.min[i % 3] = fmin(r.min[i % 3], x);
		r.max[i % 3] = fmax(r.max[i % 3], x);
	}
	for (int k = 0; k < 3; k++)
		r.centroid[k] = 0.25 * r.min[k] + 0.75 * r.max[k];
	r.volume = (r.max[0] - r.min[0]) * (r.max[1] - r.min[1]) * (r.max[2] - r.min[2]);
	if (r.volume == 0)
		r.volume = 1;
	return r;
}

static long double half_step2(const struct mp_rounded_solid *r, double x)
{
	int exponent = x == 0 || ilogb(x) < -126 ? -126 : ilogb(x);
	long double ulp = r->float32 ? ldexpl(1, exponent - 24) : 0;

	return ulp * ulp + (long double)r->step * r->step / 4;
}

/* Derivatives of the volume and the centroid by a coordinate, and what they are made of, as sizes.
 */
struct derivative {
	long double is[4], size[4];
};

/* By the header's words: what a triangle gives each of its corners. */
static void add_triangle(const struct mp_rounded_solid *r, const double p[3][3],
			 const uint32_t v[3], struct derivative (*sum)[3])
{
	long double e[3], f[3], n[3], size[3];

	for (int k = 0; k < 3; k++) {
		e[k] = (long double)p[1][k] - p[0][k];
		f[k] = (long double)p[2][k] - p[0][k];
	}
	for (int k = 0; k < 3; k++) {
		int l = (k + 1) % 3, m = (k + 2) % 3;

		n[k] = e[l] * f[m] - e[m] * f[l];
		size[k] = fabsl(e[l] * f[m]) + fabsl(e[m] * f[l]);
	}
	for (int i = 0; i < 9; i++) {
		struct derivative *d = &sum[v[i / 3]][i % 3];

		d->is[0] += n[i % 3] / 6;
		d->size[0] += size[i % 3] / 6;
		for (int k = 0; k < 3; k++) {
			long double s = 0, extent = (long double)r->max[k] - r->min[k];

			for (int c = 0; c < 3; c++)
				s += (long double)p[c][k] - r->centroid[k];
			s += (long double)p[i / 3][k] - r->centroid[k];
			d->is[1 + k] += n[i % 3] * s / 24 / (long double)r->volume;
			d->size[1 + k] += size[i % 3] * extent / 6 / (long double)r->volume;
		}
	}
}

struct expected {
	long double is[4], size[4];
};

static void define(const struct indexed *s, const struct mp_rounded_solid *r, struct expected *out)
{
	uint32_t vertices = mp_vertices_count(s->vertices);
	struct derivative(*sum)[3] = calloc(vertices, sizeof *sum);

	assert_non_null(sum);
	for (uint32_t t = 0; t < s->mesh.triangles; t++) {
		double p[3][3];

		mp_vertices_corners(s->vertices, s->tri[t], p);
		add_triangle(r, (const double(*)[3])p, s->tri[t], sum);
	}
	memset(out, 0, sizeof *out);
	for (uint32_t v = 0; v < vertices; v++) {
		double x[3];

		mp_vertices_get(s->vertices, v, x);
		for (int i = 0; i < 12; i++) {
			const struct derivative *d = &sum[v][i / 4];
			long double h2 = half_step2(r, x[i / 4]);

			out->is[i % 4] += d->is[i % 4] * d->is[i % 4] * h2;
			out->size[i % 4] += d->size[i % 4] * d->size[i % 4] * h2;
		}
	}
	for (int i = 0; i < 4; i++) {
		out->is[i] = sqrtl(out->is[i] / 3);
		out->size[i] = sqrtl(out->size[i] / 3);
	}
	free(sum);
}

/* What cancels leaves the rounding of what it was made of. */
static void assert_like(const struct mp_deviation *got, const struct expected *want)
{
	const long double value[] = {got->volume, got->centroid[0], got->centroid[1],
				     got->centroid[2]};

	for (int i = 0; i < 4; i++)
		if (!(fabsl(value[i] - want->is[i]) <=
		      1e-11L * want->is[i] + 1e-14L * want->size[i]))
			fail_msg("result %d: %Lg in the place of %Lg of %Lg", i, value[i],
				 want->is[i], want->size[i]);
}

static void check(const struct mesh *m, double step)
{
	struct mp_deviation got;
	struct expected want;
	struct mp_rounded_solid r, guess;
	struct mp_uncertainty_state state;
	struct indexed s;

	take(&s, m);
	r = describe(&s, m);
	r.step = step;
	define(&s, &r, &want);
	assert_int_equal(mp_uncertainty_find(&r, &got, NULL), 0);
	assert_like(&got, &want);
	guess = r; /* what the sums are about does not matter */
	guess.volume = 0;
	mp_uncertainty_begin(&state, &guess);
	assert_int_equal(mp_uncertainty_end(&state, &r, &got, NULL), 0);
	assert_like(&got, &want);
	drop(&s);
}

static void sums_are_what_the_header_says(void **unused)
{
	uint64_t state = 3;

	(void)unused;
	for (int i = 0; i < MESHES; i++) {
		struct random_mesh random;

		mesh_random(&random, &state);
		check(&random.mesh, i % 3 == 0 ? 1e-3 : 0);
		mesh_free(&random.mesh);
	}
}

/* Two hubs that all triangles have in common. */
static void long_rings_lose_nothing(void **unused)
{
	struct mesh m = {0};

	(void)unused;
	mesh_sphere(&m, 3, 40001, 2);
	mesh_move(&m, 0, 1000, 2, -1);
	for (size_t i = 0; i < 9 * m.count; i++)
		m.tri[i / 9][i % 9] = (float)m.tri[i / 9][i % 9];
	check(&m, 0);
	mesh_free(&m);
}

/* Where no float can hold differences or factors, where a box has no extent, and doubles. */
static void extremes_of_coordinates_are_no_matter(void **unused)
{
	static const double FACTOR[][3] = {
	    {0x1p-135, 0x1p-135, 0x1p-135}, {0x1p-120, 1, 1},
	    {0x1p124, 0x1p124, 0x1p124},    {0x1p-140, 0x1p120, 1},
	    {0x1p-300, 0x1p-300, 0x1p-300}, {0x1p300, 0x1p300, 0x1p300},
	    {1.0 / 3, 1.0 / 7, 1.0 / 9},    {1, 1, 0}};

	(void)unused;
	for (size_t i = 0; i < sizeof FACTOR / sizeof *FACTOR; i++) {
		struct mesh m = {0};

		mesh_torus(&m, 4, 1, 12, 7);
		mesh_move(&m, 0, 1, 0, 2);
		mesh_scale(&m, 0, FACTOR[i][0], FACTOR[i][1], FACTOR[i][2]);
		if (i < 4)
			for (size_t j = 0; j < 9 * m.count; j++)
				m.tri[j / 9][j % 9] = (float)m.tri[j / 9][j % 9];
		check(&m, FACTOR[i][0]);
		mesh_free(&m);
	}
}

static void add_with(const struct mp_deviation_kernel *kernel, struct mp_uncertainty_state *state,
		     const struct mp_rounded_solid *r, struct mp_deviation *out)
{
	mp_uncertainty_begin(state, r);
	state->kernel = kernel;
	assert_int_equal(mp_uncertainty_end(state, r, out, NULL), 0);
}

/* All but the last of each four, which mean nothing. */
static void assert_same_sums(const struct mp_deviation_sums *a, const struct mp_deviation_sums *b)
{
	enum { ROWS = 1 + 2 * MP_DEVIATION_ROWS };
	double x[ROWS][MP_DEVIATION_LANES], y[ROWS][MP_DEVIATION_LANES];

	memcpy(x, a, sizeof x);
	memcpy(y, b, sizeof y);
	for (int row = 0; row < ROWS; row++)
		assert_memory_equal(x[row], y[row], 3 * sizeof x[row][0]);
}

static void all_kernels_give_the_same_bits(void **unused)
{
	uint64_t state = 8;

	(void)unused;
	for (int i = 0; i < MESHES; i++) {
		struct mp_uncertainty_state plain, other;
		struct random_mesh random;
		struct mp_rounded_solid r;
		struct mp_deviation d;
		struct indexed s;

		mesh_random(&random, &state);
		take(&s, &random.mesh);
		r = describe(&s, &random.mesh);
		add_with(mp_deviation_kernel_get(0), &plain, &r, &d);
		for (size_t k = 1; k < mp_deviation_kernel_count(); k++) {
			add_with(mp_deviation_kernel_get(k), &other, &r, &d);
			assert_same_sums(&plain.sums, &other.sums);
		}
		drop(&s);
		mesh_free(&random.mesh);
	}
}

/* The same links, whether the topology shows them or not, in blocks or all at once. */
static void watching_the_topology_changes_no_bit(void **unused)
{
	uint64_t seed = 12;
	int watched = 0;

	(void)unused;
	for (int i = 0; i < MESHES; i++) {
		struct mp_uncertainty_state state;
		struct mp_deviation one, other;
		struct mp_topology topology;
		struct random_mesh random;
		struct mp_rounded_solid r;
		struct mp_mesh mesh;
		struct indexed s;

		mesh_random(&random, &seed);
		if (i == 0) /* several blocks, some vertices with more links than others */
			mesh_sphere(&random.mesh, 1, 100, 60);
		if (i == 1) /* than a block */
			mesh_sphere(&random.mesh, 1, 5000, 3);
		take(&s, &random.mesh);
		r = describe(&s, &random.mesh);
		assert_int_equal(mp_uncertainty_find(&r, &one, NULL), 0);
		mp_uncertainty_begin(&state, &r);
		mesh = s.mesh;
		mesh.watcher = &state.watcher;
		assert_int_equal(mp_topology_find(&mesh, 0, &topology, NULL), 0);
		watched += state.seen;
		assert_int_equal(mp_uncertainty_end(&state, &r, &other, NULL), 0);
		assert_true(one.volume == other.volume);
		for (int k = 0; k < 3; k++)
			assert_true(one.centroid[k] == other.centroid[k]);
		mp_topology_free(&topology);
		drop(&s);
		mesh_free(&random.mesh);
	}
	print_message("# %d of %d watched\n", watched, MESHES);
	assert_true(watched > MESHES / 2 && watched < MESHES);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(sums_are_what_the_header_says),
	    cmocka_unit_test(long_rings_lose_nothing),
	    cmocka_unit_test(extremes_of_coordinates_are_no_matter),
	    cmocka_unit_test(all_kernels_give_the_same_bits),
	    cmocka_unit_test(watching_the_topology_changes_no_bit),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
