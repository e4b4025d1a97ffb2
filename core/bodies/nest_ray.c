#include "core/bodies/containment.h"
#include "core/geometry/predicates.h"

/* The sign of (a, b, c) in the plane of axes ${i} and ${j}. */
static int turn(const double *a, const double *b, const double *c, unsigned i, unsigned j)
{
	double p[2] = {a[i], a[j]}, q[2] = {b[i], b[j]}, r[2] = {c[i], c[j]};

	return mp_orient2d(p, q, r);
}

static int sign_of_difference(double a, double b)
{
	return (a > b) - (a < b);
}

/*
 * The side of edge a, b on which p + (e, e^2) lies in the (y, z) plane: where p is on the line,
 * d/de of (b-a) x (p-a) decides, then d/de^2.  0 only where a = b in the plane.
 */
static int turn_perturbed(const double *a, const double *b, const double *p)
{
	int s = turn(a, b, p, 1, 2);

	if (s == 0)
		s = sign_of_difference(a[2], b[2]);
	if (s == 0)
		s = sign_of_difference(b[1], a[1]);
	return s;
}

int mp_ray_crossing(const struct mp_corners *corners, const double p[3])
{
	const double(*tri)[3] = (const double(*)[3])corners->p;
	int s = turn(tri[0], tri[1], tri[2], 1, 2);

	if (s == 0) /* parallel to the ray: the moved ray misses it */
		return 0;
	for (unsigned k = 0; k < 3; k++)
		if (turn_perturbed(tri[k], tri[(k + 1) % 3], p) != s)
			return 0;
	/* The normal's x has sign s, so the plane is met at larger x if p is on its other side. */
	return mp_orient3d(tri[0], tri[1], tri[2], p) == -s ? s : 0;
}

bool mp_on_triangle(const struct mp_corners *corners, const double p[3])
{
	const double(*tri)[3] = (const double(*)[3])corners->p;
	for (unsigned k = 0; k < 3; k++)
		if ((p[k] < tri[0][k] && p[k] < tri[1][k] && p[k] < tri[2][k]) ||
		    (p[k] > tri[0][k] && p[k] > tri[1][k] && p[k] > tri[2][k]))
			return false;
	if (mp_orient3d(tri[0], tri[1], tri[2], p) != 0)
		return false;
	for (unsigned i = 0; i < 3; i++) { /* in any projection that keeps the area, in the plane */
		unsigned j = (i + 1) % 3;
		int s = turn(tri[0], tri[1], tri[2], i, j);

		if (s != 0)
			return turn(tri[0], tri[1], p, i, j) != -s &&
			       turn(tri[1], tri[2], p, i, j) != -s &&
			       turn(tri[2], tri[0], p, i, j) != -s;
	}
	/* No area: a segment, whose box p is in.  Two of its corners differ. */
	return mp_collinear(tri[0], tri[1], p) && mp_collinear(tri[1], tri[2], p);
}
