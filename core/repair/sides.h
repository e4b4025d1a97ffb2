#ifndef MP_SIDES_H
#define MP_SIDES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/topology/edges.h"

/*
 * Which triangles belong together as one side of a surface, and which of them are wound against
 * the others.  Triangles on both sides of an edge that is used twice are of one sheet, and wound
 * alike where they use it in opposite directions.  Where more than two triangles meet at an edge,
 * sheets that are closed without it stay by themselves, as two boxes that touch along an edge;
 * sheets that are not go around the edge in turn, one away from the solid, one towards it.
 */
enum mp_side_flaw {
	MP_SIDE_ONE = 1,  /* the sheet has one side only, as a Moebius strip has */
	MP_SIDE_HOLE = 2, /* it has an edge that is used once */
	MP_SIDE_TORN = 4  /* some edge is not used equally often both ways, however it is wound */
};

struct mp_sides {
	uint32_t count;    /* of sheets, by their smallest triangles */
	uint32_t *of;      /* per triangle; MP_NO_BODY where it has no edges */
	uint64_t *against; /* a bit per triangle: wound against the smallest of its sheet */
	uint8_t *flaw;     /* per sheet: enum mp_side_flaw; 0: closed, once it is wound alike */
	/*
	 * Closed sheets that meet at edges hang together, for those whose nesting nobody can tell.
	 * Per sheet: the smallest of those, << 1 | whether the first triangles of both are wound
	 * against each other if the sheets take turns around their edges as above.
	 */
	uint32_t *beside;
};

/*
 * O(n log n) time whatever the mesh; about 10 bytes a triangle beside ${edges}, 8 of which stay.
 * What the triangles around an edge do is judged by exact signs.  -1: memory is out, nothing to
 * free.
 */
int mp_sides_find(const struct mp_mesh *mesh, const struct mp_edges *edges, struct mp_sides *out,
		  struct mp_error *err);
void mp_sides_free(struct mp_sides *); /* legal on a zeroed struct */

/* Wound against the smallest of its sheet? */
static inline bool mp_sides_against(const struct mp_sides *s, uint32_t t)
{
	return (s->against[t / 64] >> (t % 64)) & 1;
}

/*
 * around.c: put the ${n} uses of one edge into the order in which their triangles come around it,
 * counter-clockwise seen from the larger vertex, from that of the first on; those in the same
 * half-plane in the order in which they were.  false, and nothing done: a triangle has its third
 * corner on the line.  ${spare}: memory for as many.
 */
bool mp_around_sort(const struct mp_mesh *mesh, uint32_t *use, size_t n, uint32_t *spare);

#endif
