#include "exact_meshes.h"

#include <float.h>
#include <math.h>
#include <string.h>

static double uniform(uint64_t *state)
{
	return (double)(int64_t)soup_random(state) * 0x1p-63;
}

/* Multiples of 1 up to 2^(bits - 1) either way, of at most 53 bits; often an extreme. */
static double integer(uint64_t *state, int bits)
{
	uint64_t r = soup_random(state);
	double x = trunc(ldexp(uniform(state), bits - 1));

	if (r % 4 == 0)
		return r % 8 == 0 ? ldexp(1, bits - 1) - ldexp(1, bits > 54 ? bits - 54 : 0)
				  : -ldexp(1, bits - 1);
	return r % 4 == 1 ? trunc(ldexp(x, 1 - (int)(r >> 8) % bits)) : x;
}

static double any_double(uint64_t *state)
{
	uint64_t bits = soup_random(state);
	double x;

	memcpy(&x, &bits, sizeof x);
	return isfinite(x) ? x : 1;
}

static double noise(uint64_t *state)
{
	switch (soup_random(state) % 4) {
	case 0:
		return 6.123233995736766e-17 * uniform(state);
	case 1:
		return (double)(float)(1e-15 * uniform(state));
	case 2:
		return 0;
	default:
		return 100 * uniform(state);
	}
}

static double end_of_range(uint64_t *state)
{
	uint64_t r = soup_random(state);
	double x = r % 3 == 0 ? DBL_MAX : r % 3 == 1 ? 0x1p-1074 : 0x1p970;

	return r >> 63 ? -x : x;
}

double exact_coordinate(enum exact_style style, int axis, uint64_t *state)
{
	switch (style) {
	case SMALL_INTEGERS:
		return integer(state, 5);
	case NARROW_EDGE:
		return integer(state, 30);
	case NARROW_OVER:
		return integer(state, 31);
	case MIDDLE_EDGE:
		return integer(state, 50);
	case MIDDLE_OVER:
		return integer(state, 51);
	case FIXED_EDGE:
		return integer(state, 62);
	case FIXED_OVER:
		return integer(state, 64);
	case FLOATS_FAR_AWAY:
		return (double)(float)(-3e6 + 40 * uniform(state));
	case MICROMETRES:
		return 1e-6 * uniform(state);
	case GIGAMETRES:
		return 1e12 + 1e9 * uniform(state);
	case NEEDLE:
		return uniform(state) * (axis == 0 ? 1e4 : 1e-5);
	case PLATE:
		return uniform(state) * (axis == 2 ? 1e-12 : 1e3);
	case NOISE_NEAR_ZERO:
		return noise(state);
	case FLOAT_EXTREMES:
		return (double)FLT_MAX * uniform(state);
	case WIDE_SPAN:
		return ldexp(uniform(state), (int)(soup_random(state) % 180) - 90);
	case ANY_DOUBLE:
		return any_double(state);
	case ENDS_OF_RANGE:
		return end_of_range(state);
	case SUBNORMAL:
		return DBL_MIN * uniform(state);
	case HUGE_DOUBLES:
		return DBL_MAX * uniform(state);
	default:
		return uniform(state);
	}
}

/* Closed, whatever the coordinates: the net of a torus of n*m vertices, random places. */
static void random_net(enum exact_style style, uint64_t *state, struct soup *out)
{
	unsigned n = 3 + (unsigned)(soup_random(state) % 3), m = 3;
	double v[5][3][3];

	for (unsigned i = 0; i < n; i++)
		for (unsigned j = 0; j < m; j++)
			for (int k = 0; k < 3; k++)
				v[i][j][k] = exact_coordinate(style, k, state);
	for (unsigned i = 0; i < n; i++)
		for (unsigned j = 0; j < m; j++) {
			unsigned a = (i + 1) % n, b = (j + 1) % m;

			soup_add(out, v[i][j], v[a][j], v[a][b]);
			soup_add(out, v[i][j], v[a][b], v[i][b]);
		}
}

static void random_tetrahedron(enum exact_style style, uint64_t *state, struct soup *out)
{
	double v[4][3];

	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 3; k++)
			v[i][k] = exact_coordinate(style, k, state);
	soup_add(out, v[0], v[2], v[1]);
	soup_add(out, v[0], v[1], v[3]);
	soup_add(out, v[0], v[3], v[2]);
	soup_add(out, v[1], v[2], v[3]);
}

static void random_box(enum exact_style style, uint64_t *state, struct soup *out)
{
	double min[3], max[3];

	for (int k = 0; k < 3; k++) {
		double a = exact_coordinate(style, k, state), b = exact_coordinate(style, k, state);

		min[k] = fmin(a, b);
		max[k] = fmax(a, b);
	}
	soup_box(out, min, max);
}

void exact_mesh(enum exact_style style, uint64_t *state, struct soup *out)
{
	for (unsigned i = 0, n = 1 + (unsigned)(soup_random(state) % 3); i < n; i++)
		switch (soup_random(state) % 3) {
		case 0:
			random_net(style, state, out);
			break;
		case 1:
			random_tetrahedron(style, state, out);
			break;
		default:
			random_box(style, state, out);
		}
}
