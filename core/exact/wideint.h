#ifndef MP_WIDEINT_H
#define MP_WIDEINT_H

#include <stdint.h>

/*
 * Integers of fixed width beyond 64 bits: the 128 bits of gcc and clang, and sums of 384 bits in
 * two's complement.  What wraps is unsigned, so that it is defined; >> of a negative number shifts
 * in its sign, as both compilers document.
 */
__extension__ typedef __int128 mp_i128;
__extension__ typedef unsigned __int128 mp_u128;

enum { MP_FIXED_LIMBS = 6 };

struct mp_fixed {
	uint64_t limb[MP_FIXED_LIMBS]; /* lowest first; negative: the top bit is set */
};

/* The full product, written once so that nobody widens too late. */
static inline mp_i128 mp_mul_i64(int64_t a, int64_t b)
{
	return (mp_i128)a * b;
}

/* The low 63 bits, as they fit a positive int64_t: x == (x >> 63)*2^63 + mp_low63(x). */
static inline int64_t mp_low63(mp_i128 x)
{
	return (int64_t)((uint64_t)x & (uint64_t)INT64_MAX);
}

/* a += x * 2^bit modulo 2^384, bit < 384. */
static inline void mp_fixed_add(struct mp_fixed *a, mp_i128 x, unsigned bit)
{
	uint64_t sign = x < 0 ? UINT64_MAX : 0;
	unsigned shift = bit % 64;
	mp_u128 low = (mp_u128)(uint64_t)x << shift;
	mp_u128 high = ((mp_u128)sign << 64 | (uint64_t)(x >> 64)) << shift;
	uint64_t word[3] = {(uint64_t)low, (uint64_t)(low >> 64) | (uint64_t)high,
			    (uint64_t)(high >> 64)};
	mp_u128 sum = 0;

	for (unsigned i = bit / 64, k = 0; i < MP_FIXED_LIMBS; i++, k++) {
		sum = (sum >> 64) + a->limb[i] + (k < 3 ? word[k] : sign);
		a->limb[i] = (uint64_t)sum;
	}
}

static inline int mp_fixed_negative(const struct mp_fixed *a)
{
	return (int)(a->limb[MP_FIXED_LIMBS - 1] >> 63);
}

/* a = -a */
static inline void mp_fixed_negate(struct mp_fixed *a)
{
	for (int i = 0; i < MP_FIXED_LIMBS; i++)
		a->limb[i] = ~a->limb[i];
	mp_fixed_add(a, 1, 0);
}

#endif
