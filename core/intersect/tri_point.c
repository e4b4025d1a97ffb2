#include <math.h>

#include "core/intersect/tri_pair.h"

/* Height over the plane of ${t}, times twice its area, rounded; scaled so that nothing overflows.
 */
static double height(const struct mp_tri *t, const double x[3], double scale)
{
	double u[3], v[3], d[3], sum = 0;

	for (unsigned k = 0; k < 3; k++) {
		u[k] = t->p[1][k] * scale - t->p[0][k] * scale;
		v[k] = t->p[2][k] * scale - t->p[0][k] * scale;
		d[k] = x[k] * scale - t->p[0][k] * scale;
	}
	for (unsigned k = 0; k < 3; k++) {
		unsigned i = (k + 1) % 3, j = (k + 2) % 3;

		sum += d[k] * (u[i] * v[j] - u[j] * v[i]);
	}
	return sum;
}

/* 1 over the power of two that the largest coordinate is below. */
static double scale_of(const struct mp_tri *t, const struct mp_tri *u)
{
	double largest = 0;
	int e;

	for (unsigned i = 0; i < 3; i++)
		for (unsigned k = 0; k < 3; k++)
			largest = fmax(largest, fmax(fabs(t->p[i][k]), fabs(u->p[i][k])));
	(void)frexp(largest, &e);
	return ldexp(1, e > 1000 ? -e + 1 : e < -1000 ? 1000 : -e);
}

/* The point of segment p, q where ${f} of ${t}, 0 on the way, says so. */
static void cut(const double p[3], const double q[3], double at_p, double at_q, double out[3])
{
	double all = at_p - at_q, part = all != 0 ? at_p / all : 0.5;

	part = part >= 0 ? fmin(part, 1) : part < 0 ? 0 : 0.5;
	for (unsigned k = 0; k < 3; k++) {
		double x = p[k] * (1 - part) + q[k] * part;

		out[k] = fmin(fmax(x, fmin(p[k], q[k])), fmax(p[k], q[k])) + 0.0;
	}
}

/* Where edge p, q crosses edge r, s: in the projection in which they are the least parallel. */
static void cross(const double p[3], const double q[3], const double r[3], const double s[3],
		  double scale, double out[3])
{
	double best = -1, at_p = 0, at_q = 0;

	for (unsigned k = 0; k < 3; k++) {
		unsigned i = (k + 1) % 3, j = (k + 2) % 3;
		double dx = (s[i] * scale - r[i] * scale), dy = (s[j] * scale - r[j] * scale);
		double a = dx * (p[j] - r[j]) * scale - dy * (p[i] - r[i]) * scale;
		double b = dx * (q[j] - r[j]) * scale - dy * (q[i] - r[i]) * scale;

		if (fabs(a - b) > best) {
			best = fabs(a - b);
			at_p = a;
			at_q = b;
		}
	}
	cut(p, q, at_p, at_q, out);
}

void mp_tri_point(const struct mp_tri *t, const struct mp_tri *u, const struct mp_meeting *m,
		  unsigned i, double out[3])
{
	unsigned a = m->place[i][0], b = m->place[i][1];
	double scale = scale_of(t, u);
	const struct mp_tri *with = a < 3 || (a < MP_ON_FACE && b >= MP_ON_EDGE) ? t : u;
	unsigned corner = a < 3 ? a : b < 3 ? b : 3, edge = with == t ? a - 3 : b - 3;

	if (corner < 3) {
		for (unsigned k = 0; k < 3; k++)
			out[k] = (a < 3 ? t : u)->p[corner][k] + 0.0;
	} else if (a < MP_ON_FACE && b < MP_ON_FACE) {
		cross(t->p[a - 3], t->p[(a - 2) % 3], u->p[b - 3], u->p[(b - 2) % 3], scale, out);
	} else {
		const struct mp_tri *plane = with == t ? u : t;
		const double *p = with->p[edge], *q = with->p[(edge + 1) % 3];

		cut(p, q, height(plane, p, scale), height(plane, q, scale), out);
	}
}
