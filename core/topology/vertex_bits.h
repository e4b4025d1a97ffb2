#ifndef MP_VERTEX_BITS_H
#define MP_VERTEX_BITS_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Coordinates as words, private to the vertex table, and hashes of them. */

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

/* The words of a vertex without -0: three doubles, or three floats, two of them in one word. */
static inline __attribute__((always_inline)) void load_words(bool wide, const void *key,
							     uint64_t w[3])
{
	uint32_t z;

	if (wide) {
		memcpy(w, key, 3 * sizeof *w);
		return;
	}
	memcpy(&w[0], key, sizeof w[0]);
	memcpy(&z, (const char *)key + sizeof w[0], sizeof z);
	w[1] = z;
	w[2] = 0;
}

static inline __attribute__((always_inline)) bool same_words(bool wide, const void *a,
							     const void *b)
{
	uint64_t x[3], y[3];

	load_words(wide, a, x);
	load_words(wide, b, y);
	return ((x[0] ^ y[0]) | (x[1] ^ y[1]) | (x[2] ^ y[2])) == 0;
}

/*
 * The first line is NH (Black et al. 1999, UMAC, doi:10.1007/3-540-48405-1_14) with words of 64
 * bits: two different vertices get the same 128 bits for at most one key in 2^64, whichever two
 * the uploader chose, for the key is fresh and never shown.  The second, a folded product under
 * two more words, spreads those bits, so that what NH keeps of the order of the coordinates does
 * not become runs of neighbouring slots.
 */
static inline __attribute__((always_inline)) uint32_t hash(const uint64_t k[6], bool wide,
							   const void *key)
{
	u128 sum, product;
	uint64_t w[3], fold;

	load_words(wide, key, w);
	sum = (u128)(w[0] + k[0]) * (w[1] + k[1]) + (wide ? (u128)(w[2] + k[2]) * k[3] : 0);
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

#endif
