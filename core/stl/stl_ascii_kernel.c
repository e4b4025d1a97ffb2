#include "core/stl/stl_private.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

/*
 * The facet that printf made: every number is [-]d.dddddde+dd, one blank between them, one line
 * end and up to 8 spaces between lines.  Nothing here waits for the length of a number: blanks are
 * found in masks of 64 bytes, and a number is read backwards from the blank behind it.
 */

#define INLINE static inline __attribute__((always_inline, target("avx2,bmi")))
#define EACH(...) \
	_mm256_setr_epi8(__VA_ARGS__, __VA_ARGS__) /* the same 16 bytes for both of two numbers */

/* What is looked at behind the beginning of a facet: at most 74 bytes a line of numbers. */
enum { ROOM = 512 };

/* By 100 for a minus in the exponent + the exponent + 208 for a minus: what w is divided by. */
enum { MINUS_E = 100, MINUS = 208 };
static const double divisor[MINUS + MINUS_E + 100] = {[0] = 1e6,
						      1e5,
						      1e4,
						      1e3,
						      1e2,
						      1e1,
						      1e0,
						      [MINUS_E] = 1e6,
						      1e7,
						      1e8,
						      1e9,
						      1e10,
						      1e11,
						      1e12,
						      1e13,
						      1e14,
						      1e15,
						      1e16,
						      1e17,
						      1e18,
						      1e19,
						      1e20,
						      1e21,
						      1e22,
						      [MINUS] = -1e6,
						      -1e5,
						      -1e4,
						      -1e3,
						      -1e2,
						      -1e1,
						      -1e0,
						      [MINUS + MINUS_E] = -1e6,
						      -1e7,
						      -1e8,
						      -1e9,
						      -1e10,
						      -1e11,
						      -1e12,
						      -1e13,
						      -1e14,
						      -1e15,
						      -1e16,
						      -1e17,
						      -1e18,
						      -1e19,
						      -1e20,
						      -1e21,
						      -1e22}; /* 0: none is exact */

/* Bit i is set where p[i] is a blank or a control character, of 64 bytes. */
INLINE uint64_t blanks64(const char *p)
{
	const __m256i blank = _mm256_set1_epi8(' ');
	__m256i a = _mm256_loadu_si256((const __m256i *)(const void *)p);
	__m256i b = _mm256_loadu_si256((const __m256i *)(const void *)(p + 32));

	a = _mm256_cmpeq_epi8(_mm256_min_epu8(a, blank), a);
	b = _mm256_cmpeq_epi8(_mm256_min_epu8(b, blank), b);
	return (unsigned)_mm256_movemask_epi8(a) | (uint64_t)(unsigned)_mm256_movemask_epi8(b)
						       << 32;
}

/*
 * A line end and up to 8 spaces; what follows is for others to look at.  ${*indent} is how many
 * there were the last time: foreseen, nothing waits for them.
 */
INLINE const char *next_line(const char *p, unsigned *indent)
{
	unsigned n, guess = *indent;

	if (*p != '\n' && (*p++ != '\r' || *p != '\n'))
		return NULL;
	p++;
	n = (unsigned)_tzcnt_u64(mp_text8(p) ^ UINT64_C(0x2020202020202020)) >> 3;
	if (__builtin_expect(n == guess, 1)) {
		__asm__ volatile("" : "+r"(guess)); /* else the compiler sees that it is n */
		return p + guess;
	}
	*indent = n;
	return p + n;
}

/* Are the first ${len} letters at p those of ${name}, which is in lower case, in any case? */
INLINE bool is_word(const char *p, const char name[8], unsigned len)
{
	uint64_t low = UINT64_C(0x2020202020202020);

	return ((mp_text8(p) | low) ^ mp_text8(name)) << (64 - 8 * len) == 0;
}

/*
 * A line of three numbers from p[first] on; ${at} becomes the places of their signs, or of the
 * blanks before them.  Returns the next line.
 */
INLINE const char *numbers(const char *p, unsigned first, const char *at[3], unsigned *indent)
{
	uint64_t blank = blanks64(p) >> first;
	unsigned a, b, c;

	a = (unsigned)_tzcnt_u64(blank);
	blank = _blsr_u64(blank);
	b = (unsigned)_tzcnt_u64(blank);
	blank = _blsr_u64(blank);
	c = (unsigned)_tzcnt_u64(blank);
	if (((a - 12) | (b - a - 13) | (c - b - 13)) > 1)
		return NULL;
	p += first;
	if (p[a] != ' ' || p[b] != ' ')
		return NULL;
	at[0] = p + a - 13;
	at[1] = p + b - 13;
	at[2] = p + c - 13;
	return next_line(p + c, indent);
}

/*
 * Two numbers: each half becomes a 32-bit w, without the point, and the place of its divisor.
 * Bits of ${*odd} are set where they are of another form.
 */
INLINE __m256i two(const char *p, const char *q, __m256i *odd)
{
	const __m256i small = EACH(0, 0, 0, 0, 0, 0, 0, 0, 0, 0x20, 0, 0, 0, 0, 0, 0);
	const __m256i minus = EACH('-' - ' ', 0, 0, 0, 0, 0, 0, 0, 0, 0, '-' - '+', 0, 0, 0, 0, 0);
	const __m256i least =
	    EACH(' ', '0', '.', '0', '0', '0', '0', '0', '0', 'e', '+', '0', '0', 0, 0, 0);
	const __m256i most = EACH(0, 9, 0, 9, 9, 9, 9, 9, 9, 0, 0, 9, 9, -1, -1, -1);
	const __m256i order = EACH(-1, 1, 3, 4, 5, 6, 7, 8, 11, 12, 10, -1, 0, -1, -1, -1);
	const __m256i tens = EACH(0, 1, 10, 1, 10, 1, 10, 1, 10, 1, MINUS_E / ('-' - '+'), 0,
				  MINUS / ('-' - ' '), 0, 0, 0);
	const __m256i hundreds =
	    _mm256_setr_epi16(100, 1, 100, 1, 1, 1, 1, 1, 100, 1, 100, 1, 1, 1, 1, 1);
	const __m256i thousands =
	    _mm256_setr_epi16(10000, 1, 1, 1, 0, 0, 0, 0, 10000, 1, 1, 1, 0, 0, 0, 0);
	__m256i text, sign, digit;

	text = _mm256_castsi128_si256(_mm_loadu_si128((const __m128i *)(const void *)p));
	text = _mm256_inserti128_si256(text, _mm_loadu_si128((const __m128i *)(const void *)q), 1);
	sign = _mm256_and_si256(_mm256_cmpeq_epi8(text, _mm256_set1_epi8('-')), minus);
	digit = _mm256_sub_epi8(_mm256_sub_epi8(_mm256_or_si256(text, small), sign), least);
	*odd = _mm256_or_si256(*odd, _mm256_subs_epu8(digit, most));
	digit = _mm256_shuffle_epi8(_mm256_or_si256(digit, sign), order);
	digit = _mm256_madd_epi16(_mm256_maddubs_epi16(digit, tens), hundreds);
	return _mm256_madd_epi16(_mm256_packus_epi32(digit, digit), thousands);
}

/*
 * Four numbers from what two() made of the first and the third, the second and the fourth; ${*far}
 * where there is no divisor.  The quotient of two exact numbers is rounded once, as in
 * mp_number_compose().
 */
INLINE __m256d four(__m256i a, __m256i b, __m256d *far)
{
	__m256i w = _mm256_unpacklo_epi32(a, b); /* w0 w1 i0 i1, w2 w3 i2 i3 */
	__m128i low = _mm256_castsi256_si128(w), high = _mm256_extracti128_si256(w, 1);
	uint64_t i = (uint64_t)_mm_extract_epi64(low, 1), j = (uint64_t)_mm_extract_epi64(high, 1);
	__m256d by = _mm256_setr_pd(divisor[(uint32_t)i], divisor[i >> 32], divisor[(uint32_t)j],
				    divisor[j >> 32]);

	*far = _mm256_or_pd(*far, _mm256_cmp_pd(by, _mm256_setzero_pd(), _CMP_EQ_OQ));
	return _mm256_div_pd(_mm256_cvtepi32_pd(_mm_unpacklo_epi64(low, high)), by);
}

/* Twelve numbers, or false where one is of another form. */
INLINE bool convert(const char *const at[12], double normal[3], double tri[9])
{
	__m256i wrong = _mm256_setzero_si256();
	__m256i even0 = two(at[0], at[2], &wrong), odd0 = two(at[1], at[3], &wrong);
	__m256i even1 = two(at[4], at[6], &wrong), odd1 = two(at[5], at[7], &wrong);
	__m256i even2 = two(at[8], at[10], &wrong), odd2 = two(at[9], at[11], &wrong);
	__m256d far = _mm256_setzero_pd(), a, b, c;

	if (!_mm256_testz_si256(wrong, wrong)) /* then the places of the divisors may be anywhere */
		return false;
	a = four(even0, odd0, &far);
	b = four(even1, odd1, &far);
	c = four(even2, odd2, &far);
	_mm_storeu_pd(normal, _mm256_castpd256_pd128(a));
	_mm_storel_pd(normal + 2, _mm256_extractf128_pd(a, 1));
	_mm_storeh_pd(tri, _mm256_extractf128_pd(a, 1));
	_mm256_storeu_pd(tri + 1, b);
	_mm256_storeu_pd(tri + 5, c);
	if (_mm256_movemask_pd(far) != 0)
		for (int i = 0; i < 12; i++)
			(void)mp_number_scan_e(at[i] + 1, *at[i] == '-',
					       i < 3 ? &normal[i] : &tri[i - 3]);
	return true;
}

bool stl_has_vector(void)
{
	return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi");
}

__attribute__((target("avx2,bmi"))) const char *
stl_text_facet_vector(const char *p, const char *end, double tri[9], double normal[3],
		      unsigned indent[STL_LINES])
{
	const char *at[12];

	if (end - p < ROOM || (p = next_line(p, &indent[0])) == NULL)
		return NULL;
	if (!is_word(p, "facet no", 8) || !is_word(p + 5, " normal ", 8) || p[5] != ' ' ||
	    p[12] != ' ' || (p = numbers(p, 13, at, &indent[1])) == NULL)
		return NULL;
	if (!is_word(p, "outer lo", 8) || !is_word(p + 8, "op\0\0\0\0\0", 2) || p[5] != ' ' ||
	    (p = next_line(p + 10, &indent[2])) == NULL)
		return NULL;
	for (int i = 0; i < 3; i++)
		if (!is_word(p, "vertex ", 7) || p[6] != ' ' ||
		    (p = numbers(p, 7, at + 3 + 3 * i, &indent[3 + i])) == NULL)
			return NULL;
	if (!is_word(p, "endloop", 7) || (p = next_line(p + 7, &indent[6])) == NULL ||
	    !is_word(p, "endfacet", 8) || (p[8] != '\n' && p[8] != '\r'))
		return NULL;
	return convert(at, normal, tri) ? p + 8 : NULL;
}

#else

bool stl_has_vector(void)
{
	return false;
}

const char *stl_text_facet_vector(const char *p, const char *end, double tri[9], double normal[3],
				  unsigned indent[STL_LINES])
{
	(void)p;
	(void)end;
	(void)tri;
	(void)normal;
	(void)indent;
	return NULL;
}
#endif
