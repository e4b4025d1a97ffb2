#include <stdatomic.h>
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
enum {
	AHEAD = 24, /* what to prefetch for: about the latency of memory */
	SOME = 4096 /* triangles at a time */
};

/* Sets of vertices that hang together, by two threads if there are two. */
struct joining {
	const struct mp_mesh *mesh;
	uint32_t *label;           /* a forest as in disjoint.h, whoever changes it */
	atomic_uint_fast64_t next; /* triangle to look at, as soon as somebody is free */
	atomic_int_fast64_t sets;  /* at least */
	struct joining_half {
		struct joining *j;
		uint32_t begin, end; /* vertices */
	} half[2];
};

/* Paths become short; each root found is a set. */
static void count_sets(void *half)
{
	const struct joining_half *h = half;
	uint32_t *label = h->j->label;
	int_fast64_t sets = 0;

	for (uint32_t v = h->begin; v < h->end; v++)
		sets += mp_shared_shorten(label, v) == v;
	atomic_fetch_add_explicit(&h->j->sets, sets, memory_order_relaxed);
}

static int_fast64_t join_some(const struct joining *j, uint32_t t, uint32_t end)
{
	const uint32_t(*tri)[3] = j->mesh->tri;
	uint32_t *label = j->label, triangles = j->mesh->triangles;
	int_fast64_t joined = 0;

	for (; t < end; t++) {
		const uint32_t *v = tri[t];

		for (unsigned k = 0; k < 3 && t + AHEAD < triangles; k++)
			__builtin_prefetch(&label[tri[t + AHEAD][k]]);
		for (unsigned k = 0; k < 3 && t + AHEAD / 2 < triangles; k++)
			__builtin_prefetch(&label[mp_shared_parent(label, tri[t + AHEAD / 2][k])]);
		if (!mp_has_edges(v))
			continue;
		joined += mp_shared_unite(label, v[0], v[1]);
		joined += mp_shared_unite(label, v[1], v[2]);
	}
	return joined;
}

/* Until all triangles were looked at, or everything hangs together. */
static void join(void *half)
{
	struct joining *j = ((struct joining_half *)half)->j;
	uint64_t triangles = j->mesh->triangles;

	while (atomic_load_explicit(&j->sets, memory_order_relaxed) > 1) {
		uint64_t t = atomic_fetch_add_explicit(&j->next, SOME, memory_order_relaxed);
		int_fast64_t joined;

		if (t >= triangles)
			break;
		joined = join_some(j, (uint32_t)t,
				   (uint32_t)(triangles - t < SOME ? triangles : t + SOME));
		atomic_fetch_sub_explicit(&j->sets, joined, memory_order_relaxed);
	}
}

/*
 * The smallest neighbours alone leave few sets, in a mesh whose triangles come side by side just
 * one; the triangles join these.  Returns how many bodies there are.
 */
static uint32_t connect(struct mp_rings *r)
{
	const struct mp_mesh *mesh = r->mesh;
	struct joining j = {.mesh = mesh, .label = r->label};
	bool two = mesh->second != NULL && mesh->triangles > r->room.alone;

	j.half[0] = (struct joining_half){&j, 0, two ? r->vertices / 2 : r->vertices};
	j.half[1] = (struct joining_half){&j, j.half[0].end, r->vertices};
	atomic_init(&j.next, 0);
	atomic_init(&j.sets, -(int_fast64_t)(r->vertices - r->used)); /* each is by itself */
	mp_second_share(two ? mesh->second : NULL, count_sets, &j.half[0], &j.half[1]);
	mp_second_share(two ? mesh->second : NULL, join, &j.half[0], &j.half[1]);
	return (uint32_t)atomic_load(&j.sets);
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
