#ifndef MP_ORIENT_H
#define MP_ORIENT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/topology/topology.h"

struct mp_oriented {
	uint64_t turned; /* triangles */
	bool closed;     /* the mesh encloses a volume now: closed, or open along cracks only */
	uint64_t
	    *one_sided;     /* a bit per triangle that is of a sheet with one side; NULL: none is */
	long double volume; /* [L^3] of the mesh as it is now; 0 unless closed and in range */
};

/*
 * mp_orient(vertices, tri, triangles, out, err):
 * Wind ${tri} alike: every sheet (sides.h) in itself, by turning as few of its triangles as will
 * do; then each that is closed outward, or inward where it lies in an odd number of others
 * (nesting.h).  Sheets with one side only are left as they are, and open ones, for which there is
 * no outside, as most of their triangles are; so are those of volume 0 and those whose
 * nesting is not decided.  Winding is swapping the second and third corner.  About 60 bytes a
 * triangle for a moment.  -1: memory is out, nothing to free; ${tri} is then of no use.
 */
int mp_orient(const struct mp_vertices *vertices, uint32_t (*tri)[3], uint32_t triangles,
	      struct mp_oriented *out, struct mp_error *err);
void mp_oriented_free(struct mp_oriented *); /* legal on a zeroed struct */

#endif
