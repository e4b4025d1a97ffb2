#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/exact/exact_private.h"
#include "tests/unit/soup.h"

/* sum of size*2^exponent */
struct part {
	int64_t size;
	int exponent;
};

static void set_sum(struct mp_big *out, struct part a, struct part b)
{
	struct mp_big x;

	mp_big_set_i64(out, a.size, a.exponent);
	mp_big_set_i64(&x, b.size, b.exponent);
	mp_big_add(out, &x, 1, out);
}

static struct mp_exact_value round_sum(struct part a, struct part b, bool tiny)
{
	struct mp_big num, den;
	struct mp_exact_value v;

	set_sum(&num, a, b);
	mp_big_set(&den, 1, 1, 0);
	mp_exact_round_quotient(&num, &den, tiny, &v);
	return v;
}

static const struct part NOTHING = {0, 0}, CRUMB = {1, -3000}, MINUS_CRUMB = {-1, -3000};

static void assert_value(struct mp_exact_value v, double value, double bound)
{
	assert_true(v.defined);
	assert_true(v.value == value && !signbit(v.value) == (value >= 0));
	assert_true(v.bound == bound);
}

static void assert_undefined(struct mp_exact_value v)
{
	assert_true(!v.defined && v.value == 0 && v.bound == 0);
}

static void ties_go_to_the_even_neighbour(void **unused)
{
	const int64_t two53 = (int64_t)1 << 53;

	(void)unused;
	assert_value(round_sum((struct part){two53 + 1, 0}, NOTHING, false), 0x1p53, 1);
	assert_value(round_sum((struct part){two53 + 3, 0}, NOTHING, false), 0x1p53 + 4, 1);
	assert_value(round_sum((struct part){-two53 - 1, 0}, NOTHING, false), -0x1p53, 1);
	assert_value(round_sum((struct part){two53 + 2, 0}, NOTHING, false), 0x1p53 + 2, 0);
}

static void a_crumb_of_any_size_settles_a_tie(void **unused)
{
	const int64_t two53 = (int64_t)1 << 53;

	(void)unused;
	assert_value(round_sum((struct part){two53 + 1, 0}, CRUMB, false), 0x1p53 + 2, 1);
	assert_value(round_sum((struct part){two53 + 1, 0}, MINUS_CRUMB, false), 0x1p53, 1);
	assert_value(round_sum((struct part){two53 + 3, 0}, MINUS_CRUMB, false), 0x1p53 + 2, 1);
	assert_value(round_sum((struct part){1, 0}, CRUMB, false), 1, 0x1p-53);
	assert_value(round_sum((struct part){1, 0}, MINUS_CRUMB, false), 1, 0x1p-53);
}

static void nothing_is_rounded_to_infinity(void **unused)
{
	const struct part limit = {((int64_t)1 << 54) - 1, 970}; /* DBL_MAX + half a unit */

	(void)unused;
	assert_undefined(round_sum(limit, NOTHING, true));
	assert_undefined(round_sum((struct part){1, 1024}, NOTHING, true));
	assert_undefined(round_sum((struct part){-1, 20000}, NOTHING, true));
	assert_value(round_sum(limit, MINUS_CRUMB, false), DBL_MAX, 0x1p970);
	assert_value(round_sum((struct part){1, 1023}, NOTHING, false), 0x1p1023, 0);
}

static void below_the_normal_doubles_only_coordinates_are_defined(void **unused)
{
	(void)unused;
	assert_value(round_sum((struct part){1, -1022}, NOTHING, false), DBL_MIN, 0);
	assert_value(round_sum((struct part){1, -1022}, MINUS_CRUMB, false), DBL_MIN, 0x1p-1074);
	assert_undefined(round_sum((struct part){1, -1023}, NOTHING, false));
	assert_undefined(round_sum((struct part){1, -5000}, NOTHING, false));
	assert_value(round_sum((struct part){1, -1023}, NOTHING, true), DBL_MIN / 2, 0);
	assert_value(round_sum((struct part){-3, -1075}, NOTHING, true), -0x1p-1073, 0x1p-1074);
	assert_value(round_sum((struct part){1, -1074}, NOTHING, true), 0x1p-1074, 0);
	assert_value(round_sum((struct part){1, -1075}, NOTHING, true), 0, 0x1p-1074);
	assert_value(round_sum((struct part){1, -1075}, CRUMB, true), 0x1p-1074, 0x1p-1074);
	assert_value(round_sum((struct part){-1, -1075}, NOTHING, true), 0, 0x1p-1074);
	assert_value(round_sum((struct part){1, -5000}, NOTHING, true), 0, 0x1p-1074);
	assert_value(round_sum((struct part){1, -1074}, (struct part){1, -1076}, true), 0x1p-1074,
		     0x1p-1074);
}

static void zero_is_zero_and_exact(void **unused)
{
	(void)unused;
	assert_value(round_sum(NOTHING, NOTHING, false), 0, 0);
	assert_value(round_sum((struct part){5, 7}, (struct part){-5, 7}, false), 0, 0);
}

static double positive(uint64_t *state)
{
	return ldexp((double)(soup_random(state) >> 11) + 1, (int)(soup_random(state) % 600) - 300);
}

/* IEEE 754 asks the same of / and sqrt(). */
static void quotients_and_roots_are_those_of_the_machine(void **unused)
{
	uint64_t state = 5;

	(void)unused;
	for (int i = 0; i < 20000; i++) {
		double a = positive(&state), b = positive(&state);
		struct mp_exact_value v;
		struct mp_big num, den;

		mp_big_set_double(&num, a);
		mp_big_set_double(&den, b);
		mp_exact_round_quotient(&num, &den, false, &v);
		assert_true(v.defined && v.value == a / b);
		mp_big_set(&den, 1, 1, 0);
		mp_exact_round_root(&num, &den, &v);
		assert_true(v.defined && v.value == sqrt(a));
	}
}

static struct mp_exact_value root_of(struct part a, struct part b)
{
	struct mp_big num, one;
	struct mp_exact_value v;

	set_sum(&num, a, b);
	mp_big_set(&one, 1, 1, 0);
	mp_exact_round_root(&num, &one, &v);
	return v;
}

static void roots_are_rounded_once(void **unused)
{
	struct mp_big num, den, square;
	struct mp_exact_value v;

	(void)unused;
	assert_value(root_of((struct part){9, 0}, NOTHING), 3, 0);
	assert_value(root_of((struct part){9, 0}, CRUMB), 3, 0x1p-52);
	assert_value(root_of((struct part){9, 0}, MINUS_CRUMB), 3, 0x1p-52);
	assert_value(root_of((struct part){2, 0}, NOTHING), sqrt(2), 0x1p-53);
	assert_value(root_of(NOTHING, NOTHING), 0, 0);
	assert_undefined(root_of((struct part){-9, 0}, NOTHING));
	assert_undefined(root_of((struct part){1, 2048}, NOTHING));
	assert_value(root_of((struct part){1, 2046}, NOTHING), 0x1p1023, 0);
	assert_undefined(root_of((struct part){1, -2046}, NOTHING));
	assert_value(root_of((struct part){1, -2044}, NOTHING), DBL_MIN, 0);
	mp_big_set(&num, 1, ((uint64_t)1 << 53) + 1, 0); /* its square has a root that is a tie */
	mp_big_mul(&num, &num, &square);
	mp_big_set(&den, 1, 1, 0);
	mp_exact_round_root(&square, &den, &v);
	assert_value(v, 0x1p53, 1);
	mp_big_set_i64(&num, 1, -3000);
	mp_big_add(&square, &num, 1, &square);
	mp_exact_round_root(&square, &den, &v);
	assert_value(v, 0x1p53 + 2, 1);
}

static void doubles_are_taken_apart_and_put_together(void **unused)
{
	static const double some[] = {1, -1, 3e-310, -0x1p-1074, DBL_MAX, DBL_MIN, 0.1, -12345.678};
	struct mp_exact_value v;
	struct mp_big x, one;

	(void)unused;
	mp_big_set(&one, 1, 1, 0);
	for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
		mp_big_set_double(&x, some[i]);
		assert_true(x.d[0] % 2 == 1); /* as short as it can be */
		mp_exact_round_quotient(&x, &one, true, &v);
		assert_value(v, some[i], 0);
	}
	mp_big_set_double(&x, -0.0);
	assert_true(x.sign == 0 && x.n == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(ties_go_to_the_even_neighbour),
	    cmocka_unit_test(a_crumb_of_any_size_settles_a_tie),
	    cmocka_unit_test(nothing_is_rounded_to_infinity),
	    cmocka_unit_test(below_the_normal_doubles_only_coordinates_are_defined),
	    cmocka_unit_test(zero_is_zero_and_exact),
	    cmocka_unit_test(quotients_and_roots_are_those_of_the_machine),
	    cmocka_unit_test(roots_are_rounded_once),
	    cmocka_unit_test(doubles_are_taken_apart_and_put_together),
	};

	return cmocka_run_group_tests_name("exact_round", tests, NULL, NULL);
}
