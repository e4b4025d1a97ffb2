#ifndef MP_TWINS_H
#define MP_TWINS_H

#include "core/topology/topology.h"

/*
 * Which triangle is on the other side of an edge: half-edges in rows by their smaller vertex.
 * Half-edge 3*t + k runs from corner k of triangle t to the next.
 */
struct mp_twins {
	uint32_t *row;  /* vertices + 1 */
	uint32_t *list; /* half-edges */
};

#define MP_NO_TWIN UINT32_MAX

/* -1: memory is out, and nothing to free.  12 bytes a triangle and 4 a vertex. */
int mp_twins_build(const struct mp_mesh *, struct mp_twins *);
void mp_twins_free(struct mp_twins *); /* legal on a zeroed struct */

/*
 * The other half-edge of this one's edge; MP_NO_TWIN where there is none, or several, or it runs
 * the same way.  ${steps}: half-edges looked at are added.
 */
uint32_t mp_twin_of(const struct mp_twins *, const struct mp_mesh *, uint32_t half,
		    uint64_t *steps);

#endif
