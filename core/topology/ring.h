#ifndef MP_RING_H
#define MP_RING_H

#include <stdbool.h>
#include <stdint.h>

/*
 * Private to manifold.c.  A link is the vertex for which a triangle leaves the vertex in question
 * << 32 | the one from which it comes back.
 */
enum { MP_FEW = 8, MP_SOME = 16 }; /* links compared each with each, side by side */

/*
 * Whether the ${n} <= ${lanes} links are one ring: steps from each to one that leaves for where it
 * comes back from are home after n of them and no sooner.  So they meet every link, and no two
 * leave for the same vertex, or the second of these would be met never.
 */
static inline __attribute__((always_inline)) bool mp_is_short_ring(const uint64_t *link, unsigned n,
								   unsigned lanes)
{
	uint32_t leaves[MP_SOME], next[MP_SOME + 1], at = 0, home = 0;

	for (unsigned i = 0; i < lanes; i++)
		leaves[i] = i < n ? (uint32_t)(link[i] >> 32) : UINT32_MAX; /* no vertex */
	for (unsigned i = 0; i < n; i++) {
		uint32_t comes = (uint32_t)link[i], mask = (uint32_t)1 << MP_SOME;

		for (unsigned j = 0; j < lanes; j++)
			mask |= (leaves[j] == comes ? 1u : 0u) << j;
		next[i] = (uint32_t)__builtin_ctz(mask);
	}
	next[MP_SOME] = MP_SOME; /* a dead end */
	for (unsigned i = 1; i < n; i++) {
		at = next[at];
		home |= at == 0;
	}
	return home == 0 && next[at] == 0;
}

#endif
