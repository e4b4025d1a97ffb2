#include "core/moments/uncertainty_kernel.h"

#include <stdbool.h>
#include <string.h>

typedef float quad __attribute__((vector_size(16)));
typedef double wide __attribute__((vector_size(32)));
typedef int64_t bits __attribute__((vector_size(32)));

enum { AHEAD = 40 }; /* links to prefetch for: about the latency of memory */

#define INLINE static inline __attribute__((always_inline))

#define LANES(v, a, b, c, d) __builtin_shufflevector(v, v, a, b, c, d)

/* Vectors go by pointers, so that no kernel depends on how they are passed: all of it is inlined.
 */
struct frame {
	wide origin, scale; /* by axis */
	wide ulp, step2;    /* by lane */
	wide factor[4];     /* by lane: of struct rows, if differences are not scaled */
	double least;       /* a float below it has the steps of it */
};

struct vertex {
	wide at, four; /* the latter: 4*(at - origin), scaled */
};

/* The derivatives of the volume and of the three moments, by lane. */
struct rows {
	wide v, x, y, z;
};

INLINE void load(const double x[4], double factor, wide *out)
{
	memcpy(out, x, sizeof *out);
	*out *= factor;
}

/* Floats as they are, halves of doubles, so that no difference overflows; the fourth is anything.
 */
INLINE void find_point(const struct mp_deviation_frame *f, bool floats, size_t vertex, wide *out)
{
	quad q;

	if (floats) { /* one more than three can be read */
		memcpy(&q, f->narrow + 3 * vertex, sizeof q);
		*out = (wide){(double)q[0], (double)q[1], (double)q[2], (double)q[3]};
	} else {
		memcpy(out, f->wide + 3 * vertex, sizeof *out);
		*out *= 0.5;
	}
}

/* Products of floats stay within the range of doubles: sums of them are scaled, that is enough. */
INLINE void set_factors(const struct mp_deviation_frame *f, struct frame *out)
{
	const double *s = f->scale;
	const wide normal = {s[0] * s[1], s[1] * s[2], s[2] * s[0], 0};

	out->factor[0] = normal;
	for (int k = 0; k < 3; k++)
		out->factor[1 + k] = normal * s[k];
}

INLINE void set_frame(const struct mp_deviation_frame *f, bool floats, struct frame *out)
{
	const double unit = floats ? 1 : 0.5; /* of points */

	load(f->origin, unit, &out->origin);
	load(f->scale, 1 / unit, &out->scale);
	load(f->ulp, 1 / unit, &out->ulp);
	load(f->step, 1, &out->step2);
	out->step2 *= out->step2;
	out->least = 0x1p-126 * unit;
	set_factors(f, out);
}

/* Three floats may lie in two lines of the cache. */
INLINE void prefetch(const struct mp_deviation_frame *f, uint64_t link)
{
	const float *p = f->narrow + 3 * (size_t)(link >> 32);

	__builtin_prefetch(p);
	__builtin_prefetch(p + 3); /* one more is read */
}

INLINE void add_link(const struct mp_deviation_frame *f, bool floats, uint64_t link,
		     const struct frame *frame, const struct vertex *own, struct rows *sum)
{
	wide a, b, n, s;

	find_point(f, floats, link >> 32, &a);
	find_point(f, floats, (uint32_t)link, &b);
	a -= own->at;
	b -= own->at;
	if (!floats) {
		a *= frame->scale;
		b *= frame->scale;
	}
	n = a * LANES(b, 1, 2, 0, 3) - LANES(a, 1, 2, 0, 3) * b; /* z, x, y */
	s = a + b + own->four;
	sum->v += n;
	sum->x += n * LANES(s, 0, 0, 0, 0);
	sum->y += n * LANES(s, 1, 1, 1, 1);
	sum->z += n * LANES(s, 2, 2, 2, 2);
}

/*
 * Squares of the scaled half steps, by lane.  Half the distance between float32 numbers of the size
 * of x is 2^-24 of the power of two at or below it, 2^-150 where that is below 2^-126.
 */
INLINE void find_steps(const struct frame *f, const wide *at, wide *out)
{
	const wide x = LANES(*at, 2, 0, 1, 3), least = {f->least, f->least, f->least, f->least};
	const wide power = (wide)((bits)x & (INT64_C(0x7ff) << 52));
	const bits small = power < least;
	const wide h = (wide)((small & (bits)least) | (~small & (bits)power)) * f->ulp;

	*out = h * h + f->step2;
}

INLINE void scale_rows(const struct frame *f, struct rows *r)
{
	r->v *= f->factor[0];
	r->x *= f->factor[1];
	r->y *= f->factor[2];
	r->z *= f->factor[3];
}

INLINE void turn(const struct mp_deviation_frame *f, struct rows *r)
{
	const wide x = r->x, y = r->y, z = r->z;

	r->x = f->turn[0][0] * x + f->turn[0][1] * y + f->turn[0][2] * z;
	r->y = f->turn[1][0] * x + f->turn[1][1] * y + f->turn[1][2] * z;
	r->z = f->turn[2][0] * x + f->turn[2][1] * y + f->turn[2][2] * z;
}

INLINE void add_vertex(const struct rows *r, const wide *h2, wide out[7])
{
	const wide weight = *h2 * r->v;

	out[0] += weight * r->v;
	out[1] += weight * r->x;
	out[2] += weight * r->y;
	out[3] += weight * r->z;
	out[4] += *h2 * (r->x * r->x);
	out[5] += *h2 * (r->y * r->y);
	out[6] += *h2 * (r->z * r->z);
}

INLINE void add_all(struct mp_deviation_sums *sums, const struct mp_deviation_frame *given,
		    bool floats, const struct mp_links *links)
{
	const struct mp_deviation_frame f = *given; /* where no store can reach it */
	const uint32_t *row = links->row;
	const uint64_t *link = links->link, *end = link,
		       *last = link + (row[links->count] - row[0]);
	struct frame frame;
	wide out[7];

	_Static_assert(sizeof *sums == sizeof out, "vv, vm and mm are rows of out");
	memcpy(out, sums, sizeof out);
	set_frame(&f, floats, &frame);
	for (ptrdiff_t i = 0; floats && i < AHEAD && i < last - link; i++)
		prefetch(&f, link[i]);
	for (uint32_t i = 0; i < links->count; i++) {
		struct rows r = {{0}, {0}, {0}, {0}};
		struct vertex own;
		wide h2;

		find_point(&f, floats, links->first + i, &own.at);
		own.four = (own.at - frame.origin) * 4;
		if (!floats)
			own.four *= frame.scale;
		end += row[i + 1] - row[i];
		for (const ptrdiff_t ahead = last - end < AHEAD ? 0 : AHEAD; link < end; link++) {
			if (floats)
				prefetch(&f, link[ahead]);
			add_link(&f, floats, *link, &frame, &own, &r);
		}
		if (floats)
			scale_rows(&frame, &r);
		if (f.turned)
			turn(&f, &r);
		find_steps(&frame, &own.at, &h2);
		add_vertex(&r, &h2, out);
	}
	memcpy(sums, out, sizeof out);
}

#define KERNEL(name, features)                                        \
	features static void name(struct mp_deviation_sums *sums,     \
				  const struct mp_deviation_frame *f, \
				  const struct mp_links *links)       \
	{                                                             \
		if (f->narrow != NULL)                                \
			add_all(sums, f, true, links);                \
		else                                                  \
			add_all(sums, f, false, links);               \
	}

KERNEL(add_plain, )

#if defined(__x86_64__) && defined(__GNUC__)
KERNEL(add_avx2, __attribute__((target("avx2"))))

static const struct mp_deviation_kernel KERNELS[] = {{"plain", add_plain}, {"avx2", add_avx2}};

size_t mp_deviation_kernel_count(void)
{
	return __builtin_cpu_supports("avx2") ? 2 : 1;
}
#else
static const struct mp_deviation_kernel KERNELS[] = {{"plain", add_plain}};

size_t mp_deviation_kernel_count(void)
{
	return 1;
}
#endif

const struct mp_deviation_kernel *mp_deviation_kernel_get(size_t i)
{
	return &KERNELS[i];
}
