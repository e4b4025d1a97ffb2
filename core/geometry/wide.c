#include <gmp.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "core/geometry/predicates_exact.h"

/*
 * The predicates for coordinates whose products leave the range of a double: as integers in units
 * of the lowest bit that occurs.  GMP's mpn layer works on the stack here: nothing is allocated,
 * so nothing can fail or abort, as GMP's own mpq would when memory is out.
 */
enum {
	BITS = 2098 + 1,                 /* from 2^-1074 to 2^1024, and a difference */
	LIMBS = BITS / GMP_NUMB_BITS + 2 /* one for the ragged end, one for a shift */
};

struct wide {
	int sign;                   /* -1, 0, 1 */
	mp_size_t n;                /* limbs in use, the top one not zero; 0 for zero */
	mp_limb_t d[3 * LIMBS + 2]; /* a sum of threefold products */
};

static void trim(struct wide *w)
{
	while (w->n > 0 && w->d[w->n - 1] == 0)
		w->n--;
	if (w->n == 0)
		w->sign = 0;
}

/* |x| = mantissa * 2^exponent with an odd mantissa; x is not 0. */
static uint64_t take_apart(double x, int *exponent)
{
	uint64_t m = (uint64_t)ldexp(frexp(fabs(x), exponent), 53);

	*exponent -= 53;
	while ((m & 1) == 0) {
		m >>= 1;
		++*exponent;
	}
	return m;
}

/* x / 2^unit, which is an integer. */
static void from_double(double x, int unit, struct wide *out)
{
	unsigned shift, q;
	uint64_t m;
	int e;

	out->sign = (x > 0) - (x < 0);
	out->n = 0;
	if (x == 0)
		return;
	m = take_apart(x, &e);
	shift = (unsigned)(e - unit);
	q = shift / GMP_NUMB_BITS;
	memset(out->d, 0, (q + 3) * sizeof out->d[0]);
	for (unsigned i = 0; i < 64; i += GMP_NUMB_BITS)
		out->d[q + i / GMP_NUMB_BITS] = (mp_limb_t)(m >> i) & GMP_NUMB_MASK;
	out->n = (mp_size_t)q + 3;
	if (shift % GMP_NUMB_BITS != 0)
		mpn_lshift(out->d + q, out->d + q, 3, shift % GMP_NUMB_BITS);
	trim(out);
}

/* out = a + side * b; ${out} is neither. */
static void add(const struct wide *a, const struct wide *b, int side, struct wide *out)
{
	const struct wide *big = a, *small = b;
	int sa = a->sign, sb = side * b->sign;

	if (a->n < b->n || (a->n == b->n && a->n > 0 && mpn_cmp(a->d, b->d, a->n) < 0)) {
		big = b;
		small = a;
	}
	out->sign = big == a ? sa : sb;
	out->n = big->n;
	if (small->n == 0) {
		memcpy(out->d, big->d, (size_t)big->n * sizeof big->d[0]);
	} else if (sa == sb) {
		out->d[out->n] = mpn_add(out->d, big->d, big->n, small->d, small->n);
		out->n++;
	} else {
		mpn_sub(out->d, big->d, big->n, small->d, small->n);
	}
	trim(out);
}

static void multiply(const struct wide *a, const struct wide *b, struct wide *out)
{
	const struct wide *big = a->n >= b->n ? a : b, *small = big == a ? b : a;

	out->sign = a->sign * b->sign;
	out->n = 0;
	if (out->sign == 0)
		return;
	mpn_mul(out->d, big->d, big->n, small->d, small->n);
	out->n = big->n + small->n;
	trim(out);
}

static void cross(const struct wide *ax, const struct wide *ay, const struct wide *bx,
		  const struct wide *by, struct wide *out)
{
	struct wide left, right;

	multiply(ax, by, &left);
	multiply(ay, bx, &right);
	add(&left, &right, -1, out);
}

/* Lower ${*unit} to the lowest bit of the ${n} coordinates. */
static void lower_unit(const double *p, int n, int *unit)
{
	int e;

	for (int i = 0; i < n; i++) {
		if (p[i] == 0)
			continue;
		take_apart(p[i], &e);
		if (e < *unit)
			*unit = e;
	}
}

static void subtract(double a, double b, int unit, struct wide *out)
{
	struct wide wa, wb;

	from_double(a, unit, &wa);
	from_double(b, unit, &wb);
	add(&wa, &wb, -1, out);
}

int mp_wide_orient2d(const double a[2], const double b[2], const double c[2])
{
	struct wide u[2], v[2], det;
	int unit = 1024;

	lower_unit(a, 2, &unit);
	lower_unit(b, 2, &unit);
	lower_unit(c, 2, &unit);
	for (int k = 0; k < 2; k++) {
		subtract(b[k], a[k], unit, &u[k]);
		subtract(c[k], a[k], unit, &v[k]);
	}
	cross(&u[0], &u[1], &v[0], &v[1], &det);
	return det.sign;
}

int mp_wide_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
	struct wide u[3], v[3], w[3], minor, term, sum[2];
	int unit = 1024;

	lower_unit(a, 3, &unit);
	lower_unit(b, 3, &unit);
	lower_unit(c, 3, &unit);
	lower_unit(d, 3, &unit);
	for (int k = 0; k < 3; k++) {
		subtract(b[k], a[k], unit, &u[k]);
		subtract(c[k], a[k], unit, &v[k]);
		subtract(d[k], a[k], unit, &w[k]);
	}
	sum[0].sign = sum[1].sign = 0;
	sum[0].n = sum[1].n = 0;
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		cross(&u[i], &u[j], &v[i], &v[j], &minor);
		multiply(&minor, &w[k], &term);
		add(&sum[(k + 1) % 2], &term, 1, &sum[k % 2]);
	}
	return sum[0].sign; /* k = 2 was the last */
}
