#ifndef MP_LOOP_LIST_H
#define MP_LOOP_LIST_H

#include "core/affine/affine.h"
#include "core/topology/disjoint.h"
#include "core/topology/topology_parts.h"

/* The boundary loops that are listed, private to loop_list.c, loop_measure.c and junctions.c. */

#define MP_NO_LOOP UINT32_MAX

struct mp_loop_place {
	uint32_t first;     /* its smallest half-edge */
	uint32_t triangles; /* how many have an edge on it */
	uint32_t vertices;
	bool circle; /* every vertex has two of its edges */
};

struct mp_loop_lister {
	const struct mp_mesh *mesh;
	const uint64_t *bit; /* boundary half-edges */
	const uint64_t *gap; /* vertices at which the boundary does not cancel */
	size_t halves;
	uint32_t *parent;
	uint32_t *item; /* of the set's root: number of its loop, MP_NO_LOOP where not listed */
	uint32_t
	    *link; /* all boundary half-edges at the vertex xored: two of them give the other */
	uint8_t *degree; /* of them at the vertex, 3 for more; 0 = listed or none */
	struct mp_loop_place *loop;
	size_t items;
};

#define MP_FOR_BOUNDARY(s, h)                                                   \
	for (size_t h = mp_bit_next((s)->bit, (s)->halves, 0); h < (s)->halves; \
	     h = mp_bit_next((s)->bit, (s)->halves, h + 1))

static inline uint32_t mp_loop_tail(const struct mp_loop_lister *s, size_t half)
{
	return mp_corner_vertex(s->mesh, (uint32_t)half);
}

static inline uint32_t mp_loop_head(const struct mp_loop_lister *s, size_t half)
{
	return mp_corner_vertex(s->mesh, mp_half_next((uint32_t)half));
}

/* The number of the loop of a boundary vertex, MP_NO_LOOP where it is not listed. */
static inline uint32_t mp_loop_number(const struct mp_loop_lister *s, uint32_t v)
{
	return s->item[mp_set_find(s->parent, v)];
}

/*
 * Coordinates of a vertex as loops are measured, mapped: the one place where lengths, areas and
 * boxes of loops take them from.
 */
static inline void mp_loop_place_of(const struct mp_loop_lister *s, uint32_t v, double xyz[3])
{
	mp_vertices_get(s->mesh->vertices, v, xyz);
	if (s->mesh->map != NULL)
		(void)mp_affine_point(s->mesh->map, xyz, xyz);
}

/* loop_measure.c: all of out->loop but the junctions.  degree and loop[].vertices are whole yet. */
int mp_loops_measure(const struct mp_loop_lister *, struct mp_topology *out);

/* junctions.c: out->junction, and where each loop's are; sets out->truncated. */
int mp_junctions_find(const struct mp_loop_lister *, struct mp_topology *out);

#endif
