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
#include "tests/unit/exact_meshes.h"
#include "tests/unit/oracle.h"

/* Random meshes against the oracle, every result of every one. */

static void check(const mpq_t exact, const struct mp_exact_value *v, bool tiny)
{
	int range = oracle_range(exact);
	mpq_t error, bound;

	if (range > 0 || (range < 0 && !tiny)) {
		assert_false(v->defined);
		assert_true(v->value == 0 && v->bound == 0);
		return;
	}
	assert_true(v->defined);
	assert_true(v->value != 0 || !signbit(v->value));
	assert_true(oracle_is_nearest(exact, v->value));
	mpq_inits(error, bound, NULL);
	mpq_set_d(error, v->value);
	mpq_sub(error, error, exact);
	mpq_abs(error, error);
	mpq_set_d(bound, v->bound);
	assert_true(mpq_cmp(error, bound) <= 0);
	assert_int_equal(mpq_sgn(error) == 0, v->bound == 0);
	assert_true(v->bound <= fmax(0x1p-53 * fabs(v->value), 0x1p-1074));
	mpq_clears(error, bound, NULL);
}

static void check_tensor(const struct oracle *o, const double *about, const mpq_t factor,
			 const struct mp_exact_tensor *t)
{
	mpq_t exact[3][3];
	bool defined = true;

	for (int i = 0; i < 3; i++)
		mpq_inits(exact[i][0], exact[i][1], exact[i][2], NULL);
	oracle_inertia(o, about, factor, exact);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int range = oracle_range(exact[i][j]);

			defined = defined && (i == j ? range == 0 : range <= 0);
		}
	assert_int_equal(t->defined, defined);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			assert_true(defined ? oracle_is_nearest(exact[i][j], t->value[i][j])
					    : t->value[i][j] == 0);
	for (int i = 0; i < 3; i++)
		mpq_clears(exact[i][0], exact[i][1], exact[i][2], NULL);
}

static void check_axis(const struct oracle *o, const struct mp_exact *e,
		       const struct mp_exact_density *density, const mpq_t factor,
		       const double origin[3], const double d[3])
{
	struct mp_exact_value moment, radius;
	mpq_t exact, square;

	mpq_inits(exact, square, NULL);
	mp_exact_axis_moment(e, density, origin, d, &moment, &radius);
	oracle_moment(o, origin, d, factor, exact);
	check(exact, &moment, false);
	mpq_mul(square, factor, o->volume); /* moment over mass */
	mpq_abs(square, square);
	mpq_div(square, exact, square);
	if (radius.defined)
		assert_true(oracle_is_root(square, radius.value));
	else
		assert_true(mpq_sgn(square) < 0 || radius.value == 0);
	mpq_clears(exact, square, NULL);
}

static void set_factor(mpq_t factor, const struct mp_exact_density *density, const mpq_t volume)
{
	mpq_t x;

	mpq_init(x);
	mpq_set_d(factor, density->value);
	mpq_set_d(x, density->divisor);
	mpq_div(factor, factor, x);
	mpq_abs(x, volume);
	if (density->over != NULL)
		mpq_div(factor, factor, x);
	mpq_clear(x);
}

static void check_mass(const struct oracle *o, const struct mp_exact *e,
		       const struct mp_exact_density *density, enum exact_style style,
		       uint64_t *state)
{
	double point[3], direction[3];
	struct mp_exact_value v;
	struct mp_exact_tensor t;
	mpq_t factor, exact;

	mpq_inits(factor, exact, NULL);
	set_factor(factor, density, o->volume);
	mp_exact_density(density, &v);
	check(factor, &v, false);
	mp_exact_mass(e, density, &v);
	mpq_mul(exact, factor, o->volume);
	mpq_abs(exact, exact);
	check(exact, &v, false);
	for (int k = 0; k < 3; k++) {
		point[k] = exact_coordinate(style, k, state);
		direction[k] = exact_coordinate(style == ENDS_OF_RANGE ? style : DOUBLES, k, state);
	}
	mp_exact_inertia(e, density, NULL, &t);
	check_tensor(o, NULL, factor, &t);
	mp_exact_inertia(e, density, point, &t);
	check_tensor(o, point, factor, &t);
	check_axis(o, e, density, factor, point, direction);
	mpq_clears(factor, exact, NULL);
}

/* As a rational number, no rounding between. */
static void set_big(const struct mp_big *x, mpq_t out)
{
	mpq_set_ui(out, 0, 1);
	if (x->sign == 0)
		return;
	mpz_import(mpq_numref(out), (size_t)x->n, -1, sizeof x->d[0], 0, 0, x->d);
	if (x->sign < 0)
		mpq_neg(out, out);
	if (x->exponent > 0)
		mpq_mul_2exp(out, out, (mp_bitcnt_t)x->exponent);
	else
		mpq_div_2exp(out, out, (mp_bitcnt_t)-x->exponent);
}

static void get_sum(const struct mp_exact *e, int i, mpq_t out)
{
	struct mp_big x;

	mp_exact_get(e, i, &x);
	set_big(&x, out);
}

static void set_origin(const struct mp_exact *e, int k, mpq_t out)
{
	struct mp_big x;

	mp_exact_get_origin(e, k, &x);
	set_big(&x, out);
}

/* integral of x_i*x_j about 0 from the sums about o: A2/120 + (A1i*oj + A1j*oi)/24 + A0*oi*oj/6 */
static void check_sums(const struct oracle *o, const struct mp_exact *e)
{
	static const int axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
	mpq_t sum[MP_EXACT_SUMS], origin[3], x, y;

	mpq_inits(x, y, NULL);
	for (int i = 0; i < MP_EXACT_SUMS; i++) {
		mpq_init(sum[i]);
		get_sum(e, i, sum[i]);
		mpq_set_ui(x, 1, i == 0 ? 6 : i < 4 ? 24 : 120);
		mpq_mul(sum[i], sum[i], x);
	}
	assert_true(mpq_equal(sum[0], o->volume));
	for (int k = 0; k < 3; k++) {
		mpq_init(origin[k]);
		set_origin(e, k, origin[k]);
		mpq_mul(x, origin[k], sum[0]);
		mpq_add(x, x, sum[1 + k]);
		assert_true(mpq_equal(x, o->first[k]));
	}
	for (int k = 0; k < 6; k++) {
		int i = axes[k][0], j = axes[k][1];

		mpq_mul(x, origin[i], sum[1 + j]);
		mpq_mul(y, origin[j], sum[1 + i]);
		mpq_add(x, x, y);
		mpq_mul(y, origin[i], origin[j]);
		mpq_mul(y, y, sum[0]);
		mpq_add(x, x, y);
		mpq_add(x, x, sum[4 + k]);
		assert_true(mpq_equal(x, o->square[i][j]));
	}
	for (int i = 0; i < MP_EXACT_SUMS; i++)
		mpq_clear(sum[i]);
	mpq_clears(origin[0], origin[1], origin[2], x, y, NULL);
}

static void check_all(const struct oracle *o, const struct mp_exact *e, enum exact_style style,
		      uint64_t *state)
{
	const enum exact_style strong = style == ENDS_OF_RANGE ? style : ANY_DOUBLE;
	const struct mp_exact_density plain = {2700, 1e9, NULL};
	const struct mp_exact_density weighed = {0.0648, 1, e};
	const struct mp_exact_density strange = {fabs(exact_coordinate(strong, 0, state)),
						 fabs(exact_coordinate(strong, 0, state)), NULL};
	struct mp_exact_value v, c[3], s[6];

	check_sums(o, e);
	mp_exact_volume(e, &v);
	check(o->volume, &v, false);
	assert_int_equal(mp_exact_sign(e), mpq_sgn(o->volume));
	mp_exact_centroid(e, c);
	mp_exact_second(e, s);
	if (mpq_sgn(o->volume) == 0) {
		assert_false(c[0].defined || s[0].defined);
		return;
	}
	for (int k = 0; k < 3; k++) {
		check(o->centroid[k], &c[k], true);
		check(o->second[k][k], &s[k], false);
		check(o->second[k][(k + 1) % 3], &s[3 + k], true);
	}
	check_mass(o, e, &plain, style, state);
	check_mass(o, e, &weighed, style, state);
	check_mass(o, e, &strange, style, state);
}

/* Which way the triangles go. */
enum way { AS_FOUND, BY_DIGITS, BY_GMP, WAYS };

static void set_way(enum way way, const struct mp_mesh *mesh, struct mp_exact_grid *grid)
{
	if (way == BY_GMP)
		grid->bits = 0;
	for (uint32_t v = 0; way == BY_DIGITS && v < mp_vertices_count(mesh->vertices); v++)
		grid->q[v][0] = MP_EXACT_OFF;
}

/* Small whole numbers, changes of axes, any doubles, in turn; some of them singular. */
static void draw_map(unsigned i, uint64_t *state, double row[3][4])
{
	static const enum exact_style STYLE[4] = {SMALL_INTEGERS, DOUBLES, DOUBLES, ANY_DOUBLE};

	for (int k = 0; k < 12; k++)
		row[k / 4][k % 4] = exact_coordinate(STYLE[i % 4], k % 3, state);
	for (int k = 0; k < 12 && i % 8 == 2; k++)
		if (k % 4 != (k / 4 + 1) % 3 && k % 4 != 3)
			row[k / 4][k % 4] = 0;
}

static void check_mapped(const struct soup *soup, struct mp_exact *e, enum exact_style style,
			 unsigned i, uint64_t *state)
{
	struct mp_exact_determinant det;
	double row[3][4];
	struct oracle o;
	mpq_t exact;

	draw_map(i, state, row);
	mpq_init(exact);
	oracle_determinant((const double(*)[4])row, exact);
	mp_exact_determinant((const double(*)[4])row, &det);
	assert_int_equal(det.sign, mpq_sgn(exact));
	mpq_clear(exact);
	if (det.sign == 0)
		return;
	oracle_init(&o);
	oracle_find_mapped(&o, (const double(*)[9])soup->tri, soup->count, (const double(*)[4])row);
	assert_int_equal(mp_exact_map(e, (const double(*)[4])row, NULL), 0);
	check_all(&o, e, style, state);
	oracle_clear(&o);
}

static void run(enum exact_style style, unsigned meshes)
{
	uint64_t state = 88172645463325252u + style;

	for (unsigned i = 0; i < meshes; i++) {
		struct soup soup = {0};
		struct built built;
		struct oracle o;

		exact_mesh(style, &state, &soup);
		oracle_init(&o);
		oracle_find(&o, (const double(*)[9])soup.tri, soup.count);
		assert_int_equal(soup_build(&soup, state, &built, NULL), 0);
		for (enum way way = 0; way < WAYS; way++) {
			struct mp_exact_grid grid;
			struct mp_exact e;

			assert_int_equal(mp_exact_grid_find(&built.mesh, &grid, NULL), 0);
			set_way(way, &built.mesh, &grid);
			assert_int_equal(
			    mp_exact_find(&built.mesh, &grid, NULL, built.mesh.triangles, &e, NULL),
			    0);
			if (way == AS_FOUND)
				check_all(&o, &e, style, &state);
			else
				check_sums(&o, &e);
			if (way == AS_FOUND)
				check_mapped(&soup, &e, style, i, &state);
			mp_exact_free(&e);
			mp_exact_grid_free(&grid);
		}
		oracle_clear(&o);
		built_free(&built);
		soup_free(&soup);
	}
}

#define TEST(style, meshes)                                      \
	static void style##_are_rounded_correctly(void **unused) \
	{                                                        \
		(void)unused;                                    \
		run(style, meshes);                              \
	}

TEST(SMALL_INTEGERS, 300)
TEST(NARROW_EDGE, 200)
TEST(NARROW_OVER, 200)
TEST(MIDDLE_EDGE, 200)
TEST(MIDDLE_OVER, 200)
TEST(FIXED_EDGE, 200)
TEST(FIXED_OVER, 200)
TEST(DOUBLES, 200)
TEST(FLOATS_FAR_AWAY, 200)
TEST(MICROMETRES, 100)
TEST(GIGAMETRES, 100)
TEST(NEEDLE, 100)
TEST(PLATE, 100)
TEST(NOISE_NEAR_ZERO, 300)
TEST(FLOAT_EXTREMES, 100)
TEST(WIDE_SPAN, 100)
TEST(ANY_DOUBLE, 60)
TEST(ENDS_OF_RANGE, 60)
TEST(SUBNORMAL, 60)
TEST(HUGE_DOUBLES, 60)

#define UNIT(style) cmocka_unit_test(style##_are_rounded_correctly)

int main(void)
{
	const struct CMUnitTest tests[] = {
	    UNIT(SMALL_INTEGERS),  UNIT(NARROW_EDGE),     UNIT(NARROW_OVER),    UNIT(MIDDLE_EDGE),
	    UNIT(MIDDLE_OVER),     UNIT(FIXED_EDGE),      UNIT(FIXED_OVER),     UNIT(DOUBLES),
	    UNIT(FLOATS_FAR_AWAY), UNIT(MICROMETRES),     UNIT(GIGAMETRES),     UNIT(NEEDLE),
	    UNIT(PLATE),           UNIT(NOISE_NEAR_ZERO), UNIT(FLOAT_EXTREMES), UNIT(WIDE_SPAN),
	    UNIT(ANY_DOUBLE),      UNIT(ENDS_OF_RANGE),   UNIT(SUBNORMAL),      UNIT(HUGE_DOUBLES),
	};

	return cmocka_run_group_tests_name("exact_random", tests, NULL, NULL);
}
