#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "core/geometry/predicates.h"

enum { LANES = 8 };

#define INLINE static inline __attribute__((always_inline))

/*
 * Certainly not 0: a*b - c*d, whose factors are differences of coordinates.  Differences and
 * products have relative errors of 2^-53 each, so 2^-50 of both products is more than enough; the
 * constant is for underflow.  False where something overflowed.
 */
INLINE int64_t differs(double a, double b, double c, double d)
{
	double p = a * b, q = c * d;

	return fabs(p - q) > 0x1p-50 * (fabs(p) + fabs(q)) + 0x1p-1000;
}

size_t mp_collinear_count(const double (*tri)[9], size_t count)
{
	size_t found = 0;

	for (size_t i = 0; i < count; i++) {
		const double *t = tri[i];
		double ux = t[3] - t[0], uy = t[4] - t[1], uz = t[5] - t[2];
		double vx = t[6] - t[0], vy = t[7] - t[1], vz = t[8] - t[2];

		if (!differs(uy, vz, uz, vy) && !differs(uz, vx, ux, vz) &&
		    !differs(ux, vy, uy, vx))
			found += (size_t)mp_collinear(t, t + 3, t + 6);
	}
	return found;
}

/* Up to eight triangles from ${at} on: those that nothing is known of. */
INLINE size_t count_some(const float (*xyz)[MP_BLOCK], size_t at, size_t count)
{
	size_t found = 0;

	for (size_t i = at; i < at + count; i++) {
		double t[9];

		for (size_t k = 0; k < 9; k++)
			t[k] = (double)xyz[k][i];
		found += (size_t)mp_collinear(t, t + 3, t + 6);
	}
	return found;
}

/* Eight triangles, where the loop becomes vectors; is each of them certainly none? */
INLINE bool none(const float (*xyz)[MP_BLOCK], size_t at)
{
	int64_t unsure = 0;

	for (size_t i = at; i < at + LANES; i++) {
		double ax = (double)xyz[0][i], ay = (double)xyz[1][i], az = (double)xyz[2][i];
		double ux = (double)xyz[3][i] - ax, vx = (double)xyz[6][i] - ax;
		double uy = (double)xyz[4][i] - ay, vy = (double)xyz[7][i] - ay;
		double uz = (double)xyz[5][i] - az, vz = (double)xyz[8][i] - az;
		bool x = differs(uy, vz, uz, vy), y = differs(uz, vx, ux, vz);
		bool z = differs(ux, vy, uy, vx);

		unsure |= (x + y) + z == 0;
	}
	return unsure == 0;
}

INLINE size_t count_all(const float (*xyz)[MP_BLOCK], size_t count)
{
	size_t found = 0, at = 0;

	for (; at + LANES <= count; at += LANES)
		if (!none(xyz, at))
			found += count_some(xyz, at, LANES);
	return found + count_some(xyz, at, count - at);
}

#define KERNEL(name, features)                                                 \
	features static size_t name(const float(*xyz)[MP_BLOCK], size_t count) \
	{                                                                      \
		return count_all(xyz, count);                                  \
	}

KERNEL(plain, )

#if defined(__x86_64__) && defined(__GNUC__)
KERNEL(avx2, __attribute__((target("avx2"))))
#ifdef __clang__
KERNEL(avx512, __attribute__((target("avx512f,avx512dq"))))
#else
KERNEL(avx512, __attribute__((target("avx512f,avx512dq,prefer-vector-width=512"))))
#endif

static size_t (*const KERNELS[])(const float (*xyz)[MP_BLOCK], size_t count) = {plain, avx2,
										avx512};

size_t mp_collinear_kernels(void)
{
	if (!__builtin_cpu_supports("avx2"))
		return 1;
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") ? 3 : 2;
}
#else
static size_t (*const KERNELS[])(const float (*xyz)[MP_BLOCK], size_t count) = {plain};

size_t mp_collinear_kernels(void)
{
	return 1;
}
#endif

size_t mp_collinear_count_with(size_t kernel, const float (*xyz)[MP_BLOCK], size_t count)
{
	return KERNELS[kernel](xyz, count);
}

size_t mp_collinear_count_floats(const float (*xyz)[MP_BLOCK], size_t count)
{
	return mp_collinear_count_with(mp_collinear_kernels() - 1, xyz, count);
}
