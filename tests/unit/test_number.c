#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <gmp.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/number/number.h"
#include "core/number/number_private.h"

/* strtod of the GNU C library rounds correctly and is the second opinion throughout. */

static uint64_t seed = 0x9e3779b97f4a7c15u;

static uint64_t random64(void) /* xorshift64* */
{
	seed ^= seed >> 12;
	seed ^= seed << 25;
	seed ^= seed >> 27;
	return seed * 2685821657736338717u;
}

static unsigned below(unsigned n)
{
	return (unsigned)((random64() >> 33) % n);
}

static uint64_t bits_of(double v)
{
	uint64_t bits;

	memcpy(&bits, &v, sizeof bits);
	return bits;
}

static double from_bits(uint64_t bits)
{
	double v;

	memcpy(&v, &bits, sizeof v);
	return v;
}

/* On an exact-size copy, so that a read behind the end is seen. */
static int parse(const char *text, size_t len, double *value)
{
	char *copy = malloc(len + (len == 0));
	int ret;

	assert_non_null(copy);
	memcpy(copy, text, len);
	ret = mp_number_parse(copy, len, value);
	free(copy);
	return ret;
}

static void check_double(const char *text, size_t len, double want)
{
	double got = -12345.0;

	if (parse(text, len, &got) != 0 || bits_of(got) != bits_of(want))
		fail_msg("\"%.60s\" (%zu): %a, not %a", text, len, got, want);
}

static void check_strtod(const char *text)
{
	check_double(text, strlen(text), strtod(text, NULL));
}

/* The same digits in pieces, as a decoder sees them at the ends of chunks. */
static void check_fed(const char *text)
{
	size_t len = strlen(text);
	struct mp_decimal d;
	double got = 0.0;

	mp_decimal_begin(&d);
	for (size_t at = 0, step; at < len; at += step) {
		step = 1 + below(7);
		if (step > len - at)
			step = len - at;
		mp_decimal_feed(&d, text + at, step);
	}
	assert_int_equal(mp_decimal_finish(&d, &got), 0);
	assert_true(bits_of(got) == bits_of(strtod(text, NULL)));
}

static void accepts_every_spelling(void **state)
{
	(void)state;
	check_double("0", 1, 0.0);
	check_double("-0", 2, -0.0);
	check_double("+1", 2, 1.0);
	check_double(".5", 2, 0.5);
	check_double("5.", 2, 5.0);
	check_double("-.5e1", 5, -5.0);
	check_double("5.e-1", 5, 0.5);
	check_double("1.0E+001", 8, 10.0);
	check_double("1e00000000000000000005", 22, 1e5);
	check_double("00000000000000000000000000012", 29, 12.0);
	check_double("0.00000000000000000000000000012", 31, 1.2e-28);
	check_double("1.5d2", 5, 150.0);
	check_double("1.5D-2", 6, 0.015);
	check_double("0e999999999", 11, 0.0);
}

static void refuses_what_is_no_number(void **state)
{
	static const char *const wrong[] = {
	    "",       " ",      ".",       "+",        "-",      "e5",    "1e",      "1e+",
	    "0x10",   "1_0",    "1,5",     "1..2",     "1.2.3",  "--1",   "+-1",     "1-",
	    "1e5.",   "1e5e5",  ".e5",     "1 ",       " 1",     "1f",    "1\n",     "infi",
	    "na",     "nano",   "nan(",    "nan)",     "nan(-)", "nan x", "1.#",     "1.#IN",
	    "1.#FOO", "2.#INF", "1.#INF1", "1e--5",    "--inf",  "in",    "infinit", "infinityy",
	    "0x",     "1d",     "1.#00",   "\xd9\xa1", "1e5 ",   "$1",    "1/2",     "nan()x",
	};
	double v = 42.0;

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		if (parse(wrong[i], strlen(wrong[i]), &v) == 0)
			fail_msg("accepted \"%s\"", wrong[i]);
		assert_true(v == 42.0);
	}
	assert_int_equal(parse("1\0", 2, &v), -1);
	assert_int_equal(parse("\0", 1, &v), -1);
}

static void names_what_is_not_finite(void **state)
{
	static const char *const nan_words[] = {"nan",      "NaN",       "-NAN",       "+nan",
						"nan(ind)", "-nan(IND)", "nan(0x8_0)", "nan()",
						"1.#IND",   "-1.#IND",   "1.#QNAN00",  "-1.#snan"};
	static const char *const inf_words[] = {"inf",      "INF",    "+Inf",     "infinity",
						"INFINITY", "1.#INF", "1.#INF00", "+1.#inf"};
	double v;

	(void)state;
	for (size_t i = 0; i < sizeof nan_words / sizeof nan_words[0]; i++) {
		assert_int_equal(parse(nan_words[i], strlen(nan_words[i]), &v), 0);
		assert_true(isnan(v));
	}
	for (size_t i = 0; i < sizeof inf_words / sizeof inf_words[0]; i++) {
		assert_int_equal(parse(inf_words[i], strlen(inf_words[i]), &v), 0);
		assert_true(v == (double)INFINITY);
	}
	assert_int_equal(parse("-Infinity", 9, &v), 0);
	assert_true(v == -(double)INFINITY);
}

static void extremes_are_right(void **state)
{
	static const char *const text[] = {
	    "1.7976931348623157e308",
	    "1.7976931348623158e308",
	    "1.7976931348623159e308",
	    "17976931348623158079372897140530341507993413271003782693617377898044496829276475094664"
	    "9"
	    "01797758720709633028641669288791094655554785194040263065748867150582068190890200070838"
	    "36"
	    "76273854845817711531764475730270069855571366959622842914819860834936475292719074168444"
	    "36"
	    "5510704342711559699508093042880",
	    "1e308",
	    "1e309",
	    "9e307",
	    "2.2250738585072014e-308",
	    "2.2250738585072011e-308",
	    "2.2250738585072012e-308",
	    "4.9406564584124654e-324",
	    "2.4703282292062327e-324",
	    "2.4703282292062328e-324",
	    "2e-324",
	    "3e-324",
	    "9007199254740993",
	    "9007199254740992.99999999999999999999",
	    "9007199254740993.00000000000000000001",
	    "18446744073709551615",
	    "18446744073709551616",
	    "9999999999999999999",
	    "99999999999999999999",
	    "1e22",
	    "1e23",
	    "8.5e-5",
	    "123456789012345678901234567890e-340",
	    "0.1",
	    "1e-400",
	    "-1e400",
	    "1e999999",
	    "1e-999999",
	    "1e99999999999999999999",
	    "-1e-99999999999999999999",
	    "1e9223372036854775808",
	    "1e-9223372036854775808",
	    "1e18446744073709551617",
	    "6929495644600919.5",
	    "3.2378839133029012895883524125015321748630094840530e-319",
	};

	(void)state;
	for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) {
		check_strtod(text[i]);
		check_fed(text[i]);
	}
}

static void every_bit_pattern_reads_back(void **state)
{
	char text[64];

	(void)state;
	for (int i = 0; i < 400000; i++) {
		uint64_t bits = random64();
		int digits = 1 + (int)below(25);

		if (i % 8 == 0)
			bits &= 0x800fffffffffffffu; /* subnormal */
		if ((bits >> 52 & 2047) == 2047)
			continue;
		snprintf(text, sizeof text, "%.*e", i % 4 == 0 ? 16 : digits, from_bits(bits));
		check_strtod(text);
		snprintf(text, sizeof text, "%.17g", from_bits(bits));
		check_double(text, strlen(text), from_bits(bits));
	}
}

/* sign, digits, perhaps a point, perhaps an exponent that keeps it near the range of doubles */
static void random_text(char *text, unsigned most)
{
	unsigned digits = 1 + below(most), point = below(digits + 4);
	char *p = text;

	if (below(4) == 0)
		*p++ = "+-"[below(2)];
	for (unsigned i = 0; i < digits; i++) {
		if (i == point)
			*p++ = '.';
		*p++ = (char)('0' + (below(5) == 0 ? 9 * below(2) : below(10)));
	}
	*p = '\0';
	if (below(3) != 0)
		sprintf(p, "%c%d", "eE"[below(2)], (int)below(700) - 350);
}

/* Both scanners on an exact-size copy: what they take is what mp_number_parse() makes of it. */
static bool check_scan(const char *text, size_t len)
{
	char *room = malloc(len + MP_NUMBER_ROOM);
	const char *scanned, *inlined;
	double whole = 0, v = 0, w = 0;

	assert_non_null(room);
	memcpy(room, text, len);
	memset(room + len, ' ', MP_NUMBER_ROOM);
	scanned = mp_number_scan_text(room, &v);
	inlined = mp_number_scan(room, &w);
	if (scanned != inlined || (scanned != NULL && bits_of(v) != bits_of(w)))
		fail_msg("\"%.60s\": the scanners disagree", text);
	if (scanned == room + len &&
	    (parse(text, len, &whole) != 0 || bits_of(v) != bits_of(whole)))
		fail_msg("\"%.60s\": scanned as %a", text, v);
	len = scanned == room + len;
	free(room);
	return len != 0;
}

static void scanning_in_place_agrees(void **state)
{
	static const char *const format[] = {"%e",  "%f",   "%g",    "%.9g", "%E",      "%.3f",
					     "%+e", "%.8e", "%.17g", "%.0f", "%010.4f", "%+.1f"};
	char text[400];

	(void)state;
	for (int i = 0; i < 60000; i++) {
		double x = (double)(int64_t)random64() / (double)(1 + (random64() >> below(63)));
		int len;

		if (below(4) == 0)
			x *= pow(10, (int)below(700) - 350);
		if (below(8) == 0)
			x = below(3);
		len = snprintf(text, sizeof text, format[i % 12], below(2) ? x : -x);
		if (fabs(x) < 1e7 && fabs(x) > 0.1 && !check_scan(text, (size_t)len))
			fail_msg("%s is not scanned", text);
		for (int k = 0; k < 20; k++) {
			size_t at = below((unsigned)len);
			char was = text[at];

			text[at] = k < 10 ? "0189.eE+-:"[k] : (char)below(256);
			(void)check_scan(text, (size_t)len);
			text[at] = was;
		}
	}
}

static void random_decimals_agree_with_strtod(void **state)
{
	char text[1100];

	(void)state;
	for (int i = 0; i < 1000000; i++) {
		random_text(text, i % 64 == 0 ? 60 : 24);
		check_strtod(text);
	}
	for (int i = 0; i < 3000; i++) {
		random_text(text, 1000);
		check_strtod(text);
		check_fed(text);
	}
}

/*
 * The middle between ${low} and the next double, plus ${tenths} of a unit in the last place of its
 * decimal expansion, in full and without an exponent.
 */
static char *middle_text(double low, int tenths)
{
	uint64_t bits = bits_of(low), m = bits & (((uint64_t)1 << 52) - 1);
	int e = (int)(bits >> 52) - 1076; /* of half a unit in the last place */
	size_t places, len, zeros;
	char *digits, *text;
	mpz_t v, five;

	if (bits >> 52 != 0)
		m |= (uint64_t)1 << 52;
	else
		e++;
	places = e < 0 ? (size_t)-e + 1 : 1;
	mpz_init_set_ui(v, 2 * m + 1);
	mpz_init(five);
	if (e >= 0)
		mpz_mul_2exp(v, v, (mp_bitcnt_t)e);
	mpz_ui_pow_ui(five, 5, e < 0 ? (unsigned long)-e : 0); /* 2^e = 5^-e / 10^-e */
	mpz_mul(v, v, five);
	mpz_mul_ui(v, v, 10);
	if (tenths < 0)
		mpz_sub_ui(v, v, (unsigned long)-tenths);
	else
		mpz_add_ui(v, v, (unsigned long)tenths);
	digits = mpz_get_str(NULL, 10, v);
	len = strlen(digits);
	zeros = len > places ? 0 : places - len + 1;
	text = malloc(zeros + len + 2);
	assert_non_null(text);
	memset(text, '0', zeros);
	strcpy(text + zeros, digits);
	len += zeros;
	memmove(text + len - places + 1, text + len - places, places + 1);
	text[len - places] = '.';
	free(digits);
	mpz_clears(v, five, NULL);
	return text;
}

static void check_middle(double low)
{
	uint64_t bits = bits_of(low);
	double high = from_bits(bits + 1);
	double even = (bits & 1) != 0 ? high : low;

	for (int tenths = -1; tenths <= 1; tenths++) {
		char *text = middle_text(low, tenths);

		check_double(text, strlen(text), tenths == 0 ? even : tenths < 0 ? low : high);
		check_fed(text);
		free(text);
	}
}

static void ties_go_to_even(void **state)
{
	(void)state;
	check_middle(0.0);
	check_middle(from_bits(1));
	check_middle(from_bits(2));
	check_middle(from_bits(((uint64_t)1 << 52) - 1)); /* subnormal to normal */
	check_middle(2.2250738585072014e-308);
	check_middle(1.7976931348623157e308); /* to infinity */
	check_middle(1.0);
	check_middle(9007199254740992.0);
	for (int i = 0; i < 4000; i++) {
		uint64_t bits = random64() & INT64_MAX;

		if (i % 4 == 0)
			bits &= ((uint64_t)1 << 53) - 1;
		else if (i % 4 == 1) /* few digits: ties that the fast paths meet */
			bits = (1023 + (uint64_t)below(90)) << 52 | (bits & 0xfffff00000000);
		if (bits >> 52 < 2047)
			check_middle(from_bits(bits));
	}
}

/* 10^5 digits behind a tie decide it, wherever the one digit that is not 0 stands. */
static void long_numbers_are_exact(void **state)
{
	const size_t len = 100001;
	char *text = malloc(len + 16);

	(void)state;
	assert_non_null(text);
	memset(text, '0', len + 16);
	memcpy(text, "9007199254740993.", 17);
	check_double(text, len, 9007199254740992.0);
	text[len - 1] = '1';
	check_double(text, len, 9007199254740994.0);
	memset(text, '9', len); /* too large */
	check_double(text, len, (double)INFINITY);
	memcpy(text + len, "e-100000", 8);
	check_double(text, len + 8, 10.0); /* 9.99... to 10^5 digits */
	memset(text, '0', len);
	memcpy(text, "0.", 2);
	memcpy(text + len, "15e100000", 9);
	check_double(text, len + 9, 1.5); /* 10^5 - 1 zeros behind the point */
	memset(text, '0', len);
	text[0] = '2';
	memcpy(text + len, "e-100000", 8);
	check_double(text, len + 8, 2.0);
	free(text);
}

/* Digits are told from the rest in any place, whatever stands beside them. */
static void test_masks_of_digits(void **state)
{
	char text[64];

	(void)state;
	for (int i = 0; i < 20000; i++) {
		uint64_t bits = 0, odd;

		for (int k = 0; k < 64; k++) {
			text[k] = i % 2 ? (char)below(256) : "0519/:.- e\n\xb0"[below(12)];
			bits |= (uint64_t) !(text[k] >= '0' && text[k] <= '9') << k;
		}
		assert_true(mp_not_digits64(text) == bits);
		odd = mp_not_digits8(mp_text8(text) ^ MP_ZEROS8);
		if ((bits & 255) == 0)
			assert_true(odd == 0);
		else
			assert_int_equal(__builtin_ctzll(odd) / 8, __builtin_ctzll(bits));
	}
	for (unsigned n = 0; n <= 8; n++)
		assert_int_equal(mp_digits_of(mp_text8("12345678") ^ MP_ZEROS8, n),
				 n == 0 ? 0 : (uint64_t)(12345678 / pow(10, 8 - (int)n)));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_masks_of_digits),
	    cmocka_unit_test(accepts_every_spelling),
	    cmocka_unit_test(refuses_what_is_no_number),
	    cmocka_unit_test(names_what_is_not_finite),
	    cmocka_unit_test(extremes_are_right),
	    cmocka_unit_test(every_bit_pattern_reads_back),
	    cmocka_unit_test(scanning_in_place_agrees),
	    cmocka_unit_test(random_decimals_agree_with_strtod),
	    cmocka_unit_test(ties_go_to_even),
	    cmocka_unit_test(long_numbers_are_exact),
	};

	return cmocka_run_group_tests_name("number", tests, NULL, NULL);
}
