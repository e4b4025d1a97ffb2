#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/line.h"

static void pieces_stand_behind_each_other(void **state)
{
	char text[64];
	struct srv_line l = SRV_LINE(text);

	(void)state;
	srv_line_say(&l, "n=");
	srv_line_count(&l, 0);
	srv_line_say(&l, " ");
	srv_line_count(&l, UINT64_MAX);
	srv_line_say(&l, " ");
	srv_line_digits(&l, 7, 3);
	assert_string_equal(text, "n=0 18446744073709551615 007");
	assert_int_equal(l.len, strlen(text));
}

/* In a heap block of the exact size. */
static void what_does_not_fit_is_cut_off(void **state)
{
	(void)state;
	for (size_t size = 1; size < 12; size++) {
		struct srv_line l = {malloc(size), 0, size};

		assert_non_null(l.text);
		srv_line_say(&l, "abc");
		srv_line_count(&l, 12345);
		srv_line_thousandths(&l, 1.5);
		assert_int_equal(l.len, size - 1);
		assert_memory_equal(l.text, "abc123451.500", size - 1);
		assert_int_equal(l.text[size - 1], '\0');
		free(l.text);
	}
}

static void thousandths_are_as_printf_says(void **state)
{
	static const double x[] = {0,     0.0004,  0.0006,     0.9996, 1.0004,
				   0.123, 12.3456, 99999.9994, 1e9};
	char text[64], expected[64];

	(void)state;
	for (size_t i = 0; i < sizeof x / sizeof x[0]; i++) {
		struct srv_line l = SRV_LINE(text);

		srv_line_thousandths(&l, x[i]);
		(void)snprintf(expected, sizeof expected, "%.3f", x[i]);
		assert_string_equal(text, expected);
	}
}

static void what_is_no_time_is_nought_or_an_age(void **state)
{
	static const double nought[] = {-1, -INFINITY, NAN};
	char text[64];
	struct srv_line l;

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		l = SRV_LINE(text);
		srv_line_thousandths(&l, nought[i]);
		assert_string_equal(text, "0.000");
	}
	l = SRV_LINE(text);
	srv_line_thousandths(&l, INFINITY);
	assert_true(l.len > 15);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(pieces_stand_behind_each_other),
	    cmocka_unit_test(what_does_not_fit_is_cut_off),
	    cmocka_unit_test(thousandths_are_as_printf_says),
	    cmocka_unit_test(what_is_no_time_is_nought_or_an_age),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
