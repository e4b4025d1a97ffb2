#include "core/exact/exact.h"

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
#include "tests/unit/soup.h"

static const double NOWHERE[3] = {0, 0, 0};
static const struct mp_exact_density ALUMINIUM = {2700, 1e9, NULL}; /* kg/m3 in kg/mm3 */

static void find(const struct soup *soup, struct mp_exact *out)
{
	struct mp_exact_grid grid;
	struct built built;

	assert_int_equal(soup_build(soup, 3, &built, NULL), 0);
	assert_int_equal(mp_exact_grid_find(&built.mesh, &grid, NULL), 0);
	assert_int_equal(mp_exact_find(&built.mesh, &grid, NULL, built.mesh.triangles, out, NULL),
			 0);
	mp_exact_grid_free(&grid);
	built_free(&built);
}

static void find_box(double x0, double y0, double z0, double x1, double y1, double z1,
		     struct mp_exact *out)
{
	const double min[3] = {x0, y0, z0}, max[3] = {x1, y1, z1};
	struct soup soup = {0};

	soup_box(&soup, min, max);
	find(&soup, out);
	soup_free(&soup);
}

static double volume_of(const struct mp_exact *e)
{
	struct mp_exact_value v;

	mp_exact_volume(e, &v);
	assert_true(v.defined);
	return v.value;
}

static void assert_tensor(const struct mp_exact_tensor *t, double xx, double yy, double zz,
			  double xy, double yz, double zx)
{
	assert_true(t->defined);
	assert_true(t->value[0][0] == xx && t->value[1][1] == yy && t->value[2][2] == zz);
	assert_true(t->value[0][1] == xy && t->value[1][2] == yz && t->value[2][0] == zx);
	assert_true(t->value[1][0] == xy && t->value[2][1] == yz && t->value[0][2] == zx);
}

/* The decimals below are the exact values, so the compiler's doubles are the nearest ones. */
static void a_box_has_the_doubles_nearest_to_its_decimals(void **unused)
{
	const double axis[3] = {0, 0, 2}, corner[3] = {40, 30, 20};
	struct mp_exact e;
	struct mp_exact_value v, c[3], radius;
	struct mp_exact_tensor t;

	(void)unused;
	find_box(0, 0, 0, 40, 30, 20, &e);
	mp_exact_volume(&e, &v);
	assert_true(v.defined && v.value == 24000 && v.bound == 0);
	mp_exact_mass(&e, &ALUMINIUM, &v);
	assert_true(v.defined && v.value == 0.0648 && v.bound == 0x1p-57);
	mp_exact_density(&ALUMINIUM, &v);
	assert_true(v.defined && v.value == 2.7e-6);
	assert_true(mp_exact_centroid(&e, c));
	assert_true(c[0].value == 20 && c[1].value == 15 && c[2].value == 10);
	assert_true(c[0].bound == 0 && c[1].bound == 0 && c[2].bound == 0);
	mp_exact_inertia(&e, &ALUMINIUM, NULL, &t);
	assert_tensor(&t, 7.02, 10.8, 13.5, 0, 0, 0);
	mp_exact_inertia(&e, &ALUMINIUM, NOWHERE, &t);
	assert_tensor(&t, 28.08, 43.2, 54, -19.44, -9.72, -12.96);
	mp_exact_inertia(&e, &ALUMINIUM, corner, &t);
	assert_tensor(&t, 28.08, 43.2, 54, -19.44, -9.72, -12.96);
	mp_exact_axis_moment(&e, &ALUMINIUM, NOWHERE, axis, &v, &radius);
	assert_true(v.defined && v.value == 54);
	assert_true(radius.defined && radius.value == sqrt(2500.0 / 3));
	mp_exact_free(&e);
}

static void a_corner_tetrahedron_has_its_closed_form(void **unused)
{
	const double o[3] = {0, 0, 0}, a[3] = {40, 0, 0}, b[3] = {0, 25, 0}, c[3] = {0, 0, 8};
	struct soup soup = {0};
	struct mp_exact_tensor t;
	struct mp_exact_value v, g[3], s[6];
	struct mp_exact e;

	(void)unused;
	soup_add(&soup, o, b, a);
	soup_add(&soup, o, a, c);
	soup_add(&soup, o, c, b);
	soup_add(&soup, a, b, c);
	find(&soup, &e);
	mp_exact_volume(&e, &v);
	assert_true(v.value == 4000.0 / 3 && v.bound == 0x1p-43);
	assert_true(mp_exact_centroid(&e, g));
	assert_true(g[0].value == 10 && g[1].value == 6.25 && g[2].value == 2);
	mp_exact_inertia(&e, NULL, NOWHERE, &t); /* V*(y^2 + z^2)/10, -V*x*y/20 */
	assert_tensor(&t, 4000.0 * 689 / 30, 4000.0 * 1664 / 30, 4000.0 * 2225 / 30,
		      -4000.0 * 1000 / 60, -4000.0 * 200 / 60, -4000.0 * 320 / 60);
	assert_true(mp_exact_second(&e, s)); /* 3*V*x^2/80, -V*x*y/80 */
	assert_true(s[0].value == 80000 && s[1].value == 31250 && s[2].value == 3200);
	assert_true(s[3].value == -50000.0 / 3 && s[4].value == -10000.0 / 3);
	assert_true(s[5].value == -16000.0 / 3);
	mp_exact_free(&e);
	soup_free(&soup);
}

static void a_wedge_has_its_closed_form(void **unused)
{
	const double p[6][3] = {{0, 0, 0},  {40, 0, 0},  {0, 0, 8},
				{0, 25, 0}, {40, 25, 0}, {0, 25, 8}};
	static const int face[8][3] = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1},
				       {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
	struct soup soup = {0};
	struct mp_exact_value g[3], s[6];
	struct mp_exact e;

	(void)unused;
	for (int i = 0; i < 8; i++)
		soup_add(&soup, p[face[i][0]], p[face[i][1]], p[face[i][2]]);
	find(&soup, &e);
	assert_true(volume_of(&e) == 4000);
	assert_true(mp_exact_centroid(&e, g));
	assert_true(g[0].value == 40.0 / 3 && g[1].value == 12.5 && g[2].value == 8.0 / 3);
	assert_true(mp_exact_second(&e, s)); /* V*x^2/18, V*y^2/12, -V*x*z/36 */
	assert_true(s[0].value == 4000.0 * 1600 / 18 && s[1].value == 4000.0 * 625 / 12);
	assert_true(s[2].value == 4000.0 * 64 / 18 && s[3].value == 0 && s[4].value == 0);
	assert_true(s[5].value == -4000.0 * 320 / 36);
	mp_exact_free(&e);
	soup_free(&soup);
}

static void assert_same(const struct mp_exact *a, const struct mp_exact *b)
{
	assert_memory_equal(a->axis, b->axis, sizeof a->axis);
	for (int i = 0; i < MP_EXACT_SUMS; i++) {
		struct mp_big x, y;

		mp_exact_get(a, i, &x);
		mp_exact_get(b, i, &y);
		assert_int_equal(x.sign, y.sign);
		assert_int_equal(x.exponent, y.exponent);
		assert_int_equal(x.n, y.n);
		assert_memory_equal(x.d, y.d, (size_t)x.n * sizeof x.d[0]);
	}
}

/* Noise near 0, so that every way is taken; 800 triangles, so that blocks matter. */
static void make_ring(struct soup *soup)
{
	soup_torus(soup, 20, 20, 100, 40);
	soup->tri[7][0] += 1e-30; /* opens the mesh, which the sums do not mind */
}

static void no_order_changes_a_bit(void **unused)
{
	struct soup soup = {0};
	struct mp_exact e, shuffled;
	uint64_t state = 11;

	(void)unused;
	make_ring(&soup);
	find(&soup, &e);
	for (int i = 0; i < 30; i++) {
		soup_shuffle(&soup, &state);
		find(&soup, &shuffled);
		assert_same(&e, &shuffled);
		mp_exact_free(&shuffled);
	}
	mp_exact_free(&e);
	soup_free(&soup);
}

static void chunks_add_up_to_the_whole(void **unused)
{
	struct soup soup = {0};
	struct built built;
	struct mp_exact_grid grid;
	struct mp_exact whole, sum, part;
	uint32_t order[800];

	(void)unused;
	make_ring(&soup);
	assert_int_equal(soup_build(&soup, 3, &built, NULL), 0);
	assert_int_equal(mp_exact_grid_find(&built.mesh, &grid, NULL), 0);
	assert_int_equal(mp_exact_find(&built.mesh, &grid, NULL, 800, &whole, NULL), 0);
	for (uint32_t i = 0; i < 800; i++)
		order[i] = i * 7 % 800;
	for (uint32_t step = 1; step < 800; step += 97) {
		assert_int_equal(mp_exact_find(&built.mesh, &grid, NULL, 0, &sum, NULL), 0);
		for (uint32_t at = 0; at < 800; at += step) {
			uint32_t count = step < 800 - at ? step : 800 - at;

			assert_int_equal(
			    mp_exact_find(&built.mesh, &grid, order + at, count, &part, NULL), 0);
			assert_int_equal(mp_exact_add(&sum, &part, NULL), 0);
			mp_exact_free(&part);
		}
		assert_true(volume_of(&sum) == volume_of(&whole));
		for (int i = 0; i < MP_EXACT_SUMS; i++) {
			struct mp_big x, y;

			mp_exact_get(&sum, i, &x);
			mp_exact_get(&whole, i, &y);
			mp_big_add(&x, &y, -1, &x);
			assert_int_equal(x.sign, 0);
		}
		mp_exact_free(&sum);
	}
	mp_exact_free(&whole);
	mp_exact_grid_free(&grid);
	built_free(&built);
	soup_free(&soup);
}

static void inside_out_is_the_same_solid_with_a_negative_volume(void **unused)
{
	struct soup soup = {0};
	struct mp_exact e, back;
	struct mp_exact_tensor t, u;
	struct mp_exact_value m, n, c[3], d[3], r, s;
	const double axis[3] = {1, 2, 3};

	(void)unused;
	make_ring(&soup);
	find(&soup, &e);
	for (size_t i = 0; i < soup.count; i++)
		soup_flip(&soup, i);
	find(&soup, &back);
	assert_true(mp_exact_sign(&e) == 1 && mp_exact_sign(&back) == -1);
	assert_true(volume_of(&back) == -volume_of(&e));
	mp_exact_mass(&e, &ALUMINIUM, &m);
	mp_exact_mass(&back, &ALUMINIUM, &n);
	assert_true(m.value > 0 && m.value == n.value);
	assert_true(mp_exact_centroid(&e, c) && mp_exact_centroid(&back, d));
	assert_true(c[0].value == d[0].value && c[2].value == d[2].value);
	mp_exact_inertia(&e, NULL, axis, &t);
	mp_exact_inertia(&back, NULL, axis, &u);
	assert_true(t.defined && t.value[0][0] > 0);
	assert_memory_equal(&t, &u, sizeof t.value);
	mp_exact_axis_moment(&e, NULL, NOWHERE, axis, &m, &r);
	mp_exact_axis_moment(&back, NULL, NOWHERE, axis, &n, &s);
	assert_true(m.defined && m.value == n.value && r.defined && r.value == s.value);
	mp_exact_free(&e);
	mp_exact_free(&back);
	soup_free(&soup);
}

static void assert_empty(const struct mp_exact *e)
{
	const double axis[3] = {0, 0, 1};
	const struct mp_exact_density weighed = {5, 1, e};
	struct mp_exact_value v, w, c[6];
	struct mp_exact_tensor t;

	assert_int_equal(mp_exact_sign(e), 0);
	mp_exact_volume(e, &v);
	assert_true(v.defined && v.value == 0 && !signbit(v.value) && v.bound == 0);
	mp_exact_mass(e, &ALUMINIUM, &v);
	assert_true(v.defined && v.value == 0);
	mp_exact_mass(e, &weighed, &v);
	assert_false(v.defined);
	mp_exact_density(&weighed, &v);
	assert_false(v.defined);
	assert_false(mp_exact_centroid(e, c) || c[0].defined);
	assert_false(mp_exact_second(e, c) || c[5].defined);
	mp_exact_inertia(e, NULL, NULL, &t);
	assert_false(t.defined);
	mp_exact_axis_moment(e, NULL, NOWHERE, axis, &v, &w);
	assert_false(v.defined || w.defined);
}

/* Tilted, of coordinates that are no round numbers in any base. */
static void what_is_flat_has_exactly_no_volume(void **unused)
{
	const double a[3] = {0.1, 0.7, 1e-9}, b[3] = {1.3, -0.2, 5}, c[3] = {1e6, 3e-3, -1 / 3.0};
	const double min[3] = {-1, 2, 0.1}, max[3] = {7, 2, 3};
	struct soup soup = {0};
	struct mp_exact e;

	(void)unused;
	find(&soup, &e); /* no triangle */
	assert_empty(&e);
	mp_exact_free(&e);
	soup_add(&soup, a, a, b);
	find(&soup, &e);
	assert_empty(&e);
	mp_exact_free(&e);
	soup_add(&soup, a, b, c);
	soup_add(&soup, c, b, a); /* a sheet with two sides */
	find(&soup, &e);
	assert_empty(&e);
	mp_exact_free(&e);
	soup_free(&soup);
	soup_box(&soup, min, max);
	find(&soup, &e);
	assert_empty(&e);
	mp_exact_free(&e);
	soup_free(&soup);
}

static void far_from_the_origin_nothing_is_lost(void **unused)
{
	const double far = 0x1p45;
	struct mp_exact e;
	struct mp_exact_value c[3];
	struct mp_exact_tensor t;

	(void)unused;
	find_box(far, -far, far, far + 4, -far + 3, far + 2, &e);
	assert_true(volume_of(&e) == 24);
	assert_true(mp_exact_centroid(&e, c));
	assert_true(c[0].value == far + 2 && c[1].value == -far + 1.5 && c[2].value == far + 1);
	mp_exact_inertia(&e, NULL, NULL, &t);
	assert_tensor(&t, 26, 40, 50, 0, 0, 0);
	mp_exact_free(&e);
}

static void results_that_no_double_holds_are_not_defined(void **unused)
{
	const double axis[3] = {DBL_MAX, 0, 0x1p-1074};
	const struct mp_exact_density light = {1, DBL_MAX, NULL};
	struct mp_exact e;
	struct mp_exact_value v, c[3], s[6], radius;
	struct mp_exact_tensor t;

	(void)unused;
	find_box(-DBL_MAX, -DBL_MAX, 0, DBL_MAX, DBL_MAX, 1, &e);
	mp_exact_volume(&e, &v);
	assert_true(!v.defined && v.value == 0 && mp_exact_sign(&e) == 1);
	mp_exact_mass(&e, &light, &v);
	assert_false(v.defined); /* 4*DBL_MAX */
	assert_true(mp_exact_centroid(&e, c));
	assert_true(c[0].value == 0 && c[2].value == 0.5);
	assert_false(mp_exact_second(&e, s));
	assert_true(s[3].defined && s[3].value == 0);
	mp_exact_inertia(&e, NULL, NULL, &t);
	assert_true(!t.defined && t.value[0][1] == 0 && t.bound == 0);
	mp_exact_axis_moment(&e, NULL, NOWHERE, axis, &v, &radius);
	assert_false(v.defined);
	assert_true(radius.defined && radius.value > 0.57 * DBL_MAX &&
		    radius.value < 0.58 * DBL_MAX);
	mp_exact_free(&e);

	find_box(0, 0, 0, 0x1p-1074, 0x1p-1073, 0x1p-1040, &e);
	mp_exact_volume(&e, &v);
	assert_true(!v.defined && mp_exact_sign(&e) == 1);
	assert_true(mp_exact_centroid(&e, c));
	assert_true(c[0].value == 0 && c[0].bound > 0); /* a tie, to even */
	assert_true(c[1].value == 0x1p-1074 && c[2].value == 0x1p-1041);
	mp_exact_free(&e);
}

static void an_axis_without_a_direction_has_no_moment(void **unused)
{
	struct mp_exact e;
	struct mp_exact_value v = {1, 1, true}, w = {1, 1, true};

	(void)unused;
	find_box(0, 0, 0, 1, 1, 1, &e);
	mp_exact_axis_moment(&e, NULL, NOWHERE, NOWHERE, &v, &w);
	assert_false(v.defined || w.defined);
	mp_exact_axis_moment(&e, NULL, NOWHERE, NOWHERE, NULL, NULL);
	mp_exact_free(&e);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_box_has_the_doubles_nearest_to_its_decimals),
	    cmocka_unit_test(a_corner_tetrahedron_has_its_closed_form),
	    cmocka_unit_test(a_wedge_has_its_closed_form),
	    cmocka_unit_test(no_order_changes_a_bit),
	    cmocka_unit_test(chunks_add_up_to_the_whole),
	    cmocka_unit_test(inside_out_is_the_same_solid_with_a_negative_volume),
	    cmocka_unit_test(what_is_flat_has_exactly_no_volume),
	    cmocka_unit_test(far_from_the_origin_nothing_is_lost),
	    cmocka_unit_test(results_that_no_double_holds_are_not_defined),
	    cmocka_unit_test(an_axis_without_a_direction_has_no_moment),
	};

	return cmocka_run_group_tests_name("exact", tests, NULL, NULL);
}
