#include "core/intersect/intersect.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/soup.h"

enum { MOST_BODIES = 4096 };
static const uint8_t KEY[16] = "not very secret";

/* Of small bodies near the origin. */
static uint8_t winding_of(const struct found *f, uint32_t body)
{
	const struct mp_body_topology *b = &f->t.body[body];
	double volume = 0;

	for (uint32_t i = 0; i < f->built.mesh.triangles; i++) {
		double p[3][3];

		for (unsigned k = 0; k < 3; k++)
			mp_vertices_get(f->built.vertices, f->built.tri[i][k], p[k]);
		if (f->t.body_of[i] == body)
			volume += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
				  p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
				  p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
	}
	if (!b->closed || volume == 0)
		return MP_WOUND_NOT;
	return volume > 0 ? MP_WOUND_OUTWARD : MP_WOUND_INWARD;
}

/* The soup must have triangles with edges only. */
static int look(struct found *f, struct mp_crossings *out)
{
	static struct mp_box box[MOST_BODIES];
	static uint8_t winding[MOST_BODIES];
	struct mp_error err;
	struct mp_intersect ask = {.key = KEY, .most = 100, .box = box, .winding = winding};

	found_look(f, 10);
	assert_true(f->t.bodies <= MOST_BODIES);
	found_boxes(f, box);
	for (uint32_t i = 0; i < f->t.bodies; i++)
		winding[i] = winding_of(f, i);
	ask.mesh = &f->built.mesh;
	ask.topology = &f->t;
	return mp_overlapping_bodies(&ask, out, &err);
}

/* -1: not decided. */
static int64_t overlaps(struct found *f)
{
	struct mp_crossings c;
	int64_t count;

	assert_int_equal(look(f, &c), 0);
	count = c.decided ? (int64_t)c.count : -1;
	assert_true(!c.decided || c.listed == (c.count < 100 ? c.count : 100));
	for (size_t i = 0; i < c.listed; i++) {
		assert_true(c.list[i].points > 0);
		assert_true(c.list[i].triangle[0] < c.list[i].triangle[1]);
	}
	mp_crossings_free(&c);
	return count;
}

static int64_t overlaps_once(struct soup *s)
{
	struct found f = {.soup = *s};
	int64_t count = overlaps(&f);

	found_free(&f);
	memset(s, 0, sizeof *s);
	return count;
}

/* A solid in a chess box of 3 * 3 * 3 fields. */
enum { SIDE = 3, FINE = 2 * SIDE + 1 };
struct fields {
	bool full[SIDE][SIDE][SIDE];
};

static bool full(const struct fields *f, int x, int y, int z)
{
	return x >= 0 && y >= 0 && z >= 0 && x < SIDE && y < SIDE && z < SIDE && f->full[x][y][z];
}

/* Exact for the small integers and halves here, and no plane stays across an axis. */
static void shear(double p[3], bool when)
{
	double x = p[0], y = p[1], z = p[2];

	if (!when)
		return;
	p[0] = x + 2 * y - z;
	p[1] = y + 3 * z;
	p[2] = 5 * z + x - y;
}

/*
 * A square at ${o}, from there to ${u} and ${v}: four triangles round its centre, or twelve round
 * a point that the first kind has no vertex at, with thirds of its sides.
 */
static void square(struct soup *s, const double o[3], const double u[3], const double v[3],
		   bool thirds, bool sheared)
{
	static const double side[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
	double middle = thirds ? 1.0 / 3 : 1.0 / 2, p[12][3], c[3];
	unsigned parts = thirds ? 3 : 1, n = 4 * parts;

	for (unsigned k = 0; k < 3; k++)
		c[k] = round(o[k] + middle * u[k] + middle * v[k]);
	shear(c, sheared);
	for (unsigned i = 0; i < n; i++) {
		const double *from = side[i / parts], *to = side[(i / parts + 1) % 4];
		double at = (double)(i % parts) / parts, x = from[0] + at * (to[0] - from[0]),
		       y = from[1] + at * (to[1] - from[1]);

		for (unsigned k = 0; k < 3; k++)
			p[i][k] = round(o[k] + x * u[k] + y * v[k]);
		shear(p[i], sheared);
	}
	for (unsigned i = 0; i < n; i++)
		soup_add(s, p[i], p[(i + 1) % n], c);
}

/* The border of the solid; a field is 6 wide. */
static void border(struct soup *s, const struct fields *f, const int half[3], bool thirds,
		   bool sheared)
{
	for (int at = 0; at < SIDE * SIDE * SIDE; at++)
		for (unsigned k = 0; k < 6; k++) {
			int x[3] = {at % 3, at / 3 % 3, at / 9}, n[3] = {x[0], x[1], x[2]};
			unsigned a = k % 3, b = (a + 1) % 3, c = (a + 2) % 3;
			double o[3], u[3] = {0}, v[3] = {0};

			n[a] += k < 3 ? 1 : -1;
			if (!full(f, x[0], x[1], x[2]) || full(f, n[0], n[1], n[2]))
				continue;
			for (unsigned j = 0; j < 3; j++)
				o[j] = 6 * x[j] + 3 * half[j];
			o[a] += k < 3 ? 6 : 0;
			u[k < 3 ? b : c] = v[k < 3 ? c : b] = 6;
			square(s, o, u, v, thirds, sheared);
		}
}

/* Of up to ${steps} fields, each a neighbour of the one before. */
static struct fields random_fields(uint64_t *state, unsigned steps)
{
	struct fields f = {.full = {{{0}}}};
	unsigned x[3];

	for (unsigned k = 0; k < 3; k++)
		x[k] = (unsigned)(soup_random(state) >> 33) % 3;

	for (unsigned i = 0; i < steps; i++) {
		unsigned k = (unsigned)(soup_random(state) >> 33) % 3;

		f.full[x[0]][x[1]][x[2]] = true;
		x[k] = x[k] != 1 ? 1 : (unsigned)(soup_random(state) >> 40) % 2 * 2;
	}
	return f;
}

/* Do they overlap?  Field by field, in fields half as wide. */
static bool truth(const struct fields *f, const struct fields *g, const int half[3])
{
	bool both = false, first = false, second = false;

	for (int i = 0; i < FINE * FINE * FINE; i++) {
		int x = i % FINE, y = i / FINE % FINE, z = i / FINE / FINE;
		bool a = full(f, x / 2, y / 2, z / 2);
		bool b = x >= half[0] && y >= half[1] && z >= half[2] &&
			 full(g, (x - half[0]) / 2, (y - half[1]) / 2, (z - half[2]) / 2);

		both = both || (a && b);
		first = first || (a && !b);
		second = second || (b && !a);
	}
	return both && first == second;
}

/*
 * Solids all of whose contacts are degenerate: corners, edges and faces on each other.  What is
 * decided is true, and what has a plain surface is decided.
 */
static void test_against_fields(void **state)
{
	unsigned decided = 0, overlapping = 0, apart = 0;
	uint64_t random = 5;

	(void)state;
	for (unsigned i = 0; i < 1200; i++) {
		struct fields f = random_fields(&random, 1 + i % 17), g;
		int half[3] = {(int)(i / 3 % 2), (int)(i / 6 % 2), (int)(i / 12 % 2)};
		const int none[3] = {0};
		struct found in = {.soup = {0}};
		int64_t count;
		size_t from;
		bool two;

		g = i % 7 == 0 ? f : random_fields(&random, 1 + i / 5 % 9);
		border(&in.soup, &f, none, false, i % 2);
		from = in.soup.count;
		border(&in.soup, &g, half, true, i % 2);
		for (size_t k = i % 5 == 0 ? from : in.soup.count; k < in.soup.count; k++)
			soup_flip(&in.soup, k);
		if (i % 11 == 0)
			soup_shuffle(&in.soup, &random);
		count = overlaps(&in);
		two = in.t.bodies == 2 &&
		      (in.t.body[0].triangles == from || in.t.body[1].triangles == from);
		if (two && in.t.watertight) /* and touches itself in corners at most */
			assert_true(count >= 0);
		if (two && count >= 0) {
			assert_int_equal(count, truth(&f, &g, half));
			decided++;
			overlapping += count == 1;
			apart += count == 0;
		}
		found_free(&in);
	}
	assert_true(decided > 900 && overlapping > 300 && apart > 200);
}

static void test_boxes_at_all_places(void **state)
{
	(void)state;
	for (int i = 0; i < 11 * 11 * 11; i++) { /* from apart over touching to across and within */
		int x = i % 11 - 5, y = i / 11 % 11 - 5, z = i / 121 - 5;
		bool in[3] = {x > -2 && x<4, y> - 2 && y<4, z> - 2 && z < 4};
		struct soup s = {0};

		soup_cube(&s, 0, 0, 0, 4);
		soup_divide(&s, 0);
		soup_cube(&s, x, y, z, 2); /* its edges are those of no half edge of the other */
		if (x == 0 || y == 0 || z == 0 || x == 2 || y == 2 || z == 2) {
			soup_divide(&s, s.count - 12);
		}
		if (in[0] && in[1] && in[2]) {
			bool inside = x >= 0 && x <= 2 && y >= 0 && y <= 2 && z >= 0 && z <= 2;

			assert_int_equal(overlaps_once(&s), !inside);
		} else {
			assert_int_equal(overlaps_once(&s), 0);
		}
	}
}

/* Balls whose distance is the sum of their radii, then one ulp less and one more. */
static void test_tips_one_ulp_into_each_other(void **state)
{
	const double tip[3] = {nextafter(1, 0), 1, nextafter(1, 2)};

	(void)state;
	for (unsigned i = 0; i < 3; i++) {
		double a[3] = {0, -1, -1}, b[3] = {0, 2, 0}, c[3] = {0, -1, 1}, d[3] = {1, 0, 0};
		double e[3] = {2, -1, -1}, f[3] = {2, 2, 0}, g[3] = {2, -1, 1},
		       h[3] = {tip[i], 0, 0};
		struct soup s = {0};

		soup_add(&s, a, c, b), soup_add(&s, a, b, d), soup_add(&s, b, c, d);
		soup_add(&s, c, a, d);
		soup_add(&s, e, f, g), soup_add(&s, e, h, f), soup_add(&s, f, h, g);
		soup_add(&s, g, h, e);
		assert_int_equal(overlaps_once(&s), i == 0);
	}
}

/* A rod through a plate, flush with it: it lies within.  Longer: it overlaps. */
static void test_rod_in_a_plate(void **state)
{
	(void)state;
	for (int over = -1; over < 2; over++) {
		const double a[3] = {0, 0, 0}, b[3] = {10, 10, 2};
		const double c[3] = {3, 3, 0}, d[3] = {4, 5, 2.0 + over / 4.0};
		struct soup s = {0};

		soup_box(&s, a, b);
		soup_box(&s, c, d);
		assert_int_equal(overlaps_once(&s), over > 0);
	}
}

static void test_open_bodies_that_cross_are_not_decided(void **state)
{
	struct soup s = {0};

	(void)state;
	soup_cube(&s, 0, 0, 0, 2);
	soup_cube(&s, 1, 1, 1, 2);
	soup_drop(&s, 0);
	assert_int_equal(overlaps_once(&s), -1);
	soup_cube(&s, 0, 0, 0, 4); /* one in another: nothing crosses */
	soup_cube(&s, 1, 1, 1, 2);
	soup_drop(&s, 0);
	assert_int_equal(overlaps_once(&s), 0);
}

/* A row of cubes, each into the next: as many pairs as neighbours, whatever their order. */
static void test_chain(void **state)
{
	uint64_t random = 6;

	(void)state;
	for (unsigned shuffled = 0; shuffled < 2; shuffled++) {
		struct soup s = {0};

		for (int i = 0; i < 1000; i++)
			soup_cube(&s, 0.75 * i, 0.01 * (i % 3), 0.02 * (i % 5), 1);
		if (shuffled)
			soup_shuffle(&s, &random);
		assert_int_equal(overlaps_once(&s), 999);
	}
}

static void test_pairs_are_located(void **state)
{
	struct found f = {.soup = {0}};
	struct mp_crossings c;

	(void)state;
	soup_cube(&f.soup, 0, 0, 0, 2);
	soup_cube(&f.soup, 9, 9, 9, 2);
	soup_cube(&f.soup, 1, 1, 1, 2);
	assert_int_equal(look(&f, &c), 0);
	assert_true(c.decided && c.count == 1 && c.listed == 1 && c.list[0].points == 2);
	assert_true(c.list[0].triangle[0] < 12 && c.list[0].triangle[1] >= 24);
	for (unsigned k = 0; k < 3; k++)
		assert_true(c.list[0].point[0][k] >= 1 && c.list[0].point[0][k] <= 2);
	mp_crossings_free(&c);
	found_free(&f);
}

/* All of thousands of bodies in each other: more than the work limit allows. */
static void test_too_many_pairs_are_not_decided(void **state)
{
	struct soup s = {0};

	(void)state;
	for (int i = 0; i < 4000; i++)
		soup_tetrahedron(&s, 1e-5 * i, 2e-5 * i, 1e-5 * (i % 7), 1);
	assert_int_equal(overlaps_once(&s), -1);
}

static void test_every_allocation_may_fail(void **state)
{
	struct found f = {.soup = {0}};
	struct mp_crossings c;
	long before, used;

	(void)state;
	soup_cube(&f.soup, 0, 0, 0, 4);
	soup_divide(&f.soup, 0);
	soup_cube(&f.soup, 1, 1, 3, 2);
	soup_cube(&f.soup, 1, 1, 2, 2.5);
	soup_cube(&f.soup, 1, 1, -1.5, 1.5);
	assert_int_equal(look(&f, &c), 0);
	mp_crossings_free(&c);
	assert_true(f.t.bodies > 2);
	{
		struct mp_box box[8];
		const uint8_t winding[8] = {1, 1, 1, 1, 1, 1, 1, 1};
		struct mp_intersect ask = {&f.built.mesh, &f.t, box, winding, KEY, 10};
		struct mp_error err;

		found_boxes(&f, box);
		before = alloc_count();
		assert_int_equal(mp_overlapping_bodies(&ask, &c, &err), 0);
		mp_crossings_free(&c);
		used = alloc_count() - before;
		assert_true(used > 8);
		for (long n = 1; n <= used; n++) {
			int ret;

			alloc_fail_at(n);
			ret = mp_overlapping_bodies(&ask, &c, &err);
			alloc_fail_at(0);
			assert_true(ret == 0 || err.code == MP_NOMEM);
			mp_crossings_free(&c);
		}
	}
	found_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_against_fields),
	    cmocka_unit_test(test_boxes_at_all_places),
	    cmocka_unit_test(test_tips_one_ulp_into_each_other),
	    cmocka_unit_test(test_rod_in_a_plate),
	    cmocka_unit_test(test_open_bodies_that_cross_are_not_decided),
	    cmocka_unit_test(test_chain),
	    cmocka_unit_test(test_pairs_are_located),
	    cmocka_unit_test(test_too_many_pairs_are_not_decided),
	    cmocka_unit_test(test_every_allocation_may_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
