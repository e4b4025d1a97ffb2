#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/exact/exact_private.h"
#include "tests/unit/alloc_fail.h"
#include "tests/unit/soup.h"

/* The grid, the sums of each width at their limits, and memory running out. */

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

static void look(const struct soup *soup, struct mp_exact_grid *grid, struct mp_exact *e)
{
	struct built built;

	assert_int_equal(soup_build(soup, 3, &built, NULL), 0);
	assert_int_equal(mp_exact_grid_find(&built.mesh, grid, NULL), 0);
	assert_int_equal(mp_exact_find(&built.mesh, grid, NULL, built.mesh.triangles, e, NULL), 0);
	built_free(&built);
}

/* The grid of a triangle with the x coordinates a, b, c; count of vertices on it in *on. */
static struct mp_exact_axis axis_of(double a, double b, double c, bool *lossless, unsigned *bits,
				    int *on)
{
	const double p[3] = {a, 0, 0}, q[3] = {b, 1, 0}, r[3] = {c, 0, 1};
	struct mp_exact_grid grid;
	struct mp_exact_axis axis;
	struct soup soup = {0};
	struct mp_exact e;

	soup_add(&soup, p, q, r);
	look(&soup, &grid, &e);
	*lossless = grid.lossless;
	*bits = grid.bits;
	*on = 0;
	for (int v = 0; v < 3; v++)
		*on += grid.q[v][0] != MP_EXACT_OFF;
	axis = grid.axis[0];
	mp_exact_free(&e);
	mp_exact_grid_free(&grid);
	soup_free(&soup);
	return axis;
}

static void a_grid_is_as_coarse_as_it_may(void **unused)
{
	struct mp_exact_axis axis;
	bool lossless;
	unsigned bits;
	int on;

	(void)unused;
	axis = axis_of(6, 18, 0, &lossless, &bits, &on);
	assert_true(lossless && on == 3 && axis.exponent == 1 && axis.origin == 5 && bits == 4);
	axis = axis_of(0x1p500, 0x1p500, 0x1p500, &lossless, &bits, &on);
	assert_true(lossless && on == 3 && axis.exponent == 500 && axis.origin == 1 && bits == 1);
	axis = axis_of(0x1p-1074, 0x1p-1073, -0.0, &lossless, &bits, &on);
	assert_true(lossless && on == 3 && axis.exponent == -1074 && axis.origin == 1 && bits == 2);
	axis = axis_of(0x1p1023, -0x1p1023, 0, &lossless, &bits, &on);
	assert_true(lossless && on == 3 && axis.exponent == 1023 && axis.origin == 0 && bits == 2);
}

static void a_span_of_62_bits_is_the_last_without_loss(void **unused)
{
	struct mp_exact_axis axis;
	bool lossless;
	unsigned bits;
	int on;

	(void)unused;
	axis = axis_of(0x1p61 - 0x1p8, 1, -0x1p61, &lossless, &bits, &on);
	assert_true(lossless && on == 3 && axis.exponent == 0 && bits == 62);
	axis = axis_of(0x1p61, 1, -0x1p61, &lossless, &bits, &on);
	assert_true(!lossless && on == 2 && axis.exponent == 1 && axis.origin == 0 && bits == 62);
	axis = axis_of(0x1p62 - 0x1p9, 1, 0, &lossless, &bits, &on);
	assert_true(lossless && on == 3 && axis.exponent == 0 && bits == 62);
	axis = axis_of(0x1p62, 1, 0, &lossless, &bits, &on);
	assert_true(!lossless && on == 2 && axis.exponent == 2 && axis.origin == 0);
	axis = axis_of(DBL_MAX, 0x1p-1074, -1, &lossless, &bits, &on);
	assert_true(!lossless && on == 1 && axis.exponent == 1024 - 61);
}

static void a_single_triangle_is_summed_about_the_origin_of_the_grid(void **unused)
{
	const double a[3] = {-0.0, 0, 0}, b[3] = {4, 0, 0}, c[3] = {0, 4, -4};
	struct soup soup = {0};
	struct mp_exact_grid grid;
	struct mp_exact_value v;
	struct mp_exact e;

	(void)unused;
	soup_add(&soup, a, b, c);
	look(&soup, &grid, &e);
	assert_true(grid.lossless);
	assert_int_equal(grid.axis[0].exponent, 2);
	assert_int_equal(grid.axis[0].origin, 1); /* the middle, rounded up */
	assert_int_equal(grid.axis[2].origin, 0);
	mp_exact_volume(&e, &v); /* (-4,-4,0).((4,0,0) x (0,4,-4))/6 = (-4,-4,0).(0,16,16)/6 */
	assert_true(v.defined && v.value == -64.0 / 6);
	mp_exact_free(&e);
	mp_exact_grid_free(&grid);
	soup_free(&soup);
}

/* The sums of the header by GMP's mpz. */
static void add_plainly(mpz_t sum[MP_EXACT_SUMS], mpz_t q[9])
{
	mpz_t d, n, s, t, e[6];

	mpz_inits(d, n, s, t, NULL);
	for (int i = 0; i < 6; i++) {
		mpz_init(e[i]);
		mpz_sub(e[i], q[3 + i], q[i % 3]);
	}
	for (int k = 0; k < 3; k++) {
		mpz_mul(n, e[(k + 1) % 3], e[3 + (k + 2) % 3]);
		mpz_submul(n, e[(k + 2) % 3], e[3 + (k + 1) % 3]);
		mpz_addmul(d, n, q[k]);
	}
	mpz_add(sum[0], sum[0], d);
	for (int k = 0; k < 3; k++) {
		mpz_add(s, q[k], q[3 + k]);
		mpz_add(s, s, q[6 + k]);
		mpz_addmul(sum[1 + k], d, s);
	}
	for (int k = 0; k < 6; k++) {
		mpz_set_ui(n, 0);
		for (int c = 0; c < 3; c++) {
			mpz_add(s, q[3 * c + AXES[k][0]], q[3 * ((c + 1) % 3) + AXES[k][0]]);
			mpz_add(t, q[3 * c + AXES[k][1]], q[3 * ((c + 1) % 3) + AXES[k][1]]);
			mpz_addmul(n, s, t);
		}
		mpz_addmul(sum[4 + k], d, n);
	}
	for (int i = 0; i < 6; i++)
		mpz_clear(e[i]);
	mpz_clears(d, n, s, t, NULL);
}

static void assert_fixed(struct mp_fixed x, const mpz_t expected)
{
	bool negative = mp_fixed_negative(&x);
	mpz_t value;

	mpz_init(value);
	if (negative)
		mp_fixed_negate(&x);
	mpz_import(value, MP_FIXED_LIMBS, -1, sizeof x.limb[0], 0, 0, x.limb);
	if (negative)
		mpz_neg(value, value);
	assert_int_equal(mpz_cmp(value, expected), 0);
	mpz_clear(value);
}

/* det = 4*h^3, the largest there is; the second with the other sign. */
static const int LARGEST[2][9] = {{1, 1, 1, 1, -1, -1, -1, 1, -1}, {1, 1, 1, -1, 1, -1, 1, -1, -1}};

static int64_t corner(uint64_t *state, int64_t h, int kind, int i)
{
	uint64_t r = soup_random(state);

	if (kind < 2)
		return h * LARGEST[kind][i];
	if (kind == 2)
		return r % 2 == 0 ? h : -h;
	return (int64_t)(r % (2 * (uint64_t)h + 1)) - h;
}

/* Full blocks of one kind, so that no column may hold one product less than it must. */
static void check_fixed(unsigned bits, int kind)
{
	int64_t h = (int64_t)1 << (bits - 1), tri[MP_EXACT_BLOCK][9];
	struct mp_fixed sum[MP_EXACT_SUMS] = {0};
	mpz_t expected[MP_EXACT_SUMS], q[9];
	uint64_t state = bits;

	for (int i = 0; i < MP_EXACT_SUMS; i++)
		mpz_init(expected[i]);
	for (int i = 0; i < 9; i++)
		mpz_init(q[i]);
	for (int block = 0; block < 3; block++) {
		for (int t = 0; t < MP_EXACT_BLOCK; t++) {
			for (int i = 0; i < 9; i++) {
				tri[t][i] = corner(&state, h, kind, i);
				mpz_set_si(q[i], tri[t][i]);
			}
			add_plainly(expected, q);
		}
		mp_exact_fixed_add(sum, bits, (const int64_t(*)[9])tri, MP_EXACT_BLOCK);
	}
	for (int i = 0; i < MP_EXACT_SUMS; i++) {
		assert_fixed(sum[i], expected[i]);
		mpz_clear(expected[i]);
	}
	for (int i = 0; i < 9; i++)
		mpz_clear(q[i]);
}

static void fixed_sums_hold_the_largest_coordinates(void **unused)
{
	static const unsigned bits[] = {1, 2, 29, 30, 31, 49, 50, 51, 61, 62};

	(void)unused;
	for (size_t i = 0; i < sizeof bits / sizeof *bits; i++)
		for (int kind = 0; kind < 4; kind++)
			check_fixed(bits[i], kind);
}

/* In units of 2^-54: up to 2^115, as whole steps, as many small ones, or both. */
static double fine(uint64_t *state, int kind, int i)
{
	int64_t whole = corner(state, (int64_t)1 << 61, kind, i);

	if (kind < 3)
		return (double)whole;
	return soup_random(state) % 2 == 0
		   ? ldexp((double)(whole / 256), 8 - (int)(soup_random(state) % 55))
		   : ldexp((double)(whole / 512), -54);
}

static void check_digits(int kind)
{
	const struct mp_exact_grid grid = {.scale = {{1, 1}, {1, 1}, {1, 1}}};
	mp_i128 sum[MP_EXACT_SUMS][MP_EXACT_COLUMNS] = {{0}};
	mpz_t expected[MP_EXACT_SUMS], q[9];
	uint64_t state = 1 + (uint64_t)kind;

	for (int i = 0; i < MP_EXACT_SUMS; i++)
		mpz_init(expected[i]);
	for (int i = 0; i < 9; i++)
		mpz_init(q[i]);
	for (int t = 0; t < 500; t++) {
		double tri[9];

		for (int i = 0; i < 9; i++) {
			tri[i] = fine(&state, kind, i);
			mpz_set_d(q[i], ldexp(tri[i], 54));
		}
		assert_true(mp_exact_digits_add(sum, &grid, tri));
		add_plainly(expected, q);
	}
	for (int i = 0; i < MP_EXACT_SUMS; i++) {
		int coordinates = i == 0 ? 3 : i < 4 ? 4 : 5;
		struct mp_big x;
		mpz_t value;

		mp_exact_digits_get((const mp_i128 *)sum[i], 0, coordinates, &x);
		mpz_init(value);
		mpz_import(value, (size_t)x.n, -1, sizeof x.d[0], 0, 0, x.d);
		mpz_mul_2exp(value, value, (mp_bitcnt_t)(x.exponent + 54 * coordinates));
		if (x.sign < 0)
			mpz_neg(value, value);
		assert_int_equal(mpz_cmp(value, expected[i]), 0);
		mpz_clears(value, expected[i], NULL);
	}
	for (int i = 0; i < 9; i++)
		mpz_clear(q[i]);
}

static void digits_hold_the_largest_coordinates(void **unused)
{
	(void)unused;
	for (int kind = 0; kind < 4; kind++)
		check_digits(kind);
}

static void digits_refuse_what_lies_between(void **unused)
{
	const struct mp_exact_grid grid = {.scale = {{1, 1}, {1, 1}, {1, 1}}};
	const struct mp_exact_grid coarse = {.scale = {{0x1p-500, 0x1p-500}, {1, 1}, {1, 1}}};
	mp_i128 sum[MP_EXACT_SUMS][MP_EXACT_COLUMNS] = {{0}};
	double tri[9] = {1, 2, 3, -4, 5, 6, 7, 8, -9};

	(void)unused;
	assert_true(mp_exact_digits_add(sum, &grid, tri));
	tri[4] = 0x1p-54;
	assert_true(mp_exact_digits_add(sum, &grid, tri));
	tri[4] = 0x1p-55;
	assert_false(mp_exact_digits_add(sum, &grid, tri));
	tri[4] = 1 + 0x1p-52; /* 2^-52 is one of the steps */
	assert_true(mp_exact_digits_add(sum, &grid, tri));
	tri[4] = -0x1.8p-54;
	assert_false(mp_exact_digits_add(sum, &grid, tri));
	tri[4] = 0;
	tri[0] = 0;
	tri[3] = 0x1p1000;
	tri[6] = 1e-300; /* 0 when scaled */
	assert_false(mp_exact_digits_add(sum, &coarse, tri));
	tri[6] = -0.0;
	assert_true(mp_exact_digits_add(sum, &coarse, tri));
}

static void every_failed_allocation_is_an_error(void **unused)
{
	struct soup soup = {0};
	struct built built;
	struct mp_exact_grid grid;
	struct mp_exact e, part;
	struct mp_error err = {0};

	(void)unused;
	soup_torus(&soup, 20, 20, 100, 40);
	assert_int_equal(soup_build(&soup, 3, &built, NULL), 0);
	alloc_fail_at(1);
	assert_int_equal(mp_exact_grid_find(&built.mesh, &grid, &err), -1);
	assert_int_equal(err.code, MP_NOMEM);
	assert_int_equal(mp_exact_grid_find(&built.mesh, &grid, NULL), 0);
	alloc_fail_at(1);
	err.code = MP_OK;
	assert_int_equal(mp_exact_find(&built.mesh, &grid, NULL, 800, &e, &err), -1);
	assert_int_equal(err.code, MP_NOMEM);
	assert_int_equal(mp_exact_find(&built.mesh, &grid, NULL, 800, &e, NULL), 0);
	assert_int_equal(mp_exact_find(&built.mesh, &grid, NULL, 800, &part, NULL), 0);
	alloc_fail_at(1);
	err.code = MP_OK;
	assert_int_equal(mp_exact_add(&e, &part, &err), -1);
	assert_int_equal(err.code, MP_NOMEM);
	assert_true(e.limb != NULL && e.limb != part.limb);
	assert_int_equal(mp_exact_add(&e, &part, NULL), 0);
	alloc_fail_at(0);
	mp_exact_free(&e);
	mp_exact_free(&e); /* zeroed */
	mp_exact_free(&part);
	mp_exact_grid_free(&grid);
	mp_exact_grid_free(&grid);
	built_free(&built);
	soup_free(&soup);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_grid_is_as_coarse_as_it_may),
	    cmocka_unit_test(a_span_of_62_bits_is_the_last_without_loss),
	    cmocka_unit_test(a_single_triangle_is_summed_about_the_origin_of_the_grid),
	    cmocka_unit_test(fixed_sums_hold_the_largest_coordinates),
	    cmocka_unit_test(digits_hold_the_largest_coordinates),
	    cmocka_unit_test(digits_refuse_what_lies_between),
	    cmocka_unit_test(every_failed_allocation_is_an_error),
	};

	return cmocka_run_group_tests_name("exact_widths", tests, NULL, NULL);
}
