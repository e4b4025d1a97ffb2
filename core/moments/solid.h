#ifndef MP_SOLID_H
#define MP_SOLID_H

#include "core/moments/moments.h"
#include "core/topology/topology.h"

/* Sums over stored triangles: of one body, or of the whole mesh for the second time. */

/* Add the triangles order[0..count) of ${mesh}, or 0..count where ${order} is NULL. */
void mp_solid_add(struct mp_moments *, const struct mp_mesh *mesh, const uint32_t *order,
		  uint32_t count);

/*
 * Solve ${moments}, the sums over those triangles, and where the result asks for it sum again
 * about a better reference and with scaled axes.  ${closed}: the volume matters too, else only
 * the area does.  ${moments} holds the sums that ${out} was solved from.
 */
void mp_solid_find(struct mp_moments *moments, const struct mp_mesh *mesh, const uint32_t *order,
		   uint32_t count, bool closed, struct mp_solid *out);

#endif
