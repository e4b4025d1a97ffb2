#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "core/topology/topology.h"

enum { LANES = 8 };

#define INLINE static inline __attribute__((always_inline))

/*
 * Whether the projection of ${t} along axis ${k} is certainly not flat: Shewchuk's filter as in
 * predicates.c, with |left| + |right|, which is larger where the signs differ but then equal to
 * the other side.  The limits keep products from underflow and overflow.
 */
INLINE int is_wide(const double t[9], unsigned k)
{
	unsigned l = k == 2 ? 0 : k + 1;
	double left = (t[k] - t[6 + k]) * (t[3 + l] - t[6 + l]);
	double right = (t[l] - t[6 + l]) * (t[3 + k] - t[6 + k]);
	double sum = fabs(left) + fabs(right);

	return (sum > 0x1p-960) & (sum < 0x1p1020) & (fabs(left - right) > 0x1p-51 * sum);
}

INLINE void mark(const double t[9], uint64_t number, uint64_t *flat)
{
	uint64_t group = number / MP_FLAT_GROUP;

	if (!is_wide(t, 0) && !is_wide(t, 1) && !is_wide(t, 2))
		flat[group / 64] |= (uint64_t)1 << (group % 64);
}

void mp_flat_mark(const double (*tri)[9], size_t count, uint64_t first, uint64_t *flat)
{
	for (size_t i = 0; i < count; i++)
		mark(tri[i], first + i, flat);
}

INLINE void take(const float (*xyz)[MP_BLOCK], size_t i, double t[9])
{
	for (unsigned k = 0; k < 9; k++)
		t[k] = (double)xyz[k][i];
}

/* Whether something is to be marked of eight triangles; this loop becomes vectors. */
INLINE bool is_any_flat(const float (*xyz)[MP_BLOCK], size_t at)
{
	int64_t wide[LANES], all = 1;

	for (size_t j = 0; j < LANES; j++) {
		double t[9];

		take(xyz, at + j, t);
		wide[j] = is_wide(t, 0) | is_wide(t, 1) | is_wide(t, 2);
	}
	for (size_t j = 0; j < LANES; j++)
		all &= wide[j];
	return all == 0;
}

INLINE void mark_all(const float (*xyz)[MP_BLOCK], size_t count, uint64_t first, uint64_t *flat)
{
	for (size_t i = 0; i < count;) {
		size_t end = count - i < LANES ? count : i + LANES;

		if (end - i == LANES && !is_any_flat(xyz, i))
			i = end;
		for (; i < end; i++) {
			double t[9];

			take(xyz, i, t);
			mark(t, first + i, flat);
		}
	}
}

#define KERNEL(name, features)                                                               \
	features static void name(const float(*xyz)[MP_BLOCK], size_t count, uint64_t first, \
				  uint64_t *flat)                                            \
	{                                                                                    \
		mark_all(xyz, count, first, flat);                                           \
	}

KERNEL(plain, )

#if defined(__x86_64__) && defined(__GNUC__)
KERNEL(avx2, __attribute__((target("avx2"))))
#ifdef __clang__
KERNEL(avx512, __attribute__((target("avx512f,avx512dq"))))
#else
KERNEL(avx512, __attribute__((target("avx512f,avx512dq,prefer-vector-width=512"))))
#endif

static void (*const KERNELS[])(const float (*xyz)[MP_BLOCK], size_t count, uint64_t first,
			       uint64_t *flat) = {plain, avx2, avx512};

size_t mp_flat_kernels(void)
{
	if (!__builtin_cpu_supports("avx2"))
		return 1;
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") ? 3 : 2;
}
#else
static void (*const KERNELS[])(const float (*xyz)[MP_BLOCK], size_t count, uint64_t first,
			       uint64_t *flat) = {plain};

size_t mp_flat_kernels(void)
{
	return 1;
}
#endif

void mp_flat_mark_with(size_t kernel, const float (*xyz)[MP_BLOCK], size_t count, uint64_t first,
		       uint64_t *flat)
{
	KERNELS[kernel](xyz, count, first, flat);
}

void mp_flat_mark_floats(const float (*xyz)[MP_BLOCK], size_t count, uint64_t first, uint64_t *flat)
{
	mp_flat_mark_with(mp_flat_kernels() - 1, xyz, count, first, flat);
}
