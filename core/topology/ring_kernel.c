#include "core/topology/ring_kernel.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

enum { LANES = MP_RING_LINE };

/* Which of the links, a bit each, leave for ${comes}. */
static inline unsigned matches(const uint32_t leaves[LANES], uint32_t comes)
{
#ifdef __SSE2__
	const __m128i *half = (const __m128i *)(const void *)leaves;
	__m128i want = _mm_set1_epi32((int)comes);
	__m128i low = _mm_cmpeq_epi32(_mm_loadu_si128(half), want);
	__m128i high = _mm_cmpeq_epi32(_mm_loadu_si128(half + 1), want);
	__m128i words = _mm_packs_epi32(low, high);

	return (unsigned)_mm_movemask_epi8(_mm_packs_epi16(words, words)) & 0xff;
#else
	unsigned found = 0;

	for (unsigned j = 0; j < LANES; j++)
		found |= (leaves[j] == comes ? 1u : 0u) << j;
	return found;
#endif
}

/*
 * As many steps as there can be links, however many there are: no branch to guess wrong.  From the
 * first link all n are met, and some step leads to it: then that is the last one's.
 */
static bool is_ring(const uint32_t leaves[LANES], const uint64_t *link, unsigned n)
{
	unsigned next[LANES + 1], all = (1u << n) - 1, at = 0, met = 0, led = 0;

	for (unsigned i = 0; i < LANES; i++) {
		unsigned found = matches(leaves, (uint32_t)link[i]) & all;

		led |= i < n ? found & 1 : 0;
		next[i] = (unsigned)__builtin_ctz(found | 1u << LANES);
	}
	next[LANES] = LANES; /* a dead end */
	for (unsigned i = 0; i < LANES; i++) {
		met |= 1u << at;
		at = next[at];
	}
	return met == all && led != 0;
}

static bool look_plain(const struct mp_ring_line *line, const uint8_t *links, uint32_t count,
		       uint32_t low, uint32_t *label)
{
	for (uint32_t i = 0; i < count; i++) {
		unsigned n = links[i] < LANES ? links[i] : LANES;
		uint32_t smallest = low + i, leaves[LANES];

		for (unsigned j = 0; j < LANES; j++)
			leaves[j] = (uint32_t)(line[i].link[j] >> 32);
		if (n > 0 && links[i] <= LANES && (n < 3 || !is_ring(leaves, line[i].link, n)))
			return false;
		for (unsigned j = 0; j < n; j++)
			smallest = leaves[j] < smallest ? leaves[j] : smallest;
		label[i] = smallest;
	}
	return true;
}

#if defined(__x86_64__) && defined(__GNUC__)
#define FEATURES __attribute__((target("avx512f,avx512cd,avx512vl")))

/* The smallest of eight. */
FEATURES static inline uint32_t smallest_of(__m256i x)
{
	__m128i y = _mm_min_epu32(_mm256_castsi256_si128(x), _mm256_extracti128_si256(x, 1));

	y = _mm_min_epu32(y, _mm_shuffle_epi32(y, 0x4e));
	y = _mm_min_epu32(y, _mm_shuffle_epi32(y, 0xb1));
	return (uint32_t)_mm_cvtsi128_si32(y);
}

/*
 * All links at once: which leave for where each comes back from says the conflict detection, of
 * several the last.  What a link meets in one, two, four steps is what it and the one that many
 * steps on have met; a ring it is if each link meets all.
 */
FEATURES static bool look_avx512(const struct mp_ring_line *line, const uint8_t *links,
				 uint32_t count, uint32_t low, uint32_t *label)
{
	const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
	const __m256i top = _mm256_set1_epi32(31);
	const __m512i sides =
	    _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 0, 2, 4, 6, 8, 10, 12, 14);

	for (uint32_t i = 0; i < count; i++) {
		unsigned n = links[i] < LANES ? links[i] : LANES, all = (1u << n) - 1;
		__m512i both = _mm512_permutexvar_epi32(sides, _mm512_load_si512(&line[i]));
		__m256i found, next, met;
		unsigned ring;

		both = _mm512_mask_set1_epi32(both, (__mmask16)(~all & 0xff), -1); /* no vertex */
		found = _mm512_extracti64x4_epi64(_mm512_conflict_epi32(both), 1);
		found = _mm256_and_si256(found, _mm256_set1_epi32(0xff));
		next = _mm256_sub_epi32(top, _mm256_lzcnt_epi32(found));
		met = _mm256_or_si256(bit, _mm256_permutevar8x32_epi32(bit, next));
		next = _mm256_permutevar8x32_epi32(next, next);
		met = _mm256_or_si256(met, _mm256_permutevar8x32_epi32(met, next));
		next = _mm256_permutevar8x32_epi32(next, next);
		met = _mm256_or_si256(met, _mm256_permutevar8x32_epi32(met, next));
		ring = _mm256_cmpeq_epi32_mask(met, _mm256_set1_epi32((int)all)) &
		       _mm256_test_epi32_mask(found, found);
		if ((ring & all) != all || n == 1 || n == 2)
			if (links[i] <= LANES)
				return false;
		label[i] = smallest_of(_mm256_min_epu32(_mm512_castsi512_si256(both),
							_mm256_set1_epi32((int)(low + i))));
	}
	return true;
}

static const struct mp_ring_kernel KERNELS[] = {{"plain", look_plain}, {"avx512", look_avx512}};

size_t mp_ring_kernel_count(void)
{
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
		       __builtin_cpu_supports("avx512vl")
		   ? 2
		   : 1;
}
#else
static const struct mp_ring_kernel KERNELS[] = {{"plain", look_plain}};

size_t mp_ring_kernel_count(void)
{
	return 1;
}
#endif

const struct mp_ring_kernel *mp_ring_kernel_get(size_t i)
{
	return &KERNELS[i];
}
