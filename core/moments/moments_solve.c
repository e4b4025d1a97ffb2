#include "core/moments/moments.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "core/moments/bounds.h"

/* What a vector area may be off by over the area: 64 * 2^-53. */
#define ROUNDING 0x1p-47L

/* Below these, underflow may have eaten digits: of sums of products, of a sum of square roots. */
#define SMALL_SUM     0x1p-900L
#define SMALL_MOMENT  0x1p-960L
#define SMALL_LENGTHS 0x1p-450L

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

static long double value(const struct mp_sum *sum)
{
	return (long double)sum->hi + sum->lo;
}

static bool finite_sums(const struct mp_sum *sum, int count)
{
	for (int i = 0; i < count; i++)
		if (!isfinite(sum[i].hi) || !isfinite(sum[i].lo))
			return false;
	return true;
}

/* Product of the factors of the three axes, a power of two. */
static long double scale_product(const struct mp_moments *m)
{
	return (long double)m->scale[0] * m->scale[1] * m->scale[2];
}

static bool finite_errors(const struct mp_sum_errors *e)
{
	for (int k = 0; k < 3; k++)
		if (!isfinite(e->a1[k]) || !isfinite(e->a2[k]) || !isfinite(e->a2[k + 3]))
			return false;
	return isfinite(e->a0);
}

static struct mp_ball ball(const struct mp_sum *sum, long double error)
{
	return mp_ball_add(mp_ball(sum->hi, error), mp_ball_exact(sum->lo));
}

/* Divided by a power of two or a small integer, ${by} > 0. */
static struct mp_ball divided(struct mp_ball a, long double by)
{
	return by == 1 ? a : mp_ball_rounded(a.mid / by, a.rad / by);
}

static void solve_surface(const struct mp_moments *m, const struct mp_sum_errors *e,
			  struct mp_solid *out)
{
	long double widest = fmaxl(fmaxl(m->scale[0], m->scale[1]), m->scale[2]);
	long double area2 = value(&m->area2), product = scale_product(m);
	struct mp_ball area = divided(divided(ball(&m->area2, e->area2), 2 / widest), product);

	out->area_in_range = finite_sums(&m->area2, 1) && finite_sums(m->area_s, 3) &&
			     finite_sums(m->vector_area, 3) && finite_sums(&m->area_doubt, 1) &&
			     (area2 == 0 || area2 >= SMALL_LENGTHS);
	if (!out->area_in_range)
		return;
	out->area = area.mid;
	out->area_bound = area.rad;
	out->has_surface_centroid = area2 > 0;
	for (int k = 0; k < 3; k++) {
		long double n = value(&m->vector_area[k]) / 2 * m->scale[k] / product;

		if (fabsl(n) > ROUNDING * out->area)
			out->vector_area[k] = n;
		if (area2 > 0)
			out->surface_centroid[k] = (long double)m->reference[k] +
						   value(&m->area_s[k]) / area2 / 3 / m->scale[k];
	}
}

/* A box without an extent: exactly 0, whatever the sums say. */
static bool is_flat(const struct mp_moments *m)
{
	return m->max[0] == m->min[0] || m->max[1] == m->min[1] || m->max[2] == m->min[2];
}

/* Is the reference more than eight radii of gyration from the centroid along some axis? */
static bool far_reference(const struct mp_moments *m, const struct mp_solid *out)
{
	for (int k = 0; k < 3; k++) {
		long double g = out->centroid[k] - m->reference[k];

		if (!(g * g <= 64 * out->cov[k]))
			return true;
	}
	return false;
}

static void solve_second(const struct mp_moments *m, const struct mp_sum_errors *e,
			 struct mp_ball a0, struct mp_solid *out)
{
	struct mp_ball g[3];

	for (int k = 0; k < 3; k++) {
		struct mp_ball c;

		g[k] = divided(mp_ball_div(ball(&m->a1[k], e->a1[k]), a0), 4);
		c = mp_ball_add(mp_ball_exact(m->reference[k]), divided(g[k], m->scale[k]));
		out->centroid[k] = c.mid;
		out->centroid_bound[k] = c.rad;
	}
	for (int k = 0; k < 6; k++) {
		int i = AXES[k][0], j = AXES[k][1];
		struct mp_ball a2 = ball(&m->a2[k], e->a2[k]), c;

		c = mp_ball_sub(divided(mp_ball_div(a2, a0), 20), mp_ball_mul(g[i], g[j]));
		c = divided(divided(c, m->scale[i]), m->scale[j]);
		out->cov[k] = c.mid;
		out->cov_bound[k] = c.rad;
		if (i == j && fabsl(a2.mid) < SMALL_MOMENT)
			out->in_range = false;
	}
}

/* No volume that is proven, but maybe one, and moments. */
static void solve_zero(const struct mp_moments *m, const struct mp_sum_errors *e,
		       struct mp_ball volume, struct mp_solid *out)
{
	struct mp_ball product = mp_ball_exact(scale_product(m)), b;

	out->volume_bound = mp_ball_most(volume);
	for (int k = 0; k < 3; k++) {
		b = mp_ball_div(ball(&m->a1[k], e->a1[k]), product);
		out->first[k] = divided(divided(b, m->scale[k]), 24);
		out->reference[k] = m->reference[k];
	}
	for (int k = 0; k < 6; k++) {
		b = mp_ball_div(ball(&m->a2[k], e->a2[k]), product);
		b = divided(divided(b, m->scale[AXES[k][0]]), m->scale[AXES[k][1]]);
		out->second[k] = divided(b, 120);
	}
}

static void solve_volume(const struct mp_moments *m, const struct mp_sum_errors *e,
			 struct mp_solid *out)
{
	struct mp_ball a0 = ball(&m->a0, e->a0), volume;

	if (m->triangles == 0 || is_flat(m)) {
		out->in_range = true;
		return;
	}
	out->in_range = finite_sums(&m->a0, 1) && finite_sums(&m->doubt, 1) &&
			finite_sums(m->a1, 3) && finite_sums(m->a2, 6) &&
			finite_sums(m->doubt2, 3) && value(&m->doubt) >= SMALL_SUM &&
			finite_errors(e);
	out->again = true;
	if (!out->in_range)
		return;
	volume = mp_ball_div(divided(a0, 6), mp_ball_exact(scale_product(m)));
	if (!mp_ball_not_zero(a0)) {
		solve_zero(m, e, volume, out);
		return;
	}
	out->volume = volume.mid;
	out->volume_bound = volume.rad;
	out->has_centroid = true;
	solve_second(m, e, a0, out);
	out->again = !out->in_range || a0.rad > 0x1p-10L * fabsl(a0.mid) || far_reference(m, out);
}

void mp_moments_solve(const struct mp_moments *m, struct mp_solid *out)
{
	struct mp_sum_errors errors;

	memset(out, 0, sizeof *out);
	mp_bounds_of_sums(m, &errors);
	solve_volume(m, &errors, out);
	solve_surface(m, &errors, out);
	/* an area of exactly 0 may be one whose squares all underflowed */
	out->area_again = !out->area_in_range || (m->triangles > 0 && out->area == 0);
	out->again = out->again || out->area_again;
}
