#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/sort.h"
#include "core/topology/disjoint.h"
#include "core/topology/ring.h"
#include "core/topology/topology_parts.h"

/*
 * The short way of a good mesh.  Every corner of a vertex links a neighbour (where its triangle
 * leaves the vertex) to another (where it comes back).  If at every vertex these links form one
 * ring that meets no neighbour twice, then every edge is used once in each direction, every vertex
 * has one fan, and there is no boundary.  Two triangles with the same corners would then be each
 * other's only neighbours, a ring of two links: where no ring is that short there are none.  And
 * triangles that share a vertex hang together through edges, so bodies are sets of vertices.
 */
struct span {
	uint32_t min, max; /* of vertex numbers */
};

struct ring {
	const struct mp_mesh *mesh;
	uint32_t vertices;
	uint32_t *row;  /* vertex v has the links row[v] .. row[v + 1] */
	uint64_t *link; /* the vertex it leaves for << 32 | the one from which it comes back */
	size_t most;    /* links that are kept at a time: those of vertices low .. high - 1 */
	uint32_t low, high;
	struct span *span; /* of every BLOCK triangles */
	uint32_t *label;   /* of a vertex: first its smallest neighbour or itself, then its set */
	uint64_t *sorted;
	size_t room;          /* of sorted */
	uint64_t faces, used; /* triangles with edges, vertices that they use */
};

enum {
	AHEAD = 24, /* what to prefetch for: about the latency of memory */
	BLOCK = 1024
};

static uint32_t end_of_block(const struct ring *r, uint32_t t)
{
	return r->mesh->triangles - t < BLOCK ? r->mesh->triangles : t + BLOCK;
}

static void count_block(struct ring *r, uint32_t begin, uint32_t end)
{
	struct span s = {UINT32_MAX, 0};

	for (uint32_t t = begin; t < end; t++) {
		const uint32_t *v = r->mesh->tri[t];

		for (unsigned k = 0; k < 3 && t + AHEAD < r->mesh->triangles; k++)
			__builtin_prefetch(&r->row[r->mesh->tri[t + AHEAD][k] + 1], 1);
		if (!mp_has_edges(v))
			continue;
		r->faces++;
		for (unsigned k = 0; k < 3; k++) {
			r->row[v[k] + 1]++;
			s.min = v[k] < s.min ? v[k] : s.min;
			s.max = v[k] > s.max ? v[k] : s.max;
		}
	}
	r->span[begin / BLOCK] = s;
}

/*
 * row[v + 1] = where row v begins, so that scattering moves it to where row v + 1 begins.  Returns
 * the length of the longest row.
 */
static size_t count_links(struct ring *r)
{
	uint32_t sum = 0, longest = 0;

	for (uint32_t t = 0; t < r->mesh->triangles; t = end_of_block(r, t))
		count_block(r, t, end_of_block(r, t));
	for (uint32_t v = 0; v < r->vertices; v++) {
		uint32_t n = r->row[v + 1];

		r->used += n > 0;
		longest = n > longest ? n : longest;
		r->row[v + 1] = sum;
		sum += n;
	}
	return longest;
}

/* Where row v begins, of which nothing is scattered yet. */
static size_t begin_of(const struct ring *r, uint32_t v)
{
	return v < r->vertices ? r->row[v + 1] : 3 * r->faces;
}

/* The next vertices whose links there is room for; false where all have had their turn. */
static bool next_range(struct ring *r)
{
	r->low = r->high;
	while (r->high < r->vertices && begin_of(r, r->high + 1) - r->row[r->low] <= r->most)
		r->high++;
	return r->low < r->high;
}

static uint64_t link_of(const uint32_t v[3], uint32_t k)
{
	return (uint64_t)v[k == 2 ? 0 : k + 1] << 32 | v[k == 0 ? 2 : k - 1];
}

/* Without a branch for each corner: which of them are in the range is anybody's guess. */
static void scatter_block(struct ring *r, uint32_t begin, uint32_t end)
{
	uint32_t low = r->low, count = r->high - r->low, base = r->row[low];
	const uint32_t(*tri)[3] = r->mesh->tri + begin;
	uint16_t corner[3 * BLOCK + 1];
	uint32_t n = 0;

	for (uint32_t t = 0; t < end - begin; t++) {
		bool used = mp_has_edges(tri[t]);

		for (uint32_t k = 0; k < 3; k++) {
			corner[n] = (uint16_t)(4 * t + k);
			n += used & (tri[t][k] - low < count);
		}
	}
	for (uint32_t i = 0; i < n; i++) {
		const uint32_t *v = tri[corner[i] / 4];
		uint32_t k = corner[i] % 4;

		if (i + 2 * AHEAD < n)
			__builtin_prefetch(
			    &r->row[tri[corner[i + 2 * AHEAD] / 4][corner[i + 2 * AHEAD] % 4] + 1],
			    1);
		if (i + AHEAD < n) {
			uint32_t next = tri[corner[i + AHEAD] / 4][corner[i + AHEAD] % 4];

			__builtin_prefetch(&r->link[r->row[next + 1] - base], 1);
		}
		r->link[r->row[v[k] + 1]++ - base] = link_of(v, k);
	}
}

/* The same where all corners are in the range. */
static void scatter_whole(struct ring *r, uint32_t begin, uint32_t end)
{
	uint32_t base = r->row[r->low];

	for (uint32_t t = begin; t < end; t++) {
		const uint32_t *v = r->mesh->tri[t];

		for (unsigned k = 0; k < 3 && t + AHEAD < end; k++)
			__builtin_prefetch(&r->row[r->mesh->tri[t + AHEAD][k] + 1], 1);
		for (unsigned k = 0; k < 3 && t + AHEAD / 2 < end; k++) {
			uint32_t at = r->row[r->mesh->tri[t + AHEAD / 2][k] + 1] - base;

			__builtin_prefetch(&r->link[at < r->most ? at : 0], 1);
		}
		for (uint32_t k = 0; k < 3 && mp_has_edges(v); k++)
			r->link[r->row[v[k] + 1]++ - base] = link_of(v, k);
	}
}

static void scatter(struct ring *r)
{
	for (uint32_t t = 0; t < r->mesh->triangles; t = end_of_block(r, t)) {
		const struct span *s = &r->span[t / BLOCK];

		if (s->min >= r->low && s->max < r->high)
			scatter_whole(r, t, end_of_block(r, t));
		else if (s->min < r->high && s->max >= r->low)
			scatter_block(r, t, end_of_block(r, t));
	}
}

/* mp_is_short_ring() for any number: 1, 0, or -1 where memory is out. */
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
		at = mp_find_link(r->sorted, n, (uint32_t)r->sorted[at]);
		if (at == n || (at == 0) != (i == n - 1))
			return 0;
	}
	return 1;
}

/* Look at some of the vertices whose links are there: 1 if each has its ring, else 0 or -1. */
static int look_at_some(struct ring *r, uint32_t begin, uint32_t end)
{
	size_t base = r->row[r->low];

	for (uint32_t v = begin; v < end; v++) {
		const uint64_t *link = r->link + (r->row[v] - base);
		size_t n = r->row[v + 1] - r->row[v];
		int good = 1;

		if (n <= MP_FEW)
			good = n == 0 || (n > 2 && mp_is_short_ring(link, (unsigned)n, MP_FEW));
		else if (n <= MP_SOME)
			good = mp_is_short_ring(link, (unsigned)n, MP_SOME);
		else
			good = is_ring(r, link, n);
		if (good != 1)
			return good; /* NOLINT(clang-analyzer-unix.Malloc): r owns it */
		r->label[v] = mp_smallest_neighbour(link, n, v);
	}
	return 1;
}

static int look_at_range(struct ring *r)
{
	const struct mp_links_sink *watcher = r->mesh->watcher;
	int good = 1;

	for (uint32_t v = r->low, end; v < r->high && good == 1; v = end) {
		const uint64_t *link = r->link + (r->row[v] - r->row[r->low]);

		end = r->high - v < BLOCK ? r->high : v + BLOCK;
		good = look_at_some(r, v, end);
		if (good == 1 && watcher != NULL)
			watcher->take(watcher->self,
				      &(struct mp_links){v, end - v, r->row + v, link});
	}
	return good;
}

/* Look at all vertices: 1 if every one has its ring, else 0, or -1 where memory is out. */
static int look(struct ring *r)
{
	int good = 1;

	while (good == 1 && next_range(r)) {
		scatter(r);
		good = look_at_range(r);
	}
	return good;
}

/*
 * Labels become roots.  The smallest neighbours alone leave few sets, in a mesh whose triangles
 * come side by side just one; the triangles join these.  Returns how many bodies there are.
 */
static uint32_t connect(struct ring *r)
{
	const struct mp_mesh *mesh = r->mesh;
	uint32_t sets = 0;

	for (uint32_t v = 0; v < r->vertices; v++) {
		if (v + AHEAD < r->vertices)
			__builtin_prefetch(&r->label[r->label[v + AHEAD]]);
		sets += r->label[v] == v && r->row[v] != r->row[v + 1];
		r->label[v] = r->label[r->label[v]]; /* smaller, so it is a root already */
	}
	for (uint32_t t = 0; t < mesh->triangles && sets > 1; t++) {
		const uint32_t *v = mesh->tri[t];

		for (unsigned k = 0; k < 3 && t + AHEAD < mesh->triangles; k++)
			__builtin_prefetch(&r->label[mesh->tri[t + AHEAD][k]]);
		if (!mp_has_edges(v))
			continue;
		if (r->label[v[0]] != r->label[v[1]])
			sets -= mp_set_unite(r->label, v[0], v[1]);
		if (r->label[v[1]] != r->label[v[2]])
			sets -= mp_set_unite(r->label, v[1], v[2]);
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

/* 1 if the mesh is good, and then ${out} is filled, 0 if not, -1 where memory is out. */
static int find(struct ring *r, struct mp_topology *out)
{
	size_t longest, size;
	int good;

	size = ((size_t)r->vertices + 1) * sizeof *r->row;
	r->row = mp_huge(calloc((size_t)r->vertices + 1, sizeof *r->row), size);
	r->span = malloc(((size_t)r->mesh->triangles / BLOCK + 1) * sizeof *r->span);
	if (r->row == NULL || r->span == NULL)
		return -1;
	longest = count_links(r);
	if (r->faces == 0 || r->faces % 2 != 0)
		return 0;
	if (r->most < longest)
		r->most = longest;
	if (r->most > 3 * r->faces)
		r->most = 3 * r->faces;
	r->link = mp_huge(malloc(r->most * sizeof *r->link), r->most * sizeof *r->link);
	r->label = mp_huge(calloc(r->vertices, sizeof *r->label), r->vertices * sizeof *r->label);
	if (r->link == NULL || r->label == NULL)
		return -1;
	good = look(r);
	if (good != 1)
		return good;
	return fill(r, out) ? -1 : 1;
}

int mp_manifold_find(const struct mp_mesh *mesh, size_t links, struct mp_topology *out, bool *good)
{
	struct ring r = {
	    .mesh = mesh, .vertices = mp_vertices_count(mesh->vertices), .most = links};
	int found = find(&r, out);

	free(r.row);
	free(r.span);
	free(r.link);
	free(r.label);
	free(r.sorted);
	*good = found == 1;
	return found < 0 ? -1 : 0;
}
