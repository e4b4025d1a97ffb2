#include <assert.h>
#include <string.h>

#include "core/number/number_private.h"

/* No text is long enough for its digit count to outweigh an exponent of this size. */
static const int64_t exponent_most = (int64_t)1 << 60;

void mp_decimal_begin(struct mp_decimal *d)
{
	d->state = MP_DECIMAL_BEGIN;
	d->negative = d->negative_exponent = d->sticky = false;
	d->count = 0;
	d->point = d->exponent = 0;
}

static void keep_digit(struct mp_decimal *d, unsigned digit)
{
	if (d->count < MP_DECIMAL_DIGITS)
		d->digit[d->count++] = (uint8_t)digit;
	else if (digit != 0)
		d->sticky = true;
}

static enum mp_decimal_state take_digit(struct mp_decimal *d, unsigned digit)
{
	switch (d->state) {
	case MP_DECIMAL_BEGIN:
	case MP_DECIMAL_SIGN:
	case MP_DECIMAL_WHOLE:
		if (d->count > 0 || digit != 0) {
			keep_digit(d, digit);
			d->point++;
		}
		return MP_DECIMAL_WHOLE;
	case MP_DECIMAL_POINT:
	case MP_DECIMAL_FRACTION:
		if (d->count > 0 || digit != 0)
			keep_digit(d, digit);
		else
			d->point--;
		return MP_DECIMAL_FRACTION;
	case MP_DECIMAL_E:
	case MP_DECIMAL_E_SIGN:
	case MP_DECIMAL_EXPONENT:
		if (d->exponent < exponent_most / 16)
			d->exponent = d->exponent * 10 + digit;
		else
			d->exponent = exponent_most;
		return MP_DECIMAL_EXPONENT;
	default:
		return MP_DECIMAL_BAD;
	}
}

static enum mp_decimal_state take_mark(struct mp_decimal *d, char c)
{
	bool number = d->state == MP_DECIMAL_WHOLE || d->state == MP_DECIMAL_FRACTION;

	switch (c) {
	case '+':
	case '-':
		if (d->state == MP_DECIMAL_BEGIN) {
			d->negative = c == '-';
			return MP_DECIMAL_SIGN;
		}
		d->negative_exponent = c == '-';
		return d->state == MP_DECIMAL_E ? MP_DECIMAL_E_SIGN : MP_DECIMAL_BAD;
	case '.':
		if (d->state == MP_DECIMAL_WHOLE)
			return MP_DECIMAL_FRACTION;
		return d->state < MP_DECIMAL_WHOLE ? MP_DECIMAL_POINT : MP_DECIMAL_BAD;
	case 'e':
	case 'E':
	case 'd': /* as Fortran prints doubles */
	case 'D':
		return number ? MP_DECIMAL_E : MP_DECIMAL_BAD;
	default:
		return MP_DECIMAL_BAD;
	}
}

void mp_decimal_feed(struct mp_decimal *d, const char *text, size_t len)
{
	for (size_t i = 0; i < len && d->state != MP_DECIMAL_BAD; i++) {
		if (mp_is_digit(text[i]))
			d->state = take_digit(d, mp_digit(text[i]));
		else
			d->state = take_mark(d, text[i]);
	}
}

/*
 * Natural numbers for the last resort.  800 digits have 2658 bits; the other side of the
 * comparison is at most 2^54 * 5^1142, 2706 bits, and neither is shifted beyond the other's size
 * by more than two bits, because both sides are within a factor of two.
 */
enum { BIG_LIMBS = 48 };

struct big { /* little-endian; limb[used - 1] != 0 */
	unsigned used;
	uint64_t limb[BIG_LIMBS];
};

__extension__ typedef unsigned __int128 uint128;

static void big_push(struct big *b, uint64_t top)
{
	if (top == 0)
		return;
	assert(b->used < BIG_LIMBS);
	b->limb[b->used++] = top;
}

static void big_multiply_add(struct big *b, uint64_t factor, uint64_t add)
{
	uint128 carry = add;

	for (unsigned i = 0; i < b->used; i++) {
		carry += (uint128)b->limb[i] * factor;
		b->limb[i] = (uint64_t)carry;
		carry >>= 64;
	}
	big_push(b, (uint64_t)carry);
}

static void big_multiply_power5(struct big *b, int64_t power)
{
	const uint64_t five27 = 7450580596923828125; /* the largest power in 64 bits */

	for (; power >= 27; power -= 27)
		big_multiply_add(b, five27, 0);
	for (; power > 0; power--)
		big_multiply_add(b, 5, 0);
}

static void big_shift(struct big *b, int64_t bits) /* >= 0; *b != 0 */
{
	unsigned limbs = (unsigned)(bits / 64);

	big_multiply_add(b, (uint64_t)1 << (bits % 64), 0);
	assert(b->used + limbs <= BIG_LIMBS);
	memmove(b->limb + limbs, b->limb, b->used * sizeof b->limb[0]);
	memset(b->limb, 0, limbs * sizeof b->limb[0]);
	b->used += limbs;
}

static int big_compare(const struct big *a, const struct big *b)
{
	if (a->used != b->used)
		return a->used < b->used ? -1 : 1;
	for (unsigned i = a->used; i-- > 0;) {
		if (a->limb[i] != b->limb[i])
			return a->limb[i] < b->limb[i] ? -1 : 1;
	}
	return 0;
}

static void big_from_digits(struct big *b, const uint8_t *digit, size_t count)
{
	b->used = 0;
	while (count > 0) {
		size_t step = count < 19 ? count : 19;
		uint64_t chunk = 0, scale = 1;

		for (size_t i = 0; i < step; i++, scale *= 10)
			chunk = chunk * 10 + digit[i];
		big_multiply_add(b, scale, chunk);
		digit += step;
		count -= step;
	}
}

/*
 * Sign of the decimal (d1 d2 ... as an integer, times 10^power) minus the middle between the
 * double ${low} >= 0 and the next larger one.
 */
static int against_middle(const struct mp_decimal *d, int64_t power, double low)
{
	const uint64_t hidden = (uint64_t)1 << 52;
	struct big left, right = {0};
	uint64_t bits, mantissa;
	int64_t exponent; /* low == mantissa * 2^exponent */
	int sign;

	memcpy(&bits, &low, sizeof bits);
	mantissa = bits & (hidden - 1);
	exponent = (int64_t)(bits >> 52) - 1075;
	if (bits >> 52 != 0)
		mantissa |= hidden;
	else
		exponent++;
	big_from_digits(&left, d->digit, d->count);
	big_push(&right, 2 * mantissa + 1);
	big_multiply_power5(power < 0 ? &right : &left, power < 0 ? -power : power);
	power -= exponent - 1; /* powers of two left over on the decimal's side */
	big_shift(power < 0 ? &right : &left, power < 0 ? -power : power);
	sign = big_compare(&left, &right);
	return sign == 0 && d->sticky ? 1 : sign;
}

static double magnitude(const struct mp_decimal *d)
{
	int64_t exponent = d->point + (d->negative_exponent ? -d->exponent : d->exponent);
	uint64_t w = 0, bits;
	uint32_t i;
	double low, high;
	int sign;

	for (i = 0; i < d->count && i < 19; i++)
		w = w * 10 + d->digit[i];
	low = mp_number_scale(w, exponent - i);
	if (i == d->count)
		return low;
	high = mp_number_scale(w + 1, exponent - i); /* w >= 10^18: at most the next double */
	if (low == high)
		return low;
	sign = against_middle(d, exponent - d->count, low);
	memcpy(&bits, &low, sizeof bits);
	return sign > 0 || (sign == 0 && (bits & 1) != 0) ? high : low;
}

int mp_decimal_finish(const struct mp_decimal *d, double *value)
{
	if (d->state != MP_DECIMAL_WHOLE && d->state != MP_DECIMAL_FRACTION &&
	    d->state != MP_DECIMAL_EXPONENT)
		return -1;
	*value = magnitude(d);
	if (d->negative)
		*value = -*value;
	return 0;
}
