#include <float.h>
#include <math.h>

#include "core/moments/bounds.h"

/* See bounds.h for where the constants come from. */
#define U      0x1p-53L
#define H      0x1p-1074L
#define SLACK  (1 + 0x1p-20L)
#define SQRT_H 0x1p-536L /* > sqrt(3/2 H) */

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

static long double value(const struct mp_sum *sum)
{
	return (long double)sum->hi + sum->lo;
}

/* B: reference and vertices lie in the box, so its sides hold every difference of two. */
static long double reach(const struct mp_moments *m)
{
	long double b = 1;

	for (int k = 0; k < 3; k++) {
		long double half = (m->max[k] / 2.0L - m->min[k] / 2.0L) * m->scale[k];

		b = fmaxl(b, 2 * half * SLACK);
	}
	return b;
}

void mp_bounds_of_sums(const struct mp_moments *m, struct mp_sum_errors *out)
{
	long double blocks = (long double)m->blocks, lost = (long double)m->triangles * H;
	long double u = (U + blocks * blocks * U * U) * SLACK, b = reach(m);
	long double g = sqrtl(value(&m->doubt)), w[3];

	for (int k = 0; k < 3; k++)
		w[k] = sqrtl(value(&m->doubt2[k]));
	out->a0 = u * g * g + 32 * lost * b * b;
	for (int k = 0; k < 3; k++)
		out->a1[k] = u * g * w[k] + 128 * lost * b * b * b;
	for (int k = 0; k < 6; k++)
		out->a2[k] = u * w[AXES[k][0]] * w[AXES[k][1]] + 1024 * lost * b * b * b * b;
	out->area2 = u * (4 * value(&m->area_doubt) + 16 * value(&m->area2)) +
		     (long double)m->triangles * (SQRT_H + 16 * H * b);
}
