#include "core/moments.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Rounding of a sum over its magnitude, see mp_moments_solve() in the header: 64 * 2^-53. */
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

static void solve_surface(const struct mp_moments *m, struct mp_solid *out)
{
	long double widest = fmaxl(fmaxl(m->scale[0], m->scale[1]), m->scale[2]);
	long double area2 = value(&m->area2), product = scale_product(m);

	out->area_in_range = finite_sums(&m->area2, 1) && finite_sums(m->area_s, 3) &&
			     finite_sums(m->vector_area, 3) &&
			     (area2 == 0 || area2 >= SMALL_LENGTHS);
	if (!out->area_in_range)
		return;
	out->area = area2 / 2 * widest / product;
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

static void solve_second(const struct mp_moments *m, long double a0, struct mp_solid *out)
{
	long double g[3];

	for (int k = 0; k < 3; k++) {
		g[k] = value(&m->a1[k]) / a0 / 4;
		out->centroid[k] = (long double)m->reference[k] + g[k] / m->scale[k];
	}
	for (int k = 0; k < 6; k++) {
		int i = AXES[k][0], j = AXES[k][1];
		long double a2 = value(&m->a2[k]);

		out->cov[k] = (a2 / a0 / 20 - g[i] * g[j]) / m->scale[i] / m->scale[j];
		if (i == j && fabsl(a2) < SMALL_MOMENT)
			out->in_range = false;
	}
}

static void solve_volume(const struct mp_moments *m, struct mp_solid *out)
{
	long double a0 = value(&m->a0), magnitude = value(&m->magnitude);
	long double product = scale_product(m);

	if (m->triangles == 0 || is_flat(m)) {
		out->in_range = true;
		return;
	}
	out->in_range = finite_sums(&m->a0, 1) && finite_sums(&m->magnitude, 1) &&
			finite_sums(m->a1, 3) && finite_sums(m->a2, 6) && magnitude >= SMALL_SUM;
	out->again = true;
	if (!out->in_range)
		return;
	out->volume_bound = ROUNDING * magnitude / 6 / product;
	if (fabsl(a0) <= ROUNDING * magnitude)
		return;
	out->volume = a0 / 6 / product;
	out->has_centroid = true;
	solve_second(m, a0, out);
	out->again =
	    !out->in_range || ROUNDING * magnitude > 0x1p-10L * fabsl(a0) || far_reference(m, out);
}

void mp_moments_solve(const struct mp_moments *m, struct mp_solid *out)
{
	memset(out, 0, sizeof *out);
	solve_volume(m, out);
	solve_surface(m, out);
	/* an area of exactly 0 may be one whose squares all underflowed */
	out->area_again = !out->area_in_range || (m->triangles > 0 && out->area == 0);
	out->again = out->again || out->area_again;
}

void mp_merge_begin(struct mp_merge *merge, const long double origin[3])
{
	memset(merge, 0, sizeof *merge);
	for (int k = 0; k < 3; k++)
		merge->origin[k] = origin[k];
}

void mp_merge_add(struct mp_merge *merge, const struct mp_solid *part)
{
	long double r[3];

	merge->volume += part->volume;
	merge->volume_bound += part->volume_bound;
	merge->magnitude += fabsl(part->volume);
	for (int k = 0; k < 3; k++) {
		r[k] = part->centroid[k] - merge->origin[k];
		merge->first[k] += part->volume * r[k];
	}
	for (int k = 0; k < 6; k++)
		merge->second[k] += part->volume * (part->cov[k] + r[AXES[k][0]] * r[AXES[k][1]]);
}

void mp_merge_solve(const struct mp_merge *merge, struct mp_solid *io)
{
	long double g[3];

	io->volume_bound = merge->volume_bound + 0x1p-53L * merge->magnitude;
	io->has_centroid = fabsl(merge->volume) > io->volume_bound;
	io->volume = io->has_centroid ? merge->volume : 0;
	memset(io->centroid, 0, sizeof io->centroid);
	memset(io->cov, 0, sizeof io->cov);
	if (!io->has_centroid)
		return;
	for (int k = 0; k < 3; k++) {
		g[k] = merge->first[k] / merge->volume;
		io->centroid[k] = merge->origin[k] + g[k];
	}
	for (int k = 0; k < 6; k++)
		io->cov[k] = merge->second[k] / merge->volume - g[AXES[k][0]] * g[AXES[k][1]];
}
