#include "api/json_number.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "core/number/number.h"

__extension__ typedef unsigned __int128 u128;

struct decimal { /* d.ddd * 10^exponent */
	char digit[20];
	int count, exponent;
};

/* The significand m*2^e of a positive double, scaled by 10^k: a 17-digit number, exactly. */
struct scaled {
	u128 product; /* m * 10^k, shifted left by e where e > 0 */
	u128 ulp;     /* what one unit of m is worth in ${product} */
	int shift;    /* digits = product >> shift */
	bool even;    /* m is even: a tie reads back to x */
};

static u128 power_of_ten(int k) /* 0 <= k <= 38 */
{
	u128 p = 1;

	while (k-- > 0)
		p *= 10;
	return p;
}

static void digits_of(uint64_t n, int exponent, struct decimal *d)
{
	char buf[24] = "";
	int len = 0;

	while (n % 10 == 0)
		n /= 10;
	for (; n > 0; n /= 10)
		buf[len++] = (char)('0' + n % 10);
	d->count = len;
	d->exponent = exponent;
	for (int i = 0; i < len; i++)
		d->digit[i] = buf[len - 1 - i];
}

static bool scale(double x, int k, struct scaled *s)
{
	int e;
	uint64_t m = (uint64_t)ldexp(frexp(x, &e), DBL_MANT_DIG);
	u128 ten;

	e -= DBL_MANT_DIG;
	if (k < 0 || k > 22 || e > 4)
		return false; /* m * 10^22 < 2^127 */
	ten = power_of_ten(k);
	s->ulp = e > 0 ? ten << e : ten;
	s->product = m * s->ulp;
	s->shift = e < 0 ? -e : 0;
	s->even = m % 2 == 0;
	return true;
}

/*
 * Does ${n} units of the 17th digit lie so near that it reads back to the same double?  Below a
 * power of two the gap is only half as wide, but none of those few in fast()'s range has a
 * shorter neighbour there (the unit test goes through all of them).
 */
static bool reads_back(const struct scaled *s, uint64_t n)
{
	u128 there = (u128)n << s->shift;
	u128 gap = 2 * (there < s->product ? s->product - there : there - s->product);

	return gap < s->ulp || (gap == s->ulp && s->even);
}

/* The nearest number with its last ${drop} of 17 digits zero, ties to even. */
static uint64_t round_off(const struct scaled *s, uint64_t unit)
{
	uint64_t n = (uint64_t)(s->product >> s->shift);
	u128 low = s->product - ((u128)n << s->shift);
	u128 rest = ((u128)(n % unit) << s->shift) + low;
	u128 half = (u128)unit << s->shift;
	bool up = 2 * rest > half || (2 * rest == half && (n / unit) % 2 == 1);

	return (n / unit + (up ? 1 : 0)) * unit;
}

/* 1e-6 <= x < 1e17, in integers of 128 bits: no rounding, no table, no search. */
static bool fast(double x, struct decimal *d)
{
	const uint64_t low = UINT64_C(10000000000000000); /* 10^16 */
	int exponent = (int)floor(log10(x));
	struct scaled s;
	uint64_t n, unit;

	if (!scale(x, 16 - exponent, &s))
		return false;
	n = (uint64_t)(s.product >> s.shift);
	if (n < low || n >= 10 * low) { /* log10 rounded across a power of ten */
		exponent += n < low ? -1 : 1;
		if (!scale(x, 16 - exponent, &s))
			return false;
	}
	for (unit = 100; unit > 1; unit /= 10)
		if (reads_back(&s, round_off(&s, unit)))
			break;
	n = round_off(&s, unit);
	digits_of(n, n >= 10 * low ? exponent + 1 : exponent, d);
	return true;
}

/*
 * Without an exponent up to here.  The fewest digits of a larger whole number, padded with zeros,
 * may be a neighbouring integer, and readers that have integers of any size (Python) take them as
 * those: not as the double.  Below 10^16 they are the number itself.
 */
enum { PLAIN = 16 };

static size_t lay_out(char *out, bool negative, const struct decimal *d)
{
	char *p = out;
	int e = d->exponent, i;

	if (negative)
		*p++ = '-';
	if (e >= 0 && e < PLAIN) {
		for (i = 0; i < d->count || i <= e; i++) {
			if (i == e + 1)
				*p++ = '.';
			*p++ = (char)(i < d->count ? d->digit[i] : '0');
		}
		*p = '\0';
		return (size_t)(p - out);
	}
	if (e < 0 && e >= -6) {
		*p++ = '0';
		*p++ = '.';
		for (i = e + 1; i < 0; i++)
			*p++ = '0';
		memcpy(p, d->digit, (size_t)d->count);
		p[d->count] = '\0';
		return (size_t)(p - out) + (size_t)d->count;
	}
	*p++ = d->digit[0];
	if (d->count > 1)
		*p++ = '.';
	for (i = 1; i < d->count; i++)
		*p++ = d->digit[i];
	*p++ = 'e';
	*p++ = e < 0 ? '-' : '+';
	e = e < 0 ? -e : e;
	if (e >= 100)
		*p++ = (char)('0' + e / 100);
	if (e >= 10)
		*p++ = (char)('0' + e / 10 % 10);
	*p++ = (char)('0' + e % 10);
	*p = '\0';
	return (size_t)(p - out);
}

/* Take the digits of what %e printed; whatever the locale's decimal point is, it is no digit. */
static void scan(const char *text, struct decimal *d)
{
	bool negative;
	int exponent = 0;

	d->count = 0;
	for (; *text != 'e'; text++)
		if (*text >= '0' && *text <= '9')
			d->digit[d->count++] = *text;
	negative = *++text == '-';
	while (*++text != '\0')
		exponent = exponent * 10 + (*text - '0');
	d->exponent = negative ? -exponent : exponent;
	while (d->count > 1 && d->digit[d->count - 1] == '0')
		d->count--;
}

static void round_to(double x, int digits, struct decimal *d)
{
	char text[64];

	(void)snprintf(text, sizeof text, "%.*e", digits - 1, x);
	scan(text, d);
}

/*
 * ${all} are the 17 digits nearest to x; cut to ${digits} they are the nearest of so many, unless
 * what is cut off lies just in the middle, where one cannot tell: false.
 */
static bool cut(const struct decimal *all, int digits, struct decimal *d)
{
	int rest = 0, half = 5;

	*d = *all;
	for (int i = digits; i < DBL_DECIMAL_DIG; i++) {
		rest = 10 * rest + (i < all->count ? all->digit[i] - '0' : 0);
		half *= i > digits ? 10 : 1;
	}
	if (rest == half)
		return false;
	if (d->count > digits)
		d->count = digits;
	if (rest > half) {
		int i = digits - 1; /* rest > 0: there are more digits than that */

		while (i >= 0 && d->digit[i] == '9')
			i--;
		if (i < 0) {
			d->digit[0] = '1';
			d->exponent++;
		} else {
			d->digit[i]++;
		}
		d->count = i < 0 ? 1 : i + 1;
	}
	while (d->count > 1 && d->digit[d->count - 1] == '0')
		d->count--;
	return true;
}

static bool survives(double x, const struct decimal *d)
{
	char text[API_NUMBER_SIZE];
	double back = 0;

	return mp_number_parse(text, lay_out(text, false, d), &back) == 0 && back == x;
}

static void slow(double x, struct decimal *d)
{
	int digits = x < DBL_MIN ? 1 : 15; /* any 15 digits survive, unless x is subnormal */
	struct decimal all;

	round_to(x, DBL_DECIMAL_DIG, &all);
	for (; digits < DBL_DECIMAL_DIG; digits++) {
		if (digits < 15 || !cut(&all, digits, d))
			round_to(x, digits, d);
		if (survives(x, d))
			return;
	}
	*d = all;
}

static size_t word(char *out, const char *text)
{
	size_t len = strlen(text);

	memcpy(out, text, len + 1);
	return len;
}

size_t api_json_number(char out[API_NUMBER_SIZE], double x)
{
	double a = fabs(x);
	struct decimal d = {.digit = "0", .count = 1};

	if (!isfinite(x))
		return word(out, "null");
	if (a == 0)
		return word(out, "0");
	if (a < 9007199254740992.0 && a == floor(a)) {
		uint64_t n = (uint64_t)a, tens = 10;
		int exponent = 0;

		for (; tens <= n; tens *= 10)
			exponent++;
		digits_of(n, exponent, &d);
	} else if (a < 1e-6 || a >= 1e17 || !fast(a, &d)) {
		slow(a, &d);
	}
	return lay_out(out, x < 0, &d);
}

size_t api_json_number_rounded(char out[API_NUMBER_SIZE], double x, int digits)
{
	struct decimal d = {.digit = "0", .count = 1};

	if (!isfinite(x))
		return word(out, "null");
	if (x == 0)
		return word(out, "0");
	round_to(fabs(x), digits, &d);
	return lay_out(out, x < 0, &d);
}
