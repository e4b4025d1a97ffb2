#include <stdlib.h>

#include "core/geometry/predicates.h"
#include "core/topology/topology_parts.h"

/*
 * Whether the boundary is zero as a geometric current: whether on every line the directed edges
 * that lie on it cancel, wherever they are divided (T-junctions).  Then every integral that the
 * divergence theorem turns into one over the surface is as exact as if the mesh were closed.
 *
 * Different lines have only points in common, so the lines can be judged one by one; and a
 * combination of segments of one line is zero exactly if it has no boundary: if at each vertex as
 * many of its edges begin as end.  So it is enough to sort the edges at each vertex by their line,
 * which takes the signs of 2x2 determinants, and to add up each line: exact, and O(n log n)
 * however many edges meet.
 */
struct chain {
	const struct mp_mesh *mesh;
	const struct mp_edges *edges;
	const uint32_t *body_of;
	uint32_t *row; /* the ends at vertex v: end[row[v] .. row[v + 1]) */
	uint32_t *end; /* the place in edges->use of the first use of the edge */
};

/* Uses from the smaller vertex less uses from the larger. */
static int64_t excess(const struct mp_edges *e, size_t first)
{
	int64_t sum = 0;

	for (size_t i = first, end = mp_edges_end(e, first); i < end; i++)
		sum += (e->use[i] & MP_USE_BACK) ? -1 : 1;
	return sum;
}

static uint32_t end_vertex(const struct chain *c, size_t first, bool larger)
{
	return mp_corner_vertex(c->mesh, mp_use_corner(c->edges->use[first], larger));
}

static uint32_t other_end(const struct chain *c, uint32_t first, uint32_t v)
{
	uint32_t small = end_vertex(c, first, false);

	return small == v ? end_vertex(c, first, true) : small;
}

static uint32_t body(const struct chain *c, uint32_t first)
{
	return c->body_of[mp_use_triangle(c->edges->use[first])];
}

/* The first axis along which ${p} differs from ${m}, and to which side. */
static unsigned leading_axis(const double m[3], const double p[3], int *side)
{
	unsigned k = 0;

	while (k < 2 && p[k] == m[k])
		k++;
	*side = p[k] > m[k] ? 1 : -1;
	return k;
}

/* By the leading axis of the direction, then by its slopes against that axis. */
int mp_compare_lines(const double m[3], const double p[3], const double q[3])
{
	int s, t;
	unsigned a = leading_axis(m, p, &s), b = leading_axis(m, q, &t);

	if (a != b)
		return a < b ? -1 : 1;
	for (unsigned k = a + 1; k < 3; k++) {
		double m2[2] = {m[a], m[k]}, p2[2] = {p[a], p[k]}, q2[2] = {q[a], q[k]};
		int turn = mp_orient2d(m2, p2, q2) * s * t;

		if (turn != 0)
			return -turn;
	}
	return 0;
}

static int compare(const struct chain *c, uint32_t v, uint32_t x, uint32_t y, bool lines_only)
{
	double m[3], p[3], q[3];
	int order;

	mp_vertices_get(c->mesh->vertices, v, m);
	mp_vertices_get(c->mesh->vertices, other_end(c, x, v), p);
	mp_vertices_get(c->mesh->vertices, other_end(c, y, v), q);
	order = mp_compare_lines(m, p, q);
	if (order != 0 || lines_only)
		return order;
	return (body(c, x) > body(c, y)) - (body(c, x) < body(c, y));
}

static void sift(const struct chain *c, uint32_t v, uint32_t *a, size_t i, size_t n)
{
	uint32_t x = a[i];

	for (size_t child = 2 * i + 1; child < n; child = 2 * i + 1) {
		if (child + 1 < n && compare(c, v, a[child], a[child + 1], false) < 0)
			child++;
		if (compare(c, v, x, a[child], false) >= 0)
			break;
		a[i] = a[child];
		i = child;
	}
	a[i] = x;
}

/* Heapsort: in place, and no order of the edges makes it slow. */
static void sort_ends(const struct chain *c, uint32_t v, uint32_t *a, size_t n)
{
	for (size_t i = n / 2; i-- > 0;)
		sift(c, v, a, i, n);
	for (size_t last = n; last-- > 1;) {
		uint32_t top = a[0];

		a[0] = a[last];
		a[last] = top;
		sift(c, v, a, 0, last);
	}
}

/* The sums at vertex ${v}, for each line and for each body on each line. */
static void judge(const struct chain *c, uint32_t v, uint64_t *gap, struct mp_topology *out)
{
	uint32_t *a = c->end + c->row[v];
	size_t n = c->row[v + 1] - c->row[v];
	int64_t line = 0, part = 0;

	if (n > 1)
		sort_ends(c, v, a, n);
	for (size_t i = 0; i < n; i++) {
		bool smaller = end_vertex(c, a[i], false) == v;
		int64_t leaving = smaller ? excess(c->edges, a[i]) : -excess(c->edges, a[i]);
		bool same_line = i + 1 < n && compare(c, v, a[i], a[i + 1], true) == 0;

		line += leaving;
		part += leaving;
		if (same_line && body(c, a[i]) == body(c, a[i + 1]))
			continue;
		if (part != 0)
			out->body[body(c, a[i])].cracks_only = false;
		part = 0;
		if (same_line)
			continue;
		if (line != 0) {
			out->cracks_only = false;
			gap[v / 64] |= (uint64_t)1 << (v % 64);
		}
		line = 0;
	}
}

/* Rows of ends under their vertices; row[] as in edges.c. */
static int build(struct chain *c)
{
	const struct mp_edges *e = c->edges;
	uint32_t vertices = mp_vertices_count(c->mesh->vertices), sum = 0;

	c->row = calloc((size_t)vertices + 1, sizeof *c->row);
	if (c->row == NULL)
		return -1;
	for (size_t i = 0; i < e->count; i = mp_edges_end(e, i)) {
		if (excess(e, i) == 0)
			continue;
		c->row[end_vertex(c, i, false) + 1]++;
		c->row[end_vertex(c, i, true) + 1]++;
	}
	for (uint32_t v = 0; v < vertices; v++) {
		uint32_t n = c->row[v + 1];

		c->row[v + 1] = sum;
		sum += n;
	}
	c->end = malloc(((size_t)sum + 1) * sizeof *c->end);
	if (c->end == NULL)
		return -1;
	for (size_t i = 0; i < e->count; i = mp_edges_end(e, i)) {
		if (excess(e, i) == 0)
			continue;
		c->end[c->row[end_vertex(c, i, false) + 1]++] = (uint32_t)i;
		c->end[c->row[end_vertex(c, i, true) + 1]++] = (uint32_t)i;
	}
	return 0;
}

int mp_cracks_find(const struct mp_mesh *mesh, const struct mp_edges *edges, uint64_t *gap,
		   struct mp_topology *out)
{
	struct chain c = {.mesh = mesh, .edges = edges, .body_of = out->body_of};
	int failed = build(&c);

	out->cracks_only = edges->count > 0 && !out->closed;
	for (uint32_t b = 0; b < out->bodies; b++)
		out->body[b].cracks_only = !out->body[b].closed;
	for (uint32_t v = 0; !failed && v < mp_vertices_count(mesh->vertices); v++)
		judge(&c, v, gap, out);
	free(c.end);
	free(c.row);
	return failed;
}
