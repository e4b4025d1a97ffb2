#include "core/moments/moments.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "core/moments/moments_kernel.h"

static void sum_add(struct mp_sum *sum, double x)
{
	double s = sum->hi + x; /* TwoSum, Knuth: s + error == hi + x exactly */
	double part = s - sum->hi;

	sum->lo += (sum->hi - (s - part)) + (x - part);
	sum->hi = s;
}

/* Always this order: upper half onto lower half, three times. */
static double fold(const double l[MP_LANES])
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

static void add_lanes(struct mp_moments *m, const struct mp_lanes *l)
{
	sum_add(&m->a0, fold(l->a0));
	sum_add(&m->doubt, fold(l->doubt));
	sum_add(&m->area2, fold(l->area2));
	sum_add(&m->area_doubt, fold(l->area_doubt));
	for (int k = 0; k < 3; k++) {
		sum_add(&m->a1[k], fold(l->a1[k]));
		sum_add(&m->doubt2[k], fold(l->doubt2[k]));
		sum_add(&m->vector_area[k], fold(l->n[k]));
		sum_add(&m->area_s[k], fold(l->area_s[k]));
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

/* A block in one of its two forms, the other one NULL; ${first} is its first triangle. */
static void add_block(struct mp_moments *m, const double first[9], const double (*tri)[9],
		      const float (*xyz)[MP_BLOCK], size_t count, const struct mp_kernel *kernel)
{
	double min[3][MP_LANES], max[3][MP_LANES];
	double widest = larger(larger(m->scale[0], m->scale[1]), m->scale[2]);
	struct mp_lanes lanes = {0};
	struct mp_frame frame;

	start(m, first);
	for (int k = 0; k < 3; k++) {
		frame.scale[k] = m->scale[k];
		frame.origin[k] = m->reference[k] * m->scale[k];
		frame.weight[k] = m->scale[k] / widest;
		for (int j = 0; j < MP_LANES; j++) {
			min[k][j] = m->min[k];
			max[k][j] = m->max[k];
		}
	}
	if (xyz != NULL)
		kernel->add_floats(&lanes, min, max, &frame, xyz, count);
	else
		kernel->add(&lanes, min, max, &frame, tri, count);
	add_lanes(m, &lanes);
	for (int i = 0; i < 3 * MP_LANES; i++) { /* + 0.0 makes 0 of -0 */
		int k = i / MP_LANES, j = i % MP_LANES;

		m->min[k] = smaller(min[k][j], m->min[k]) + 0.0;
		m->max[k] = larger(max[k][j], m->max[k]) + 0.0;
	}
	m->triangles += count;
	m->blocks++;
}

void mp_moments_add_with(struct mp_moments *m, const double (*tri)[9], size_t count,
			 const struct mp_kernel *kernel)
{
	if (count > 0)
		add_block(m, tri[0], tri, NULL, count, kernel);
}

void mp_moments_add_floats_with(struct mp_moments *m, const float (*xyz)[MP_BLOCK], size_t count,
				const struct mp_kernel *kernel)
{
	double first[9];

	if (count == 0)
		return;
	for (int k = 0; k < 9; k++)
		first[k] = (double)xyz[k][0];
	add_block(m, first, NULL, xyz, count, kernel);
}

void mp_moments_add_floats(struct mp_moments *m, const float (*xyz)[MP_BLOCK], size_t count)
{
	mp_moments_add_floats_with(m, xyz, count, mp_kernel_get(mp_kernel_count() - 1));
}

void mp_moments_add(struct mp_moments *m, const double (*tri)[9], size_t count)
{
	mp_moments_add_with(m, tri, count, mp_kernel_get(mp_kernel_count() - 1));
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
