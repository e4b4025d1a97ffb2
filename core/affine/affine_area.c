#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "core/affine/affine.h"

#define U        0x1p-53L
#define SLACK    (1 + 0x1p-20L)
#define SQRT_H   0x1p-536L /* > sqrt(3/2 * 2^-1074) */
#define H        0x1p-1074L
#define ROUNDING 0x1p-47L  /* what a vector area may be off by over the area */
#define SMALL    0x1p-450L /* of a sum of lengths: below it underflow may have eaten digits */

enum { BLOCK = 256 };

/* Of |m|, |m| s, m, and t, in the frame of struct frame. */
enum { AREA, CENTROID, VECTOR = CENTROID + 3, DOUBT = VECTOR + 3, SUMS = DOUBT + 3 };

/*
 * q = (x - origin)*scale, so that the box is about 1 wide along every axis; m = W (e x f) has its
 * largest element near 1, and is twice the mapped vector area times 2^-exponent.
 */
struct frame {
	double origin[3], scale[3], w[3][3];
	long double w_bound[3][3];
	int exponent;
	bool fits; /* within the range of a long double */
};

struct sums {
	struct mp_sum of[SUMS];
	uint64_t blocks, triangles;
};

static void add(struct mp_sum *sum, double x)
{
	double s = sum->hi + x; /* TwoSum, Knuth: s + error == hi + x exactly */
	double part = s - sum->hi;

	sum->lo += (sum->hi - (s - part)) + (x - part);
	sum->hi = s;
}

static long double value(const struct mp_sum *sum)
{
	return (long double)sum->hi + sum->lo;
}

/* The cofactor of L that makes normals of normals, with the sign that the winding takes. */
static struct mp_ball cofactor(const struct mp_affine *a, int i, int k)
{
	const double *p = a->row[(i + 1) % 3], *q = a->row[(i + 2) % 3];
	int c = (k + 1) % 3, d = (k + 2) % 3;
	struct mp_ball x = mp_ball_sub(mp_ball_mul(mp_ball_exact(p[c]), mp_ball_exact(q[d])),
				       mp_ball_mul(mp_ball_exact(p[d]), mp_ball_exact(q[c])));

	return a->mirrors ? mp_ball_neg(x) : x;
}

static void set_weights(const struct mp_affine *a, struct frame *f)
{
	struct mp_ball w[3][3];
	long double largest = 0;

	for (int i = 0; i < 9; i++) {
		long double scale = f->scale[i % 3];

		w[i / 3][i % 3] = mp_ball_mul(cofactor(a, i / 3, i % 3), mp_ball_exact(scale));
		largest = fmaxl(largest, mp_ball_most(w[i / 3][i % 3]));
	}
	f->fits = largest > 0 && largest <= LDBL_MAX;
	if (!f->fits)
		return;
	(void)frexpl(largest, &f->exponent);
	for (int i = 0; i < 9; i++) {
		struct mp_ball x = w[i / 3][i % 3];

		x.mid = ldexpl(x.mid, -f->exponent);
		x.rad = ldexpl(x.rad, -f->exponent) + MP_BALL_TINY;
		f->w[i / 3][i % 3] = (double)x.mid;
		f->w_bound[i / 3][i % 3] = mp_ball_distance(x, (double)x.mid);
	}
	for (int k = 0; k < 3; k++)
		f->exponent -= ilogb(f->scale[k]);
}

/* Powers of two that make the box about 1 wide; a flat axis takes the largest of the others. */
static void set_frame(const struct mp_affine *a, const struct mp_box *box, struct frame *f)
{
	struct mp_moments extent = {.scale = {1, 1, 1}}, scaled;

	memcpy(extent.min, box->min, sizeof extent.min);
	memcpy(extent.max, box->max, sizeof extent.max);
	mp_moments_begin_again(&scaled, &extent);
	memcpy(f->scale, scaled.scale, sizeof f->scale);
	memcpy(f->origin, scaled.reference, sizeof f->origin);
	set_weights(a, f);
}

static void add_triangle(const struct frame *f, double q[3][3], struct mp_sum sum[SUMS])
{
	double e[3], d[3], n[3], t[3], m[3], length;

	for (int k = 0; k < 3; k++) { /* from the vertices themselves: q would be rounded */
		e[k] = q[1][k] * f->scale[k] - q[0][k] * f->scale[k];
		d[k] = q[2][k] * f->scale[k] - q[0][k] * f->scale[k];
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		double p = e[i] * d[j], r = e[j] * d[i];

		n[k] = p - r;
		t[k] = fabs(p) + fabs(r);
	}
	for (int i = 0; i < 3; i++)
		m[i] = (f->w[i][0] * n[0] + f->w[i][1] * n[1]) + f->w[i][2] * n[2];
	length = sqrt((m[0] * m[0] + m[1] * m[1]) + m[2] * m[2]);
	add(&sum[AREA], length);
	for (int k = 0; k < 3; k++) {
		double s = 0;

		for (int c = 0; c < 3; c++)
			s += q[c][k] * f->scale[k] - f->origin[k] * f->scale[k];
		add(&sum[CENTROID + k], length * s);
		add(&sum[VECTOR + k], m[k]);
		add(&sum[DOUBT + k], t[k]);
	}
}

static void add_all(const struct frame *f, const struct mp_mesh *mesh, const uint32_t *order,
		    uint32_t count, struct sums *out)
{
	memset(out, 0, sizeof *out);
	out->triangles = count;
	for (uint32_t at = 0, end; at < count; at = end) {
		struct mp_sum block[SUMS] = {{0, 0}};

		end = count - at < BLOCK ? count : at + BLOCK;
		for (uint32_t i = at; i < end; i++) {
			const uint32_t *corner = mesh->tri[order != NULL ? order[i] : i];
			double q[3][3];

			for (int c = 0; c < 3; c++)
				mp_vertices_get(mesh->vertices, corner[c], q[c]);
			add_triangle(f, q, block);
		}
		for (int k = 0; k < SUMS; k++)
			add(&out->of[k], block[k].hi + block[k].lo);
		out->blocks++;
	}
}

/* Of twice the area, in the frame. */
static long double find_bound(const struct frame *f, const struct sums *s)
{
	long double n = (long double)s->blocks + BLOCK, error = 0;

	for (int i = 0; i < 9; i++)
		error +=
		    (7 * U * fabsl((long double)f->w[i / 3][i % 3]) + f->w_bound[i / 3][i % 3]) *
		    value(&s->of[DOUBT + i % 3]);
	error += (6 * U + n * n * U * U) * value(&s->of[AREA]);
	return error * SLACK + (long double)s->triangles * (SQRT_H + 64 * H);
}

static bool in_range(const struct sums *s)
{
	for (int k = 0; k < SUMS; k++)
		if (!isfinite(s->of[k].hi) || !isfinite(s->of[k].lo))
			return false;
	return value(&s->of[AREA]) == 0 || value(&s->of[AREA]) >= SMALL;
}

static void solve(const struct frame *f, const struct sums *s, struct mp_solid *io)
{
	long double area2 = value(&s->of[AREA]);

	io->area = ldexpl(area2, f->exponent - 1);
	io->area_bound = ldexpl(find_bound(f, s), f->exponent - 1);
	io->area_bound += io->area * MP_BALL_UNIT * 4 + MP_BALL_TINY;
	io->has_surface_centroid = area2 > 0;
	for (int k = 0; k < 3; k++) {
		long double n = ldexpl(value(&s->of[VECTOR + k]), f->exponent - 1);

		io->vector_area[k] = fabsl(n) > ROUNDING * io->area ? n : 0;
		io->surface_centroid[k] =
		    area2 > 0 ? f->origin[k] + value(&s->of[CENTROID + k]) / area2 / 3 / f->scale[k]
			      : 0;
	}
}

static void map_centroid(const struct mp_affine *a, struct mp_solid *io)
{
	long double x[3];

	if (!io->has_surface_centroid)
		return;
	memcpy(x, io->surface_centroid, sizeof x);
	for (int i = 0; i < 3; i++)
		io->surface_centroid[i] =
		    ((a->row[i][0] * x[0] + a->row[i][1] * x[1]) + a->row[i][2] * x[2]) +
		    a->row[i][3];
}

/* All areas change by the square of the factor. */
static void scale_area(const struct mp_affine *a, struct mp_solid *io)
{
	struct mp_ball factor = mp_ball_exact(a->factor);
	struct mp_ball area =
	    mp_ball_mul(mp_ball_mul(factor, factor), mp_ball(io->area, io->area_bound));
	long double x[3];

	io->area = area.mid;
	io->area_bound = area.rad;
	memcpy(x, io->vector_area, sizeof x);
	for (int i = 0; i < 3; i++)
		io->vector_area[i] =
		    ((a->row[i][0] * x[0] + a->row[i][1] * x[1]) + a->row[i][2] * x[2]) * a->factor;
}

void mp_affine_area(const struct mp_affine *a, const struct mp_mesh *mesh, const uint32_t *order,
		    uint32_t count, const struct mp_box *box, struct mp_solid *io)
{
	struct frame frame;
	struct sums sums;

	if (io->area == 0 && io->area_bound == 0 && io->area_in_range)
		return; /* lines stay lines */
	if (a->factor > 0 && io->area_in_range) {
		scale_area(a, io);
		map_centroid(a, io);
		return;
	}
	set_frame(a, box, &frame);
	io->area_in_range = false;
	if (!frame.fits)
		return;
	add_all(&frame, mesh, order, count, &sums);
	io->area_in_range = in_range(&sums);
	if (!io->area_in_range)
		return;
	solve(&frame, &sums, io);
	map_centroid(a, io);
}
