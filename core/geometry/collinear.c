#include <math.h>
#include <stdbool.h>

#include "core/geometry/predicates.h"

/*
 * Certainly not 0: a*b - c*d, whose factors are differences of coordinates.  Differences and
 * products have relative errors of 2^-53 each, so 2^-50 of both products is more than enough; the
 * constant is for underflow.  False where something overflowed.
 */
static inline bool differs(double a, double b, double c, double d)
{
	double p = a * b, q = c * d;

	return fabs(p - q) > 0x1p-50 * (fabs(p) + fabs(q)) + 0x1p-1000;
}

size_t mp_collinear_count(const double (*tri)[9], size_t count)
{
	size_t found = 0;

	for (size_t i = 0; i < count; i++) {
		const double *t = tri[i];
		double ux = t[3] - t[0], uy = t[4] - t[1], uz = t[5] - t[2];
		double vx = t[6] - t[0], vy = t[7] - t[1], vz = t[8] - t[2];

		if (!differs(uy, vz, uz, vy) && !differs(uz, vx, ux, vz) &&
		    !differs(ux, vy, uy, vx))
			found += (size_t)mp_collinear(t, t + 3, t + 6);
	}
	return found;
}
