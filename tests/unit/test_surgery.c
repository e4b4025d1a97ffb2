#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/topology/topology.h"
#include "soup.h"

/*
 * Closed meshes on which known operations are done, each at a site of its own that shares no
 * vertex with another; the checks have to find exactly what was done, and where.
 */

enum { SEEDS = 2500, MOST_ITEMS = 256, MOST_MARKED = 400 };

/* What one operation leaves to be found. */
struct item {
	enum mp_defect_kind kind;
	double at[4][3]; /* its vertices, in any order */
	unsigned count;
	bool crack, opposite;
	double junction[3];
};

struct patient {
	struct soup soup;
	uint64_t state;
	struct item item[MOST_ITEMS];
	size_t items, kind[MP_DEFECT_KINDS];
	double marked[MOST_MARKED][3]; /* vertices of sites */
	size_t marks;
	int64_t bodies, vertices, edges, faces, opposite;
	bool open, unbalanced, not_crack;
};

typedef bool operation(struct patient *p, size_t t);

static bool same(const double a[3], const double b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool is_marked(const struct patient *p, const double v[3])
{
	for (size_t i = 0; i < p->marks; i++)
		if (same(p->marked[i], v))
			return true;
	return false;
}

static bool touches(const double *t, const double *u)
{
	for (int i = 0; i < 9; i += 3)
		for (int j = 0; j < 9; j += 3)
			if (same(t + i, u + j))
				return true;
	return false;
}

/* Take the triangle ${t} and all that touch it, unless another site has some of their vertices. */
static bool claim(struct patient *p, size_t t)
{
	const struct soup *s = &p->soup;

	for (size_t u = 0; u < s->count; u++)
		if (touches(s->tri[t], s->tri[u]))
			for (int i = 0; i < 9; i += 3)
				if (is_marked(p, s->tri[u] + i))
					return false;
	for (size_t u = 0; u < s->count; u++) {
		if (!touches(s->tri[t], s->tri[u]))
			continue;
		for (int i = 0; i < 9 && p->marks < MOST_MARKED; i += 3)
			if (!is_marked(p, s->tri[u] + i))
				memcpy(p->marked[p->marks++], s->tri[u] + i, sizeof *p->marked);
	}
	return p->marks < MOST_MARKED;
}

static struct item *expect(struct patient *p, enum mp_defect_kind kind, unsigned count,
			   const double *a, const double *b, const double *c, const double *d)
{
	const double *v[4] = {a, b, c, d};
	struct item *i = &p->item[p->items++];

	assert_true(p->items <= MOST_ITEMS);
	memset(i, 0, sizeof *i);
	i->kind = kind;
	i->count = count;
	for (unsigned k = 0; k < count; k++)
		memcpy(i->at[k], v[k], sizeof i->at[k]);
	p->kind[kind]++;
	return i;
}

static void expect_edge(struct patient *p, enum mp_defect_kind kind, const double *a,
			const double *b)
{
	expect(p, kind, 2, a, b, NULL, NULL);
}

static void expect_edges(struct patient *p, enum mp_defect_kind kind, const double t[9])
{
	expect_edge(p, kind, t, t + 3);
	expect_edge(p, kind, t + 3, t + 6);
	expect_edge(p, kind, t + 6, t);
}

static bool drop(struct patient *p, size_t t)
{
	const double *v = p->soup.tri[t];

	expect_edges(p, MP_DEFECT_BOUNDARY_EDGE, v);
	expect(p, MP_DEFECT_BOUNDARY_LOOP, 3, v, v + 3, v + 6, NULL);
	soup_drop(&p->soup, t);
	p->faces--;
	return p->open = p->not_crack = true;
}

static bool flip(struct patient *p, size_t t)
{
	expect_edges(p, MP_DEFECT_MISORIENTED_EDGE, p->soup.tri[t]);
	soup_flip(&p->soup, t);
	return p->unbalanced = true;
}

static bool repeat(struct patient *p, size_t t)
{
	bool opposite = soup_random(&p->state) % 2;
	double v[9];

	memcpy(v, p->soup.tri[t], sizeof v);
	expect_edges(p, MP_DEFECT_NON_MANIFOLD_EDGE, v);
	expect(p, MP_DEFECT_DUPLICATE_TRIANGLE, 3, v, v + 3, v + 6, NULL)->opposite = opposite;
	soup_add(&p->soup, v, v + 3, v + 6);
	if (opposite)
		soup_flip(&p->soup, p->soup.count - 1);
	p->opposite += opposite;
	p->faces++;
	return p->unbalanced = true;
}

/* Its first edge in two, but not its neighbour's: coordinates are on a grid of twice the step. */
static bool split(struct patient *p, size_t t)
{
	double v[9], m[3];
	struct item *i;

	memcpy(v, p->soup.tri[t], sizeof v);
	for (int k = 0; k < 3; k++)
		m[k] = (v[k] + v[k + 3]) / 2;
	soup_drop(&p->soup, t);
	soup_add(&p->soup, v, m, v + 6);
	soup_add(&p->soup, m, v + 3, v + 6);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, v, v + 3);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, v, m);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, m, v + 3);
	i = expect(p, MP_DEFECT_BOUNDARY_LOOP, 3, v, v + 3, m, NULL);
	i->crack = true;
	memcpy(i->junction, m, sizeof m);
	p->vertices++;
	p->edges += 3;
	p->faces++;
	return p->open = true;
}

static bool tear(struct patient *p, size_t t)
{
	double *v = p->soup.tri[t], old[3];

	memcpy(old, v, sizeof old);
	v[2] = nextafter(v[2], 100); /* by an ulp of a double, off the grid */
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, old, v + 3);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, old, v + 6);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, v, v + 3);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, v, v + 6);
	expect(p, MP_DEFECT_BOUNDARY_LOOP, 4, old, v + 3, v, v + 6);
	p->vertices++;
	p->edges += 2;
	return p->open = p->not_crack = true;
}

static void away(struct patient *p, const double from[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = from[k] + 0.125 + 0x1p-30 * (double)(soup_random(&p->state) % 1000 + 1);
}

static bool add_flap(struct patient *p, size_t t)
{
	double v[9], x[3];

	memcpy(v, p->soup.tri[t], sizeof v);
	away(p, v, x);
	soup_add(&p->soup, v, v + 3, x);
	expect_edge(p, MP_DEFECT_NON_MANIFOLD_EDGE, v, v + 3);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, v + 3, x);
	expect_edge(p, MP_DEFECT_BOUNDARY_EDGE, x, v);
	expect(p, MP_DEFECT_BOUNDARY_LOOP, 3, v, v + 3, x, NULL);
	p->vertices++;
	p->edges += 2;
	p->faces++;
	return p->open = p->unbalanced = p->not_crack = true;
}

static bool add_fin(struct patient *p, size_t t)
{
	double v[9], x[3];

	memcpy(v, p->soup.tri[t], sizeof v);
	away(p, v, x);
	soup_add(&p->soup, v, v + 3, x);
	soup_add(&p->soup, v + 3, v, x);
	expect_edge(p, MP_DEFECT_NON_MANIFOLD_EDGE, v, v + 3);
	expect(p, MP_DEFECT_DUPLICATE_TRIANGLE, 3, v, v + 3, x, NULL)->opposite = true;
	p->opposite++;
	p->vertices++;
	p->edges += 2;
	p->faces += 2;
	return true;
}

static bool add_degenerate(struct patient *p, size_t t)
{
	double v[9];

	memcpy(v, p->soup.tri[t], sizeof v);
	soup_add(&p->soup, v, v + 3, v + 3);
	expect_edge(p, MP_DEFECT_DEGENERATE_TRIANGLE, v, v + 3);
	return true;
}

/* Its first vertex becomes that of another site. */
static bool pinch(struct patient *p, size_t t)
{
	double from[3], to[3];
	size_t u = 0;

	memcpy(from, p->soup.tri[t], sizeof from);
	while (u < p->soup.count && !claim(p, u))
		u++;
	if (u == p->soup.count)
		return false;
	memcpy(to, p->soup.tri[u], sizeof to);
	for (size_t i = 0; i < p->soup.count; i++)
		for (int k = 0; k < 9; k += 3)
			if (same(p->soup.tri[i] + k, from))
				memcpy(p->soup.tri[i] + k, to, sizeof to);
	expect(p, MP_DEFECT_NON_MANIFOLD_VERTEX, 1, to, NULL, NULL, NULL);
	p->vertices--;
	return true;
}

static void operate(struct patient *p)
{
	static operation *const can[] = {drop,     flip,    repeat,         split, tear,
					 add_flap, add_fin, add_degenerate, pinch};
	unsigned tries = (unsigned)(soup_random(&p->state) % 9);

	for (unsigned i = 0; i < tries; i++) {
		size_t t = soup_random(&p->state) % p->soup.count;
		size_t which = soup_random(&p->state) % (sizeof can / sizeof *can);

		if (claim(p, t))
			can[which](p, t);
	}
}

/* On the grid, and so far off its place that no four vertices lie in a plane by symmetry. */
static void displace(double v[3])
{
	uint64_t state = 1;

	for (int k = 0; k < 3; k++) {
		v[k] = round(v[k] * 0x1p20);
		state = (state ^ (uint64_t)(int64_t)v[k]) * 0x9e3779b97f4a7c15u + 1;
	}
	for (int k = 0; k < 3; k++)
		v[k] = (v[k] + (double)(soup_random(&state) % 32768)) * 0x1p-20;
}

/* Up to three closed bodies beside each other, every coordinate a multiple of 2^-20. */
static void admit(struct patient *p, uint64_t seed)
{
	unsigned bodies;

	memset(p, 0, sizeof *p);
	p->state = seed * 0x9e3779b97f4a7c15u + 1;
	bodies = 1 + (unsigned)(soup_random(&p->state) % 3);
	for (unsigned b = 0; b < bodies; b++) {
		struct soup body = {0};
		unsigned n = 5 + (unsigned)(soup_random(&p->state) % 8);
		const double shift[3] = {8.0 * b, 0, 0};

		if (soup_random(&p->state) % 4 == 0) {
			soup_tetrahedron(&body, 0, 0, 0, 1);
			p->vertices += 4;
		} else {
			soup_torus(&body, n, n, 2, 0.75);
			p->vertices += n * n;
		}
		for (size_t i = 0; i < 3 * body.count; i++)
			displace(&body.tri[i / 3][i % 3 * 3]);
		p->faces += (int64_t)body.count;
		soup_copy(&p->soup, &body, 1, shift);
		soup_free(&body);
	}
	p->bodies = bodies;
	p->edges = p->faces / 2 * 3;
	soup_shuffle(&p->soup, &p->state);
}

/* ---- What was found ---- */

static void place(const struct found *f, uint32_t v, double out[3])
{
	mp_vertices_get(f->built.vertices, v, out);
}

/* As sets: a degenerate triangle names a vertex twice. */
static bool is_item(const struct found *f, const struct mp_defect_list *l, size_t n,
		    const struct item *i)
{
	unsigned seen = 0;

	for (size_t k = l->vertex_at[n]; k < l->vertex_at[n + 1]; k++) {
		unsigned j = 0;
		double v[3];

		place(f, l->vertices[k], v);
		while (j < i->count && !same(v, i->at[j]))
			j++;
		if (j == i->count)
			return false;
		seen |= 1u << j;
	}
	return seen == (1u << i->count) - 1;
}

static double distance(const double a[3], const double b[3])
{
	return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
		    (a[2] - b[2]) * (a[2] - b[2]));
}

static void check_loop(const struct found *f, size_t n, const struct item *i)
{
	const struct mp_loop *l = &f->t.loop[n];
	double around = 0, v[3];

	assert_int_equal(l->crack, i->crack);
	assert_int_equal(l->vertices, i->count);
	assert_true(l->length_defined);
	if (!l->simple) { /* the flap's */
		assert_int_equal(l->edges, 2);
		assert_false(l->area_defined);
		return;
	}
	assert_int_equal(l->edges, i->count);
	for (unsigned k = 0; k < i->count; k++)
		around += distance(i->at[k], i->at[(k + 1) % i->count]);
	assert_true(fabs(l->length - around) <= 1e-15 * around);
	for (unsigned k = 0; k < i->count; k++)
		for (int c = 0; c < 3; c++)
			assert_true(l->min[c] <= i->at[k][c] && i->at[k][c] <= l->max[c]);
	if (!l->crack)
		return;
	assert_true(l->area_defined && l->area == 0 && l->planar);
	assert_int_equal(l->junctions, 1);
	place(f, f->t.junction[l->junction_at].vertex, v);
	assert_true(same(v, i->junction));
	for (int e = 0; e < 2; e++) {
		place(f, f->t.junction[l->junction_at].ends[e], v);
		assert_true(same(v, i->at[0]) || same(v, i->at[1]));
	}
}

static void check_item(const struct found *f, const struct item *i)
{
	const struct mp_defect_list *l = &f->t.defect[i->kind];
	size_t n = 0;

	while (n < l->count && !is_item(f, l, n, i))
		n++;
	if (n == l->count)
		fail_msg("a defect of kind %d was not found", (int)i->kind);
	if (i->kind == MP_DEFECT_BOUNDARY_LOOP)
		check_loop(f, n, i);
	if (i->kind == MP_DEFECT_DUPLICATE_TRIANGLE) {
		const uint32_t *t = l->triangles + l->triangle_at[n];

		assert_int_equal(mp_same_winding(f->built.tri[t[0]], f->built.tri[t[1]]),
				 !i->opposite);
	}
}

static void check_counts(const struct patient *p, const struct mp_topology *t)
{
	assert_int_equal(t->bodies, p->bodies);
	assert_int_equal(t->vertices, p->vertices);
	assert_int_equal(t->edges, p->edges);
	assert_int_equal(t->faces, p->faces);
	assert_int_equal(t->boundary_edges, p->kind[MP_DEFECT_BOUNDARY_EDGE]);
	assert_int_equal(t->boundary_loops, p->kind[MP_DEFECT_BOUNDARY_LOOP]);
	assert_int_equal(t->non_manifold_edges, p->kind[MP_DEFECT_NON_MANIFOLD_EDGE]);
	assert_int_equal(t->non_manifold_vertices, p->kind[MP_DEFECT_NON_MANIFOLD_VERTEX]);
	assert_int_equal(t->misoriented_edges, p->kind[MP_DEFECT_MISORIENTED_EDGE]);
	assert_int_equal(t->degenerate_triangles, p->kind[MP_DEFECT_DEGENERATE_TRIANGLE]);
	assert_int_equal(t->duplicate_triangles, p->kind[MP_DEFECT_DUPLICATE_TRIANGLE]);
	assert_int_equal(t->opposite_duplicates, p->opposite);
	assert_int_equal(t->closed, !p->open && !p->unbalanced);
	assert_int_equal(t->cracks_only, p->open && !p->unbalanced && !p->not_crack);
	assert_int_equal(t->unbalanced_edges > 0, p->unbalanced);
	assert_int_equal(t->double_walls + t->single_walls, 0);
	assert_false(t->truncated);
}

static void examine(struct patient *p)
{
	struct found f = {.soup = p->soup};

	found_look(&f, 1000);
	check_counts(p, &f.t);
	for (size_t i = 0; i < p->items; i++)
		check_item(&f, &p->item[i]);
	memset(&f.soup, 0, sizeof f.soup); /* the patient's */
	found_free(&f);
}

static void what_was_done_is_found_whatever_the_order(void **unused)
{
	static struct patient p;

	(void)unused;
	for (uint64_t seed = 0; seed < SEEDS; seed++) {
		admit(&p, seed);
		operate(&p);
		for (int order = 0; order < 2; order++) {
			soup_shuffle(&p.soup, &p.state);
			examine(&p);
		}
		soup_free(&p.soup);
	}
}

/* ---- One edge with very many triangles ---- */

static void one_edge_with_200000_triangles(void **unused)
{
	const double a[3] = {0, 0, 0}, b[3] = {0, 0, 1};
	const struct mp_defect_list *l;
	struct found f = {0};
	uint32_t n = 200000;

	(void)unused;
	for (uint32_t i = 0; i < n; i++) {
		const double c[3] = {1 + i % 500, 1 + i / 500, 0.5};

		soup_add(&f.soup, i % 2 ? a : b, i % 2 ? b : a, c);
	}
	found_look(&f, 100);
	assert_int_equal(f.t.non_manifold_edges, 1);
	assert_int_equal(f.t.unbalanced_edges, 0);
	assert_int_equal(f.t.boundary_edges, 2 * n);
	assert_int_equal(f.t.boundary_loops, 1);
	assert_int_equal(f.t.bodies, 1);
	assert_int_equal(f.t.loop[0].edges, 2 * n);
	assert_int_equal(f.t.loop[0].vertices, n + 2);
	assert_false(f.t.loop[0].simple || f.t.loop[0].crack);
	assert_int_equal(f.t.loop[0].junctions, 0);
	l = &f.t.defect[MP_DEFECT_NON_MANIFOLD_EDGE];
	assert_int_equal(l->triangle_at[1], MP_DEFECT_TRIANGLES);
	found_free(&f);
}

static void one_triangle_200000_times(void **unused)
{
	struct found f = {0};
	uint32_t n = 200000;
	double v[9];

	(void)unused;
	soup_tetrahedron(&f.soup, 0, 0, 0, 1);
	memcpy(v, f.soup.tri[0], sizeof v);
	for (uint32_t i = 1; i < n; i++) {
		soup_add(&f.soup, v, v + 3, v + 6);
		if (i % 4 == 0)
			soup_flip(&f.soup, f.soup.count - 1);
	}
	found_look(&f, 100);
	assert_int_equal(f.t.duplicate_triangles, n - 1);
	assert_int_equal(f.t.opposite_duplicates, n / 4 - 1);
	assert_int_equal(f.t.non_manifold_edges, 3);
	assert_int_equal(f.t.defect[MP_DEFECT_DUPLICATE_TRIANGLE].count, 100);
	found_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(what_was_done_is_found_whatever_the_order),
	    cmocka_unit_test(one_edge_with_200000_triangles),
	    cmocka_unit_test(one_triangle_200000_times),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
