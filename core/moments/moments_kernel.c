#include "core/moments/moments_kernel.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What TwoSum and the error bounds rest on: every operation rounds to a double at once. */
_Static_assert(FLT_EVAL_METHOD == 0, "doubles must be computed as doubles: -msse2 -mfpmath=sse");

enum { LANES = MP_LANES, ROUND = 8 * MP_LANES };

#define INLINE static inline __attribute__((always_inline))

INLINE double smaller(double a, double b)
{
	return a < b ? a : b;
}

INLINE double larger(double a, double b)
{
	return a > b ? a : b;
}

/*
 * v: the corners, [corner*3 + axis][lane].  Widen the box by them, then scale them.
 * In this and the next function the lanes are the inner loop, so that it becomes vectors.
 */
INLINE void add_box(double (*restrict min)[LANES], double (*restrict max)[LANES],
		    double (*restrict v)[LANES], const double scale[3])
{
	for (int k = 0; k < 3; k++) {
		double factor = scale[k];

		for (int j = 0; j < LANES; j++) {
			double a = v[k][j], b = v[3 + k][j], c = v[6 + k][j];

			min[k][j] = smaller(smaller(a, b), smaller(c, min[k][j]));
			max[k][j] = larger(larger(a, b), larger(c, max[k][j]));
			v[k][j] = a * factor;
			v[3 + k][j] = b * factor;
			v[6 + k][j] = c * factor;
		}
	}
}

/*
 * Edges come from the vertices themselves, not from q: far from the reference q is rounded.
 * The doubts are explained where they are used, in moments_bound.c.
 */
INLINE void add_group(struct mp_lanes *restrict l, double (*restrict v)[LANES],
		      const double origin[3], const double weight[3])
{
	double ox = origin[0], oy = origin[1], oz = origin[2];
	double weight_x = weight[0], weight_y = weight[1], weight_z = weight[2];

	for (int j = 0; j < LANES; j++) {
		double ex = v[3][j] - v[0][j], ey = v[4][j] - v[1][j], ez = v[5][j] - v[2][j];
		double fx = v[6][j] - v[0][j], fy = v[7][j] - v[1][j], fz = v[8][j] - v[2][j];
		double ax = v[0][j] - ox, ay = v[1][j] - oy, az = v[2][j] - oz;
		double bx = v[3][j] - ox, by = v[4][j] - oy, bz = v[5][j] - oz;
		double cx = v[6][j] - ox, cy = v[7][j] - oy, cz = v[8][j] - oz;
		double yz = ey * fz, zy = ez * fy, zx = ez * fx;
		double xz = ex * fz, xy = ex * fy, yx = ey * fx;
		double nx = yz - zy, ny = zx - xz, nz = xy - yx;
		double tx = fabs(yz) + fabs(zy), ty = fabs(zx) + fabs(xz), tz = fabs(xy) + fabs(yx);
		double d = (ax * nx + ay * ny) + az * nz;
		double ux = ax + bx, uy = ay + by, uz = az + bz;
		double vx = bx + cx, vy = by + cy, vz = bz + cz;
		double wx = cx + ax, wy = cy + ay, wz = cz + az;
		double sx = ax + vx, sy = ay + vy, sz = az + vz;
		double mx = nx * weight_x, my = ny * weight_y, mz = nz * weight_z;
		double area2 = sqrt((mx * mx + my * my) + mz * mz);
		double xx = (ux * ux + wx * wx) + vx * vx;
		double yy = (uy * uy + wy * wy) + vy * vy;
		double zz = (uz * uz + wz * wz) + vz * vz;
		double doubt = 8 * ((fabs(ax) * tx + fabs(ay) * ty) + fabs(az) * tz) + 24 * fabs(d);

		l->a0[j] += d;
		l->a1[0][j] += d * sx;
		l->a1[1][j] += d * sy;
		l->a1[2][j] += d * sz;
		l->a2[0][j] += d * xx;
		l->a2[1][j] += d * yy;
		l->a2[2][j] += d * zz;
		l->a2[3][j] += d * ((ux * uy + wx * wy) + vx * vy);
		l->a2[4][j] += d * ((uy * uz + wy * wz) + vy * vz);
		l->a2[5][j] += d * ((uz * ux + wz * wx) + vz * vx);
		l->doubt[j] += doubt;
		l->doubt2[0][j] += doubt * xx;
		l->doubt2[1][j] += doubt * yy;
		l->doubt2[2][j] += doubt * zz;
		l->n[0][j] += nx;
		l->n[1][j] += ny;
		l->n[2][j] += nz;
		l->area2[j] += area2;
		l->area_s[0][j] += area2 * sx;
		l->area_s[1][j] += area2 * sy;
		l->area_s[2][j] += area2 * sz;
		l->area_doubt[j] += (weight_x * tx + weight_y * ty) + weight_z * tz;
	}
}

struct source { /* one of the two */
	const double (*tri)[9];
	const float (*xyz)[MP_BLOCK];
};

/* Eight triangles side by side. */
INLINE void load(const struct source *from, size_t at, double (*restrict v)[LANES])
{
	if (from->xyz != NULL)
		for (int i = 0; i < 9; i++)
			for (int j = 0; j < LANES; j++)
				v[i][j] = (double)from->xyz[i][at + (size_t)j];
	else
		for (int j = 0; j < LANES; j++)
			for (int i = 0; i < 9; i++)
				v[i][j] = from->tri[at + (size_t)j][i];
}

/* What is left of a block, filled up with a point of the mesh, which adds 0 to every sum. */
INLINE void load_rest(const struct source *from, size_t at, size_t count, double (*v)[LANES])
{
	for (size_t j = 0; j < LANES; j++)
		for (size_t i = 0; i < 9; i++) {
			size_t k = j < count ? i : i % 3, t = j < count ? at + j : at;

			v[i][j] = from->xyz != NULL ? (double)from->xyz[k][t] : from->tri[t][k];
		}
}

/* Rounds of 64 triangles apiece, so that no chain of additions is long. */
INLINE void add_all(struct mp_lanes *restrict sums, double (*restrict min)[LANES],
		    double (*restrict max)[LANES], const struct mp_frame *frame,
		    const struct source *from, size_t count)
{
	enum { WIDTH = sizeof *sums / sizeof(double) };
	struct mp_frame f = *frame;
	double v[9][LANES];

	for (size_t round = 0; round < count; round += ROUND) {
		struct mp_lanes l = {0};
		const double *part = (const double *)&l;
		double *whole = (double *)sums;
		size_t end = count - round < ROUND ? count : round + ROUND;

		for (size_t at = round; at < end; at += LANES) {
			if (end - at >= LANES)
				load(from, at, v);
			else
				load_rest(from, at, end - at, v);
			add_box(min, max, v, f.scale);
			add_group(&l, v, f.origin, f.weight);
		}
		for (int i = 0; i < WIDTH; i++)
			whole[i] += part[i];
	}
}

#define KERNEL(name, features)                                                                 \
	features static void name(struct mp_lanes *sums, double min[3][LANES],                 \
				  double max[3][LANES], const struct mp_frame *frame,          \
				  const double(*tri)[9], size_t count)                         \
	{                                                                                      \
		const struct source from = {.tri = tri};                                       \
                                                                                               \
		add_all(sums, min, max, frame, &from, count);                                  \
	}                                                                                      \
	features static void name##_floats(struct mp_lanes *sums, double min[3][LANES],        \
					   double max[3][LANES], const struct mp_frame *frame, \
					   const float(*xyz)[MP_BLOCK], size_t count)          \
	{                                                                                      \
		const struct source from = {.xyz = xyz};                                       \
                                                                                               \
		add_all(sums, min, max, frame, &from, count);                                  \
	}

KERNEL(add_plain, )

#if defined(__x86_64__) && defined(__GNUC__)
KERNEL(add_avx2, __attribute__((target("avx2"))))
#ifdef __clang__
KERNEL(add_avx512, __attribute__((target("avx512f"))))
#else
KERNEL(add_avx512, __attribute__((target("avx512f,prefer-vector-width=512"))))
#endif

static const struct mp_kernel KERNELS[] = {{"plain", add_plain, add_plain_floats},
					   {"avx2", add_avx2, add_avx2_floats},
					   {"avx512", add_avx512, add_avx512_floats}};

size_t mp_kernel_count(void)
{
	if (!__builtin_cpu_supports("avx2"))
		return 1;
	return __builtin_cpu_supports("avx512f") ? 3 : 2;
}
#else
static const struct mp_kernel KERNELS[] = {{"plain", add_plain, add_plain_floats}};

size_t mp_kernel_count(void)
{
	return 1;
}
#endif

const struct mp_kernel *mp_kernel_get(size_t i)
{
	return &KERNELS[i];
}
