#include "core/number/number.h"

#include <math.h>
#include <string.h>

#include "core/number/number_private.h"
#include "pow5_table.h"

__extension__ typedef unsigned __int128 uint128; /* gcc and clang on 64-bit hosts */

/* floor(log2(10^q)) + 63 for |q| <= 350: 217706/2^16 is just above log2(10). */
static int64_t binary_exponent(int64_t q)
{
	return ((217706 * (q + 65536)) >> 16) - 217706 + 63; /* no negative number is shifted */
}

/*
 * The top of w * 5^q as 128 bits: 55 bits of it are right, which is all that rounding needs.  The
 * lower half of the table only counts where the upper product is all ones below those bits.
 */
static void multiply(uint64_t w, int64_t q, uint64_t *hi, uint64_t *lo)
{
	const uint64_t *five = pow5_table[q - POW5_LOWEST];
	uint128 product = (uint128)w * five[0];
	const uint64_t unsure = UINT64_MAX >> 55;

	if (((uint64_t)(product >> 64) & unsure) == unsure)
		product += ((uint128)w * five[1]) >> 64;
	*hi = (uint64_t)(product >> 64);
	*lo = (uint64_t)product;
}

int mp_number_power(int q, uint64_t top[2])
{
	memcpy(top, pow5_table[q - POW5_LOWEST], 2 * sizeof top[0]);
	return (int)binary_exponent(q) - 63 - 127;
}

static double from_bits(uint64_t exponent, uint64_t mantissa)
{
	uint64_t bits = exponent << 52 | (mantissa & (((uint64_t)1 << 52) - 1));
	double v;

	memcpy(&v, &bits, sizeof v);
	return v;
}

/* ${mantissa} has one bit below the last place; ${shift} more places are lost before rounding. */
static double subnormal(uint64_t mantissa, int64_t shift)
{
	if (shift >= 64)
		return 0.0;
	mantissa >>= shift;
	mantissa += mantissa & 1; /* no tie can come here: see the paper, section 8.3 */
	mantissa >>= 1;
	return from_bits(mantissa >> 52, mantissa);
}

/*
 * Eisel-Lemire (doi:10.1002/spe.2984).  A 64-bit w never needs a fallback (Mushtak and Lemire
 * 2023, doi:10.1002/spe.3198).
 */
double mp_number_scale(uint64_t w, int64_t q)
{
	uint64_t hi, lo, mantissa;
	int64_t exponent;
	int zeros, upper;

	if (w == 0 || q < POW5_LOWEST)
		return 0.0;
	if (q > POW5_HIGHEST)
		return (double)INFINITY;
	zeros = __builtin_clzll(w);
	multiply(w << zeros, q, &hi, &lo);
	upper = (int)(hi >> 63);
	mantissa = hi >> (upper + 9); /* 54 bits: one to round by */
	exponent = binary_exponent(q) + upper - zeros + 1023;
	if (exponent <= 0)
		return subnormal(mantissa, 1 - exponent);
	/* Exactly halfway: 5^q divides w, or 5^-q fits beside the mantissa; then to even. */
	if (lo <= 1 && q >= -4 && q <= 23 && (mantissa & 3) == 1 && mantissa << (upper + 9) == hi)
		mantissa &= ~(uint64_t)1;
	mantissa += mantissa & 1;
	mantissa >>= 1;
	if (mantissa >> 53 != 0) {
		mantissa >>= 1;
		exponent++;
	}
	if (exponent >= 2047)
		return (double)INFINITY;
	return from_bits((uint64_t)exponent, mantissa);
}

/* Is ${text} the lower-case ${word}, in any case? */
static bool is_word(const char *text, size_t len, const char *word)
{
	size_t i;

	for (i = 0; i < len && word[i] != '\0'; i++) {
		char c = text[i];

		if ((c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c) != word[i])
			return false;
	}
	return i == len && word[i] == '\0';
}

/* What C libraries print for NaN: nan, nan(ind), nan(0x8000). */
static bool is_nan(const char *text, size_t len)
{
	if (len < 3 || !is_word(text, 3, "nan"))
		return false;
	if (len == 3)
		return true;
	for (size_t i = 4; i + 1 < len; i++) {
		char c = text[i];

		if (!mp_is_digit(c) && c != '_' && !((c | 0x20) >= 'a' && (c | 0x20) <= 'z'))
			return false;
	}
	return len > 4 && text[3] == '(' && text[len - 1] == ')';
}

/* What the Microsoft library printed before 2015: 1.#IND, 1.#QNAN00, 1.#INF. */
static int microsoft(const char *text, size_t len, double *value)
{
	while (len > 0 && text[len - 1] == '0') /* filled up to the precision asked for */
		len--;
	if (is_word(text, len, "1.#inf"))
		*value = (double)INFINITY;
	else if (is_word(text, len, "1.#ind") || is_word(text, len, "1.#qnan") ||
		 is_word(text, len, "1.#snan"))
		*value = (double)NAN;
	else
		return -1;
	return 0;
}

static int not_finite(const char *text, size_t len, double *value)
{
	bool negative = text[0] == '-';

	if (len > MP_NUMBER_WORD)
		return -1;
	if (negative || text[0] == '+') {
		text++;
		len--;
	}
	if (is_nan(text, len))
		*value = (double)NAN;
	else if (is_word(text, len, "inf") || is_word(text, len, "infinity"))
		*value = (double)INFINITY;
	else if (microsoft(text, len, value))
		return -1;
	if (negative)
		*value = -*value;
	return 0;
}

int mp_number_parse(const char *text, size_t len, double *value)
{
	struct mp_decimal d;
	double v;

	if (len == 0)
		return -1;
	if (mp_number_scan_bytes(text, text + len, &v) != text + len) {
		mp_decimal_begin(&d);
		mp_decimal_feed(&d, text, len);
		if (mp_decimal_finish(&d, &v) && not_finite(text, len, &v))
			return -1;
	}
	*value = v;
	return 0;
}
