#ifndef MP_CLUSTER_PRIVATE_H
#define MP_CLUSTER_PRIVATE_H

#include <stdbool.h>
#include <stdint.h>

/* The tree behind mp_cluster_find(). */

struct mp_near_point {
	double p[3];
	uint32_t id; /* the caller's */
};

struct mp_near_node {
	double lo[3], hi[3];
	bool one; /* all its points are known to be of one cluster */
};

enum { MP_NEAR_LEAF = 16 };

/*
 * Node 1 has all points; node i those of its children 2i and 2i + 1, a half each, cut across the
 * widest axis of its box; a leaf has at most MP_NEAR_LEAF.  All leaves are at the same depth.
 */
struct mp_near_tree {
	struct mp_near_point *point;
	uint32_t count;
	struct mp_near_node *node;
	unsigned depth; /* of the leaves; the root's is 0 */
};

/* The nodes of a tree of so many points: 2 << depth. */
unsigned mp_near_depth(uint32_t count);

/*
 * Put the points, no two of which have one number, in their order and fill the boxes: O(n log n) on
 * average over ${seed}, whatever the points.  ${seed} does not change the tree.
 */
void mp_near_build(struct mp_near_tree *, uint64_t seed);

#endif
