#ifndef MP_RING_H
#define MP_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Private to ring_window.c.  A link is the vertex for which a triangle leaves the vertex in
 * question << 32 | the one from which it comes back.
 */
enum { MP_SOME = 16 }; /* links compared each with each, side by side */

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

/* The link of ${n} that leaves for ${v}, by their order; ${n} where there is none. */
static inline size_t mp_find_link(const uint64_t *sorted, size_t n, uint32_t v)
{
	size_t low = 0, high = n;

	while (low < high) {
		size_t mid = low + (high - low) / 2;

		if (sorted[mid] >> 32 < v)
			low = mid + 1;
		else
			high = mid;
	}
	return low < n && sorted[low] >> 32 == v ? low : n;
}

/* Of vertex ${v} and those that its links leave for. */
static inline uint32_t mp_smallest_neighbour(const uint64_t *link, size_t n, uint32_t v)
{
	for (size_t i = 0; i < n; i++)
		v = (uint32_t)(link[i] >> 32) < v ? (uint32_t)(link[i] >> 32) : v;
	return v;
}

#endif
