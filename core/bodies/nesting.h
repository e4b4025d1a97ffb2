#ifndef MP_NESTING_H
#define MP_NESTING_H

#include <stdbool.h>
#include <stdint.h>

#include "core/topology/topology.h"

struct mp_box {
	double min[3], max[3];
};

struct mp_nest {
	bool decided; /* false: the work limit was reached, or every vertex lies on the container */
	uint32_t depth;  /* how many closed bodies it lies in */
	uint32_t parent; /* the innermost of them, MP_NO_BODY for none */
};

/*
 * mp_nesting_find(mesh, topology, box, out, err):
 * For every body how many closed bodies contain it, judged at one of its vertices that lies on
 * no candidate: crossings of a ray, every sign exact (mp_orient2d, mp_orient3d).  Only bodies
 * whose box lies in the other's box are candidates.  ${box}, ${out}: topology->bodies entries.
 * Work is bounded (about 10^8 steps); what it does not reach is undecided.
 */
int mp_nesting_find(const struct mp_mesh *mesh, const struct mp_topology *topology,
		    const struct mp_box *box, struct mp_nest *out, struct mp_error *err);

#endif
