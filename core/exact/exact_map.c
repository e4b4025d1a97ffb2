#include <stdlib.h>
#include <string.h>

#include "core/exact/exact_private.h"

/*
 * Affine maps, exactly.  With L the linear part and D = |det L|, sums of products of d, which is
 * the determinant of three corners, and corners become D*A0, D*L*A1, D*L*A2*L^T, about the mapped
 * point.
 */

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
static const int PLACE[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/* io += a*x */
static void add_product(struct mp_big *io, double a, const struct mp_big *x)
{
	struct mp_big factor, product;

	if (a == 0)
		return;
	mp_big_set_double(&factor, a);
	mp_big_mul(x, &factor, &product);
	mp_big_add(io, &product, 1, io);
}

static void multiply(struct mp_big *io, const struct mp_big *by)
{
	struct mp_big product;

	mp_big_mul(io, by, &product);
	mp_big_copy(io, &product);
}

static void determinant(const double row[3][4], struct mp_big *out)
{
	mp_big_set(out, 0, 0, 0);
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		struct mp_big minor, x;

		mp_big_set_double(&minor, 0);
		mp_big_set_double(&x, row[2][j]);
		add_product(&minor, row[1][i], &x);
		mp_big_set_double(&x, -row[2][i]);
		add_product(&minor, row[1][j], &x);
		add_product(out, row[0][k], &minor);
	}
}

/* The linear part of row ${i} times ${x}. */
static void apply(const double row[3][4], int i, const struct mp_big x[3], struct mp_big *out)
{
	mp_big_set(out, 0, 0, 0);
	for (int k = 0; k < 3; k++)
		add_product(out, row[i][k], &x[k]);
}

static void map_first(const struct mp_exact *e, const double row[3][4], const struct mp_big *size,
		      struct mp_big out[3])
{
	struct mp_big first[3];

	for (int k = 0; k < 3; k++)
		mp_exact_get(e, 1 + k, &first[k]);
	for (int i = 0; i < 3; i++) {
		apply(row, i, first, &out[i]);
		multiply(&out[i], size);
	}
}

static void map_second(const struct mp_exact *e, const double row[3][4], const struct mp_big *size,
		       struct mp_big out[6])
{
	struct mp_big column[3], half[3][3]; /* L*A2 */

	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 3; i++)
			mp_exact_get(e, 4 + PLACE[i][k], &column[i]);
		for (int i = 0; i < 3; i++)
			apply(row, i, column, &half[i][k]);
	}
	for (int k = 0; k < 6; k++) {
		apply(row, AXES[k][1], half[AXES[k][0]], &out[k]);
		multiply(&out[k], size);
	}
}

static void map_origin(const struct mp_exact *e, const double row[3][4], struct mp_big out[3])
{
	struct mp_big origin[3], shift;

	for (int k = 0; k < 3; k++)
		mp_exact_get_origin(e, k, &origin[k]);
	for (int i = 0; i < 3; i++) {
		apply(row, i, origin, &out[i]);
		mp_big_set_double(&shift, row[i][3]);
		mp_big_add(&out[i], &shift, 1, &out[i]);
	}
}

int mp_exact_map(struct mp_exact *io, const double row[3][4], struct mp_error *err)
{
	struct mp_big sum[MP_EXACT_SUMS + 3], size;
	uint64_t *old = io->limb;

	determinant(row, &size);
	size.sign = size.sign != 0;
	mp_exact_get(io, 0, &sum[0]);
	multiply(&sum[0], &size);
	map_first(io, row, &size, sum + 1);
	map_second(io, row, &size, sum + 4);
	map_origin(io, row, sum + MP_EXACT_SUMS);
	if (mp_exact_pack(io->axis, true, sum, io, err))
		return -1;
	free(old);
	return 0;
}

void mp_exact_coordinate(const double row[4], const double x[3], struct mp_exact_value *out)
{
	struct mp_big sum, one, point;

	mp_big_set_double(&sum, row[3]);
	for (int k = 0; k < 3; k++) {
		mp_big_set_double(&point, x[k]);
		add_product(&sum, row[k], &point);
	}
	mp_big_set(&one, 1, 1, 0);
	mp_exact_round_quotient(&sum, &one, true, out);
}

void mp_exact_determinant(const double row[3][4], struct mp_exact_determinant *out)
{
	struct mp_big det;
	unsigned shift;

	memset(out, 0, sizeof *out);
	determinant(row, &det);
	if (det.sign == 0)
		return;
	shift = (unsigned)(64 * det.n - mp_big_bits(&det));
	out->sign = det.sign;
	out->exponent = det.exponent + 64 * (det.n - 1) - (int)shift;
	out->size = det.d[det.n - 1] << shift;
	if (det.n > 1 && shift > 0)
		out->size |= det.d[det.n - 2] >> (64 - shift);
	out->more = det.n > 1;
}
