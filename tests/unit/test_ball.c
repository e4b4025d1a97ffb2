#include "core/moments/ball.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <gmp.h>

#include "tests/unit/mesh_random.h"

/* A ball with a rational number in it. */
struct held {
	struct mp_ball ball;
	mpq_t exact;
};

/* A long double as a fraction: a few doubles that sum up to it. */
static void set_long(mpq_t out, long double x)
{
	mpq_t part;

	mpq_init(part);
	mpq_set_ui(out, 0, 1);
	for (int i = 0; i < 4 && x != 0; i++) {
		double head = (double)x;

		mpq_set_d(part, head);
		mpq_add(out, out, part);
		x -= head;
	}
	mpq_clear(part);
}

static bool holds(const struct held *h)
{
	mpq_t distance, rad;
	bool inside;

	if (isinf(h->ball.rad))
		return true;
	mpq_inits(distance, rad, NULL);
	set_long(distance, h->ball.mid);
	set_long(rad, h->ball.rad);
	mpq_sub(distance, distance, h->exact);
	mpq_abs(distance, distance);
	inside = mpq_cmp(distance, rad) <= 0;
	mpq_clears(distance, rad, NULL);
	return inside;
}

/* Anywhere in its ball, which may be a point. */
static void draw(struct held *h, uint64_t *state)
{
	double mid = ldexp(random_between(state, -1, 1), (int)random_between(state, -60, 60));
	double rad =
	    random_chance(state, 0.3) ? 0 : fabs(mid) * pow(2, random_between(state, -60, 1));
	double at = random_between(state, -1, 1);
	mpq_t x;

	mpq_init(x);
	if (random_chance(state, 0.05))
		mid = 0;
	h->ball = mp_ball(mid, rad);
	mpq_set_d(h->exact, mid);
	mpq_set_d(x, at * rad * (1 - DBL_EPSILON));
	mpq_add(h->exact, h->exact, x);
	mpq_clear(x);
}

static void check_quotient(const struct held *a, const struct held *b, struct held *out)
{
	out->ball = mp_ball_div(a->ball, b->ball);
	assert_true(isinf(out->ball.rad) == !(fabsl(b->ball.mid) > b->ball.rad));
	if (mpq_sgn(b->exact) == 0)
		return;
	mpq_div(out->exact, a->exact, b->exact);
	assert_true(holds(out));
}

/* The root squared lies between the squares of the ends. */
static void check_root(const struct held *a, mpq_t low, mpq_t high)
{
	struct mp_ball root = mp_ball_sqrt(a->ball);

	if (mpq_sgn(a->exact) < 0)
		return;
	set_long(low, root.mid - root.rad > 0 ? (root.mid - root.rad) * (1 - LDBL_EPSILON) : 0);
	set_long(high, (root.mid + root.rad) * (1 + LDBL_EPSILON));
	mpq_mul(low, low, low);
	mpq_mul(high, high, high);
	assert_true(mpq_cmp(low, a->exact) <= 0 && mpq_cmp(a->exact, high) <= 0);
}

static void test_results_stay_in_their_balls(void **unused)
{
	struct held a, b, out;
	uint64_t state = 1;

	(void)unused;
	mpq_inits(a.exact, b.exact, out.exact, NULL);
	for (int i = 0; i < 20000; i++) {
		draw(&a, &state);
		draw(&b, &state);
		out.ball = mp_ball_add(a.ball, b.ball);
		mpq_add(out.exact, a.exact, b.exact);
		assert_true(holds(&out));
		out.ball = mp_ball_sub(a.ball, b.ball);
		mpq_sub(out.exact, a.exact, b.exact);
		assert_true(holds(&out));
		out.ball = mp_ball_mul(a.ball, b.ball);
		mpq_mul(out.exact, a.exact, b.exact);
		assert_true(holds(&out));
		check_quotient(&a, &b, &out);
		check_root(&a, out.exact, b.exact);
	}
	mpq_clears(a.exact, b.exact, out.exact, NULL);
}

static void test_radii_are_not_wide(void **unused)
{
	struct mp_ball third = mp_ball_div(mp_ball_exact(1), mp_ball_exact(3));

	(void)unused;
	assert_true(third.mid == 1.0L / 3 && third.rad > 0 && third.rad <= LDBL_EPSILON / 5);
	assert_true(mp_ball_mul(mp_ball(2, 1e-3L), mp_ball_exact(3)).rad < 3.0001e-3L);
	assert_true(mp_ball_sqrt(mp_ball(4, 1e-3L)).rad < 5.001e-4L);
}

static void test_exact_zeros_stay_exact(void **unused)
{
	const struct mp_ball zero = mp_ball_exact(0), x = mp_ball(3, 1), seven = mp_ball_exact(0.7);
	struct mp_ball r;

	(void)unused;
	r = mp_ball_mul(zero, x);
	assert_true(r.mid == 0 && r.rad == 0);
	r = mp_ball_div(zero, x);
	assert_true(r.mid == 0 && r.rad == 0);
	r = mp_ball_sqrt(zero);
	assert_true(r.mid == 0 && r.rad == 0);
	r = mp_ball_sub(seven, seven);
	assert_true(r.mid == 0 && r.rad == 0);
	r = mp_ball_add(x, zero);
	assert_true(r.mid == 3 && r.rad >= 1 && r.rad < 1 + 16 * LDBL_EPSILON);
	assert_true(mp_ball_distance(seven, 0.7) == 0);
}

static void test_underflow_is_taken_in(void **unused)
{
	const struct mp_ball tiny = mp_ball_exact(LDBL_TRUE_MIN);
	struct mp_ball r = mp_ball_mul(tiny, tiny);

	(void)unused;
	assert_true(r.mid == 0 && r.rad > 0);
	r = mp_ball_div(tiny, mp_ball_exact(3));
	assert_true(r.rad >= LDBL_TRUE_MIN);
}

static void test_nothing_known_is_infinite(void **unused)
{
	const struct mp_ball huge = mp_ball_exact(LDBL_MAX);
	struct mp_ball r = mp_ball_div(mp_ball_exact(1), mp_ball(1, 1));

	(void)unused;
	assert_true(isinf(r.rad) && !isnan(r.mid));
	r = mp_ball_sub(mp_ball_mul(huge, huge), mp_ball_mul(huge, huge));
	assert_true(isinf(r.rad) && !isnan(r.mid));
	assert_true(isinf(mp_ball_distance(r, 1)));
	assert_false(mp_ball_not_zero(r));
	r = mp_ball_mul(mp_ball(0, 1), mp_ball(1, INFINITY));
	assert_true(isinf(r.rad));
}

static void test_not_zero(void **unused)
{
	(void)unused;
	assert_true(mp_ball_not_zero(mp_ball(-1, 0.99L)));
	assert_false(mp_ball_not_zero(mp_ball(1, 0.9999L))); /* hardly anything is left */
	assert_false(mp_ball_not_zero(mp_ball(1, 2)));
	assert_false(mp_ball_not_zero(mp_ball_exact(0)));
	assert_true(mp_ball_least(mp_ball(-3, 1)) <= 2 && mp_ball_least(mp_ball(-3, 1)) > 1.999L);
	assert_true(mp_ball_least(mp_ball(1, 2)) == 0);
	assert_true(mp_ball_most(mp_ball(-3, 1)) >= 4 && mp_ball_most(mp_ball(-3, 1)) < 4.001L);
}

static void test_doubles_are_rounded_upwards(void **unused)
{
	(void)unused;
	assert_true(mp_round_up(1) == 1);
	assert_true(mp_round_up(1 + (long double)DBL_EPSILON / 4) > 1 || LDBL_MANT_DIG == 53);
	assert_true(mp_round_up(LDBL_TRUE_MIN) >= DBL_TRUE_MIN);
	assert_true(mp_ball_distance(mp_ball(1, 0.5L), 2) >= 1.5);
	assert_true(mp_ball_distance(mp_ball(1, 0.5L), 2) < 1.5000001);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_results_stay_in_their_balls),
	    cmocka_unit_test(test_radii_are_not_wide),
	    cmocka_unit_test(test_exact_zeros_stay_exact),
	    cmocka_unit_test(test_underflow_is_taken_in),
	    cmocka_unit_test(test_nothing_known_is_infinite),
	    cmocka_unit_test(test_not_zero),
	    cmocka_unit_test(test_doubles_are_rounded_upwards),
	};

	return cmocka_run_group_tests_name("ball", tests, NULL, NULL);
}
