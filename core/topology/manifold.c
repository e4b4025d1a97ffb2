#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/topology/disjoint.h"
#include "core/topology/rings.h"

/*
 * The short way of a good mesh.  Every corner of a vertex links a neighbour (where its triangle
 * leaves the vertex) to another (where it comes back).  If at every vertex these links form one
 * ring that meets no neighbour twice, then every edge is used once in each direction, every vertex
 * has one fan, and there is no boundary.  Two triangles with the same corners would then be each
 * other's only neighbours, a ring of two links: where no ring is that short there are none.  And
 * triangles that share a vertex hang together through edges, so bodies are sets of vertices.
 */
enum { AHEAD = 24 }; /* what to prefetch for: about the latency of memory */

/*
 * The smallest neighbours alone leave few sets, in a mesh whose triangles come side by side just
 * one; the triangles join these.  Returns how many bodies there are.
 */
static uint32_t connect(struct mp_rings *r)
{
	const struct mp_mesh *mesh = r->mesh;
	uint32_t sets = 0;

	for (uint32_t v = 0; v < r->vertices; v++)
		sets += r->label[v] == v;
	sets -= r->vertices - (uint32_t)r->used; /* each of them is by itself */
	for (uint32_t t = 0; t < mesh->triangles && sets > 1; t++) {
		const uint32_t *v = mesh->tri[t];

		for (unsigned k = 0; k < 3 && t + AHEAD < mesh->triangles; k++)
			__builtin_prefetch(&r->label[mesh->tri[t + AHEAD][k]]);
		for (unsigned k = 0; k < 3 && t + AHEAD / 2 < mesh->triangles; k++)
			__builtin_prefetch(&r->label[r->label[mesh->tri[t + AHEAD / 2][k]]]);
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
static void assign(struct mp_rings *r, uint32_t *number, struct mp_topology *out)
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
	for (uint32_t v = 0; v < r->vertices; v++) {
		uint32_t body = number[mp_set_find(r->label, v)];

		if (body != UINT32_MAX) /* v is used */
			out->body[body].fans++;
	}
}

static int number_bodies(struct mp_rings *r, struct mp_topology *out)
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

static int fill(struct mp_rings *r, struct mp_topology *out)
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

int mp_manifold_find(const struct mp_mesh *mesh, const struct mp_manifold_room *room,
		     struct mp_topology *out, bool *good)
{
	struct mp_rings r = {
	    .mesh = mesh, .vertices = mp_vertices_count(mesh->vertices), .room = *room};
	size_t size = ((size_t)r.vertices + 1) * sizeof *r.label;
	int found;

	r.label = mp_huge(malloc(size), size);
	found = r.label == NULL ? -1 : mp_rings_find(&r);
	if (found == 1 && fill(&r, out))
		found = -1;
	free(r.label);
	*good = found == 1;
	return found < 0 ? -1 : 0;
}
