#ifndef MP_UNCERTAINTY_H
#define MP_UNCERTAINTY_H

#include <stdbool.h>
#include <stdint.h>

#include "core/affine/affine.h"
#include "core/decoder.h"
#include "core/moments/uncertainty_kernel.h"
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
 * mp_uncertainty_begin(state, solid):
 * ${solid}: all but volume and centroid must be right, which may be 0 or a guess.  Its mesh is used
 * until end(); ${state} must not move.  state->watcher is for a copy of the mesh that goes through
 * mp_topology_find(): then nearly every mesh is done as a by-product.
 */
struct mp_uncertainty_state {
	struct mp_links_sink watcher;
	const struct mp_mesh *mesh;
	double row_scale[3]; /* a row's derivatives times this are those wanted */
	const struct mp_deviation_kernel *kernel;
	struct mp_deviation_frame frame;
	struct mp_deviation_sums *window; /* of each, while they are looked at */
	size_t windows;
	struct mp_deviation_sums sums; /* of all, one after the other, whoever was done first */
	bool seen;                     /* they are there */
};
void mp_uncertainty_begin(struct mp_uncertainty_state *, const struct mp_rounded_solid *);

/*
 * mp_uncertainty_end(state, solid, out, err):
 * ${solid}: as for begin(), with the volume and the centroid.  If some vertices were not seen all
 * are looked at, with 24 bytes a triangle and 4 a vertex beside the mesh for a moment.  0, or -1:
 * memory is out.
 */
int mp_uncertainty_end(struct mp_uncertainty_state *, const struct mp_rounded_solid *,
		       struct mp_deviation *out, struct mp_error *err);

/* Both at once. */
int mp_uncertainty_find(const struct mp_rounded_solid *, struct mp_deviation *out,
			struct mp_error *err);

#endif
