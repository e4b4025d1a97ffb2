#include <stdlib.h>

#include "core/topology/disjoint.h"
#include "core/topology/topology_parts.h"

enum { AHEAD = 24 }; /* uses to prefetch for: about the latency of memory */

static void connect(const struct mp_edges *e, uint32_t *parent)
{
	for (size_t i = 0; i < e->count; i++) {
		if (i + AHEAD < e->count)
			__builtin_prefetch(&parent[mp_use_triangle(e->use[i + AHEAD])], 1);
		if (!(e->use[i] & MP_USE_FIRST))
			mp_set_unite(parent, mp_use_triangle(e->use[i - 1]),
				     mp_use_triangle(e->use[i]));
	}
}

/*
 * Turn parents into body numbers, in place: a root is the smallest of its body and a parent comes
 * before its children, so its number is there already.
 */
static uint32_t number(uint32_t *body_of, uint32_t triangles)
{
	uint32_t bodies = 0;

	for (uint32_t t = 0; t < triangles; t++) {
		if (body_of[t] == MP_NO_BODY)
			continue;
		body_of[t] = body_of[t] == t ? bodies++ : body_of[body_of[t]];
	}
	return bodies;
}

static int describe(const uint32_t *body_of, uint32_t triangles, struct mp_topology *out)
{
	out->body = calloc((size_t)out->bodies + 1, sizeof *out->body);
	if (out->body == NULL)
		return -1;
	for (uint32_t t = 0; t < triangles; t++) {
		struct mp_body_topology *b;

		if (body_of[t] == MP_NO_BODY)
			continue;
		b = &out->body[body_of[t]];
		if (b->triangles++ == 0)
			b->first = t;
	}
	for (uint32_t i = 0; i < out->bodies; i++)
		out->body[i].closed = out->body[i].watertight = true;
	return 0;
}

/* What is wrong with an edge that is used ${n} times, ${back} of them from the larger vertex. */
static void count_edge(struct mp_topology *out, struct mp_body_topology *b, size_t n, size_t back)
{
	if (n != 2) {
		out->watertight = b->watertight = false;
		b->boundary_edges += n == 1;
		b->non_manifold_edges += n > 2;
		out->boundary_edges += n == 1;
		out->non_manifold_edges += n > 2;
	} else if (back != 1) {
		b->misoriented_edges++;
		out->misoriented_edges++;
	}
	if (2 * back != n) {
		out->closed = b->closed = false;
		out->unbalanced_edges += n > 1;
	}
}

static void count_edges(const struct mp_edges *e, struct mp_topology *out)
{
	out->closed = out->watertight = e->count > 0;
	for (size_t i = 0, end; i < e->count; i = end) {
		size_t back = 0;

		end = mp_edges_end(e, i);
		out->edges++;
		for (size_t j = i; j < end; j++)
			back += (e->use[j] & MP_USE_BACK) != 0;
		if (end - i == 2 && back == 1)
			continue;
		count_edge(out, &out->body[out->body_of[mp_use_triangle(e->use[i])]], end - i,
			   back);
	}
	out->winding_consistent = out->misoriented_edges == 0;
}

int mp_bodies_find(const struct mp_mesh *mesh, const struct mp_edges *edges,
		   struct mp_topology *out)
{
	out->body_of = malloc(((size_t)mesh->triangles + 1) * sizeof *out->body_of);
	if (out->body_of == NULL)
		return -1;
	for (uint32_t t = 0; t < mesh->triangles; t++) {
		bool used = mp_has_edges(mesh->tri[t]);

		out->body_of[t] = used ? t : MP_NO_BODY;
		out->faces += used;
	}
	connect(edges, out->body_of);
	out->bodies = number(out->body_of, mesh->triangles);
	if (describe(out->body_of, mesh->triangles, out))
		return -1;
	count_edges(edges, out);
	return 0;
}
