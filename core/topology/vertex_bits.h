#ifndef MP_VERTEX_BITS_H
#define MP_VERTEX_BITS_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Coordinates as words, private to the vertex table: hashes of them and whether a float would do.
 */

__extension__ typedef unsigned __int128 u128;

static inline uint64_t mix(uint64_t x)
{
	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

/* Six words out of two, splitmix64 keyed with both halves (Steele 2014, doi:10.1145/2660193). */
static inline void expand_key(const uint8_t key[16], uint64_t out[6])
{
	uint64_t half[2];

	memcpy(half, key, sizeof half);
	for (unsigned i = 0; i < 6; i++)
		out[i] = mix(mix(half[0] + (i + 1) * 0x9e3779b97f4a7c15u) + half[1]);
}

/*
 * The first line is NH (Black et al. 1999, UMAC, doi:10.1007/3-540-48405-1_14) with words of 64
 * bits: two different vertices get the same 128 bits for at most one key in 2^64, whichever two
 * the uploader chose, for the key is fresh and never shown.  The second, a folded product under
 * two more words, spreads those bits, so that what NH keeps of the order of the coordinates does
 * not become runs of neighbouring slots.
 */
static inline uint32_t hash(const uint64_t k[6], const uint64_t w[3])
{
	u128 sum, product;
	uint64_t fold;

	sum = (u128)(w[0] + k[0]) * (w[1] + k[1]) + (u128)(w[2] + k[2]) * k[3];
	product = (u128)((uint64_t)sum ^ k[4]) * ((uint64_t)(sum >> 64) ^ k[5]);
	fold = (uint64_t)product ^ (uint64_t)(product >> 64);
	return (uint32_t)(fold ^ (fold >> 32));
}

static inline uint64_t bits_of(double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	return bits;
}

/*
 * Whether a float holds ${x}, by its bits: GCC 12's SLP vectoriser may drop the rounding of
 * (double)(float)x.
 */
static inline bool fits_float(double x)
{
	uint64_t bits = bits_of(x);
	unsigned exponent = (unsigned)(bits >> 52) & 0x7ff;

	if (exponent >= 1023 - 126)
		return (bits & 0x1fffffff) == 0 && exponent <= 1023 + 127;
	x *= 0x1p149; /* exact; a subnormal float is a multiple of 2^-149 */
	return (double)(int64_t)x == x;
}

/*
 * What speaks against a float for the double of these bits, to be collected with |: no branch, and
 * right for all but subnormal floats.
 */
struct float_doubt {
	uint64_t low;  /* these 29 bits have to be 0 */
	uint64_t sign; /* and this one: the exponent is too small or too large */
};

static inline void doubt_float(struct float_doubt *doubt, uint64_t bits)
{
	uint64_t size = bits & (UINT64_MAX >> 1), not_zero = 0 - size;
	uint64_t small = size - ((uint64_t)(1023 - 126) << 52);
	uint64_t large = ((uint64_t)(1023 + 128) << 52) - 1 - size;

	doubt->low |= bits;
	doubt->sign |= (small & not_zero) | large;
}

static inline bool is_doubtful(const struct float_doubt *doubt)
{
	return (doubt->low & 0x1fffffff) != 0 || doubt->sign >> 63 != 0;
}

#endif
