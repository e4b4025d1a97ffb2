#include "core/affine/affine.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "core/exact/exact.h"

/* What changes axes and signs and scales all of them alike has one number a row and a column. */
static double find_factor(const double row[3][4])
{
	double factor = 0;
	unsigned columns = 0;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++) {
			if (row[i][k] == 0)
				continue;
			if ((columns & 1u << k) != 0 || (i > 0 && fabs(row[i][k]) != factor))
				return 0;
			columns |= 1u << k;
			factor = fabs(row[i][k]);
		}
	return columns == 7 ? factor : 0;
}

bool mp_affine_set(struct mp_affine *a, const double row[3][4])
{
	struct mp_exact_determinant det;
	long double size;

	memset(a, 0, sizeof *a);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++)
			a->row[i][k] = row[i][k] + 0.0;
	mp_exact_determinant((const double(*)[4])a->row, &det);
	if (det.sign == 0)
		return false;
	a->mirrors = det.sign < 0;
	a->factor = find_factor((const double(*)[4])a->row);
	size = ldexpl((long double)det.size, det.exponent);
	a->size = det.more == 0 && (LDBL_MANT_DIG >= 64 || det.size << 53 == 0)
		      ? mp_ball_exact(size)
		      : mp_ball_rounded(size, size * 0x1p-63L);
	return true;
}

bool mp_affine_is_identity(const struct mp_affine *a)
{
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++)
			if (a->row[i][k] != (i == k ? 1 : 0))
				return false;
	return true;
}

/*
 * Products of doubles are exact or lose half a unit of a long double, three sums as much each: far
 * less than a double can show, unless the result is near the middle between two of them.
 */
static bool coordinate(const double row[4], const double x[3], double *out)
{
	struct mp_exact_value exact;
	long double sum = 0, size = 0, low, high;

	for (int k = 0; k < 3; k++) {
		long double product = (long double)row[k] * x[k];

		sum += product;
		size += fabsl(product);
	}
	sum += row[3];
	size = (size + fabsl((long double)row[3])) * (8 * MP_BALL_UNIT) + MP_BALL_TINY;
	low = sum - size;
	high = sum + size;
	*out = (double)low + 0.0;
	if (isfinite(*out) && *out == (double)high)
		return true;
	mp_exact_coordinate(row, x, &exact);
	*out = exact.value;
	return exact.defined;
}

bool mp_affine_point(const struct mp_affine *a, const double x[3], double out[3])
{
	const double from[3] = {x[0], x[1], x[2]};

	return coordinate(a->row[0], from, &out[0]) && coordinate(a->row[1], from, &out[1]) &&
	       coordinate(a->row[2], from, &out[2]);
}

/* Most vertices are within the box for certain; NaN and infinity are not. */
static bool widen(const double row[4], const double x[3], double *min, double *max)
{
	double p = row[0] * x[0], q = row[1] * x[1], r = row[2] * x[2], y = ((p + q) + r) + row[3];
	double off = (((fabs(p) + fabs(q)) + fabs(r)) + fabs(row[3])) * 0x1p-49 + DBL_MIN;

	if (y - off >= *min && y + off <= *max)
		return true;
	if (!coordinate(row, x, &y))
		return false;
	*min = y < *min ? y : *min;
	*max = y > *max ? y : *max;
	return true;
}

static bool take_in(const struct mp_affine *a, const struct mp_vertices *vertices, uint32_t v,
		    bool first, struct mp_box *box)
{
	double x[3];

	mp_vertices_get(vertices, v, x);
	if (first) {
		if (!mp_affine_point(a, x, box->min))
			return false;
		memcpy(box->max, box->min, sizeof box->max);
	}
	for (int k = 0; k < 3; k++)
		if (!widen(a->row[k], x, &box->min[k], &box->max[k]))
			return false;
	return true;
}

bool mp_affine_box(const struct mp_affine *a, const struct mp_mesh *mesh, const uint32_t *order,
		   uint32_t count, struct mp_box *out)
{
	for (uint64_t i = 0; i < 3 * (uint64_t)count; i++) {
		uint32_t t = order != NULL ? order[i / 3] : (uint32_t)(i / 3);

		if (!take_in(a, mesh->vertices, mesh->tri[t][i % 3], i == 0, out))
			return false;
	}
	return true;
}

bool mp_affine_box_of_all(const struct mp_affine *a, const struct mp_vertices *vertices,
			  struct mp_box *out)
{
	for (uint32_t v = 0; v < mp_vertices_count(vertices); v++)
		if (!take_in(a, vertices, v, v == 0, out))
			return false;
	return true;
}

static const int COV[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

/* L x */
static struct mp_ball apply(const double row[4], const struct mp_ball x[3])
{
	struct mp_ball sum = mp_ball_exact(0);

	for (int k = 0; k < 3; k++)
		sum = mp_ball_add(sum, mp_ball_mul(mp_ball_exact(row[k]), x[k]));
	return sum;
}

/* L C L^T */
static void map_cov(const struct mp_affine *a, struct mp_solid *io)
{
	struct mp_ball half[3][3], x[3];

	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 3; i++)
			x[i] = mp_ball(io->cov[COV[i][k]], io->cov_bound[COV[i][k]]);
		for (int i = 0; i < 3; i++)
			half[i][k] = apply(a->row[i], x);
	}
	for (int k = 0; k < 6; k++) {
		struct mp_ball y = apply(a->row[AXES[k][1]], half[AXES[k][0]]);

		io->cov[k] = y.mid;
		io->cov_bound[k] = y.rad;
	}
}

void mp_affine_solid(const struct mp_affine *a, struct mp_solid *io)
{
	struct mp_ball volume = mp_ball_mul(a->size, mp_ball(io->volume, io->volume_bound)), x[3];

	io->volume = volume.mid;
	io->volume_bound = volume.rad;
	if (!io->has_centroid)
		return;
	for (int k = 0; k < 3; k++)
		x[k] = mp_ball(io->centroid[k], io->centroid_bound[k]);
	for (int k = 0; k < 3; k++) {
		struct mp_ball y = mp_ball_add(apply(a->row[k], x), mp_ball_exact(a->row[k][3]));

		io->centroid[k] = y.mid;
		io->centroid_bound[k] = y.rad;
	}
	map_cov(a, io);
}
