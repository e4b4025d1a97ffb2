#ifndef MP_POLYGON_H
#define MP_POLYGON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"

/*
 * Polygons in space to triangles.  A struct mp_polygon that is all 0 is ready; what it has
 * allocated is kept from one polygon to the next until mp_polygon_free().
 */
struct mp_polygon {
	uint32_t (*tri)[3]; /* the n - 2 triangles: positions 0 .. n - 1, wound as the polygon */
	bool nonplanar;     /* which triangles were chosen changes the surface */
	bool tangled;       /* not split properly: it crosses itself, or the work grew too much */

	size_t tri_room;
	void *work; /* of the ear clipping */
	size_t work_size;
};

/*
 * mp_polygon_split(p, xyz, corner, n, err):
 * Split the polygon with the corners xyz[corner[0]] ... xyz[corner[n - 1]], n >= 3, coordinates
 * finite, into n - 2 triangles and set p->tri, p->nonplanar, p->tangled.
 *
 * It is looked at along the axis next to its Newell normal, where every turn is decided exactly.
 * Where the fan from corner 0 has no flat and no reversed triangle, it is the answer; else a sweep
 * finds one.  Concave polygons, holes on bridges that are used twice, boundaries that touch
 * themselves, spikes, repeated and collinear corners are fine: no triangle is reversed, so the area
 * of a flat polygon is right.  Where the boundary crosses itself, ears are clipped as far as they
 * go and p->tangled says whether the area is off; the volume does not depend on it.  A polygon
 * without area gives a fan.  O(n log n) time, about 100 bytes a corner.
 *
 * Return 0, or -1 where memory is out.
 */
int mp_polygon_split(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner,
		     uint32_t n, struct mp_error *err);

/*
 * Would mp_polygon_split() make 0 1 2 and 0 2 3 of these four corners?  It does where this is true,
 * and sets ${*nonplanar}; false says nothing.  The short way for nearly all polygons there are.
 */
bool mp_polygon_usual_quad(const double (*xyz)[3], const uint32_t corner[4], bool *nonplanar);

void mp_polygon_free(struct mp_polygon *); /* legal on a zeroed struct */

#endif
