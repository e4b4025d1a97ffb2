#include "core/intersect/signs.h"

#include <math.h>

#include "core/geometry/predicates.h"

int mp_sign3(struct mp_work *w, const double a[3], const double b[3], const double c[3],
	     const double d[3])
{
	int s = mp_orient3d_filter(a, b, c, d);

	mp_work_spend(w, MP_WORK_SIGN);
	if (s != MP_UNSURE)
		return s;
	mp_work_spend(w, w->exact);
	return mp_orient3d(a, b, c, d);
}

int mp_sign2(struct mp_work *w, const uint8_t axis[2], const double a[3], const double b[3],
	     const double c[3])
{
	const double p[2] = {a[axis[0]], a[axis[1]]}, q[2] = {b[axis[0]], b[axis[1]]},
		     r[2] = {c[axis[0]], c[axis[1]]};
	int s = mp_orient2d_filter(p, q, r);

	mp_work_spend(w, MP_WORK_SIGN);
	if (s != MP_UNSURE)
		return s;
	mp_work_spend(w, w->exact / 4);
	return mp_orient2d(p, q, r);
}

int mp_sign_axes(struct mp_work *w, const double tri[3][3], uint8_t axis[2])
{
	double size[3];
	uint8_t first = 0;

	for (uint8_t k = 0; k < 3; k++) {
		uint8_t i = (uint8_t)((k + 1) % 3), j = (uint8_t)((k + 2) % 3);

		size[k] = fabs((tri[1][i] - tri[0][i]) * (tri[2][j] - tri[0][j]) -
			       (tri[1][j] - tri[0][j]) * (tri[2][i] - tri[0][i]));
		if (size[k] > size[first])
			first = k;
	}
	/* The largest by rounded numbers, which may be wrong: any other will do, too. */
	for (uint8_t n = 0; n < 3; n++) {
		uint8_t k = (uint8_t)((first + n) % 3);
		int s;

		axis[0] = (uint8_t)((k + 1) % 3);
		axis[1] = (uint8_t)((k + 2) % 3);
		s = mp_sign2(w, axis, tri[0], tri[1], tri[2]);
		if (s != 0)
			return s;
	}
	return 0;
}
