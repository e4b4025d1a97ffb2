#include "core/fingerprint/fingerprint_kernel.h"

#include <stdbool.h>

static const struct mp_cipher portable = {mp_aes_encrypt};

static void add_portable(const struct mp_aes key[2], const double (*tri)[9], size_t count,
			 uint64_t sum[2])
{
	mp_fingerprint_plain(&portable, key, tri, count, sum);
}

/* Triangles ${from} and above as doubles. */
static void widen(const float (*xyz)[MP_BLOCK], size_t from, size_t count, double (*tri)[9])
{
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 9; k++)
			tri[i][k] = (double)xyz[k][from + i];
}

static void add_portable_floats(const struct mp_aes key[2], const float (*xyz)[MP_BLOCK],
				size_t count, uint64_t sum[2])
{
	double tri[MP_BLOCK][9];

	widen(xyz, 0, count, tri);
	add_portable(key, (const double(*)[9])tri, count, sum);
}

#if defined(__x86_64__) && defined(__GNUC__)

#include <cpuid.h>
#include <immintrin.h>

/*
 * A copy here takes a few triangles at a time as floats and keeps them in registers; if some
 * coordinate of the block is none, what was summed is thrown away and the block goes the long way,
 * with the same instructions for the cipher.
 *
 * The two products of a triangle come from one: with (f,g) side by side, (c1 - c0)*(c2 - c0), the
 * second with its halves swapped, and S is what was summed on the left less that on the right.
 */
#define AESNI   __attribute__((target("aes,sse4.1")))
#define VAES    __attribute__((target("vaes,aes,avx512f,avx512dq,avx512vl")))
#define INLINE  static inline __attribute__((always_inline))
#define FLOATS  12 /* chains side by side hide the latency of a round */
#define IN_FOUR 4

AESNI static void encrypt_aesni(const struct mp_aes *aes, const uint64_t (*in)[2],
				uint64_t (*out)[2], size_t count)
{
	const __m128i *key = (const __m128i *)(const void *)aes->round;

	for (size_t i = 0; i < count; i += 8) {
		size_t n = count - i < 8 ? count - i : 8;
		__m128i b[8];

		for (size_t j = 0; j < 8; j++)
			b[j] = _mm_xor_si128(
			    _mm_loadu_si128((const __m128i *)(const void *)in[i + (j < n ? j : 0)]),
			    _mm_loadu_si128(key));
		for (int round = 1; round < 10; round++)
			for (int j = 0; j < 8; j++)
				b[j] = _mm_aesenc_si128(b[j], _mm_loadu_si128(key + round));
		for (size_t j = 0; j < n; j++)
			_mm_storeu_si128((__m128i *)(void *)out[i + j],
					 _mm_aesenclast_si128(b[j], _mm_loadu_si128(key + 10)));
	}
}

static const struct mp_cipher aesni = {encrypt_aesni};

/* The block of the corner at ${p} as floats; bits of ${*odd} where they lose something. */
AESNI INLINE __m128i corner_aesni(const double *p, __m128i *odd)
{
	const __m128i tag = _mm_set_epi32(-1, 0, 0, 0);
	__m128d xy = _mm_loadu_pd(p), z = _mm_load_sd(p + 2);
	__m128 near_xy = _mm_cvtpd_ps(xy), near_z = _mm_cvtpd_ps(z);
	__m128i lost_xy = _mm_castpd_si128(_mm_xor_pd(xy, _mm_cvtps_pd(near_xy)));
	__m128i lost_z = _mm_castpd_si128(_mm_xor_pd(z, _mm_cvtps_pd(near_z)));
	__m128 xyz = _mm_movelh_ps(near_xy, near_z);

	*odd = _mm_or_si128(*odd, _mm_or_si128(lost_xy, lost_z));
	xyz = _mm_add_ps(xyz, _mm_setzero_ps()); /* -0 becomes 0 */
	return _mm_or_si128(_mm_castps_si128(xyz), tag);
}

AESNI INLINE __m128i product_aesni(__m128i a, __m128i b)
{
	__m128i cross = _mm_mullo_epi32(a, _mm_shuffle_epi32(b, _MM_SHUFFLE(2, 3, 0, 1)));

	cross = _mm_add_epi32(cross, _mm_srli_epi64(cross, 32));
	return _mm_add_epi64(_mm_mul_epu32(a, b), _mm_slli_epi64(cross, 32));
}

/* Four triangles under one key; ${in}: corner k of triangle i at 3*i + k. */
AESNI INLINE __m128i four_aesni(const struct mp_aes *aes, const __m128i in[FLOATS])
{
	const __m128i *key = (const __m128i *)(const void *)aes->round;
	__m128i b[FLOATS], sum = _mm_setzero_si128();

	for (int j = 0; j < FLOATS; j++)
		b[j] = _mm_xor_si128(in[j], _mm_loadu_si128(key));
	for (int round = 1; round < 10; round++)
		for (int j = 0; j < FLOATS; j++)
			b[j] = _mm_aesenc_si128(b[j], _mm_loadu_si128(key + round));
	for (int j = 0; j < FLOATS; j++)
		b[j] = _mm_aesenclast_si128(b[j], _mm_loadu_si128(key + 10));
	for (int j = 0; j < FLOATS; j += 3) {
		__m128i one = _mm_sub_epi64(b[j + 1], b[j]), other = _mm_sub_epi64(b[j + 2], b[j]);

		other = _mm_shuffle_epi32(other, _MM_SHUFFLE(1, 0, 3, 2));
		sum = _mm_add_epi64(sum, product_aesni(one, other));
	}
	return sum;
}

AESNI INLINE void finish_aesni(__m128i sum, uint64_t *out)
{
	*out += (uint64_t)_mm_cvtsi128_si64(sum) - (uint64_t)_mm_extract_epi64(sum, 1);
}

AESNI static void add_aesni(const struct mp_aes key[2], const double (*tri)[9], size_t count,
			    uint64_t sum[2])
{
	__m128i s[2] = {_mm_setzero_si128(), _mm_setzero_si128()}, odd = s[0];
	size_t whole = count - count % IN_FOUR;

	for (size_t i = 0; i < whole; i += IN_FOUR) {
		__m128i in[FLOATS];

		for (size_t j = 0; j < FLOATS; j++)
			in[j] = corner_aesni(tri[i + j / 3] + 3 * (j % 3), &odd);
		for (int lane = 0; lane < 2; lane++)
			s[lane] = _mm_add_epi64(s[lane], four_aesni(&key[lane], in));
	}
	if (!_mm_testz_si128(odd, odd)) {
		whole = 0;
	} else {
		finish_aesni(s[0], &sum[0]);
		finish_aesni(s[1], &sum[1]);
	}
	if (whole < count)
		mp_fingerprint_plain(&aesni, key, tri + whole, count - whole, sum);
}

AESNI static void add_aesni_floats(const struct mp_aes key[2], const float (*xyz)[MP_BLOCK],
				   size_t count, uint64_t sum[2])
{
	const __m128 tag = _mm_castsi128_ps(_mm_set1_epi32(-1)), zero = _mm_setzero_ps();
	__m128i s[2] = {_mm_setzero_si128(), _mm_setzero_si128()};
	size_t whole = count - count % IN_FOUR;
	double rest[IN_FOUR][9];

	for (size_t i = 0; i < whole; i += IN_FOUR) {
		__m128i in[FLOATS];

		for (size_t k = 0; k < 3; k++) { /* corner k of four triangles */
			__m128 a = _mm_add_ps(_mm_loadu_ps(xyz[3 * k] + i), zero);
			__m128 b = _mm_add_ps(_mm_loadu_ps(xyz[3 * k + 1] + i), zero);
			__m128 c = _mm_add_ps(_mm_loadu_ps(xyz[3 * k + 2] + i), zero);
			__m128 d = tag;

			_MM_TRANSPOSE4_PS(a, b, c, d);
			in[k] = _mm_castps_si128(a);
			in[k + 3] = _mm_castps_si128(b);
			in[k + 6] = _mm_castps_si128(c);
			in[k + 9] = _mm_castps_si128(d);
		}
		for (int lane = 0; lane < 2; lane++)
			s[lane] = _mm_add_epi64(s[lane], four_aesni(&key[lane], in));
	}
	finish_aesni(s[0], &sum[0]);
	finish_aesni(s[1], &sum[1]);
	widen(xyz, whole, count - whole, rest);
	mp_fingerprint_plain(&aesni, key, (const double(*)[9])rest, count - whole, sum);
}

/* Corner at ${k} doubles of four triangles, a block each. */
VAES INLINE __m512i corners_vaes(const double (*tri)[9], int k, __m512i *odd)
{
	const __m512 zero = _mm512_setzero_ps();
	const __m512i tag = _mm512_maskz_set1_epi32(0x8888, -1);
	__m512d v[2];
	__m256 f[2];
	__m512 all;

	for (int i = 0; i < 2; i++) {
		v[i] = _mm512_castpd256_pd512(_mm256_maskz_loadu_pd(7, tri[2 * i] + k));
		v[i] = _mm512_insertf64x4(v[i], _mm256_maskz_loadu_pd(7, tri[2 * i + 1] + k), 1);
		f[i] = _mm512_cvtpd_ps(v[i]);
		*odd = _mm512_ternarylogic_epi64(*odd, _mm512_castpd_si512(v[i]),
						 _mm512_castpd_si512(_mm512_cvtps_pd(f[i])),
						 0xf6); /* odd | (v ^ f) */
	}
	all = _mm512_insertf32x8(_mm512_castps256_ps512(f[0]), f[1], 1);
	return _mm512_or_si512(_mm512_castps_si512(_mm512_add_ps(all, zero)), tag);
}

VAES INLINE __m512i key_vaes(const struct mp_aes *aes, int round)
{
	return _mm512_broadcast_i32x4(
	    _mm_loadu_si128((const __m128i *)(const void *)aes->round[round]));
}

/* Eight triangles under both keys; in[3*h + k]: corner k of triangles 4*h to 4*h + 3. */
VAES INLINE void eight_vaes(const struct mp_aes key[2], const __m512i in[6], __m512i sum[2])
{
	__m512i b[12];

	for (int j = 0; j < 12; j++)
		b[j] = _mm512_xor_si512(in[j % 6], key_vaes(&key[j / 6], 0));
	for (int round = 1; round < 10; round++)
		for (int j = 0; j < 12; j++)
			b[j] = _mm512_aesenc_epi128(b[j], key_vaes(&key[j / 6], round));
	for (int j = 0; j < 12; j++)
		b[j] = _mm512_aesenclast_epi128(b[j], key_vaes(&key[j / 6], 10));
	for (int j = 0; j < 12; j += 3) {
		__m512i one = _mm512_sub_epi64(b[j + 1], b[j]);
		__m512i other = _mm512_sub_epi64(b[j + 2], b[j]);

		other = _mm512_shuffle_epi32(other, (_MM_PERM_ENUM)_MM_SHUFFLE(1, 0, 3, 2));
		sum[j / 6] = _mm512_add_epi64(sum[j / 6], _mm512_mullo_epi64(one, other));
	}
}

VAES INLINE void finish_vaes(__m512i sum, uint64_t *out)
{
	uint64_t s[8];

	_mm512_storeu_si512(s, sum);
	for (int i = 0; i < 8; i += 2)
		*out += s[i] - s[i + 1];
}

VAES static void add_vaes(const struct mp_aes key[2], const double (*tri)[9], size_t count,
			  uint64_t sum[2])
{
	__m512i s[2] = {_mm512_setzero_si512(), _mm512_setzero_si512()}, odd = s[0];
	size_t whole = count - count % 8;

	for (size_t i = 0; i < whole; i += 8) {
		__m512i in[6];

		for (int j = 0; j < 6; j++)
			in[j] = corners_vaes(tri + i + 4 * (j / 3), 3 * (j % 3), &odd);
		eight_vaes(key, in, s);
	}
	if (_mm512_test_epi64_mask(odd, odd) != 0) {
		whole = 0;
	} else {
		finish_vaes(s[0], &sum[0]);
		finish_vaes(s[1], &sum[1]);
	}
	if (whole < count)
		add_aesni(key, tri + whole, count - whole, sum);
}

/* Corner ${k} of sixteen triangles, which come apart four by four: 0, 4, 8, 12; 1, 5, 9, 13; ... */
VAES INLINE void corners_floats(const float (*xyz)[MP_BLOCK], size_t at, int k, __m512i out[4])
{
	const __m512 zero = _mm512_setzero_ps();
	const __m512 tag = _mm512_castsi512_ps(_mm512_set1_epi32(-1));
	__m512 x = _mm512_add_ps(_mm512_loadu_ps(xyz[3 * k] + at), zero); /* -0 becomes 0 */
	__m512 y = _mm512_add_ps(_mm512_loadu_ps(xyz[3 * k + 1] + at), zero);
	__m512 z = _mm512_add_ps(_mm512_loadu_ps(xyz[3 * k + 2] + at), zero);
	__m512d xy = _mm512_castps_pd(_mm512_unpacklo_ps(x, y));
	__m512d zt = _mm512_castps_pd(_mm512_unpacklo_ps(z, tag));

	out[0] = _mm512_castpd_si512(_mm512_unpacklo_pd(xy, zt));
	out[1] = _mm512_castpd_si512(_mm512_unpackhi_pd(xy, zt));
	xy = _mm512_castps_pd(_mm512_unpackhi_ps(x, y));
	zt = _mm512_castps_pd(_mm512_unpackhi_ps(z, tag));
	out[2] = _mm512_castpd_si512(_mm512_unpacklo_pd(xy, zt));
	out[3] = _mm512_castpd_si512(_mm512_unpackhi_pd(xy, zt));
}

VAES static void add_vaes_floats(const struct mp_aes key[2], const float (*xyz)[MP_BLOCK],
				 size_t count, uint64_t sum[2])
{
	__m512i s[2] = {_mm512_setzero_si512(), _mm512_setzero_si512()};
	size_t whole = count - count % 16;
	double rest[16][9];

	for (size_t i = 0; i < whole; i += 16) {
		__m512i corner[3][4];

		for (int k = 0; k < 3; k++)
			corners_floats(xyz, i, k, corner[k]);
		for (int j = 0; j < 4; j += 2) {
			const __m512i in[6] = {corner[0][j],     corner[1][j],
					       corner[2][j],     corner[0][j + 1],
					       corner[1][j + 1], corner[2][j + 1]};

			eight_vaes(key, in, s);
		}
	}
	finish_vaes(s[0], &sum[0]);
	finish_vaes(s[1], &sum[1]);
	widen(xyz, whole, count - whole, rest);
	add_aesni(key, (const double(*)[9])rest, count - whole, sum);
}

static const struct mp_fingerprint_kernel KERNELS[] = {
    {"portable", add_portable, add_portable_floats},
    {"aesni", add_aesni, add_aesni_floats},
    {"vaes", add_vaes, add_vaes_floats}};

/* Not every compiler knows its name. */
static bool has_vaes(void)
{
	unsigned a, b, c, d;

	return __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (c >> 9 & 1) != 0 &&
	       __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
	       __builtin_cpu_supports("avx512vl");
}

size_t mp_fingerprint_kernels(void)
{
	if (!__builtin_cpu_supports("aes") || !__builtin_cpu_supports("sse4.1"))
		return 1;
	return has_vaes() ? 3 : 2;
}
#else
static const struct mp_fingerprint_kernel KERNELS[] = {
    {"portable", add_portable, add_portable_floats}};

size_t mp_fingerprint_kernels(void)
{
	return 1;
}
#endif

const struct mp_fingerprint_kernel *mp_fingerprint_kernel(size_t i)
{
	return &KERNELS[i];
}
