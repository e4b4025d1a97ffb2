#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/json_number.h"

/* strtod and printf of the GNU C library round correctly and are the second opinion. */

static uint64_t seed = 88172645463325252u;

static uint64_t random64(void) /* xorshift64* */
{
	seed ^= seed >> 12;
	seed ^= seed << 25;
	seed ^= seed >> 27;
	return seed * 2685821657736338717u;
}

static double from_bits(uint64_t bits)
{
	double x;

	memcpy(&x, &bits, sizeof x);
	return x;
}

static void prints(double x, const char *expected)
{
	char out[API_NUMBER_SIZE];

	assert_int_equal(api_json_number(out, x), strlen(expected));
	assert_string_equal(out, expected);
}

static size_t significant(const char *text)
{
	size_t count = 0, zeros = 0;

	for (; *text != '\0' && *text != 'e'; text++) {
		if (*text < '0' || *text > '9' || (count == 0 && *text == '0'))
			continue;
		count++;
		zeros = *text == '0' ? zeros + 1 : 0;
	}
	return count - zeros;
}

/* The fewest digits at which printf's text reads back. */
static size_t fewest(double x)
{
	char text[64];
	int digits = 0;

	do
		snprintf(text, sizeof text, "%.*e", digits++, x);
	while (strtod(text, NULL) != x);
	return significant(text);
}

/* RFC 8259: no leading zeros, a digit on both sides of the point. */
static void is_json(const char *text)
{
	if (*text == '-')
		text++;
	assert_in_range(*text, '0', '9');
	if (*text == '0')
		assert_true(text[1] == '.' || text[1] == '\0');
	text += strspn(text, "0123456789");
	if (*text == '.') {
		assert_in_range(text[1], '0', '9');
		text += 1 + strspn(text + 1, "0123456789");
	}
	if (*text == 'e') {
		assert_true(text[1] == '+' || text[1] == '-');
		assert_in_range(text[2], '0', '9');
		text += 2 + strspn(text + 2, "0123456789");
	}
	assert_string_equal(text, "");
}

static void reads_back(double x)
{
	char out[API_NUMBER_SIZE];

	size_t len = api_json_number(out, x);

	assert_int_equal(len, strlen(out));
	is_json(out);
	if (strtod(out, NULL) != x || significant(out) > fewest(x))
		fail_msg("%a printed as %s", x, out);
}

static void prints_the_contracts_numbers(void **state)
{
	(void)state;
	prints(0, "0");
	prints(24000, "24000");
	prints(0.0648, "0.0648");
	prints(-19.44, "-19.44");
	prints(28.08, "28.08");
	prints(7.02, "7.02");
	prints(1e-12, "1e-12");
	prints(1e-17, "1e-17");
	prints(1e100, "1e+100");
	prints(0.1, "0.1");
	prints(1e15, "1000000000000000");
	prints(1e21, "1e+21");
	prints(9007199254740993.0, "9007199254740992");
	prints(1e-7, "1e-7");
	prints(1.5e-7, "1.5e-7");
	prints(0.000001, "0.000001");
}

/* Python reads digits alone as an integer of any size: it has to be the double to the last one. */
static void what_looks_like_an_integer_is_it(void **state)
{
	(void)state;
	prints(9999999999999998.0, "9999999999999998");
	prints(1e16, "1e+16");
	prints(-1e20, "-1e+20");
	prints(36028797018963970.0, "3.602879701896397e+16"); /* is ...968 */
	prints(123456789012345680000.0, "1.2345678901234568e+20");
	for (int i = 0; i < 60000; i++) {
		uint64_t n = random64() >> (1 + i % 63), back;
		char out[API_NUMBER_SIZE], *end;

		(void)api_json_number(out, (double)n);
		back = strtoull(out, &end, 10);
		if (*end == '\0' && back != (uint64_t)(double)n)
			fail_msg("%a printed as %s", (double)n, out);
	}
}

static void what_json_cannot_say_is_null(void **state)
{
	(void)state;
	prints(NAN, "null");
	prints(INFINITY, "null");
	prints(-INFINITY, "null");
}

static void minus_zero_is_zero(void **state)
{
	(void)state;
	prints(-0.0, "0");
}

static void the_ends_of_the_range_read_back(void **state)
{
	(void)state;
	prints(DBL_MAX, "1.7976931348623157e+308");
	prints(DBL_MIN, "2.2250738585072014e-308");
	prints(from_bits(1), "5e-324");
	reads_back(nextafter(DBL_MIN, 0));
	reads_back(-DBL_MAX);
}

static void any_double_reads_back_in_the_fewest_digits(void **state)
{
	(void)state;
	for (int i = 0; i < 20000; i++) {
		double x = from_bits(random64());

		if (isfinite(x) && x != 0)
			reads_back(x);
	}
}

static void numbers_of_a_workshop_read_back_in_the_fewest_digits(void **state)
{
	(void)state;
	for (int i = 0; i < 60000; i++) {
		double x = (double)(random64() >> 11) / 9007199254740992.0;
		double y = x * pow(10, (int)(random64() % 26) - 8);

		reads_back(y);
		reads_back((double)(float)y);
		reads_back(-round(y * 1000) / 1000 - 0.001);
		reads_back(nextafter(y, 1e300));
	}
}

/* Numbers of few bits have an end, often a 5: just between two of the next shorter ones. */
static void ties_read_back_in_the_fewest_digits(void **state)
{
	(void)state;
	prints(1.000030517578125, "1.000030517578125");
	prints(0x1.0001p0, "1.0000152587890625");
	for (int i = 0; i < 60000; i++)
		reads_back(ldexp((double)(random64() >> (12 + random64() % 50) | 1),
				 -(int)(random64() % 120)));
}

/* Where the gap below is half the gap above, and where log10 rounds. */
static void neighbours_of_powers_read_back(void **state)
{
	(void)state;
	for (int e = -330; e < 308; e++) {
		double x = pow(10, e), below = nextafter(x, 0);

		for (int k = 0; k < 4 && below > 0; k++, below = nextafter(below, 0))
			reads_back(below);
		for (int k = 0; k < 4 && x > 0; k++, x = nextafter(x, DBL_MAX))
			reads_back(x);
	}
	for (int e = -1060; e < 1023; e++) {
		double x = ldexp(1, e);

		reads_back(nextafter(x, 0));
		reads_back(x);
		reads_back(nextafter(x, DBL_MAX));
	}
}

static void people_get_the_digits_they_ask_for(void **state)
{
	char out[API_NUMBER_SIZE];

	(void)state;
	(void)api_json_number_rounded(out, 2.0 / 3, 6);
	assert_string_equal(out, "0.666667");
	(void)api_json_number_rounded(out, -123456789, 3);
	assert_string_equal(out, "-123000000");
	(void)api_json_number_rounded(out, 0.1 + 0.2, 10);
	assert_string_equal(out, "0.3");
	(void)api_json_number_rounded(out, -0.0, 10);
	assert_string_equal(out, "0");
}

int main(void)
{
	const struct CMUnitTest json_number[] = {
	    cmocka_unit_test(prints_the_contracts_numbers),
	    cmocka_unit_test(what_looks_like_an_integer_is_it),
	    cmocka_unit_test(what_json_cannot_say_is_null),
	    cmocka_unit_test(minus_zero_is_zero),
	    cmocka_unit_test(the_ends_of_the_range_read_back),
	    cmocka_unit_test(any_double_reads_back_in_the_fewest_digits),
	    cmocka_unit_test(numbers_of_a_workshop_read_back_in_the_fewest_digits),
	    cmocka_unit_test(ties_read_back_in_the_fewest_digits),
	    cmocka_unit_test(neighbours_of_powers_read_back),
	    cmocka_unit_test(people_get_the_digits_they_ask_for),
	};

	return cmocka_run_group_tests(json_number, NULL, NULL);
}
