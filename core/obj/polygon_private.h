#ifndef MP_POLYGON_PRIVATE_H
#define MP_POLYGON_PRIVATE_H

#include "core/obj/polygon.h"

#define POLYGON_NONE UINT32_MAX

/* At least ${size} bytes in p->work, what was in it is lost; NULL where memory is out. */
void *polygon_room(struct mp_polygon *p, size_t size, struct mp_error *err);

/*
 * Two ways to write n - 2 triangles to p->tri, n >= 4: corner i lies at {xyz[corner[i]][axis[0]],
 * ...[axis[1]]}, the whole counter-clockwise in that plane.
 *
 * The sweep takes O(n log n) time, but knows no answer where the boundary crosses itself;
 * ${*split_up} says whether it found one.
 */
int polygon_sweep(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner, uint32_t n,
		  const int axis[2], bool *split_up, struct mp_error *err);

/* Ears are clipped for as long as there are any, in O(n) work, then what is left is a fan. */
int polygon_clip(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner, uint32_t n,
		 const int axis[2], struct mp_error *err);

#endif
