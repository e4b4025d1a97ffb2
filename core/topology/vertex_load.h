#ifndef MP_VERTEX_LOAD_H
#define MP_VERTEX_LOAD_H

#include <stdbool.h>
#include <string.h>

#include "core/decoder.h"
#include "core/topology/vertex_bits.h"

/* How coordinates come into the vertex table, private to it: in their order, and -0 as 0. */

/* ${count} coordinates as floats; returns whether that changed some. */
static inline bool load_narrow(const double *x, unsigned count, float *out)
{
	uint64_t changed = 0;

	for (unsigned i = 0; i < count; i++)
		out[i] = (float)(x[i] + 0.0); /* -0 + 0 is +0 */
	/* GCC 12's SLP vectoriser may drop the rounding of (double)(float)x: not through memory */
	__asm__ volatile("" : : "r"(out) : "memory");
	for (unsigned i = 0; i < count; i++)
		changed |= bits_of((double)out[i]) ^ bits_of(x[i] + 0.0);
	return changed != 0;
}

static inline void load_wide(const double *x, unsigned count, uint64_t *out)
{
	for (unsigned i = 0; i < count; i++)
		out[i] = bits_of(x[i] + 0.0);
}

/* Four floats anywhere: no memcpy(), which would be checked against the size of what is around. */
typedef float mp_quad __attribute__((vector_size(16), aligned(4), may_alias));

/* Four rows at ${at}, without -0, become columns: four floats to each of four triangles. */
static inline void turn_four(const float (*row)[MP_BLOCK], size_t at, float *out)
{
	const mp_quad a = *(const mp_quad *)&row[0][at], b = *(const mp_quad *)&row[1][at];
	const mp_quad c = *(const mp_quad *)&row[2][at], d = *(const mp_quad *)&row[3][at];
	const mp_quad ab = __builtin_shufflevector(a, b, 0, 4, 1, 5) + 0.0F;
	const mp_quad cd = __builtin_shufflevector(c, d, 0, 4, 1, 5) + 0.0F;
	const mp_quad ef = __builtin_shufflevector(a, b, 2, 6, 3, 7) + 0.0F;
	const mp_quad gh = __builtin_shufflevector(c, d, 2, 6, 3, 7) + 0.0F;

	*(mp_quad *)out = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
	*(mp_quad *)(out + 9) = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
	*(mp_quad *)(out + 18) = __builtin_shufflevector(ef, gh, 0, 1, 4, 5);
	*(mp_quad *)(out + 27) = __builtin_shufflevector(ef, gh, 2, 3, 6, 7);
}

/* ${n} triangles from ${at} on, nine coordinates each. */
static inline void load_columns(const float (*xyz)[MP_BLOCK], size_t at, unsigned n, float *out)
{
	unsigned i = 0;

	for (; i + 4 <= n; i += 4, out += 36) {
		turn_four(xyz, at + i, out);
		turn_four(xyz + 4, at + i, out + 4);
		for (unsigned j = 0; j < 4; j++)
			out[9 * j + 8] = xyz[8][at + i + j] + 0.0F;
	}
	for (; i < n; i++, out += 9)
		for (unsigned k = 0; k < 9; k++)
			out[k] = xyz[k][at + i] + 0.0F;
}

#endif
