#include "core/geometry/predicates.h"

#include <math.h>
#include <stdbool.h>

#include "core/geometry/predicates_exact.h"

/*
 * Half an ulp of 1.  Shewchuk's filters are (3 + 16 EPS) EPS and (7 + 56 EPS) EPS times the sum of
 * the magnitudes; the next whole number is taken, and what that adds covers products that fell
 * below the normal range, given the range tests next to the uses.
 */
#define EPS 0x1p-53

static int sign(double x)
{
	return (x > 0) - (x < 0);
}

/*
 * orient2d where rounding cannot matter, else MP_UNSURE.  The sign of a difference of doubles is
 * always exact (gradual underflow), hence so are the signs of the two products; only where both
 * are the same does the magnitude decide.
 */
static int filter2d(double ax, double ay, double bx, double by, double cx, double cy)
{
	double acx = ax - cx, acy = ay - cy, bcx = bx - cx, bcy = by - cy;
	double left = acx * bcy, right = acy * bcx;
	int s = sign(acx) * sign(bcy), t = sign(acy) * sign(bcx);
	double sum = fabs(left + right);

	if (s != t)
		return s > t ? 1 : -1;
	if (s == 0)
		return 0;
	/* The differences may be infinite: the comparisons below are then false. */
	if (sum > 0x1p-960 && sum < 0x1p1020 && fabs(left - right) > 4 * EPS * sum)
		return sign(left - right);
	return MP_UNSURE;
}

int mp_orient2d_filter(const double a[2], const double b[2], const double c[2])
{
	return filter2d(a[0], a[1], b[0], b[1], c[0], c[1]);
}

int mp_orient2d(const double a[2], const double b[2], const double c[2])
{
	int s = filter2d(a[0], a[1], b[0], b[1], c[0], c[1]);

	return s != MP_UNSURE ? s : mp_exact_orient2d(a, b, c);
}

static bool same(const double a[3], const double b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* The frequent exact zeros: a point repeated, or all four in a plane across an axis. */
static bool plainly_coplanar(const double a[3], const double b[3], const double c[3],
			     const double d[3])
{
	for (int k = 0; k < 3; k++)
		if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k])
			return true;
	return same(a, b) || same(a, c) || same(b, c) || same(d, a) || same(d, b) || same(d, c);
}

int mp_orient3d_filter(const double a[3], const double b[3], const double c[3], const double d[3])
{
	double u[3], v[3], w[3], det = 0, sum = 0, largest = 0;

	for (int k = 0; k < 3; k++) {
		u[k] = b[k] - a[k];
		v[k] = c[k] - a[k];
		w[k] = d[k] - a[k];
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		double left = u[i] * v[j], right = u[j] * v[i];

		det += w[k] * (left - right);
		sum += fabs(w[k]) * (fabs(left) + fabs(right));
		if (fabs(w[k]) > largest)
			largest = fabs(w[k]);
	}
	/* An underflow in left or right, 2^-1075, is multiplied by w: hence both limits. */
	if (sum > 0x1p-700 && largest < 0x1p300 && fabs(det) > 8 * EPS * sum)
		return sign(det);
	return plainly_coplanar(a, b, c, d) ? 0 : MP_UNSURE;
}

int mp_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
	int s = mp_orient3d_filter(a, b, c, d);

	return s != MP_UNSURE ? s : mp_exact_orient3d(a, b, c, d);
}

int mp_collinear(const double a[3], const double b[3], const double c[3])
{
	bool sure = true;

	/* One projection that is certainly not flat is enough: try all cheap tests first. */
	for (int k = 0; k < 3; k++) {
		int l = (k + 1) % 3;
		int s = filter2d(a[k], a[l], b[k], b[l], c[k], c[l]);

		if (s == 1 || s == -1)
			return 0;
		sure = sure && s == 0;
	}
	for (int k = 0; k < 3 && !sure; k++) {
		int l = (k + 1) % 3;
		double p[2] = {a[k], a[l]}, q[2] = {b[k], b[l]}, r[2] = {c[k], c[l]};

		if (mp_orient2d(p, q, r) != 0)
			return 0;
	}
	return 1;
}
