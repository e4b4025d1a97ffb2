#ifndef MP_MASS_H
#define MP_MASS_H

#include "core/moments/moments.h"
#include "core/report/report.h"

/*
 * From the geometry of a solid (density 1, long double) to masses and inertia tensors in doubles.
 * Functions return false, with the output all 0, where a double cannot hold the result.
 */
struct mp_density {
	bool asked;        /* else value is 1 and masses are volumes */
	bool defined;      /* false: a weighed mass over a volume that is 0 or undefined */
	bool weighed;      /* the mass of the whole was given, exactly ${mass} */
	double mass;       /* [M] */
	long double value; /* [M/L^3] */
	long double bound; /* value is at most this far from what was asked; not if weighed */
};

/*
 * density/divisor, with the error that the division adds to a relative ${error} of the two.
 * ${divisor} 0 counts as 1.
 */
struct mp_ball mp_density_ball(double density, double divisor, double error);

/* The mass of the whole, which is ${solid}, with its error. */
struct mp_ball mp_mass_ball(const struct mp_solid *solid, const struct mp_density *density);

/* Put the mass in the place of the volume, which becomes positive. */
void mp_mass_weigh(struct mp_solid *solid, struct mp_ball density);

/* x as a double: false if too large, or not 0 and below the normal range. */
bool mp_in_range(long double x, double *out);

/*
 * Fill ${out} from ${solid}.  ${closed}: its volume means something (closed, or cracks only).
 * false: some field that is defined by the mesh is not for want of range.
 */
bool mp_mass_fill(struct mp_mass *out, const struct mp_solid *solid, bool closed,
		  const struct mp_density *density);

/*
 * Tensor of a mass of ${mass} about the point from which the centroid lies at ${r} [L]:
 * mass*(tr(E) 1 - E), E = cov + r r^T; [0][1] = -integral of density*x*y.
 */
bool mp_mass_inertia(const struct mp_solid *solid, long double mass, const long double r[3],
		     double out[3][3]);

/* Moment about the line through ${origin} along ${direction} (any length > 0). */
bool mp_mass_axis(const struct mp_solid *solid, long double mass, const double origin[3],
		  const double direction[3], struct mp_axis_moment *out);

#endif
