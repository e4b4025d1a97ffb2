#ifndef MP_UNCERTAINTY_H
#define MP_UNCERTAINTY_H

#include <stdbool.h>
#include <stdint.h>

#include "core/affine/affine.h"
#include "core/decoder.h"
#include "core/topology/topology.h"

/*
 * What the file's own rounding does to the results: no bound, but the standard deviation to expect
 * where every coordinate was rounded by itself, evenly within half a step h of the truth:
 *   sigma^2 = sum over vertices and coordinates (dF/dx * h)^2/3.
 * Over the triangles around a vertex p, n twice the area vector, s the sum of the corners,
 * everything about the centroid:
 *   dV/dp_k = sum n_k/6,  dC_i/dp_k = sum n_k*(s_i + p_i)/(24 V)
 * (the hat function of p integrated over the triangles; the surface's motion along its normal is
 * what changes an integral over the solid).
 */
struct mp_uncertainty {
	enum mp_rounding source; /* UNKNOWN: nothing is defined */
	double volume, mass;     /* [L^3], [M] */
	double centroid;         /* of each coordinate, the largest [L] */
	bool volume_defined, mass_defined, centroid_defined;
};

struct mp_rounded_solid {
	const struct mp_mesh *mesh;
	double min[3], max[3];       /* box of the vertices */
	bool float32;                /* coordinates are rounded to float32, */
	double step;                 /* and to multiples of this before, if > 0 */
	double volume;               /* signed [L^3] */
	double centroid[3];          /* not used where volume is 0 */
	const struct mp_affine *map; /* NULL, or what the results are mapped by, not the above */
};

struct mp_deviation {
	long double volume;      /* [L^3] */
	long double centroid[3]; /* [L]; 0 where the volume is; may be infinite */
};

/*
 * One pass over the triangles (four where vertices are many), 48 bytes a vertex beside the mesh,
 * never more than 40 a triangle.  0, or -1: memory is out.
 */
int mp_uncertainty_find(const struct mp_rounded_solid *, struct mp_deviation *out,
			struct mp_error *err);

#endif
