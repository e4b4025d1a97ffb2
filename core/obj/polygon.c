#include "core/obj/polygon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/geometry/predicates.h"
#include "core/obj/polygon_private.h"

/*
 * A polygon is flat where it is thinner than this part of its size, and of its largest coordinate,
 * since real files round to 7 digits.
 */
#define FLAT         2e-6
#define FLAT_ROUNDED 2e-6

/* Below this part of its size squared an area is rounding: nothing can be said of the polygon. */
#define NO_AREA 1e-12

/* Products of three lengths in this range neither overflow nor underflow. */
#define SMALL 1e-90
#define LARGE 1e90

/* Corners are numbered in 30 bits. */
enum { MOST = 1 << 30 };

struct shape {
	double normal[3]; /* Newell's: its length is twice the area */
	double size;      /* the longest way along an axis from corner 0 */
	double largest;   /* of the coordinates, about */
	double off;       /* the thickness times the length of the normal */
};

/* Inline where the number of corners is known: nearly all polygons that are no triangles have 4. */
#define INLINE static inline __attribute__((always_inline))

INLINE double larger(double a, double b)
{
	return a > b ? a : b;
}

/* All coordinates times ${scale}, a power of two. */
INLINE void measure(const double (*xyz)[3], const uint32_t *corner, uint32_t n, double scale,
		    struct shape *s)
{
	const double *p = xyz[corner[0]];
	const double o[3] = {p[0] * scale, p[1] * scale, p[2] * scale};
	double a[3] = {0, 0, 0}, low = 0, high = 0;

	memset(s, 0, sizeof *s);
	for (uint32_t i = 1; i < n; i++) {
		double b[3];

		for (int k = 0; k < 3; k++) {
			b[k] = xyz[corner[i]][k] * scale - o[k];
			s->size = fabs(b[k]) > s->size ? fabs(b[k]) : s->size;
		}
		s->normal[0] += a[1] * b[2] - a[2] * b[1];
		s->normal[1] += a[2] * b[0] - a[0] * b[2];
		s->normal[2] += a[0] * b[1] - a[1] * b[0];
		memcpy(a, b, sizeof a);
	}
	for (uint32_t i = 1; i < n; i++) {
		double off = 0;

		p = xyz[corner[i]];
		for (int k = 0; k < 3; k++)
			off += s->normal[k] * (p[k] * scale - o[k]);
		low = off < low ? off : low;
		high = off > high ? off : high;
	}
	s->off = high - low;
	s->largest = s->size + larger(fabs(o[0]), larger(fabs(o[1]), fabs(o[2])));
}

/* A power of two that brings the largest coordinate to about 1, as far as one does. */
static double scale_of(const double (*xyz)[3], const uint32_t *corner, uint32_t n)
{
	double largest = 0;
	int exponent;

	for (uint32_t i = 0; i < n; i++)
		for (int k = 0; k < 3; k++)
			largest = fmax(largest, fabs(xyz[corner[i]][k]));
	(void)frexp(largest, &exponent);
	return ldexp(1.0, exponent < -1000 ? 1000 : -exponent - 1);
}

/* The axes of the plane in which the polygon is looked at; false where it has no area. */
INLINE bool choose_axes(const struct shape *s, int axis[2])
{
	int k = 0;

	for (int l = 1; l < 3; l++)
		if (fabs(s->normal[l]) > fabs(s->normal[k]))
			k = l;
	axis[0] = (k + 1) % 3;
	axis[1] = (k + 2) % 3;
	if (s->normal[k] < 0) {
		axis[0] = (k + 2) % 3;
		axis[1] = (k + 1) % 3;
	}
	return s->normal[k] != 0;
}

/*
 * mp_orient2d(a, b, c) > 0.  Products in this range are normal numbers; four times half an ulp of
 * their sum is more than they and the differences can be off (see core/geometry/predicates.c).
 */
INLINE bool is_left(const double a[2], const double b[2], const double c[2])
{
	double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]);
	double sum = fabs(left) + fabs(right);

	if (sum > 0x1p-960 && sum < 0x1p1020 && left - right > 0x1p-51 * sum)
		return true;
	return mp_orient2d(a, b, c) > 0;
}

/* Are all triangles of the fan from corner ${first} counter-clockwise, none of them flat? */
INLINE bool is_good_fan(const double (*xyz)[3], const uint32_t *corner, uint32_t n, uint32_t first,
			const int axis[2])
{
	double point[3][2];

	for (uint32_t i = 0, at = first; i < n; i++, at = at + 1 < n ? at + 1 : 0) {
		double *p = point[i == 0 ? 0 : 1 + i % 2];

		p[0] = xyz[corner[at]][axis[0]];
		p[1] = xyz[corner[at]][axis[1]];
		if (i >= 2 && !is_left(point[0], point[1 + (i - 1) % 2], p))
			return false;
	}
	return true;
}

INLINE int fan(struct mp_polygon *p, uint32_t n, uint32_t first)
{
	uint32_t at = first + 1; /* first is 0 or 1, n at least 3 */

	for (uint32_t i = 0; i < n - 2; i++) {
		p->tri[i][0] = first;
		p->tri[i][1] = at;
		p->tri[i][2] = at = at + 1 < n ? at + 1 : 0;
	}
	return 0;
}

/* Some to spare, but not of what is large. */
static size_t generous(size_t size)
{
	return size < (size_t)1 << 20 ? 2 * size : size;
}

static int reserve(struct mp_polygon *p, uint32_t n, struct mp_error *err)
{
	size_t room = generous(n);
	void *new;

	if (p->tri_room >= n)
		return 0;
	if (room > SIZE_MAX / sizeof *p->tri ||
	    (new = realloc(p->tri, room * sizeof *p->tri)) == NULL)
		return mp_fail_nomem(err);
	p->tri = new;
	p->tri_room = room;
	return 0;
}

void *polygon_room(struct mp_polygon *p, size_t size, struct mp_error *err)
{
	if (p->work_size < size) {
		free(p->work);
		p->work = malloc(generous(size));
		p->work_size = p->work != NULL ? generous(size) : 0;
	}
	if (p->work == NULL)
		(void)mp_fail_nomem(err);
	return p->work;
}

INLINE double twice_area(const struct shape *s)
{
	return sqrt(s->normal[0] * s->normal[0] + s->normal[1] * s->normal[1] +
		    s->normal[2] * s->normal[2]);
}

INLINE bool is_nonplanar(const struct shape *s, double area)
{
	return s->off > area * (FLAT * s->size + FLAT_ROUNDED * s->largest);
}

/* The magnitude of ${n} is more than that of ${than}. */
INLINE bool exceeds(double n, double than)
{
	return fabs(n) > fabs(than);
}

INLINE double largest3(double x, double y, double z)
{
	return larger(larger(fabs(x), fabs(y)), fabs(z));
}

/*
 * The steps of mp_polygon_split() as far as they go without a detour: the figures are the same as
 * measure()'s, in single variables since arrays would pass through memory.  A turn is certain where
 * its component along the axis is more than 2^-49 size^2: both products in it are at most size^2,
 * rounded three times each.
 */
bool mp_polygon_usual_quad(const double (*xyz)[3], const uint32_t corner[4], bool *nonplanar)
{
	const double *o = xyz[corner[0]];
	const double *p = xyz[corner[1]], *q = xyz[corner[2]], *r = xyz[corner[3]];
	double px = p[0] - o[0], py = p[1] - o[1], pz = p[2] - o[2];
	double qx = q[0] - o[0], qy = q[1] - o[1], qz = q[2] - o[2];
	double rx = r[0] - o[0], ry = r[1] - o[1], rz = r[2] - o[2];
	double ax = py * qz - pz * qy, ay = pz * qx - px * qz, az = px * qy - py * qx;
	double bx = qy * rz - qz * ry, by = qz * rx - qx * rz, bz = qx * ry - qy * rx;
	double nx = ax + bx, ny = ay + by, nz = az + bz;
	double poff = nx * px + ny * py + nz * pz, qoff = nx * qx + ny * qy + nz * qz;
	double roff = nx * rx + ny * ry + nz * rz;
	double n = nx, a = ax, b = bx, certain;
	struct shape s = {.normal = {nx, ny, nz}};

	s.size = larger(largest3(px, py, pz), larger(largest3(qx, qy, qz), largest3(rx, ry, rz)));
	s.largest = s.size + largest3(o[0], o[1], o[2]);
	if (exceeds(ny, n)) {
		n = ny;
		a = ay;
		b = by;
	}
	if (exceeds(nz, n)) {
		n = nz;
		a = az;
		b = bz;
	}
	certain = 0x1p-49 * s.size * s.size;
	if (!(s.size > SMALL && s.largest < LARGE) ||
	    (n < 0 ? !(a < -certain && b < -certain) : !(a > certain && b > certain)))
		return false;
	s.off = larger(larger(poff, 0), larger(qoff, roff)) +
		larger(larger(-poff, 0), larger(-qoff, -roff));
	*nonplanar = is_nonplanar(&s, twice_area(&s));
	return true;
}

int mp_polygon_split(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner,
		     uint32_t n, struct mp_error *err)
{
	struct shape s;
	double area;
	int axis[2];
	bool done = false;

	p->nonplanar = p->tangled = false;
	if (n >= MOST)
		return mp_fail_nomem(err);
	if (reserve(p, n, err))
		return -1;
	if (n == 3)
		return fan(p, n, 0);
	measure(xyz, corner, n, 1, &s);
	if (!(s.size > SMALL && s.largest < LARGE))
		measure(xyz, corner, n, scale_of(xyz, corner, n), &s);
	if (!choose_axes(&s, axis))
		return fan(p, n, 0);
	area = twice_area(&s);
	p->nonplanar = is_nonplanar(&s, area);
	if (is_good_fan(xyz, corner, n, 0, axis))
		return fan(p, n, 0);
	if (n == 4 && is_good_fan(xyz, corner, n, 1, axis))
		return fan(p, n, 1);
	if (polygon_sweep(p, xyz, corner, n, axis, &done, err))
		return -1;
	if (!done && polygon_clip(p, xyz, corner, n, axis, err))
		return -1;
	if (area < NO_AREA * s.size * s.size)
		p->nonplanar = p->tangled = false;
	return 0;
}

void mp_polygon_free(struct mp_polygon *p)
{
	free(p->tri);
	free(p->work);
	memset(p, 0, sizeof *p);
}
