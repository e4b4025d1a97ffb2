#ifndef MP_KDTREE_H
#define MP_KDTREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Points in a box: a k-d tree (Bentley 1975, doi:10.1145/361002.361007) without pointers.  The
 * middle point of an array divides the others along one axis, the axes take turns, and so on in
 * either half; coinciding points are fine.
 */
struct mp_kd_point {
	double p[3];
	uint32_t id; /* the caller's */
};

/* Bring ${n} points into order: O(n log n) for good input, O(n log^2 n) for any. */
void mp_kd_build(struct mp_kd_point *, size_t n);

/*
 * Call ${visit} with every point for which lo[k] <= p[k] <= hi[k].  Each point looked at takes one
 * from ${*steps}.  -1: steps ran out, or visit returned nonzero; the search ended there.
 */
int mp_kd_search(const struct mp_kd_point *, size_t n, const double lo[3], const double hi[3],
		 uint64_t *steps, int (*visit)(void *self, uint32_t id), void *self);

#endif
