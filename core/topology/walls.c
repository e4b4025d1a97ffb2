#include <stdlib.h>
#include <string.h>

#include "core/topology/disjoint.h"
#include "core/topology/topology_parts.h"

/*
 * Double walls are found by what coincides, single ones by the edges at which they hang.  Both take
 * a pass or two over the edges and disjoint sets; neither looks at coordinates, so whether a wall
 * stands inside of the material or spans an opening outside of it is not decided.
 */
enum { FREE = 1, ATTACHED = 2, OPEN = 4 };

struct walls {
	const struct mp_mesh *mesh;
	const struct mp_edges *edges;
	const uint64_t *spare;
	uint32_t *parent; /* of triangles, later of vertices */
	uint8_t *flag;    /* of the sets' roots */
};

static int begin(struct walls *w)
{
	size_t n = w->mesh->triangles, vertices = mp_vertices_count(w->mesh->vertices);

	w->parent = malloc(((n > vertices ? n : vertices) + 1) * sizeof *w->parent);
	w->flag = calloc(n + 1, 1);
	if (w->parent == NULL || w->flag == NULL)
		return -1;
	for (uint32_t t = 0; t < n; t++)
		w->parent[t] = t;
	return 0;
}

static void end(struct walls *w)
{
	free(w->flag);
	free(w->parent);
}

static bool is_in(const uint64_t *bit, uint32_t use)
{
	uint32_t t = mp_use_triangle(use);

	return bit != NULL && (bit[t / 64] >> (t % 64) & 1);
}

/* Join the paired triangles at the edge whose uses begin at ${i}; returns how many there are. */
static size_t join_paired(struct walls *w, const uint64_t *paired, size_t i, size_t last,
			  uint32_t *one)
{
	size_t count = 0;

	for (; i < last; i++) {
		uint32_t t = mp_use_triangle(w->edges->use[i]);

		if (!is_in(paired, w->edges->use[i]))
			continue;
		if (count++ > 0)
			mp_set_unite(w->parent, *one, t);
		*one = t;
	}
	return count;
}

static uint64_t count_double(struct walls *w, const uint64_t *paired)
{
	const struct mp_edges *e = w->edges;
	uint64_t walls = 0;

	for (size_t i = 0, last; i < e->count; i = last) {
		uint32_t one = 0;
		size_t count;

		last = mp_edges_end(e, i);
		count = join_paired(w, paired, i, last, &one);
		if (count == 0) /* then there is no ${one} */
			continue;
		if (last - i == count + 1 || (count == 2 && last - i == 2))
			w->flag[one] |= FREE;
		if (last - i > count)
			w->flag[one] |= ATTACHED;
	}
	for (uint32_t t = 0; t < w->mesh->triangles; t++)
		w->flag[mp_set_find(w->parent, t)] |= w->flag[t];
	for (uint32_t t = 0; t < w->mesh->triangles; t++)
		walls += w->parent[t] == t && (w->flag[t] & (FREE | ATTACHED)) == ATTACHED;
	return walls;
}

/* How often the edge is used by triangles that are not spare; ${two}: the first and the last. */
static size_t count_uses(const struct walls *w, size_t i, size_t last, uint32_t two[2])
{
	size_t n = 0;

	for (; i < last; i++)
		if (!is_in(w->spare, w->edges->use[i]))
			two[n++ > 0] = mp_use_triangle(w->edges->use[i]);
	return n;
}

/* Sheets: triangles joined across edges used twice; OPEN where one has a boundary edge. */
static void find_sheets(struct walls *w)
{
	const struct mp_edges *e = w->edges;

	for (size_t i = 0, last; i < e->count; i = last) {
		uint32_t two[2];
		size_t uses;

		last = mp_edges_end(e, i);
		uses = count_uses(w, i, last, two);
		if (uses == 2)
			mp_set_unite(w->parent, two[0], two[1]);
		else if (uses == 1)
			w->flag[two[0]] |= OPEN;
	}
	for (uint32_t t = 0; t < w->mesh->triangles; t++)
		w->flag[mp_set_find(w->parent, t)] |= w->flag[t];
	for (uint32_t t = 0; t < w->mesh->triangles; t++)
		w->flag[t] = w->flag[mp_set_find(w->parent, t)];
}

static bool all_sheets_closed(const struct walls *w, size_t i, size_t last)
{
	for (; i < last; i++)
		if (!is_in(w->spare, w->edges->use[i]) &&
		    (w->flag[mp_use_triangle(w->edges->use[i])] & OPEN))
			return false;
	return true;
}

static uint32_t enter(uint32_t *parent, uint32_t v)
{
	if (parent[v] != UINT32_MAX)
		return 0;
	parent[v] = v;
	return 1;
}

/* The rims at which single walls hang: their edges' components, vertices less merges. */
static uint64_t count_single(struct walls *w)
{
	const struct mp_edges *e = w->edges;
	uint64_t rims = 0;

	find_sheets(w);
	memset(w->parent, 0xff, mp_vertices_count(w->mesh->vertices) * sizeof *w->parent);
	for (size_t i = 0, last; i < e->count; i = last) {
		uint32_t u, v, two[2];
		size_t uses;

		last = mp_edges_end(e, i);
		uses = last - i < 3 ? 0 : count_uses(w, i, last, two);
		if (uses < 3 || uses % 2 == 0 || !all_sheets_closed(w, i, last))
			continue;
		u = mp_corner_vertex(w->mesh, mp_use_corner(e->use[i], false));
		v = mp_corner_vertex(w->mesh, mp_use_corner(e->use[i], true));
		rims += enter(w->parent, u);
		rims += enter(w->parent, v);
		rims -= mp_set_unite(w->parent, u, v);
	}
	return rims;
}

int mp_walls_find(const struct mp_mesh *mesh, const struct mp_edges *edges,
		  const struct mp_repeats *repeats, struct mp_topology *out)
{
	struct walls w = {.mesh = mesh, .edges = edges, .spare = repeats->spare};
	int failed = 0;

	if (out->opposite_duplicates > 0) {
		failed = begin(&w);
		if (!failed)
			out->double_walls = count_double(&w, repeats->paired);
		end(&w);
	}
	/* an edge used an odd number of times and more than once is not balanced */
	if (!failed && out->non_manifold_edges > 0 && out->unbalanced_edges > 0) {
		failed = begin(&w);
		if (!failed)
			out->single_walls = count_single(&w);
		end(&w);
	}
	return failed;
}
