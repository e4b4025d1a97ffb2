#include "api/json_number.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "core/number/number.h"

__extension__ typedef unsigned __int128 u128;

/* d.ddd * 10^exponent.  Behind ${count} digits there is room, so that 17 can be moved in one go. */
enum { WHOLE_MOVED = 8, ALL = 17 };
struct decimal {
	char digit[WHOLE_MOVED + ALL + 7];
	int count, exponent;
};

/* The significand m*2^e of a positive double, scaled by 10^k: a 17-digit number, exactly. */
struct scaled {
	u128 product;  /* m * 10^k, shifted left by e where e > 0 */
	u128 ulp;      /* what one unit of m is worth in ${product} */
	int shift;     /* digits = product >> shift */
	bool even;     /* m is even: a tie reads back to x */
	bool lowest;   /* m is a power of two: below it the numbers are twice as dense */
	unsigned dull; /* product and ulp are off by less than this; 0: they are exact */
};

enum attempt { SHORTER_FAILS, READS_BACK, UNSURE };

static u128 power_of_ten(int k) /* 0 <= k <= 38 */
{
	u128 p = 1;

	while (k-- > 0)
		p *= 10;
	return p;
}

#define FOUR(x) (x), 10 * (x), 100 * (x), 1000 * (x)
static const uint64_t tens[] = {FOUR(UINT64_C(1)), FOUR(UINT64_C(10000)), FOUR(UINT64_C(100000000)),
				FOUR(UINT64_C(1000000000000)), FOUR(UINT64_C(10000000000000000))};
#undef FOUR

/* Of 0 < n < 10^18: log10(2) is 1233/4096, a little less. */
static int count_digits(uint64_t n)
{
	int least = ((64 - __builtin_clzll(n)) * 1233) >> 12;

	return least + (n >= tens[least]);
}

/* The last ${count} digits of ${n}, two by two. */
static void put_digits(char *out, uint32_t n, int count)
{
	static const char pairs[] = "00010203040506070809101112131415161718192021222324"
				    "25262728293031323334353637383940414243444546474849"
				    "50515253545556575859606162636465666768697071727374"
				    "75767778798081828384858687888990919293949596979899";

	for (; count > 1; count -= 2, n /= 100)
		memcpy(out + count - 2, pairs + 2 * (size_t)(n % 100), 2);
	if (count > 0)
		out[0] = (char)('0' + n % 10);
}

/* n > 0 has at most 18 digits; 32-bit divisions by a constant are twice as fast. */
static void digits_of(uint64_t n, struct decimal *d)
{
	int len = count_digits(n);

	if (len > 9) {
		put_digits(d->digit + len - 9, (uint32_t)(n % 1000000000), 9);
		put_digits(d->digit, (uint32_t)(n / 1000000000), len - 9);
	} else {
		put_digits(d->digit, (uint32_t)n, len);
	}
	d->exponent = len - 1;
	while (d->digit[len - 1] == '0')
		len--;
	d->count = len;
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
	s->lowest = m == UINT64_C(1) << (DBL_MANT_DIG - 1);
	s->dull = 0;
	return true;
}

/* The same for any normal x by the highest 128 bits of 10^k: nearly all that is ever needed. */
static bool scale_dull(double x, int k, struct scaled *s)
{
	const uint64_t hidden = UINT64_C(1) << 52;
	uint64_t bits, w, top[2];
	int e;

	memcpy(&bits, &x, sizeof bits);
	w = ((bits & (hidden - 1)) | hidden) << 11;
	e = (int)(bits >> 52) - 1075 - 11 + mp_number_power(k, top) + 64;
	s->product = ((u128)w * top[0] + ((u128)w * top[1] >> 64)) >> 1;
	s->ulp = ((u128)top[0] << 64 | top[1]) >> 54;
	s->shift = -e - 1;
	s->even = (bits & 1) == 0;
	s->lowest = (bits & (hidden - 1)) == 0;
	s->dull = 8; /* 2 of the product and 1 of ulp, doubled where they are compared */
	return s->shift > 64 && s->shift < 80;
}

/*
 * The nearest number with the last digits of 17 zero, ties to even: ${unit} is 100, 10 or 1, and
 * the result is in units of the 17th digit.  Does it lie so near that it reads back to the same
 * double?  (17 digits always do.)
 */
static inline enum attempt round_off(const struct scaled *s, uint64_t unit, uint64_t *out)
{
	uint64_t n = (uint64_t)(s->product >> s->shift);
	u128 low = s->product - ((u128)n << s->shift);
	u128 rest = 2 * (((u128)(n % unit) << s->shift) + low);
	u128 half = (u128)unit << s->shift, there, gap, room;

	if (s->dull > 0 && (rest > half ? rest - half : half - rest) < s->dull)
		return UNSURE;
	*out = (n / unit + (rest > half || (rest == half && (n / unit) % 2 == 1) ? 1 : 0)) * unit;
	if (unit == 1)
		return READS_BACK;
	there = (u128)*out << s->shift;
	room = there < s->product && s->lowest ? s->ulp / 2 : s->ulp;
	gap = 2 * (there < s->product ? s->product - there : there - s->product);
	if (s->dull > 0 && (gap > room ? gap - room : room - gap) < s->dull)
		return UNSURE;
	return gap < room || (gap == room && s->even) ? READS_BACK : SHORTER_FAILS;
}

static const uint64_t least17 = UINT64_C(10000000000000000); /* 10^16 */

static bool shorten(const struct scaled *s, int exponent, struct decimal *d)
{
	uint64_t n;
	enum attempt a = round_off(s, 100, &n);

	a = a == SHORTER_FAILS ? round_off(s, 10, &n) : a;
	a = a == SHORTER_FAILS ? round_off(s, 1, &n) : a;
	if (a != READS_BACK)
		return false;
	digits_of(n, d);
	d->exponent += exponent - (ALL - 1);
	return true;
}

/* False where 128 bits do not tell, which is rare, and below 1e-290, where 10^k is not known. */
static bool fast(double x, struct decimal *d)
{
	struct scaled s;
	int binary, exponent;
	uint64_t bits;

	if (x < 1e-290)
		return false;
	memcpy(&bits, &x, sizeof bits); /* normal, positive */
	binary = (int)(bits >> 52) - 1022;
	/* floor(log10(2^(binary-1))) by log10(2), and x may have one digit more; 2^22 * log10(2) */
	exponent = (int)((INT64_C(1262611) * (binary - 1 + (1 << 22))) >> 22) - 1262611;
	if (!scale_dull(x, 16 - exponent, &s))
		return false;
	if (s.product >> s.shift >= 10 * least17 && !scale_dull(x, 16 - ++exponent, &s))
		return false;
	return s.product >> s.shift >= least17 && shorten(&s, exponent, d);
}

/* 1e-6 <= x < 1e17, in integers of 128 bits: no rounding, no table. */
static bool exact(double x, struct decimal *d)
{
	int exponent = (int)floor(log10(x));
	struct scaled s;
	uint64_t n;

	if (!scale(x, 16 - exponent, &s))
		return false;
	n = (uint64_t)(s.product >> s.shift);
	if (n < least17 || n >= 10 * least17) { /* log10 rounded across a power of ten */
		exponent += n < least17 ? -1 : 1;
		if (!scale(x, 16 - exponent, &s))
			return false;
	}
	return shorten(&s, exponent, d);
}

/*
 * Without an exponent up to here.  The fewest digits of a larger whole number, padded with zeros,
 * may be a neighbouring integer, and readers that have integers of any size (Python) take them as
 * those: not as the double.  Below 10^16 they are the number itself.
 */
enum { PLAIN = 16 };

static size_t lay_out_exponent(char *out, const struct decimal *d)
{
	int e = d->exponent < 0 ? -d->exponent : d->exponent;
	char *p = out;

	*p++ = d->digit[0];
	if (d->count > 1) {
		*p++ = '.';
		memcpy(p, d->digit + 1, ALL - 1);
		p += d->count - 1;
	}
	*p++ = 'e';
	*p++ = d->exponent < 0 ? '-' : '+';
	if (e >= 100)
		*p++ = (char)('0' + e / 100);
	if (e >= 10)
		*p++ = (char)('0' + e / 10 % 10);
	*p++ = (char)('0' + e % 10);
	*p = '\0';
	return (size_t)(p - out);
}

static size_t lay_out_plain(char *out, const struct decimal *d)
{
	int whole = d->exponent + 1, fraction = d->count - whole;

	if (fraction <= 0) {
		memcpy(out, d->digit, ALL);
		memset(out + d->count, '0', (size_t)-fraction);
		out[whole] = '\0';
		return (size_t)whole;
	}
	if (whole <= WHOLE_MOVED) {
		memcpy(out, d->digit, WHOLE_MOVED);
		memcpy(out + whole + 1, d->digit + whole, ALL);
	} else {
		memcpy(out, d->digit, (size_t)whole);
		memcpy(out + whole + 1, d->digit + whole, (size_t)fraction);
	}
	out[whole] = '.';
	out[d->count + 1] = '\0';
	return (size_t)d->count + 1;
}

static size_t lay_out(char *out, bool negative, const struct decimal *d)
{
	int e = d->exponent;
	char *p = out;

	if (negative)
		*p++ = '-';
	if (e >= PLAIN || e < -6)
		return (size_t)(p - out) + lay_out_exponent(p, d);
	if (e >= 0)
		return (size_t)(p - out) + lay_out_plain(p, d);
	memcpy(p, "0.00000", 7);
	p += 1 - e;
	memcpy(p, d->digit, ALL);
	p[d->count] = '\0';
	return (size_t)(p - out) + (size_t)d->count;
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
	if (a < 9007199254740992.0 && a == (double)(int64_t)a)
		digits_of((uint64_t)a, &d);
	else if (!fast(a, &d) && (a < 1e-6 || a >= 1e17 || !exact(a, &d)))
		slow(a, &d);
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
