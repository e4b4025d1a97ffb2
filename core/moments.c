#include "core/moments.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "core/decoder.h"

enum { LANES = 8 };

/* Partial sums of a block, a lane each.  The order of the members is that of struct mp_moments. */
struct lanes {
	double a0[LANES], a1[3][LANES], a2[6][LANES], magnitude[LANES];
	double n[3][LANES], area2[LANES], area_s[3][LANES];
	double min[3][LANES], max[3][LANES];
};

static void sum_add(struct mp_sum *sum, double x)
{
	double s = sum->hi + x; /* TwoSum, Knuth: s + error == hi + x exactly */
	double part = s - sum->hi;

	sum->lo += (sum->hi - (s - part)) + (x - part);
	sum->hi = s;
}

/* Always this order; a kernel with vectors of 8, 4 or 2 folds upper half onto lower half. */
static double fold(const double l[LANES])
{
	return ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]));
}

static double smaller(double a, double b)
{
	return a < b ? a : b;
}

static double larger(double a, double b)
{
	return a > b ? a : b;
}

void mp_moments_begin(struct mp_moments *m)
{
	memset(m, 0, sizeof *m);
	for (int k = 0; k < 3; k++)
		m->scale[k] = 1.0;
}

/*
 * Exponent that brings the extent of axis ${k} below 1: |q| <= extent < 2^(e+2), e that of its
 * half (the extent itself may be infinite).  INT_MAX where the box has no extent there.
 */
static int axis_exponent(const struct mp_moments *first, int k)
{
	double half = first->max[k] / 2 - first->min[k] / 2;

	if (first->max[k] > first->min[k] && half < DBL_MIN)
		return DBL_MAX_EXP - 1;
	if (!(half > 0))
		return INT_MAX;
	return -(ilogb(half) + 2) < DBL_MAX_EXP ? -(ilogb(half) + 2) : DBL_MAX_EXP - 1;
}

/* A flat axis takes the largest factor of the others, so that areas are not scaled away. */
static void set_scale(struct mp_moments *m, const struct mp_moments *first)
{
	int exponent[3], top = INT_MIN;

	for (int k = 0; k < 3; k++) {
		exponent[k] = axis_exponent(first, k);
		if (exponent[k] != INT_MAX && exponent[k] > top)
			top = exponent[k];
	}
	for (int k = 0; k < 3; k++) {
		if (exponent[k] == INT_MAX) {
			exponent[k] = top == INT_MIN ? 0 : top;
			if (first->max[k] != 0 && exponent[k] + ilogb(first->max[k]) > 1000)
				exponent[k] = 1000 - ilogb(first->max[k]);
		}
		m->scale[k] = ldexp(1.0, exponent[k]);
	}
}

void mp_moments_begin_again(struct mp_moments *m, const struct mp_moments *first)
{
	double area2 = first->area2.hi + first->area2.lo;

	mp_moments_begin(m);
	set_scale(m, first);
	for (int k = 0; k < 3; k++) {
		double s = first->area_s[k].hi + first->area_s[k].lo;
		double at = first->reference[k] + s / area2 / 3 / first->scale[k];

		if (!isfinite(at))
			at = first->min[k] / 2 + first->max[k] / 2;
		m->reference[k] = smaller(larger(at, first->min[k]), first->max[k]);
	}
	m->started = true;
}

/*
 * v: the corners, [corner*3 + axis][lane].  Widen the box by them, then scale them.
 * In this and the next function the lanes are the inner loop, so that it becomes vectors.
 */
static void add_box(struct lanes *restrict l, double (*restrict v)[LANES], const double scale[3])
{
	for (int k = 0; k < 3; k++) {
		double factor = scale[k];

		for (int j = 0; j < LANES; j++) {
			double a = v[k][j], b = v[3 + k][j], c = v[6 + k][j];

			l->min[k][j] = smaller(smaller(a, b), smaller(c, l->min[k][j]));
			l->max[k][j] = larger(larger(a, b), larger(c, l->max[k][j]));
			v[k][j] = a * factor;
			v[3 + k][j] = b * factor;
			v[6 + k][j] = c * factor;
		}
	}
}

/* Edges come from the vertices themselves, not from q: far from the reference q is rounded. */
static void add_group(struct lanes *restrict l, double (*restrict v)[LANES], const double origin[3],
		      const double weight[3])
{
	double ox = origin[0], oy = origin[1], oz = origin[2];
	double weight_x = weight[0], weight_y = weight[1], weight_z = weight[2];

	for (int j = 0; j < LANES; j++) {
		double ex = v[3][j] - v[0][j], ey = v[4][j] - v[1][j], ez = v[5][j] - v[2][j];
		double fx = v[6][j] - v[0][j], fy = v[7][j] - v[1][j], fz = v[8][j] - v[2][j];
		double ax = v[0][j] - ox, ay = v[1][j] - oy, az = v[2][j] - oz;
		double bx = v[3][j] - ox, by = v[4][j] - oy, bz = v[5][j] - oz;
		double cx = v[6][j] - ox, cy = v[7][j] - oy, cz = v[8][j] - oz;
		double yz = ey * fz, zy = ez * fy, zx = ez * fx;
		double xz = ex * fz, xy = ex * fy, yx = ey * fx;
		double nx = yz - zy, ny = zx - xz, nz = xy - yx;
		double d = (ax * nx + ay * ny) + az * nz;
		double ux = ax + bx, uy = ay + by, uz = az + bz;
		double vx = bx + cx, vy = by + cy, vz = bz + cz;
		double wx = cx + ax, wy = cy + ay, wz = cz + az;
		double sx = ax + vx, sy = ay + vy, sz = az + vz;
		double mx = nx * weight_x, my = ny * weight_y, mz = nz * weight_z;
		double area2 = sqrt((mx * mx + my * my) + mz * mz);

		l->a0[j] += d;
		l->a1[0][j] += d * sx;
		l->a1[1][j] += d * sy;
		l->a1[2][j] += d * sz;
		l->a2[0][j] += d * ((ux * ux + wx * wx) + vx * vx);
		l->a2[1][j] += d * ((uy * uy + wy * wy) + vy * vy);
		l->a2[2][j] += d * ((uz * uz + wz * wz) + vz * vz);
		l->a2[3][j] += d * ((ux * uy + wx * wy) + vx * vy);
		l->a2[4][j] += d * ((uy * uz + wy * wz) + vy * vz);
		l->a2[5][j] += d * ((uz * ux + wz * wx) + vz * vx);
		l->magnitude[j] +=
		    (fabs(ax) * (fabs(yz) + fabs(zy)) + fabs(ay) * (fabs(zx) + fabs(xz))) +
		    fabs(az) * (fabs(xy) + fabs(yx));
		l->n[0][j] += nx;
		l->n[1][j] += ny;
		l->n[2][j] += nz;
		l->area2[j] += area2;
		l->area_s[0][j] += area2 * sx;
		l->area_s[1][j] += area2 * sy;
		l->area_s[2][j] += area2 * sz;
	}
}

static void add_lanes(struct mp_moments *m, const struct lanes *l)
{
	sum_add(&m->a0, fold(l->a0));
	sum_add(&m->magnitude, fold(l->magnitude));
	sum_add(&m->area2, fold(l->area2));
	for (int k = 0; k < 3; k++) {
		sum_add(&m->a1[k], fold(l->a1[k]));
		sum_add(&m->vector_area[k], fold(l->n[k]));
		sum_add(&m->area_s[k], fold(l->area_s[k]));
		for (int j = 0; j < LANES; j++) { /* + 0.0 makes 0 of -0 */
			m->min[k] = smaller(l->min[k][j], m->min[k]) + 0.0;
			m->max[k] = larger(l->max[k][j], m->max[k]) + 0.0;
		}
	}
	for (int k = 0; k < 6; k++)
		sum_add(&m->a2[k], fold(l->a2[k]));
}

static void start(struct mp_moments *m, const double first[9])
{
	if (!m->started)
		memcpy(m->reference, first, sizeof m->reference);
	m->started = true;
	if (m->triangles > 0)
		return;
	memcpy(m->min, first, sizeof m->min);
	memcpy(m->max, first, sizeof m->max);
}

/* Eight triangles side by side. */
static void transpose(const double (*restrict tri)[9], double (*restrict v)[LANES])
{
	for (int j = 0; j < LANES; j++)
		for (int i = 0; i < 9; i++)
			v[i][j] = tri[j][i];
}

/* What is left of a block, filled up with a point of the mesh, which adds 0 to every sum. */
static void transpose_rest(const double (*tri)[9], size_t count, double (*v)[LANES])
{
	for (size_t j = 0; j < LANES; j++)
		for (size_t i = 0; i < 9; i++)
			v[i][j] = j < count ? tri[j][i] : tri[0][i % 3];
}

void mp_moments_add(struct mp_moments *m, const double (*tri)[9], size_t count)
{
	struct lanes l = {0};
	double v[9][LANES], origin[3], weight[3];
	double widest = larger(larger(m->scale[0], m->scale[1]), m->scale[2]);

	if (count == 0)
		return;
	start(m, tri[0]);
	for (int k = 0; k < 3; k++) {
		origin[k] = m->reference[k] * m->scale[k];
		weight[k] = m->scale[k] / widest;
		for (int j = 0; j < LANES; j++) {
			l.min[k][j] = m->min[k];
			l.max[k][j] = m->max[k];
		}
	}
	for (size_t at = 0; at < count; at += LANES) {
		if (count - at >= LANES)
			transpose(tri + at, v);
		else
			transpose_rest(tri + at, count - at, v);
		add_box(&l, v, m->scale);
		add_group(&l, v, origin, weight);
	}
	add_lanes(m, &l);
	m->triangles += count;
}

void mp_moments_flip(struct mp_moments *m)
{
	struct mp_sum *signed_sums[] = {&m->a0,
					&m->a1[0],
					&m->a1[1],
					&m->a1[2],
					&m->a2[0],
					&m->a2[1],
					&m->a2[2],
					&m->a2[3],
					&m->a2[4],
					&m->a2[5],
					&m->vector_area[0],
					&m->vector_area[1],
					&m->vector_area[2]};

	for (size_t i = 0; i < sizeof signed_sums / sizeof *signed_sums; i++) {
		signed_sums[i]->hi = -signed_sums[i]->hi;
		signed_sums[i]->lo = -signed_sums[i]->lo;
	}
}
