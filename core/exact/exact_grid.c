#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/exact/exact_private.h"

enum { MOST_BITS = 62 };

/* What the coordinates on an axis are. */
struct range {
	double min, max;
	int lowest; /* exponent of the lowest bit of any, INT_MAX if all are 0 */
};

/* x = odd integer * 2^lowest_bit(x); INT_MAX for 0. */
static int lowest_bit(double x)
{
	uint64_t bits, mantissa;
	int exponent;

	memcpy(&bits, &x, sizeof bits);
	exponent = (int)(bits >> 52 & 0x7ff);
	mantissa = bits & (((uint64_t)1 << 52) - 1);
	if (exponent > 0)
		mantissa |= (uint64_t)1 << 52;
	else
		exponent = 1;
	return mantissa == 0 ? INT_MAX : exponent - 1075 + __builtin_ctzll(mantissa);
}

static void find_ranges(const struct mp_mesh *mesh, struct range range[3])
{
	uint32_t count = mp_vertices_count(mesh->vertices);

	for (int k = 0; k < 3; k++)
		range[k] = (struct range){.lowest = INT_MAX};
	for (uint32_t v = 0; v < count; v++) {
		double x[3];

		mp_vertices_get(mesh->vertices, v, x);
		for (int k = 0; k < 3; k++) {
			int lowest = lowest_bit(x[k]);

			if (v == 0 || x[k] < range[k].min)
				range[k].min = x[k];
			if (v == 0 || x[k] > range[k].max)
				range[k].max = x[k];
			if (lowest < range[k].lowest)
				range[k].lowest = lowest;
		}
	}
}

/*
 * Lossless where the indices x/2^lowest span less than 2^62: the origin is then their middle.
 * Else some x is off the grid, and none of it is worth a bit of width: the grid takes the 62 bits
 * from the largest coordinate down and the origin is 0, which keeps the numbers short for GMP.  (A
 * mesh far from 0 is lossless, as its doubles have no low bits; the one exception, 2^62 <= largest
 * index and span < 2^62, loses nothing but time.)
 */
static bool set_axis(const struct range *range, struct mp_exact_axis *axis, unsigned *bits)
{
	double largest = fmax(-range->min, range->max);
	int top = largest > 0 ? ilogb(largest) + 1 : 0; /* |x| < 2^top */
	int64_t min, max;
	uint64_t span;

	axis->exponent = range->lowest == INT_MAX ? 0 : range->lowest;
	axis->origin = 0;
	*bits = MOST_BITS;
	if (top - axis->exponent <= MOST_BITS) {
		min = (int64_t)ldexp(range->min, -axis->exponent); /* exact: both are on the grid */
		max = (int64_t)ldexp(range->max, -axis->exponent);
		span = (uint64_t)max - (uint64_t)min;
		if (span >> MOST_BITS == 0) {
			axis->origin = min + (int64_t)((span + 1) / 2);
			*bits = span == 0 ? 1 : 64 - (unsigned)__builtin_clzll(span);
			return true;
		}
	}
	axis->exponent = top - (MOST_BITS - 1);
	return false;
}

/* The exponent is -1074 to 1023. */
static void set_scale(int exponent, double scale[2])
{
	int half = -exponent / 2;

	scale[0] = ldexp(1, half);
	scale[1] = ldexp(1, -exponent - half);
}

/*
 * |x| < 2^62*2^exponent, and scaling up is exact, so the cast is defined; scaling down may round,
 * but never to an integer other than 0.
 */
static bool find_index(double x, const double scale[2], int64_t origin, int64_t *out)
{
	double scaled = x * scale[0] * scale[1];
	int64_t index = (int64_t)scaled;

	*out = index - origin;
	return (double)index == scaled && (index != 0 || x == 0);
}

static void find_indices(const struct mp_mesh *mesh, struct mp_exact_grid *grid)
{
	uint32_t count = mp_vertices_count(mesh->vertices);

	for (uint32_t v = 0; v < count; v++) {
		bool on = true;
		double x[3];

		mp_vertices_get(mesh->vertices, v, x);
		for (int k = 0; k < 3; k++)
			on &=
			    find_index(x[k], grid->scale[k], grid->axis[k].origin, &grid->q[v][k]);
		if (!on)
			grid->q[v][0] = MP_EXACT_OFF;
	}
}

int mp_exact_grid_find(const struct mp_mesh *mesh, struct mp_exact_grid *out, struct mp_error *err)
{
	struct range range[3];
	unsigned bits;

	memset(out, 0, sizeof *out);
	out->q = malloc(((size_t)mp_vertices_count(mesh->vertices) + 1) * sizeof *out->q);
	if (out->q == NULL)
		return mp_fail_nomem(err);
	find_ranges(mesh, range);
	out->bits = 1;
	out->lossless = true;
	for (int k = 0; k < 3; k++) {
		out->lossless = set_axis(&range[k], &out->axis[k], &bits) && out->lossless;
		set_scale(out->axis[k].exponent, out->scale[k]);
		if (bits > out->bits)
			out->bits = bits;
	}
	find_indices(mesh, out);
	return 0;
}

void mp_exact_grid_free(struct mp_exact_grid *grid)
{
	free(grid->q);
	memset(grid, 0, sizeof *grid);
}
