#include <assert.h>
#include <float.h>
#include <math.h>

#include "core/exact/exact_private.h"

/*
 * A quotient is computed to at least 55 bits, a root from at least 112 bits of quotient, so to 56;
 * what is below them is only seen as "something", which settles every tie.
 */
enum { MANTISSA = 53, QUOTIENT = 56, RADICAND = 112, LOWEST = -1074 };

/* (size + a fraction)*2^exponent, the fraction in (0, 1) if ${more}, else 0; size >= 2^55 or 0. */
struct chopped {
	uint64_t size;
	int exponent;
	bool more;
};

static int bits_of(uint64_t x)
{
	return x == 0 ? 0 : 64 - __builtin_clzll(x);
}

/*
 * floor(|num/den| * 2^shift) with a shift for at least ${bits} bits and at most two more; *unit
 * gets the power of two that it counts, an even one if ${even}.
 */
static bool divide(const struct mp_big *num, const struct mp_big *den, int bits, bool even,
		   mp_limb_t quotient[3], int *unit)
{
	mp_limb_t n[MP_BIG_LIMBS], d[MP_BIG_LIMBS], q[MP_BIG_LIMBS], rest[MP_BIG_LIMBS];
	int shift = bits - (mp_big_bits(num) - mp_big_bits(den));
	int nn, dn;

	*unit = num->exponent - den->exponent - shift;
	if (even && *unit % 2 != 0) {
		shift++;
		--*unit;
	}
	nn = mp_big_shift(num->d, num->n, shift > 0 ? (unsigned)shift : 0, n);
	dn = mp_big_shift(den->d, den->n, shift < 0 ? (unsigned)-shift : 0, d);
	assert(nn >= dn && nn - dn < 3);
	mpn_tdiv_qr(q, rest, 0, n, nn, d, dn);
	for (int i = 0; i < 3; i++)
		quotient[i] = i <= nn - dn ? q[i] : 0;
	for (int i = 0; i < dn; i++)
		if (rest[i] != 0)
			return true;
	return false;
}

/* The ${bits} <= 128 leading bits of |x|, zeros behind it where it is shorter; ${*all}: no other.
 */
static mp_u128 leading(const struct mp_big *x, int bits, bool *all)
{
	int n = x->n, zeros = __builtin_clzll(x->d[n - 1]), width = 64 * n - zeros;
	mp_u128 top = (mp_u128)x->d[n - 1] << 64 | (n > 1 ? x->d[n - 2] : 0);

	top <<= zeros;
	if (n > 2 && zeros > 0)
		top |= x->d[n - 3] >> (64 - zeros);
	*all = width <= bits;
	return top >> (128 - bits);
}

/*
 * divide() for QUOTIENT bits, from the leading ones: n of 120, d of 64, so 2^55 < n/d < 2^57.  What
 * was cut off is less than 1 of either, so the true ratio is above n/d - n/d^2 > n/d - 2^57/d and
 * below n/d + 1/d: it lies between the same integers where the remainder is not that near to either
 * end.  False where that cannot be told.
 */
static bool divide_leading(const struct mp_big *num, const struct mp_big *den, struct chopped *x)
{
	bool all_num, all_den;
	mp_u128 n = leading(num, 120, &all_num);
	uint64_t d = (uint64_t)leading(den, 64, &all_den), rest, margin = (uint64_t)1 << 57;

	x->size = (uint64_t)(n / d);
	rest = (uint64_t)(n - (mp_u128)x->size * d);
	x->exponent =
	    num->exponent + mp_big_bits(num) - 120 - (den->exponent + mp_big_bits(den) - 64);
	x->more = rest != 0;
	return (all_num && all_den) || (rest >= margin && rest < d - 1);
}

/* x rounded to nearest, ties to even, as a multiple of 2^LOWEST where it is subnormal. */
static double nearest(const struct chopped *x, bool *exact)
{
	int top = bits_of(x->size) + x->exponent; /* x < 2^top */
	int drop = bits_of(x->size) - MANTISSA;
	uint64_t kept, rest, half;

	if (top > DBL_MAX_EXP) {
		*exact = false;
		return HUGE_VAL;
	}
	if (x->exponent + drop < LOWEST)
		drop = LOWEST - x->exponent;
	if (drop > bits_of(x->size)) { /* less than half of the smallest double */
		*exact = false;
		return 0;
	}
	half = (uint64_t)1 << (drop - 1);
	kept = x->size >> drop;
	rest = x->size & (2 * half - 1);
	*exact = rest == 0 && !x->more;
	if (rest > half || (rest == half && (x->more || kept % 2 != 0)))
		kept++;
	return ldexp((double)kept, x->exponent + drop);
}

/* A valid bound for a result that was rounded to ${x}, which is not 0 or DBL_MIN at least. */
static double half_unit(double x)
{
	int exponent = (x == 0 ? LOWEST : ilogb(x)) - MANTISSA;

	return ldexp(1, exponent < LOWEST ? LOWEST : exponent);
}

static void deliver(const struct chopped *x, int sign, bool tiny, struct mp_exact_value *out)
{
	bool exact;
	double size = nearest(x, &exact);

	*out = (struct mp_exact_value){0, 0, false};
	if (!(size <= DBL_MAX) || (size < DBL_MIN && !tiny))
		return;
	out->value = sign < 0 && size > 0 ? -size : size;
	out->bound = exact ? 0 : half_unit(size);
	out->defined = true;
}

void mp_exact_round_quotient(const struct mp_big *num, const struct mp_big *den, bool tiny,
			     struct mp_exact_value *out)
{
	mp_limb_t quotient[3];
	struct chopped x;

	if (num->sign == 0) {
		*out = (struct mp_exact_value){0, 0, true};
		return;
	}
	if (!divide_leading(num, den, &x)) {
		x.more = divide(num, den, QUOTIENT, false, quotient, &x.exponent);
		x.size = quotient[0];
	}
	deliver(&x, num->sign, tiny, out);
}

void mp_exact_round_root(const struct mp_big *num, const struct mp_big *den,
			 struct mp_exact_value *out)
{
	mp_limb_t quotient[3], root[2], rest[3];
	struct chopped x;

	*out = (struct mp_exact_value){0, 0, num->sign == 0};
	if (num->sign <= 0)
		return;
	x.more = divide(num, den, RADICAND, true, quotient, &x.exponent);
	x.more = mpn_sqrtrem(root, rest, quotient, 2) != 0 || x.more;
	x.size = root[0];
	x.exponent /= 2;
	deliver(&x, 1, false, out);
}
