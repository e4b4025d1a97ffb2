#include "core/topology/vertex_slots.h"

#ifdef __SSE2__
#include <immintrin.h>
#endif

/* The first of the ${line}'s slots with this tag or empty; SLOTS_OF_LINE if there is none. */
static unsigned search_line(const uint64_t *line, uint32_t tag)
{
#ifdef __SSE2__
	const __m128 *pair = (const __m128 *)(const void *)line;
	__m128i zero = _mm_setzero_si128(), want = _mm_set1_epi32((int)tag);
	unsigned found = 1u << SLOTS_OF_LINE;

	for (unsigned i = 0; i < SLOTS_OF_LINE / 4; i++) { /* tags and numbers of four slots */
		__m128 a = pair[2 * i], b = pair[2 * i + 1];
		__m128i tags = _mm_castps_si128(_mm_shuffle_ps(a, b, 0xdd));
		__m128i numbers = _mm_castps_si128(_mm_shuffle_ps(a, b, 0x88));
		__m128i hit =
		    _mm_or_si128(_mm_cmpeq_epi32(tags, want), _mm_cmpeq_epi32(numbers, zero));

		found |= (unsigned)_mm_movemask_ps(_mm_castsi128_ps(hit)) << 4 * i;
	}
	return (unsigned)__builtin_ctz(found);
#else
	unsigned i = 0;

	while (i < SLOTS_OF_LINE && line[i] != 0 && line[i] >> 32 != tag)
		i++;
	return i;
#endif
}

void mp_slots_find(const uint64_t *slot, unsigned bits, const void *xyz, size_t each,
		   struct mp_slot_corner *corner, unsigned n)
{
	uint64_t mask = ((uint64_t)1 << bits) - 1;

	for (unsigned i = 0; i < n; i++) {
		uint64_t line = home(corner[i].tag, bits), s;
		unsigned at;

		while ((at = search_line(slot + line, corner[i].tag)) == SLOTS_OF_LINE)
			line = (line + SLOTS_OF_LINE) & mask;
		corner[i].at = line + at;
		s = slot[line + at];
		if (s != 0) { /* they may lie in two lines of the cache */
			const char *p = (const char *)xyz + ((uint32_t)s - 1) * each;

			__builtin_prefetch(p);
			__builtin_prefetch(p + each - 1);
		}
	}
}
