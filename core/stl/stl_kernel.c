#include "core/stl/stl_kernel.h"

#include <string.h>

#include "core/stl/stl_private.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

enum { LANES = 8 };

#define INLINE static inline __attribute__((always_inline))

static void turn(struct stl_columns *c, size_t at, const uint8_t *p, size_t count)
{
	for (size_t i = 0; i < count; i++, p += STL_FACET)
		for (size_t k = 0; k < 12; k++) {
			const uint8_t *b = p + 4 * k;
			uint32_t bits = b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 |
					(uint32_t)b[3] << 24;

			memcpy(&c->row[k][at + i], &bits, sizeof bits);
		}
}

/* stl_check_normal() of facets ${at} and above; the lanes are the inner loop, to become vectors. */
INLINE void check_normals(const struct stl_columns *c, size_t at, size_t count,
			  struct stl_columns_seen *seen)
{
	const float(*n)[MP_BLOCK] = c->row, (*t)[MP_BLOCK] = c->row + 3;
	int64_t disagreeing[LANES] = {0}, odd[LANES] = {0};
	size_t whole = count - count % LANES;
	struct mp_notes rest = {.triangles = 0};

	for (size_t i = at; i < at + whole; i += LANES)
		for (size_t j = 0; j < LANES; j++) {
			double nx = (double)n[0][i + j], ny = (double)n[1][i + j];
			double nz = (double)n[2][i + j], ax = (double)t[0][i + j];
			double ay = (double)t[1][i + j], az = (double)t[2][i + j];
			double ux = (double)t[3][i + j] - ax, uy = (double)t[4][i + j] - ay;
			double uz = (double)t[5][i + j] - az, vx = (double)t[6][i + j] - ax;
			double vy = (double)t[7][i + j] - ay, vz = (double)t[8][i + j] - az;
			double dot = nx * (uy * vz - uz * vy) + ny * (uz * vx - ux * vz) +
				     nz * (ux * vy - uy * vx);
			bool finite = (nx - nx) + (ny - ny) + (nz - nz) == 0;

			odd[j] += !finite;
			disagreeing[j] += finite & (dot < 0.0);
		}
	for (size_t i = at + whole; i < at + count; i++) {
		double tri[9], normal[3];

		for (size_t k = 0; k < 9; k++)
			tri[k] = (double)t[k][i];
		for (size_t k = 0; k < 3; k++)
			normal[k] = (double)n[k][i];
		stl_check_normal(&rest, tri, normal);
	}
	for (size_t j = 0; j < LANES; j++) {
		rest.normals_not_finite += (uint64_t)odd[j];
		rest.normals_disagreeing += (uint64_t)disagreeing[j];
	}
	seen->normals_not_finite = rest.normals_not_finite;
	seen->normals_disagreeing = rest.normals_disagreeing;
}

/* Bit 31 of a sum is set where the exponent is all ones. */
INLINE bool has_not_finite(const struct stl_columns *c, size_t at, size_t count)
{
	uint32_t bad = 0;

	for (size_t k = 3; k < 12; k++)
		for (size_t i = at; i < at + count; i++) {
			uint32_t bits;

			memcpy(&bits, &c->row[k][i], sizeof bits);
			bad |= (bits & 0x7f800000) + 0x00800000;
		}
	return bad >> 31 != 0;
}

INLINE void look(const struct stl_columns *c, size_t at, size_t count,
		 struct stl_columns_seen *seen)
{
	check_normals(c, at, count, seen);
	seen->not_finite = has_not_finite(c, at, count);
}

static void read_plain(struct stl_columns *c, size_t at, const uint8_t *p, size_t count,
		       struct stl_columns_seen *seen)
{
	turn(c, at, p, count);
	look(c, at, count, seen);
}

#if defined(__x86_64__) && defined(__GNUC__)
#define AVX2 __attribute__((target("avx2")))
#ifdef __clang__
#define AVX512 __attribute__((target("avx512f,avx512dq,avx512bw,avx512vl")))
#else
#define AVX512 __attribute__((target("avx512f,avx512dq,avx512bw,avx512vl,prefer-vector-width=512")))
#endif

/* The four numbers at ${p}, and those of the facet four further on. */
AVX2 INLINE __m256 pair(const uint8_t *p)
{
	const __m128i *near = (const __m128i *)(const void *)p;
	const __m128i *far = (const __m128i *)(const void *)(p + 4 * STL_FACET);
	__m256i low = _mm256_castsi128_si256(_mm_loadu_si128(near));

	return _mm256_castsi256_ps(_mm256_inserti128_si256(low, _mm_loadu_si128(far), 1));
}

/* Eight facets. */
AVX2 INLINE void turn_eight(struct stl_columns *c, size_t at, const uint8_t *p)
{
	for (size_t k = 0; k < 12; k += 4, p += 16) {
		__m256 a = pair(p), b = pair(p + STL_FACET);
		__m256 d = pair(p + 2 * STL_FACET), e = pair(p + 3 * STL_FACET);
		__m256 ab = _mm256_unpacklo_ps(a, b), de = _mm256_unpacklo_ps(d, e);

		_mm256_storeu_ps(c->row[k] + at, _mm256_shuffle_ps(ab, de, 0x44));
		_mm256_storeu_ps(c->row[k + 1] + at, _mm256_shuffle_ps(ab, de, 0xee));
		ab = _mm256_unpackhi_ps(a, b);
		de = _mm256_unpackhi_ps(d, e);
		_mm256_storeu_ps(c->row[k + 2] + at, _mm256_shuffle_ps(ab, de, 0x44));
		_mm256_storeu_ps(c->row[k + 3] + at, _mm256_shuffle_ps(ab, de, 0xee));
	}
}

AVX2 INLINE void turn_all(struct stl_columns *c, size_t at, const uint8_t *p, size_t count)
{
	size_t i = 0;

	for (; i + LANES <= count; i += LANES)
		turn_eight(c, at + i, p + i * STL_FACET);
	turn(c, at + i, p + i * STL_FACET, count - i);
}

AVX2 static void read_avx2(struct stl_columns *c, size_t at, const uint8_t *p, size_t count,
			   struct stl_columns_seen *seen)
{
	turn_all(c, at, p, count);
	look(c, at, count, seen);
}

AVX512 static void look_avx512(const struct stl_columns *c, size_t at, size_t count,
			       struct stl_columns_seen *seen)
{
	look(c, at, count, seen);
}

AVX2 static void read_avx512(struct stl_columns *c, size_t at, const uint8_t *p, size_t count,
			     struct stl_columns_seen *seen)
{
	turn_all(c, at, p, count);
	look_avx512(c, at, count, seen);
}

static void (*const KERNELS[])(struct stl_columns *c, size_t at, const uint8_t *p, size_t count,
			       struct stl_columns_seen *seen) = {read_plain, read_avx2,
								 read_avx512};

size_t stl_columns_kernels(void)
{
	if (!__builtin_cpu_supports("avx2"))
		return 1;
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
		       __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")
		   ? 3
		   : 2;
}
#else
static void (*const KERNELS[])(struct stl_columns *c, size_t at, const uint8_t *p, size_t count,
			       struct stl_columns_seen *seen) = {read_plain};

size_t stl_columns_kernels(void)
{
	return 1;
}
#endif

void stl_columns_read(size_t kernel, struct stl_columns *c, size_t at, const uint8_t *p,
		      size_t count, struct stl_columns_seen *seen)
{
	KERNELS[kernel](c, at, p, count, seen);
}
