#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/predicates.h"
#include "core/intersect/intersect.h"
#include "tests/unit/alloc_fail.h"
#include "tests/unit/pair_truth.h"
#include "tests/unit/soup.h"

static const uint8_t KEY[16] = "not very secret";

static int look(struct found *f, uint32_t most, struct mp_crossings *out)
{
	struct mp_error err;
	struct mp_intersect ask = {.key = KEY, .most = most};

	found_look(f, 10);
	ask.mesh = &f->built.mesh;
	ask.topology = &f->t;
	return mp_self_intersections(&ask, out, &err);
}

static uint64_t count(struct soup *s)
{
	struct found f = {.soup = *s};
	struct mp_crossings c;
	uint64_t n;

	assert_int_equal(look(&f, 3, &c), 0);
	assert_true(c.asked && c.decided && c.listed == (c.count < 3 ? c.count : 3));
	n = c.count;
	mp_crossings_free(&c);
	found_free(&f);
	memset(s, 0, sizeof *s);
	return n;
}

static void load(const struct mp_mesh *mesh, uint32_t triangle, struct mp_tri *t)
{
	for (unsigned k = 0; k < 3; k++) {
		t->v[k] = mesh->tri[triangle][k];
		mp_vertices_get(mesh->vertices, t->v[k], t->p[k]);
	}
}

static bool intersect(const struct mp_mesh *mesh, uint32_t a, uint32_t b)
{
	struct pair_truth truth;
	unsigned shared = 0;
	struct mp_tri t, u;

	load(mesh, a, &t);
	load(mesh, b, &u);
	for (unsigned k = 0; k < 9; k++)
		shared += t.v[k % 3] == u.v[k / 3];
	if (shared >= 3 || mp_collinear(t.p[0], t.p[1], t.p[2]) ||
	    mp_collinear(u.p[0], u.p[1], u.p[2]))
		return false;
	pair_truth_find(&t, &u, &truth);
	return truth.intersects;
}

/* Every pair of a soup on a coarse grid, one by one in fractions, and which come first. */
static void test_against_all_pairs(void **state)
{
	uint64_t random = 7;

	(void)state;
	for (unsigned i = 0; i < 24; i++) {
		unsigned side = 3 + i % 8, triangles = 40;
		struct found f = {.soup = {0}};
		struct mp_crossings c;
		uint64_t n = 0;

		while (triangles-- > 0) {
			double p[3][3];

			for (unsigned k = 0; k < 9; k++)
				p[k / 3][k % 3] = (double)((soup_random(&random) >> 33) % side);
			soup_add(&f.soup, p[0], p[1], p[2]);
		}
		assert_int_equal(look(&f, 20, &c), 0);
		for (uint32_t a = 0; a < f.built.mesh.triangles; a++)
			for (uint32_t b = a + 1; b < f.built.mesh.triangles; b++) {
				if (!intersect(&f.built.mesh, a, b))
					continue;
				if (n < c.listed)
					assert_true(c.list[n].triangle[0] == a &&
						    c.list[n].triangle[1] == b);
				n++;
			}
		assert_true(c.decided && c.count == n && c.listed == (n < 20 ? n : 20));
		mp_crossings_free(&c);
		found_free(&f);
	}
}

static void test_sound_surfaces_have_none(void **state)
{
	struct soup s = {0};

	(void)state;
	soup_cube(&s, 0, 0, 0, 1);
	soup_cube(&s, 0, 0, 3, 1);
	soup_cube(&s, 1, 1, 0, 1); /* the first one's edge */
	assert_int_equal(count(&s), 0);
	soup_torus(&s, 100, 40, 3, 1);
	assert_int_equal(count(&s), 0);
	soup_tube(&s, 100, 1);
	assert_int_equal(count(&s), 0);
	assert_int_equal(count(&s), 0); /* nothing at all */
}

/* Rings that hang in each other; then they come too close. */
static void test_thick_torus_meets_itself(void **state)
{
	struct soup s = {0};

	(void)state;
	soup_torus(&s, 40, 30, 1, 1.2);
	assert_true(count(&s) > 40);
}

static void test_order_does_not_matter(void **state)
{
	uint64_t random = 8, first = 0;

	(void)state;
	for (unsigned i = 0; i < 4; i++) {
		const double shift[3] = {0.1, 0.2, 0.3};
		struct soup s = {0}, t = {0};

		soup_torus(&t, 30, 20, 2, 1);
		soup_copy(&s, &t, 1, shift);
		soup_torus(&s, 20, 30, 2, 0.9);
		soup_free(&t);
		if (i > 0)
			soup_shuffle(&s, &random);
		if (i == 0)
			first = count(&s);
		else
			assert_int_equal(count(&s), first);
	}
	assert_true(first > 100);
}

/* Faces on each other count, repeated triangles and an edge that meets two others do not. */
static void test_what_only_touches(void **state)
{
	const double a[3] = {0, 0, 0}, b[3] = {2, 0, 0}, c[3] = {0, 2, 0}, d[3] = {1, 0, 0},
		     e[3] = {0, -2, 0}, f[3] = {2, 2, 0}, g[3] = {0.5, 0.5, 1},
		     h[3] = {0.5, 0.5, 0}, k[3] = {1, 0.5, 1};
	struct soup s = {0};

	(void)state;
	soup_add(&s, a, b, c);
	soup_add(&s, a, d, e);
	soup_add(&s, d, b, e);
	soup_add(&s, c, b, a);
	soup_add(&s, a, d, b); /* no area */
	assert_int_equal(count(&s), 0);
	soup_add(&s, a, b, c);
	soup_add(&s, a, b, f);
	assert_int_equal(count(&s), 1);
	soup_add(&s, a, b, c);
	soup_add(&s, h, g, k);
	assert_int_equal(count(&s), 1);
}

static void test_needles_through_each_other_are_not_decided(void **state)
{
	struct found f = {.soup = {0}};
	struct mp_crossings c;

	(void)state;
	for (unsigned i = 0; i < 60000; i++) {
		double at = i / 60000.0, w = 1e-6;
		const double a[3] = {-1, at, -at}, b[3] = {1, -at, at}, d[3] = {1, w - at, at + w};
		const double p[3] = {at, -1, at}, q[3] = {-at, 1, -at}, r[3] = {w - at, 1, w - at};

		soup_add(&f.soup, a, b, d);
		soup_add(&f.soup, p, q, r);
	}
	assert_int_equal(look(&f, 100, &c), 0);
	assert_true(c.asked && !c.decided && c.count > 100 && c.listed == 100);
	mp_crossings_free(&c);
	found_free(&f);
}

static void test_every_allocation_may_fail(void **state)
{
	struct found f = {.soup = {0}};
	struct mp_crossings c;
	struct mp_error err;
	long before, used;

	(void)state;
	soup_torus(&f.soup, 20, 20, 1, 1.2);
	for (int i = 0; i < 40; i++) /* so far away that halves are lopsided */
		soup_cube(&f.soup, ldexp(1, 2 * i), 0, 0, 1e-3);
	before = alloc_count();
	assert_int_equal(look(&f, 100, &c), 0);
	mp_crossings_free(&c);
	{
		struct mp_intersect ask = {
		    .mesh = &f.built.mesh, .topology = &f.t, .key = KEY, .most = 100};

		before = alloc_count();
		assert_int_equal(mp_self_intersections(&ask, &c, &err), 0);
		mp_crossings_free(&c);
		used = alloc_count() - before;
		assert_true(used > 8);
		for (long n = 1; n <= used; n++) {
			int ret;

			alloc_fail_at(n);
			ret = mp_self_intersections(&ask, &c, &err);
			alloc_fail_at(0);
			assert_true(ret == 0 || err.code == MP_NOMEM);
			if (ret == 0)
				mp_crossings_free(&c);
		}
	}
	found_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_against_all_pairs),
	    cmocka_unit_test(test_sound_surfaces_have_none),
	    cmocka_unit_test(test_thick_torus_meets_itself),
	    cmocka_unit_test(test_order_does_not_matter),
	    cmocka_unit_test(test_what_only_touches),
	    cmocka_unit_test(test_needles_through_each_other_are_not_decided),
	    cmocka_unit_test(test_every_allocation_may_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
