#include <string.h>

#include "core/exact/exact_private.h"

/*
 * The results as quotients of integers, rounded once each:
 *   volume   A0/6
 *   centroid origin + A1/(4*A0)
 *   second   (4*A0*A2ij - 5*A1i*A1j)/(480*A0), central
 * and about a point P, with R = 4*A0*(origin - P) + A1, the last numerator + 5*Ri*Rj.  Units need
 * no thought: every number carries its exponent.  Divisors are |A0|: the solid that is meant.
 */

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

static void set_undefined(struct mp_exact_value *out, int count)
{
	for (int i = 0; i < count; i++)
		out[i] = (struct mp_exact_value){0, 0, false};
}

/* io *= by */
static void multiply(struct mp_big *io, const struct mp_big *by)
{
	struct mp_big product;

	mp_big_mul(io, by, &product);
	mp_big_copy(io, &product);
}

static void get_size(const struct mp_exact *e, struct mp_big *a0)
{
	mp_exact_get(e, 0, a0);
	a0->sign = a0->sign != 0;
}

/* Multiply num/den by the density; false if there is none. */
static bool apply_density(const struct mp_exact_density *density, struct mp_big *num,
			  struct mp_big *den)
{
	struct mp_big x;

	if (density == NULL)
		return true;
	mp_big_set_double(&x, density->value);
	multiply(num, &x);
	if (density->divisor != 0) {
		mp_big_set_double(&x, density->divisor);
		multiply(den, &x);
	}
	if (density->over == NULL)
		return true;
	get_size(density->over, &x);
	mp_big_scale(num, 6);
	multiply(den, &x);
	return x.sign != 0;
}

void mp_exact_volume(const struct mp_exact *e, struct mp_exact_value *out)
{
	struct mp_big a0, six;

	mp_exact_get(e, 0, &a0);
	mp_big_set(&six, 1, 6, 0);
	mp_exact_round_quotient(&a0, &six, false, out);
}

void mp_exact_density(const struct mp_exact_density *density, struct mp_exact_value *out)
{
	struct mp_big num, den;

	mp_big_set(&num, 1, 1, 0);
	mp_big_set(&den, 1, 1, 0);
	if (apply_density(density, &num, &den))
		mp_exact_round_quotient(&num, &den, false, out);
	else
		set_undefined(out, 1);
}

void mp_exact_mass(const struct mp_exact *e, const struct mp_exact_density *density,
		   struct mp_exact_value *out)
{
	struct mp_big num, den;

	get_size(e, &num);
	mp_big_set(&den, 1, 6, 0);
	if (apply_density(density, &num, &den))
		mp_exact_round_quotient(&num, &den, false, out);
	else
		set_undefined(out, 1);
}

/* R of axis ${k}: 4*A0*(centroid - at), at NULL for 0. */
static void find_arm(const struct mp_exact *e, int k, const double *at, struct mp_big *out)
{
	struct mp_big a, arm, x;

	mp_exact_get_origin(e, k, &arm);
	mp_big_set_double(&x, at == NULL ? 0 : at[k]);
	mp_big_add(&arm, &x, -1, &arm);
	mp_exact_get(e, 0, &a);
	mp_big_scale(&a, 4);
	mp_big_mul(&a, &arm, out);
	mp_exact_get(e, 1 + k, &a);
	mp_big_add(out, &a, 1, out);
}

bool mp_exact_centroid(const struct mp_exact *e, struct mp_exact_value out[3])
{
	struct mp_big num, den;

	set_undefined(out, 3);
	if (mp_exact_sign(e) == 0)
		return false;
	get_size(e, &den);
	mp_big_scale(&den, 4);
	for (int k = 0; k < 3; k++) {
		find_arm(e, k, NULL, &num);
		num.sign *= mp_exact_sign(e);
		mp_exact_round_quotient(&num, &den, true, &out[k]);
	}
	return out[0].defined && out[1].defined && out[2].defined;
}

/* io += side*5*a*b */
static void add_five(struct mp_big *io, const struct mp_big *a, const struct mp_big *b, int side)
{
	struct mp_big x;

	mp_big_mul(a, b, &x);
	mp_big_scale(&x, 5);
	mp_big_add(io, &x, side, io);
}

/* Numerators over 480*A0 of the central second moments. */
static void find_central(const struct mp_exact *e, struct mp_big out[6])
{
	struct mp_big first[3], a0, a2;

	mp_exact_get(e, 0, &a0);
	mp_big_scale(&a0, 4);
	for (int k = 0; k < 3; k++)
		mp_exact_get(e, 1 + k, &first[k]);
	for (int k = 0; k < 6; k++) {
		mp_exact_get(e, 4 + k, &a2);
		mp_big_mul(&a0, &a2, &out[k]);
		add_five(&out[k], &first[AXES[k][0]], &first[AXES[k][1]], -1);
	}
}

/* From there to those about ${about}. */
static void move(const struct mp_exact *e, const double about[3], struct mp_big io[6])
{
	struct mp_big arm[3];

	for (int k = 0; k < 3; k++)
		find_arm(e, k, about, &arm[k]);
	for (int k = 0; k < 6; k++)
		add_five(&io[k], &arm[AXES[k][0]], &arm[AXES[k][1]], 1);
}

bool mp_exact_second(const struct mp_exact *e, struct mp_exact_value out[6])
{
	struct mp_big num[6], den;
	bool all = true;

	set_undefined(out, 6);
	if (mp_exact_sign(e) == 0)
		return false;
	find_central(e, num);
	get_size(e, &den);
	mp_big_scale(&den, 480);
	for (int k = 0; k < 6; k++) {
		num[k].sign *= mp_exact_sign(e);
		mp_exact_round_quotient(&num[k], &den, k >= 3, &out[k]);
		all = all && out[k].defined;
	}
	return all;
}

/* Entry ${k} of the tensor, in the order of the second moments: numerator over 480*|A0|. */
static void find_entry(const struct mp_big second[6], int k, struct mp_big *out)
{
	if (k < 3) {
		mp_big_add(&second[(k + 1) % 3], &second[(k + 2) % 3], 1, out);
		return;
	}
	mp_big_copy(out, &second[k]);
	out->sign = -out->sign;
}

/* The tensor of those second moments. */
static void round_tensor(const struct mp_exact *e, const struct mp_exact_density *density,
			 const struct mp_big second[6], struct mp_exact_tensor *out)
{
	struct mp_big num, den, whole;
	bool defined = true;

	get_size(e, &whole);
	mp_big_scale(&whole, 480);
	for (int k = 0; k < 6 && defined; k++) {
		struct mp_exact_value x;
		int i = AXES[k][0], j = AXES[k][1];

		find_entry(second, k, &num);
		mp_big_copy(&den, &whole);
		set_undefined(&x, 1);
		if (apply_density(density, &num, &den))
			mp_exact_round_quotient(&num, &den, k >= 3, &x);
		defined = x.defined;
		out->value[i][j] = out->value[j][i] = x.value;
		if (x.bound > out->bound)
			out->bound = x.bound;
	}
	if (!defined)
		memset(out, 0, sizeof *out);
	out->defined = defined;
}

void mp_exact_inertias(const struct mp_exact *e, const struct mp_exact_density *density,
		       const double about[3], struct mp_exact_tensor *central,
		       struct mp_exact_tensor *moved)
{
	struct mp_big second[6];

	if (central != NULL)
		memset(central, 0, sizeof *central);
	if (moved != NULL)
		memset(moved, 0, sizeof *moved);
	if (mp_exact_sign(e) == 0)
		return;
	find_central(e, second);
	if (central != NULL)
		round_tensor(e, density, (const struct mp_big *)second, central);
	if (moved == NULL)
		return;
	move(e, about, second);
	round_tensor(e, density, (const struct mp_big *)second, moved);
}

void mp_exact_inertia(const struct mp_exact *e, const struct mp_exact_density *density,
		      const double about[3], struct mp_exact_tensor *out)
{
	mp_exact_inertias(e, density, about, about == NULL ? out : NULL,
			  about == NULL ? NULL : out);
}

/* d.T.d over 480*|A0|*${square}, square = d.d, T the tensor of density 1 about ${origin}. */
static void find_moment(const struct mp_exact *e, const double origin[3], const double direction[3],
			struct mp_big *num, struct mp_big *square)
{
	struct mp_big second[6], d[3], x, y;

	find_central(e, second);
	move(e, origin, second);
	mp_big_set(num, 0, 0, 0);
	mp_big_set(square, 0, 0, 0);
	for (int k = 0; k < 3; k++)
		mp_big_set_double(&d[k], direction[k]);
	for (int k = 0; k < 6; k++) {
		mp_big_mul(&d[AXES[k][0]], &d[AXES[k][1]], &x);
		if (k < 3)
			mp_big_add(square, &x, 1, square);
		else
			mp_big_scale(&x, 2);
		find_entry(second, k, &y);
		multiply(&x, &y);
		mp_big_add(num, &x, 1, num);
	}
}

void mp_exact_axis_moment(const struct mp_exact *e, const struct mp_exact_density *density,
			  const double origin[3], const double direction[3],
			  struct mp_exact_value *moment, struct mp_exact_value *radius)
{
	struct mp_exact_value ignored = {.defined = false};
	struct mp_big num, den, square, a0;

	moment = moment != NULL ? moment : &ignored;
	radius = radius != NULL ? radius : &ignored;
	set_undefined(moment, 1);
	set_undefined(radius, 1);
	if (mp_exact_sign(e) == 0)
		return;
	find_moment(e, origin, direction, &num, &square);
	if (square.sign == 0)
		return;
	get_size(e, &a0);
	mp_big_mul(&a0, &square, &den); /* radius^2 = moment/volume: num*6/(480*a0*square*a0) */
	multiply(&a0, &den);
	mp_big_scale(&a0, 80);
	mp_exact_round_root(&num, &a0, radius);
	mp_big_scale(&den, 480);
	if (apply_density(density, &num, &den))
		mp_exact_round_quotient(&num, &den, false, moment);
}
