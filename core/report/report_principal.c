#include <float.h>
#include <math.h>
#include <string.h>

#include "core/moments/mass.h"
#include "core/report/report_parts.h"

/* Moments that agree to this part of the largest are one, even where they are told apart. */
#define SAME_MOMENT 1e-14

void mp_report_principal(struct mp_report *r, double tensor, struct mp_ball mass)
{
	const double(*inertia)[3] = (const double(*)[3])r->total.inertia;
	double norm = 0, tolerance = 2 * tensor;

	for (int i = 0; i < 3; i++)
		norm = fmax(norm, fabs(inertia[i][i]));
	tolerance = fmin(fmax(tolerance, SAME_MOMENT * norm), DBL_MAX);
	mp_principal_find(inertia, tolerance, &r->principal);
	if (!isfinite(r->principal.moments[2])) {
		memset(&r->principal, 0, sizeof r->principal);
		memset(r->total.inertia, 0, sizeof r->total.inertia);
		r->total.inertia_defined = false;
		mp_warn(r, MP_WARN_OUT_OF_RANGE, true);
		return;
	}
	r->radii_defined = true;
	for (int k = 0; k < 3; k++) {
		long double square = r->principal.moments[k] / mass.mid;

		if (square < 0 && r->principal.moments[k] >= -tolerance)
			square = 0; /* a needle's smallest moment is lost in the rounding */
		r->radii_defined = r->radii_defined && square >= 0 &&
				   mp_in_range(sqrtl(square), &r->radii_of_gyration[k]);
	}
	if (!r->radii_defined)
		memset(r->radii_of_gyration, 0, sizeof r->radii_of_gyration);
}
