#include <stdlib.h>

#include "core/sort.h"
#include "core/topology/disjoint.h"
#include "core/topology/topology_parts.h"

/*
 * Corners are linked across every shared edge; the corners at a vertex that hang together are a
 * fan.  A vertex with one fan is manifold as far as its triangles go.
 */

enum { AHEAD = 24 };

static void connect(const struct mp_edges *e, uint32_t *parent)
{
	for (size_t i = 0; i < e->count; i++) {
		uint32_t u, v;

		if (i + AHEAD < e->count)
			__builtin_prefetch(&parent[mp_use_half(e->use[i + AHEAD])], 1);
		if (e->use[i] & MP_USE_FIRST)
			continue;
		u = e->use[i - 1];
		v = e->use[i];
		mp_set_unite(parent, mp_use_corner(u, false), mp_use_corner(v, false));
		mp_set_unite(parent, mp_use_corner(u, true), mp_use_corner(v, true));
	}
}

/* Which bodies have several fans at one vertex.  ${roots}: fans of vertices with more than one. */
static int find_pinched(const struct mp_mesh *mesh, const uint32_t *parent, const uint8_t *fans,
			size_t roots, struct mp_topology *out)
{
	uint64_t *key = malloc((roots + 1) * sizeof *key);
	size_t n = 0;

	if (key == NULL)
		return -1;
	for (uint32_t c = 0; n < roots; c++) {
		uint32_t v = mp_corner_vertex(mesh, c);

		if (parent[c] == c && fans[v] > 1 && mp_has_edges(mesh->tri[c / 3]))
			key[n++] = (uint64_t)v << 32 | out->body_of[c / 3];
	}
	mp_sort_u64(key, n);
	for (size_t i = 1; i < n; i++)
		if (key[i] == key[i - 1])
			out->body[(uint32_t)key[i]].pinched = true;
	free(key);
	return 0;
}

/* fans[v]: 0, 1 or 2 for more than one. */
static int count_fans(const struct mp_mesh *mesh, const struct mp_edges *e, uint8_t *fans,
		      struct mp_topology *out)
{
	size_t corners = 3 * (size_t)mesh->triangles;
	uint32_t *parent = malloc((corners + 1) * sizeof *parent);
	size_t shared = 0;
	int failed = 0;

	if (parent == NULL)
		return -1;
	for (uint32_t c = 0; c < corners; c++)
		parent[c] = c;
	connect(e, parent);
	for (uint32_t t = 0; t < mesh->triangles; t++) {
		if (!mp_has_edges(mesh->tri[t]))
			continue;
		for (uint32_t k = 0; k < 3; k++) {
			uint8_t *f = &fans[mesh->tri[t][k]];

			if (parent[3 * t + k] != 3 * t + k)
				continue;
			out->body[out->body_of[t]].fans++;
			shared += *f == 0 ? 0 : *f == 1 ? 2 : 1; /* the first one counts late */
			*f = *f == 0 ? 1 : 2;
		}
	}
	if (shared > 0)
		failed = find_pinched(mesh, parent, fans, shared, out);
	free(parent);
	return failed;
}

/*
 * The items, numbered by their smallest triangle: item[v], UINT32_MAX for none; how many triangles
 * each names goes to l->triangle_at[item + 1].  Returns whether any triangle had to be left out.
 */
static bool count_items(const struct mp_mesh *mesh, const uint8_t *fans, size_t most,
			uint32_t *item, struct mp_defect_list *l)
{
	bool truncated = false;

	for (uint32_t t = 0; t < mesh->triangles; t++) {
		for (unsigned k = 0; k < 3 && mp_has_edges(mesh->tri[t]); k++) {
			uint32_t v = mesh->tri[t][k];

			if (fans[v] < 2)
				continue;
			if (item[v] == UINT32_MAX && l->count < most) {
				item[v] = (uint32_t)l->count;
				l->vertices[l->count++] = v;
			}
			if (item[v] == UINT32_MAX)
				truncated = true;
			else if (l->triangle_at[item[v] + 1] < MP_DEFECT_TRIANGLES)
				l->triangle_at[item[v] + 1]++;
			else
				truncated = true;
		}
	}
	return truncated;
}

/* In the end item i names vertex i alone; until then vertex_at[i + 1] counts what came to item i.
 */
static void fill_items(const struct mp_mesh *mesh, const uint32_t *item, struct mp_defect_list *l)
{
	for (size_t i = 0; i < l->count; i++)
		l->triangle_at[i + 1] += l->triangle_at[i];
	for (uint32_t t = 0; t < mesh->triangles; t++) {
		for (unsigned k = 0; k < 3 && mp_has_edges(mesh->tri[t]); k++) {
			size_t i = item[mesh->tri[t][k]], at;

			if (i == UINT32_MAX)
				continue;
			at = l->triangle_at[i] + l->vertex_at[i + 1];
			if (at == l->triangle_at[i + 1])
				continue;
			l->triangles[at] = t;
			l->vertex_at[i + 1]++;
		}
	}
	for (size_t i = 0; i < l->count; i++)
		l->vertex_at[i + 1] = i + 1;
}

static int list(const struct mp_mesh *mesh, const uint8_t *fans, size_t items,
		struct mp_topology *out)
{
	struct mp_defect_list *l = &out->defect[MP_DEFECT_NON_MANIFOLD_VERTEX];
	uint32_t vertices = mp_vertices_count(mesh->vertices);
	uint32_t *item;

	if (mp_defects_begin(l, items, items * MP_DEFECT_TRIANGLES, items))
		return -1;
	if (items == 0)
		return 0;
	item = malloc(vertices * sizeof *item);
	if (item == NULL)
		return -1;
	for (uint32_t v = 0; v < vertices; v++)
		item[v] = UINT32_MAX;
	out->truncated |= count_items(mesh, fans, items, item, l);
	fill_items(mesh, item, l);
	free(item);
	return 0;
}

int mp_fans_find(const struct mp_mesh *mesh, const struct mp_edges *edges, uint32_t most,
		 struct mp_topology *out)
{
	uint32_t vertices = mp_vertices_count(mesh->vertices);
	uint8_t *fans = calloc((size_t)vertices + 1, 1);
	int failed;

	if (fans == NULL)
		return -1;
	failed = count_fans(mesh, edges, fans, out);
	for (uint32_t v = 0; v < vertices; v++) {
		out->vertices += fans[v] > 0;
		out->non_manifold_vertices += fans[v] > 1;
	}
	if (!failed) {
		size_t n = out->non_manifold_vertices;

		failed = list(mesh, fans, n < most ? n : most, out);
	}
	free(fans);
	return failed;
}
