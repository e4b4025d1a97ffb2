#include <stdlib.h>

#include "core/topology/disjoint.h"
#include "core/topology/topology_parts.h"

size_t mp_bit_next(const uint64_t *bit, size_t n, size_t from)
{
	for (size_t w = from / 64; from < n; from = ++w * 64) {
		uint64_t rest = bit[w] >> (from % 64);

		if (rest != 0)
			return from + (size_t)__builtin_ctzll(rest);
	}
	return n;
}

/* Which half-edges are the only use of their edge: in this form they come in file order. */
static uint64_t *boundary_bits(const struct mp_mesh *mesh, const struct mp_edges *e)
{
	uint64_t *bit = calloc(3 * (size_t)mesh->triangles / 64 + 1, sizeof *bit);

	for (size_t i = 0; bit != NULL && i < e->count; i++) {
		if (e->use[i] & e->use[i + 1] & MP_USE_FIRST) {
			uint32_t half = mp_use_half(e->use[i]);

			bit[half / 64] |= (uint64_t)1 << (half % 64);
		}
	}
	return bit;
}

static int list_edges(const struct mp_mesh *mesh, const uint64_t *bit, size_t items,
		      struct mp_defect_list *l)
{
	size_t n = 3 * (size_t)mesh->triangles;

	if (mp_defects_begin(l, items, items, 2 * items))
		return -1;
	for (size_t h = mp_bit_next(bit, n, 0); l->count < items; h = mp_bit_next(bit, n, h + 1)) {
		uint32_t half = (uint32_t)h, t = half / 3;
		uint32_t ends[2] = {mp_corner_vertex(mesh, half),
				    mp_corner_vertex(mesh, mp_half_next(half))};

		mp_defects_add(l, &t, 1, ends, 2);
	}
	return 0;
}

/* A vertex enters its own set when it is met: returns 1 for the first time. */
static unsigned enter(uint32_t *parent, uint32_t v)
{
	if (parent[v] != UINT32_MAX)
		return 0;
	parent[v] = v;
	return 1;
}

/* Connected components: vertices less merges. */
uint64_t mp_loops_join(const struct mp_mesh *mesh, const uint64_t *bit, uint32_t *parent)
{
	size_t n = 3 * (size_t)mesh->triangles;
	uint64_t loops = 0;

	for (uint32_t v = 0; v < mp_vertices_count(mesh->vertices); v++)
		parent[v] = UINT32_MAX;
	for (size_t h = mp_bit_next(bit, n, 0); h < n; h = mp_bit_next(bit, n, h + 1)) {
		uint32_t u = mp_corner_vertex(mesh, (uint32_t)h);
		uint32_t v = mp_corner_vertex(mesh, mp_half_next((uint32_t)h));

		loops += enter(parent, u);
		loops += enter(parent, v);
		loops -= mp_set_unite(parent, u, v);
	}
	return loops;
}

int mp_loops_find(const struct mp_mesh *mesh, const struct mp_edges *e, uint32_t most,
		  const uint64_t *gap, struct mp_topology *out)
{
	uint64_t edges = out->boundary_edges < most ? out->boundary_edges : most;
	uint32_t *parent = NULL;
	int failed = -1;

	if (out->boundary_edges == 0)
		return mp_defects_begin(&out->defect[MP_DEFECT_BOUNDARY_EDGE], 0, 0, 0) ||
			       mp_defects_begin(&out->defect[MP_DEFECT_BOUNDARY_LOOP], 0, 0, 0)
			   ? -1
			   : 0;
	out->boundary = boundary_bits(mesh, e);
	parent = malloc(mp_vertices_count(mesh->vertices) * sizeof *parent);
	if (out->boundary != NULL && parent != NULL) {
		out->boundary_loops = mp_loops_join(mesh, out->boundary, parent);
		failed =
		    list_edges(mesh, out->boundary, edges, &out->defect[MP_DEFECT_BOUNDARY_EDGE]) ||
		    mp_loops_list(mesh, out->boundary, gap, parent,
				  out->boundary_loops < most ? out->boundary_loops : most, out);
	}
	free(parent);
	return failed ? -1 : 0;
}
