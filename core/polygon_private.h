#ifndef MP_POLYGON_PRIVATE_H
#define MP_POLYGON_PRIVATE_H

#include "core/polygon.h"

#define POLYGON_NONE UINT32_MAX

/*
 * The corners that can be in the way of an ear (all that are not strictly convex): a packed R-tree
 * along a Z-order curve.  Corners only ever leave it.
 */
enum { POLYGON_LEAF = 8, POLYGON_LEVELS = 30 };

struct polygon_tree {
	const double (*xy)[2];
	uint32_t count, levels;
	uint32_t first[POLYGON_LEVELS]; /* of the nodes of a level; level 0: the leaves */
	uint32_t *order;                /* corners; leaf i has those from POLYGON_LEAF * i */
	uint32_t *place;                /* of a corner in ${order}, or POLYGON_NONE */
	double (*box)[4];               /* of a node: least x, y, greatest x, y */
	uint32_t *alive;                /* corners below a node that have not left */
};

size_t polygon_tree_nodes(uint32_t count); /* at most so many for ${count} corners */

/*
 * Build the tree of the ${count} corners named in the lower halves of ${key}[]; the upper halves
 * are overwritten.  The arrays of ${t} are the caller's, ${place} is filled.
 */
void polygon_tree_build(struct polygon_tree *t, uint64_t *key, uint32_t count);

void polygon_tree_remove(struct polygon_tree *t, uint32_t corner);

/*
 * Call ${visit} with the corners that lie in the closed triangle ${tri} (counter-clockwise, area
 * not 0) and possibly with others near it, until it returns true.  Returns the work done.
 */
uint64_t polygon_tree_search(const struct polygon_tree *t, const double *const tri[3],
			     bool (*visit)(void *self, uint32_t corner), void *self);

/* At least ${size} bytes in p->work, what was in it is lost; NULL where memory is out. */
void *polygon_room(struct mp_polygon *p, size_t size, struct mp_error *err);

/*
 * Sweep: as polygon_clip(), in O(n log n) time, but only where the boundary does not touch itself,
 * bridges to holes and repeated corners apart; ${*split_up} says whether that was so.
 */
int polygon_sweep(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner, uint32_t n,
		  const int axis[2], bool *split_up, struct mp_error *err);

/*
 * Clip ears: corner i lies at {xyz[corner[i]][axis[0]], ...[axis[1]]}, the whole counter-clockwise
 * in that plane; writes n - 2 triangles to p->tri.  n >= 4.
 */
int polygon_clip(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner, uint32_t n,
		 const int axis[2], struct mp_error *err);

#endif
