#include "core/exact/exact.h"

#include <stdlib.h>
#include <string.h>

#include "core/exact/exact_private.h"

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

/* Sums on their way, by what their triangles went through. */
struct sums {
	struct mp_fixed fixed[MP_EXACT_SUMS];
	mp_i128 digits[MP_EXACT_SUMS][MP_EXACT_COLUMNS];
	bool off_grid; /* not all of them went through fixed */
	struct mp_big gmp[MP_EXACT_SUMS + 3];
};

/* The corners on the grid; false if one is not. */
static bool find_corners(const struct mp_exact_grid *grid, const uint32_t corner[3], int64_t out[9])
{
	const int64_t *a = grid->q[corner[0]], *b = grid->q[corner[1]], *c = grid->q[corner[2]];

	memcpy(out, a, 3 * sizeof *out);
	memcpy(out + 3, b, 3 * sizeof *out);
	memcpy(out + 6, c, 3 * sizeof *out);
	return grid->bits > 0 && a[0] != MP_EXACT_OFF && b[0] != MP_EXACT_OFF &&
	       c[0] != MP_EXACT_OFF;
}

static void add_off_grid(const struct mp_mesh *mesh, const struct mp_exact_grid *grid,
			 const uint32_t corner[3], struct sums *sums)
{
	double tri[9];

	sums->off_grid = true;
	for (int k = 0; k < 3; k++)
		mp_vertices_get(mesh->vertices, corner[k], &tri[3 * k]);
	if (grid->bits == 0 || !mp_exact_digits_add(sums->digits, grid, tri))
		mp_exact_gmp_add(sums->gmp, grid->axis, tri);
}

static void add_all(const struct mp_mesh *mesh, const struct mp_exact_grid *grid,
		    const uint32_t *order, uint32_t count, struct sums *sums)
{
	int64_t block[MP_EXACT_BLOCK][9];
	size_t fill = 0;

	for (uint32_t i = 0; i < count; i++) {
		const uint32_t *corner = mesh->tri[order != NULL ? order[i] : i];

		if (find_corners(grid, corner, block[fill]))
			fill++;
		else
			add_off_grid(mesh, grid, corner, sums);
		if (fill < MP_EXACT_BLOCK)
			continue;
		mp_exact_fixed_add(sums->fixed, grid->bits, (const int64_t(*)[9])block, fill);
		fill = 0;
	}
	if (fill > 0)
		mp_exact_fixed_add(sums->fixed, grid->bits, (const int64_t(*)[9])block, fill);
}

/* The exponent of the fixed sum ${i}: of a product of 3, 4 or 5 coordinates. */
static int unit_of(const struct mp_exact_axis a[3], int i)
{
	int unit = a[0].exponent + a[1].exponent + a[2].exponent;

	if (i >= 4)
		return unit + a[AXES[i - 4][0]].exponent + a[AXES[i - 4][1]].exponent;
	return i == 0 ? unit : unit + a[i - 1].exponent;
}

static void join(const struct mp_exact_axis axis[3], struct sums *sums)
{
	for (int i = 0; i < MP_EXACT_SUMS; i++) {
		struct mp_fixed *fixed = &sums->fixed[i];
		int sign = mp_fixed_negative(fixed) ? -1 : 1;
		int unit = unit_of(axis, i), coordinates = i == 0 ? 3 : i < 4 ? 4 : 5;
		struct mp_big x;

		if (sign < 0)
			mp_fixed_negate(fixed);
		mp_big_set_limbs(&x, sign, fixed->limb, MP_FIXED_LIMBS, unit);
		mp_big_add(&sums->gmp[i], &x, 1, &sums->gmp[i]);
		if (!sums->off_grid)
			continue;
		mp_exact_digits_get((const mp_i128 *)sums->digits[i], unit, coordinates, &x);
		mp_big_add(&sums->gmp[i], &x, 1, &sums->gmp[i]);
	}
}

int mp_exact_pack(const struct mp_exact_axis axis[3], bool mapped,
		  const struct mp_big sum[MP_EXACT_SUMS + 3], struct mp_exact *out,
		  struct mp_error *err)
{
	int sums = MP_EXACT_SUMS + (mapped ? 3 : 0);
	uint32_t limbs = 0;
	uint64_t *limb;

	for (int i = 0; i < sums; i++)
		limbs += (uint32_t)sum[i].n;
	limb = malloc((limbs + (size_t)1) * sizeof *limb); /* never 0 bytes */
	if (limb == NULL)
		return mp_fail_nomem(err);
	out->limb = limb;
	out->mapped = mapped;
	memmove(out->axis, axis, sizeof out->axis);
	limbs = 0;
	for (int i = 0; i < sums; i++) {
		int k = 0;

		while (k < sum[i].n && sum[i].d[k] == 0)
			k++; /* what everybody would multiply in vain */
		out->sum[i].sign = sum[i].sign;
		out->sum[i].exponent = sum[i].exponent + 64 * k;
		out->sum[i].at = limbs;
		for (; k < sum[i].n; k++)
			out->limb[limbs++] = sum[i].d[k];
		out->sum[i].end = limbs;
	}
	return 0;
}

int mp_exact_find(const struct mp_mesh *mesh, const struct mp_exact_grid *grid,
		  const uint32_t *order, uint32_t count, struct mp_exact *out, struct mp_error *err)
{
	struct sums sums;

	memset(out, 0, sizeof *out);
	memset(sums.fixed, 0, sizeof sums.fixed);
	memset(sums.digits, 0, sizeof sums.digits);
	sums.off_grid = false;
	for (int i = 0; i < MP_EXACT_SUMS; i++)
		mp_big_set(&sums.gmp[i], 0, 0, 0);
	add_all(mesh, grid, order, count, &sums);
	join(grid->axis, &sums);
	return mp_exact_pack(grid->axis, false, sums.gmp, out, err);
}

void mp_exact_get(const struct mp_exact *from, int i, struct mp_big *out)
{
	mp_big_set_limbs(out, from->sum[i].sign, from->limb + from->sum[i].at,
			 (int)(from->sum[i].end - from->sum[i].at), from->sum[i].exponent);
}

int mp_exact_add(struct mp_exact *io, const struct mp_exact *part, struct mp_error *err)
{
	struct mp_big sum[MP_EXACT_SUMS + 3], x;
	uint64_t *old = io->limb;

	for (int i = 0; i < MP_EXACT_SUMS; i++) {
		mp_exact_get(io, i, &sum[i]);
		mp_exact_get(part, i, &x);
		mp_big_add(&sum[i], &x, 1, &sum[i]);
	}
	for (int k = 0; k < 3 && part->mapped; k++)
		mp_exact_get(part, MP_EXACT_SUMS + k, &sum[MP_EXACT_SUMS + k]);
	if (mp_exact_pack(part->axis, part->mapped, sum, io, err))
		return -1;
	free(old);
	return 0;
}

void mp_exact_get_origin(const struct mp_exact *from, int k, struct mp_big *out)
{
	if (from->mapped)
		mp_exact_get(from, MP_EXACT_SUMS + k, out);
	else
		mp_big_set_i64(out, from->axis[k].origin, from->axis[k].exponent);
}

void mp_exact_free(struct mp_exact *e)
{
	free(e->limb);
	memset(e, 0, sizeof *e);
}

int mp_exact_sign(const struct mp_exact *e)
{
	return e->sum[0].sign;
}
