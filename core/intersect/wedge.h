#ifndef MP_WEDGE_H
#define MP_WEDGE_H

#include "core/intersect/signs.h"

/*
 * Two solids round a line that lies in the surfaces of both, seen along the line: each fills the
 * sector between two half-planes, given by points on them.
 */
struct mp_wedge {
	const double *from, *to; /* filled counter-clockwise, seen against the direction p to q */
};

enum {
	MP_WEDGE_BOTH = 1,  /* some of the space round the line is in both */
	MP_WEDGE_FIRST = 2, /* some is in the first alone */
	MP_WEDGE_SECOND = 4 /* some is in the second alone */
};

/* Exact.  0: no answer, because a half-plane is none or a sector is empty or everything. */
unsigned mp_wedge_compare(struct mp_work *, const double p[3], const double q[3],
			  const struct mp_wedge *first, const struct mp_wedge *second);

#endif
