#ifndef MP_INTERSECT_H
#define MP_INTERSECT_H

#include <stdbool.h>

#include "core/bodies/nesting.h"
#include "core/topology/topology.h"

/*
 * Where the surface of a mesh meets itself, decided without a rounding error, in O((n + k) log n)
 * for n triangles of which k pairs are near each other.  Work is counted and bounded: where it does
 * not suffice, nothing is decided.
 */

enum { MP_CROSSING_POINTS = 6 };
enum { MP_WOUND_NOT, MP_WOUND_OUTWARD, MP_WOUND_INWARD }; /* as enum mp_orientation */

/* Two triangles that meet, ascending, and the corners of what they have in common, rounded. */
struct mp_crossing {
	uint32_t triangle[2];
	uint32_t points; /* 1 to 6; a segment has 2 */
	double point[MP_CROSSING_POINTS][3];
};

struct mp_crossings {
	bool asked, decided;
	uint64_t count;           /* of pairs; where not decided, those that were found */
	struct mp_crossing *list; /* the first ones by their triangle numbers, maybe not all */
	size_t listed;
};

struct mp_intersect {
	const struct mp_mesh *mesh;
	const struct mp_topology *topology;
	const struct mp_box *box; /* of the bodies */
	const uint8_t *winding;   /* of the bodies: MP_WOUND_*; NOT: open, or no volume */
	const uint8_t *key;       /* 16 secret bytes */
	uint32_t most;            /* crossings to list */
};

/*
 * mp_self_intersections(ask, out, err):
 * The pairs of triangles that intersect, see tri_pair.h.  Triangles without an area and pairs with
 * the same three vertices are left out: they are counted by the topology.  box and winding are not
 * read.
 */
int mp_self_intersections(const struct mp_intersect *ask, struct mp_crossings *out,
			  struct mp_error *err);

/*
 * mp_overlapping_bodies(ask, out, err):
 * The pairs of bodies that overlap: their surfaces pass through each other, or they have space in
 * common and neither lies within the other.  Bodies that touch, in a point, along an edge or with
 * whole faces, do not overlap, nor does one that lies within another; two that fill the same
 * space do.  Each pair is located by two triangles that meet.
 *
 * Where the surfaces of two bodies cross in a segment within a triangle of each, they overlap.
 * Elsewhere what they have in common is points, which decide nothing, and segments of edges: there
 * the sectors that both solids fill round the edge are compared.  Every piece into which
 * one surface cuts the other is bounded by such segments, so together they tell whether the
 * interiors meet and whether something is left of either.  That takes bodies whose surface is
 * watertight and does not touch itself, which is checked; where another body touches along an
 * edge, the pair is not decided.  Neither is one with a body without a volume that crosses another.
 */
int mp_overlapping_bodies(const struct mp_intersect *ask, struct mp_crossings *out,
			  struct mp_error *err);

void mp_crossings_free(struct mp_crossings *); /* legal on a zeroed struct */

#endif
