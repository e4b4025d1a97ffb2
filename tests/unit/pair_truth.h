#ifndef PAIR_TRUTH_H
#define PAIR_TRUTH_H

#include "core/intersect/tri_pair.h"

/*
 * What two triangles have in common, in fractions: one polygon is clipped by the half-spaces that
 * make up the other.  The slow and plain way, from the definitions alone.
 */
struct pair_truth {
	bool touches, intersects, crosses, coplanar;
	uint8_t along[2][3];
	unsigned points;
	double point[12][3]; /* the corners of what they have in common */
};

void pair_truth_find(const struct mp_tri *, const struct mp_tri *, struct pair_truth *);

#endif
