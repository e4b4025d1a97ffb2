#ifndef MP_BVH_H
#define MP_BVH_H

#include <stddef.h>

#include "core/error.h"
#include "core/intersect/signs.h"

/*
 * A hierarchy of boxes over items that have a box and belong to a group, to find all pairs whose
 * boxes meet.  Split in the middle of the items' centres along the longest axis, and at the median
 * where that would be lopsided: O(n log n) to build, whatever the boxes, at most some 150 deep.
 *
 * Coordinates are float32 about an origin.  Both steps are monotone, so boxes that meet still do;
 * some that do not may, too.
 */
struct mp_bvh_box {
	float min[3], max[3];
};

struct mp_bvh_item {
	uint32_t id, group; /* both the caller's */
	struct mp_bvh_box box;
};

#define MP_BVH_MIXED UINT32_MAX /* no group of an item */

struct mp_bvh_node {
	struct mp_bvh_box box;
	uint32_t group; /* of all in it, or MP_BVH_MIXED */
	uint32_t begin, count;
	uint32_t right; /* the left child follows at once; 0: a leaf */
};

struct mp_bvh {
	struct mp_bvh_item *item;
	uint32_t count;
	struct mp_bvh_node *node; /* none where there are no items */
	uint32_t nodes, room;
};

/* A coordinate for a box. */
float mp_bvh_round(double x, double origin);

/*
 * Takes ${item} (from malloc, ${count} of them), which mp_bvh_free() frees, after a failure too.
 * About 25 bytes an item beside it.  0, or -1: memory is out.
 */
int mp_bvh_build(struct mp_bvh *, struct mp_bvh_item *item, uint32_t count, struct mp_error *err);
void mp_bvh_free(struct mp_bvh *); /* legal on a zeroed struct */

/*
 * Every pair of items whose boxes meet, once.  ${wanted} says whether a pair of groups (either may
 * be MP_BVH_MIXED, which it has to want) is of interest.  -1: no work is left, or ${pair} returned
 * nonzero; the search ended there.
 */
struct mp_bvh_visitor {
	void *self;
	bool (*wanted)(void *self, uint32_t group, uint32_t other);
	int (*pair)(void *self, const struct mp_bvh_item *, const struct mp_bvh_item *);
};
int mp_bvh_pairs(const struct mp_bvh *, const struct mp_bvh_visitor *, struct mp_work *);

#endif
