#ifndef MP_RINGS_H
#define MP_RINGS_H

#include "core/topology/topology_parts.h"

/*
 * Private to manifold.c.  Every corner of a vertex links a neighbour (where its triangle leaves the
 * vertex) to another (where it comes back): do these links form one ring at every vertex?
 */
struct mp_rings {
	const struct mp_mesh *mesh;
	uint32_t vertices;
	uint32_t *label; /* of each vertex, see below */
	uint64_t faces;  /* triangles with edges */
	uint64_t used;   /* vertices that they have */
	struct mp_manifold_room room;
};

/*
 * 1 if every vertex that is used has one ring of three links or more that meets no neighbour twice,
 * 0 if not or if that cannot be told within the room, -1 where memory is out.  When 1: label[v] <=
 * v is the smallest vertex that shares an edge with v; itself where none is smaller or v is not
 * used.
 */
int mp_rings_find(struct mp_rings *);

#endif
