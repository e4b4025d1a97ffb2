#ifndef MP_CLUSTER_H
#define MP_CLUSTER_H

#include <stdbool.h>
#include <stdint.h>

#include "core/affine/affine.h"
#include "core/error.h"
#include "core/topology/vertices.h"

/*
 * mp_cluster_find(vertices, map, which, count, distance, key, leader, complete, err):
 * Points that hang together by steps shorter than ${distance} [L] > 0 are one cluster: the
 * transitive closure of "nearer than", so the order of the points changes nothing.  The points are
 * the vertices which[0 .. count), all different, or 0 .. count where ${which} is NULL; leader[i]
 * becomes the number of the lexicographically smallest place (x, then y, then z) in the cluster of
 * point i.  Unless ${map} is NULL, distances and which place is the smallest are those of the
 * points mapped (and rounded; of places that rounding makes one the smallest of the file is taken);
 * it takes none of them beyond the range of a double.
 *
 * A k-d tree joined with itself (Gray & Moore 2001, "N-body problems in statistical learning"):
 * whole nodes are passed over where they are too far apart, and taken as one where they are near
 * enough or known to hang together, so neither 10^6 points within one distance nor a chain of them
 * costs more than O(n log n).  There is no grid, so no cell can overflow.  Clouds that keep just
 * out of each other's reach can be made to cost more: work is bounded, and ${*complete} is false
 * where that left some pair unseen.  ${key}: secret bytes, for the pivots of the tree; they do not
 * show in the result.  40 to 55 bytes a point.  -1: memory is out.
 */
int mp_cluster_find(const struct mp_vertices *vertices, const struct mp_affine *map,
		    const uint32_t *which, uint32_t count, double distance, const uint8_t key[16],
		    uint32_t *leader, bool *complete, struct mp_error *err);

#endif
