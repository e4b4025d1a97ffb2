#include <stdlib.h>
#include <string.h>

#include "core/sort.h"
#include "core/topology/disjoint.h"
#include "core/topology/topology_parts.h"

/*
 * The short way of a good mesh.  Every corner of a vertex links a neighbour (where its triangle
 * leaves the vertex) to another (where it comes back).  If at every vertex these links form one
 * ring that meets no neighbour twice, then every edge is used once in each direction, every vertex
 * has one fan, and there is no boundary.  Two triangles with the same corners would then be each
 * other's only neighbours, a ring of two links: where no ring is that short there are none.  And
 * triangles that share a vertex hang together through edges, so bodies are sets of vertices.
 */
struct ring {
	const struct mp_mesh *mesh;
	uint32_t vertices;
	uint32_t *row;   /* vertex v has the links row[v] .. row[v + 1] */
	uint64_t *link;  /* the vertex it leaves for << 32 | the one from which it comes back */
	uint32_t *label; /* of a vertex: first its smallest neighbour or itself, then its set */
	uint64_t *sorted;
	size_t room;          /* of sorted */
	uint64_t faces, used; /* triangles with edges, vertices that they use */
};

enum {
	FEW = 8, /* links that are compared each with each, side by side: nearly all vertices */
	SOME = 2 * FEW,
	AHEAD = 24 /* what to prefetch for: about the latency of memory */
};

static void prefetch_rows(const struct ring *r, uint32_t t)
{
	if (t + AHEAD >= r->mesh->triangles)
		return;
	for (unsigned k = 0; k < 3; k++)
		__builtin_prefetch(&r->row[r->mesh->tri[t + AHEAD][k] + 1], 1);
}

/* row[v + 1] = where row v begins, so that scattering moves it to where row v + 1 begins. */
static void count_links(struct ring *r)
{
	uint32_t sum = 0;

	for (uint32_t t = 0; t < r->mesh->triangles; t++) {
		const uint32_t *v = r->mesh->tri[t];

		prefetch_rows(r, t);
		if (!mp_has_edges(v))
			continue;
		r->faces++;
		for (unsigned k = 0; k < 3; k++)
			r->row[v[k] + 1]++;
	}
	for (uint32_t v = 0; v < r->vertices; v++) {
		uint32_t n = r->row[v + 1];

		r->used += n > 0;
		r->row[v + 1] = sum;
		sum += n;
	}
}

static void scatter(struct ring *r)
{
	for (uint32_t t = 0; t < r->mesh->triangles; t++) {
		const uint32_t *v = r->mesh->tri[t];

		prefetch_rows(r, t);
		if (t + AHEAD / 2 < r->mesh->triangles)
			for (unsigned k = 0; k < 3; k++)
				__builtin_prefetch(
				    &r->link[r->row[r->mesh->tri[t + AHEAD / 2][k] + 1]], 1);
		if (!mp_has_edges(v))
			continue;
		r->link[r->row[v[0] + 1]++] = (uint64_t)v[1] << 32 | v[2];
		r->link[r->row[v[1] + 1]++] = (uint64_t)v[2] << 32 | v[0];
		r->link[r->row[v[2] + 1]++] = (uint64_t)v[0] << 32 | v[1];
	}
}

/*
 * Whether the ${n} <= ${lanes} links are one ring: steps from each to one that leaves for where it
 * comes back from are home after n of them and no sooner.  So they meet every link, and no two
 * leave for the same vertex, or the second of these would be met never.
 */
static inline __attribute__((always_inline)) bool is_short_ring(const uint64_t *link, unsigned n,
								unsigned lanes)
{
	uint32_t leaves[SOME], next[SOME + 1], at = 0, home = 0;

	for (unsigned i = 0; i < lanes; i++)
		leaves[i] = i < n ? (uint32_t)(link[i] >> 32) : UINT32_MAX; /* no vertex */
	for (unsigned i = 0; i < n; i++) {
		uint32_t comes = (uint32_t)link[i], mask = (uint32_t)1 << SOME;

		for (unsigned j = 0; j < lanes; j++)
			mask |= (leaves[j] == comes ? 1u : 0u) << j;
		next[i] = (uint32_t)__builtin_ctz(mask);
	}
	next[SOME] = SOME; /* a dead end */
	for (unsigned i = 1; i < n; i++) {
		at = next[at];
		home |= at == 0;
	}
	return home == 0 && next[at] == 0;
}

/* The link of ${n} that leaves for ${v}, by their order; ${n} where there is none. */
static size_t find_link(const uint64_t *sorted, size_t n, uint32_t v)
{
	size_t low = 0, high = n;

	while (low < high) {
		size_t mid = low + (high - low) / 2;

		if (sorted[mid] >> 32 < v)
			low = mid + 1;
		else
			high = mid;
	}
	return low < n && sorted[low] >> 32 == v ? low : n;
}

/* The same for any number: 1, 0, or -1 where memory is out. */
static int is_ring(struct ring *r, const uint64_t *link, size_t n)
{
	size_t at = 0;

	if (n > r->room) {
		uint64_t *sorted = realloc(r->sorted, 2 * n * sizeof *sorted);

		if (sorted == NULL)
			return -1;
		r->sorted = sorted;
		r->room = 2 * n;
	}
	memcpy(r->sorted, link, n * sizeof *link);
	mp_sort_u64(r->sorted, n);
	for (size_t i = 0; i < n; i++) {
		at = find_link(r->sorted, n, (uint32_t)r->sorted[at]);
		if (at == n || (at == 0) != (i == n - 1))
			return 0;
	}
	return 1;
}

static uint32_t smallest_neighbour(const uint64_t *link, size_t n, uint32_t v)
{
	for (size_t i = 0; i < n; i++)
		v = (uint32_t)(link[i] >> 32) < v ? (uint32_t)(link[i] >> 32) : v;
	return v;
}

/* Look at all vertices: 1 if every one has its ring, else 0, or -1 where memory is out. */
static int look(struct ring *r)
{
	for (uint32_t v = 0; v < r->vertices; v++) {
		const uint64_t *link = r->link + r->row[v];
		size_t n = r->row[v + 1] - r->row[v];
		int good = 1;

		if (n <= FEW)
			good = n == 0 || (n > 2 && is_short_ring(link, (unsigned)n, FEW));
		else if (n <= SOME)
			good = is_short_ring(link, (unsigned)n, SOME);
		else
			good = is_ring(r, link, n);
		if (good != 1)
			return good;
		r->label[v] = smallest_neighbour(link, n, v);
	}
	return 1;
}

/*
 * Labels become roots.  The smallest neighbours alone leave few sets, in a mesh whose triangles
 * come side by side just one; the other links join these.  Returns how many bodies there are.
 */
static uint32_t connect(struct ring *r)
{
	uint32_t sets = 0;

	for (uint32_t v = 0; v < r->vertices; v++) {
		if (v + AHEAD < r->vertices)
			__builtin_prefetch(&r->label[r->label[v + AHEAD]]);
		sets += r->label[v] == v && r->row[v] != r->row[v + 1];
		r->label[v] = r->label[r->label[v]]; /* smaller, so it is a root already */
	}
	for (uint32_t v = 0; v < r->vertices && sets > 1; v++) {
		for (uint32_t i = r->row[v]; i < r->row[v + 1]; i++) {
			uint32_t to = (uint32_t)(r->link[i] >> 32);

			if (i + AHEAD < 3 * r->faces)
				__builtin_prefetch(&r->label[r->link[i + AHEAD] >> 32]);
			if (to > v && r->label[to] != r->label[v])
				sets -= mp_set_unite(r->label, v, to);
		}
	}
	return sets;
}

/* Bodies by their smallest triangle; ${number}: of each root, UINT32_MAX before. */
static void assign(struct ring *r, uint32_t *number, struct mp_topology *out)
{
	uint32_t bodies = 0;

	for (uint32_t t = 0; t < r->mesh->triangles; t++) {
		const uint32_t *v = r->mesh->tri[t];
		uint32_t root;

		out->body_of[t] = MP_NO_BODY;
		if (!mp_has_edges(v))
			continue;
		root = mp_set_find(r->label, v[0]);
		if (number[root] == UINT32_MAX) {
			number[root] = bodies;
			out->body[bodies++].first = t;
		}
		out->body_of[t] = number[root];
		out->body[number[root]].triangles++;
	}
	for (uint32_t v = 0; v < r->vertices; v++)
		if (r->row[v] != r->row[v + 1])
			out->body[number[mp_set_find(r->label, v)]].fans++;
}

static int number_bodies(struct ring *r, struct mp_topology *out)
{
	uint32_t *number;

	out->body = calloc((size_t)out->bodies + 1, sizeof *out->body);
	out->body_of = calloc((size_t)r->mesh->triangles + 1, sizeof *out->body_of);
	if (out->body == NULL || out->body_of == NULL)
		return -1;
	for (uint32_t i = 0; i < out->bodies; i++)
		out->body[i].closed = out->body[i].watertight = true;
	if (out->bodies == 1 && r->faces == r->mesh->triangles) {
		out->body[0].triangles = r->mesh->triangles; /* all in body 0 */
		out->body[0].fans = r->used;
		return 0;
	}
	number = malloc(((size_t)r->vertices + 1) * sizeof *number);
	if (number == NULL)
		return -1;
	memset(number, 0xff, ((size_t)r->vertices + 1) * sizeof *number);
	assign(r, number, out);
	free(number);
	return 0;
}

static int fill(struct ring *r, struct mp_topology *out)
{
	static const enum mp_defect_kind none[] = {
	    MP_DEFECT_BOUNDARY_EDGE,     MP_DEFECT_BOUNDARY_LOOP,
	    MP_DEFECT_NON_MANIFOLD_EDGE, MP_DEFECT_NON_MANIFOLD_VERTEX,
	    MP_DEFECT_MISORIENTED_EDGE,  MP_DEFECT_DUPLICATE_TRIANGLE};

	out->bodies = connect(r);
	out->vertices = r->used;
	out->faces = r->faces;
	out->edges = 3 * r->faces / 2;
	out->closed = out->watertight = out->winding_consistent = true;
	for (size_t i = 0; i < sizeof none / sizeof *none; i++)
		if (mp_defects_begin(&out->defect[none[i]], 0, 0, 0))
			return -1;
	return number_bodies(r, out);
}

int mp_manifold_find(const struct mp_mesh *mesh, struct mp_topology *out, bool *good)
{
	struct ring r = {.mesh = mesh, .vertices = mp_vertices_count(mesh->vertices)};
	int found = -1;

	*good = false;
	r.row = calloc((size_t)r.vertices + 1, sizeof *r.row);
	if (r.row == NULL)
		return -1;
	count_links(&r);
	if (r.faces == 0 || r.faces % 2 != 0) {
		free(r.row);
		return 0;
	}
	r.link = malloc(3 * r.faces * sizeof *r.link);
	r.label = malloc(r.vertices * sizeof *r.label);
	if (r.link != NULL && r.label != NULL) {
		scatter(&r);
		found = look(&r);
	}
	if (found == 1 && fill(&r, out))
		found = -1;
	free(r.row);
	free(r.link);
	free(r.label);
	free(r.sorted);
	*good = found == 1;
	return found < 0 ? -1 : 0;
}
