#ifndef MP_FACET_H
#define MP_FACET_H

#include <stdbool.h>

/*
 * One triangle by itself.  Edges and their products are kept in pairs of doubles, so that neither
 * the distance from the origin nor a sliver takes digits away: each number is within a few ulp
 * of the exact one (of a vector: of its longest component), unless a sliver is 2^-50 times as wide
 * as long.
 */
struct mp_facet {
	double area;        /* [L^2] */
	double normal[3];   /* unit; 0 where degenerate */
	double centroid[3]; /* [L] */
	double height; /* [L] of its plane over the origin, along the normal; 0 where degenerate */
	double volume; /* [L^3] of the tetrahedron that it makes with the origin, signed */
	bool degenerate; /* the corners lie on one line, or are 2^-90 times as wide as long */
};

/* Any finite corners.  What no double can hold is infinite or 0. */
void mp_facet_find(const double corner[3][3], struct mp_facet *out);

#endif
