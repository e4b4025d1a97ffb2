#ifndef MP_STL_WRITE_H
#define MP_STL_WRITE_H

#include <stdbool.h>
#include <stdint.h>

/* Binary STL, written: a head, then facets, each corner three little-endian float32. */
enum { MP_STL_HEAD = 84, MP_STL_FACET = 50 }; /* bytes */

void mp_stl_write_head(uint8_t out[MP_STL_HEAD], uint32_t triangles);

/*
 * Corners relative to ${origin}, each coordinate the float32 nearest to the difference in doubles;
 * the normal is the unit normal of the corners in doubles, 0 0 0 where they have none (collinear,
 * or too small or too large to tell).  false: a coordinate is beyond what float32 holds.
 */
bool mp_stl_write_facet(uint8_t out[MP_STL_FACET], const double corner[3][3],
			const double origin[3]);

#endif
