#include "core/moments/principal.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/moments/ball.h"
#include "core/moments/principal_error.h"

/* Jacobi converges quadratically; six sweeps do for any 3x3, the rest is for peace of mind. */
enum { SWEEPS = 40 };
#define NOTHING 1e-200

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Entries of ${v} are of the order of 1. */
static void normalise(double v[3])
{
	double length = sqrt(dot(v, v));

	for (int k = 0; k < 3; k++)
		v[k] = v[k] / length + 0.0; /* + 0.0: no -0 */
}

/* One rotation in the plane p, q: a[p][q] becomes 0.  Golub and Van Loan, section 8.5. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
	double theta = (a[q][q] - a[p][p]) / 2 / a[p][q];
	double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
	double c, s, apq = a[p][q];
	int r = 3 - p - q;
	double arp = a[r][p], arq = a[r][q];

	c = 1 / sqrt(t * t + 1); /* theta may be so large that t is 0: nothing left to turn */
	s = t * c;
	a[p][p] -= t * apq;
	a[q][q] += t * apq;
	a[p][q] = a[q][p] = 0;
	a[r][p] = a[p][r] = c * arp - s * arq;
	a[r][q] = a[q][r] = s * arp + c * arq;
	for (int k = 0; k < 3; k++) { /* rows of v are the axes */
		double vp = v[p][k], vq = v[q][k];

		v[p][k] = c * vp - s * vq;
		v[q][k] = s * vp + c * vq;
	}
}

/* Diagonalise.  Entries are of the order of 1: what is below NOTHING cannot turn an axis. */
static void jacobi(double a[3][3], double v[3][3])
{
	static const int PAIR[3][2] = {{0, 1}, {0, 2}, {1, 2}};

	for (int sweep = 0, left = 1; left > 0 && sweep < SWEEPS; sweep++) {
		left = 0;
		for (int i = 0; i < 3; i++) {
			int p = PAIR[i][0], q = PAIR[i][1];

			if (fabs(a[p][q]) < NOTHING)
				continue;
			left++;
			rotate(a, v, p, q);
		}
	}
}

static void swap_rows(double moments[3], double v[3][3], int i, int j)
{
	double row[3], moment = moments[i];

	if (moments[i] <= moments[j])
		return;
	moments[i] = moments[j];
	moments[j] = moment;
	memcpy(row, v[i], sizeof row);
	memcpy(v[i], v[j], sizeof row);
	memcpy(v[j], row, sizeof row);
}

/* The component of largest magnitude, the first of equal ones, becomes positive. */
static void set_sign(double v[3])
{
	int top = 0;

	for (int k = 1; k < 3; k++)
		if (fabs(v[k]) > fabs(v[top]))
			top = k;
	for (int k = 0; k < 3; k++)
		v[k] = (v[top] < 0 && k != top ? -v[k] : v[k]) + 0.0;
	v[top] = fabs(v[top]);
}

/* Unit vector across ${axis} nearest to world X, or to Y where X is nearly along the axis. */
static void free_axis(const double axis[3], double out[3])
{
	int world = fabs(axis[0]) > 0.9 ? 1 : 0;

	for (int k = 0; k < 3; k++)
		out[k] = (k == world ? 1.0 : 0.0) - axis[world] * axis[k];
	normalise(out);
}

static void across(const double axis[3], double v[3]) /* Gram and Schmidt, once is enough here */
{
	double along = dot(axis, v);

	for (int k = 0; k < 3; k++)
		v[k] -= along * axis[k];
	normalise(v);
}

static void set_axes(struct mp_principal *out, int distinct)
{
	double(*e)[3] = out->axes;

	for (int i = 0; i < 3; i++)
		normalise(e[i]);
	if (distinct == 2) {
		free_axis(e[2], e[0]);
		cross(e[2], e[0], e[1]);
	} else if (distinct == 0) {
		free_axis(e[0], e[1]);
	}
	set_sign(e[0]);
	across(e[0], e[1]);
	set_sign(e[1]);
	cross(e[0], e[1], e[2]);
	normalise(e[2]);
}

/* Shepperd 1978: divide by the largest component.  The rotation's columns are the axes. */
static void set_quaternion(struct mp_principal *out)
{
	double(*e)[3] = out->axes, *q = out->quaternion;
	double trace = e[0][0] + e[1][1] + e[2][2], four;
	int top = 0;

	for (int k = 1; k < 3; k++)
		if (e[k][k] > e[top][top])
			top = k;
	if (trace >= e[top][top]) {
		q[0] = sqrt(1 + trace) / 2;
		four = 4 * q[0];
		q[1] = (e[1][2] - e[2][1]) / four;
		q[2] = (e[2][0] - e[0][2]) / four;
		q[3] = (e[0][1] - e[1][0]) / four;
	} else {
		int j = (top + 1) % 3, k = (top + 2) % 3;

		q[1 + top] = sqrt(1 + 2 * e[top][top] - trace) / 2;
		four = 4 * q[1 + top];
		q[0] = (e[j][k] - e[k][j]) / four;
		q[1 + j] = (e[top][j] + e[j][top]) / four;
		q[1 + k] = (e[top][k] + e[k][top]) / four;
	}
	for (int k = 3; k >= 0; k--)
		q[k] = (q[0] < 0 ? -q[k] : q[k]) + 0.0;
}

static void world_axes(struct mp_principal *out)
{
	static const double WORLD[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

	memcpy(out->axes, WORLD, sizeof WORLD);
}

/* Which axis stands alone: sets the class; -1 where none or all do. */
static int classify(struct mp_principal *out, const double moments[3], double tolerance)
{
	bool low = moments[1] - moments[0] <= tolerance,
	     high = moments[2] - moments[1] <= tolerance;

	out->symmetry = low && high   ? MP_SYMMETRY_SPHERICAL
			: low || high ? MP_SYMMETRY_AXIAL
				      : MP_SYMMETRY_NONE;
	return low == high ? -1 : low ? 2 : 0;
}

/* As much as scaling may have eaten of entries that are tiny beside the others, and of moments. */
#define SCALED_AWAY 0x1p-1000L

static double unscaled(long double x, int exponent)
{
	return mp_round_up(ldexpl(x + SCALED_AWAY, -exponent) + 2 * DBL_TRUE_MIN);
}

void mp_principal_find(const double inertia[3][3], double tolerance, struct mp_principal *out)
{
	double a[3][3], scaled[3][3], moments[3], largest = 0;
	const double(*fixed)[3] = (const double(*)[3])scaled;
	int exponent = 0, distinct;

	memset(out, 0, sizeof *out);
	for (int i = 0; i < 9; i++)
		largest = fmax(largest, fabs(inertia[i / 3][i % 3]));
	if (largest > 0)
		exponent = -ilogb(largest) - 2; /* entries below 1/2: nothing overflows */
	for (int i = 0; i < 9; i++)
		a[i / 3][i % 3] = scaled[i / 3][i % 3] = ldexp(inertia[i / 3][i % 3], exponent);
	world_axes(out);
	jacobi(a, out->axes);
	for (int k = 0; k < 3; k++)
		moments[k] = a[k][k];
	swap_rows(moments, out->axes, 0, 1);
	swap_rows(moments, out->axes, 1, 2);
	swap_rows(moments, out->axes, 0, 1);
	out->error =
	    unscaled(mp_principal_error(fixed, (const double(*)[3])out->axes, moments), exponent);
	distinct = classify(out, moments, ldexp(tolerance, exponent));
	if (out->symmetry == MP_SYMMETRY_SPHERICAL)
		world_axes(out);
	set_axes(out, distinct);
	set_quaternion(out);
	for (int k = 0; k < 3; k++) {
		out->moments[k] = ldexp(moments[k], -exponent) + 0.0;
		out->residual[k] =
		    unscaled(mp_principal_residual(fixed, out->axes[k], moments[k]), exponent);
	}
}
