#include "core/intersect/tri_pair.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/geometry/predicates.h"
#include "tests/unit/pair_truth.h"
#include "tests/unit/soup.h"

static struct mp_work plenty(void)
{
	return (struct mp_work){.left = UINT64_MAX, .exact = MP_WORK_EXACT};
}

/* A triangle on a grid of ${side} points a side; its vertices are numbered by their place. */
static struct mp_tri random_triangle(uint64_t *state, unsigned side, double scale)
{
	struct mp_tri t;

	do {
		for (unsigned i = 0; i < 3; i++) {
			t.v[i] = 0;
			for (unsigned k = 0; k < 3; k++) {
				unsigned x = (unsigned)(soup_random(state) >> 33) % side;

				t.v[i] = t.v[i] * side + x;
				t.p[i][k] = x * scale;
			}
		}
	} while (mp_collinear(t.p[0], t.p[1], t.p[2]));
	return t;
}

static bool near(const double a[3], const double b[3], double tolerance)
{
	return fabs(a[0] - b[0]) <= tolerance && fabs(a[1] - b[1]) <= tolerance &&
	       fabs(a[2] - b[2]) <= tolerance;
}

static void assert_points(const struct mp_tri *t, const struct mp_tri *u,
			  const struct mp_meeting *m, const struct pair_truth *truth, double size)
{
	assert_int_equal(m->points, truth->points);
	for (unsigned i = 0; i < m->points; i++) {
		double p[3];
		bool found = false;

		mp_tri_point(t, u, m, i, p);
		for (unsigned j = 0; j < truth->points; j++)
			found = found || near(p, truth->point[j], 4e-15 * size);
		if (!found)
			fail_msg("%.17g %.17g %.17g is no corner", p[0], p[1], p[2]);
	}
}

static void assert_true_of(const struct mp_tri *t, const struct mp_tri *u, double size)
{
	struct mp_work work = plenty();
	struct pair_truth truth;
	struct mp_meeting m;

	mp_tri_meet(t, u, &work, &m);
	if (m.shared == 3) {
		assert_false(m.touches || m.intersects || m.crosses);
		return;
	}
	pair_truth_find(t, u, &truth);
	assert_int_equal(m.touches, truth.touches);
	assert_int_equal(m.intersects, truth.intersects);
	assert_int_equal(m.crosses, truth.crosses);
	assert_true(!m.coplanar || truth.coplanar);
	for (unsigned k = 0; k < 6 && m.shared < 2; k++)
		assert_int_equal(m.along[k / 3][k % 3], truth.along[k / 3][k % 3]);
	if (m.touches)
		assert_points(t, u, &m, &truth, size);
}

/* On grids so coarse every degenerate case there is comes up, often. */
static void test_against_fractions(void **state)
{
	uint64_t random = 1;

	(void)state;
	for (unsigned side = 2; side < 7; side++)
		for (unsigned i = 0; i < 2000; i++) {
			struct mp_tri t = random_triangle(&random, side, 1);
			struct mp_tri u = random_triangle(&random, side, 1);

			assert_true_of(&t, &u, side);
		}
}

static void flatten(struct mp_tri *t, unsigned side)
{
	for (unsigned i = 0; i < 3; i++) {
		t->p[i][2] = t->p[i][0] + t->p[i][1];
		t->v[i] = (uint32_t)t->p[i][0] * side + (uint32_t)t->p[i][1];
	}
}

static void test_coplanar_against_fractions(void **state)
{
	uint64_t random = 2;

	(void)state;
	for (unsigned i = 0; i < 6000; i++) {
		unsigned side = 3 + i % 4;
		struct mp_tri t = random_triangle(&random, side, 1);
		struct mp_tri u = random_triangle(&random, side, 1);

		flatten(&t, side);
		flatten(&u, side);
		if (mp_collinear(t.p[0], t.p[1], t.p[2]) || mp_collinear(u.p[0], u.p[1], u.p[2]))
			continue;
		assert_true_of(&t, &u, 2 * side);
	}
}

/* The same where products leave the range of a double. */
static void test_beyond_the_range_of_doubles(void **state)
{
	const double scale[] = {0x1p900, 0x1p-1074, 0x1p-1000, 0x1p1020};
	uint64_t random = 3;

	(void)state;
	for (unsigned i = 0; i < 400; i++) {
		double size = scale[i % 4];
		struct mp_tri t = random_triangle(&random, 4, size);
		struct mp_tri u = random_triangle(&random, 4, size);

		assert_true_of(&t, &u, 4 * size + 1e300 * 0x1p-1074);
	}
}

/* Neither the order of the two nor that of their corners matters. */
static void test_symmetry(void **state)
{
	uint64_t random = 4;

	(void)state;
	for (unsigned i = 0; i < 3000; i++) {
		struct mp_tri t = random_triangle(&random, 4, 1), r = t;
		struct mp_tri u = random_triangle(&random, 4, 1);
		struct mp_work work = plenty();
		struct mp_meeting m, n;

		for (unsigned k = 0; k < 3; k++) {
			r.v[k] = t.v[(2 - k + i) % 3];
			for (unsigned j = 0; j < 3; j++)
				r.p[k][j] = t.p[(2 - k + i) % 3][j];
		}
		mp_tri_meet(&t, &u, &work, &m);
		mp_tri_meet(&u, &r, &work, &n);
		assert_true(m.touches == n.touches && m.intersects == n.intersects &&
			    m.crosses == n.crosses && m.points == n.points);
	}
}

static struct mp_tri tri(double ax, double ay, double az, double bx, double by, double bz,
			 double cx, double cy, double cz, uint32_t first)
{
	return (struct mp_tri){{{ax, ay, az}, {bx, by, bz}, {cx, cy, cz}},
			       {first, first + 1, first + 2}};
}

/* A corner that is one ulp short of a face, on it, and one ulp through. */
static void test_one_ulp_decides(void **state)
{
	struct mp_tri floor = tri(0, 0, 1, 3, 0, 1, 0, 3, 1, 0);
	struct mp_tri tip = tri(1, 1, nextafter(1, 2), 1, 1, 2, 2, 1, 2, 3);
	struct mp_work work = plenty();
	struct mp_meeting m;

	(void)state;
	mp_tri_meet(&floor, &tip, &work, &m);
	assert_false(m.touches);
	tip.p[0][2] = 1;
	mp_tri_meet(&floor, &tip, &work, &m);
	assert_true(m.intersects && !m.crosses && m.points == 1);
	tip.p[0][2] = nextafter(1, 0);
	mp_tri_meet(&floor, &tip, &work, &m);
	assert_true(m.intersects && m.crosses && m.points == 2);
}

/* An edge of one triangle along two edges of others that meet at its middle: no intersection. */
static void test_t_junction_only_touches(void **state)
{
	struct mp_tri whole = tri(0, 0, 0, 2, 0, 0, 1, 1, 0, 0);
	struct mp_tri half = tri(0, 0, 0, 1, 0, 0, 1, -1, 0, 7);
	struct mp_work work = plenty();
	struct mp_meeting m;

	(void)state;
	half.v[0] = whole.v[0];
	mp_tri_meet(&whole, &half, &work, &m);
	assert_true(m.touches && !m.intersects);
	half.p[2][1] = 1;
	mp_tri_meet(&whole, &half, &work, &m);
	assert_true(m.intersects && !m.crosses && m.coplanar);
}

static void test_work_is_counted(void **state)
{
	struct mp_tri floor = tri(0, 0, 1, 3, 0, 1, 0, 3, 1, 0);
	struct mp_tri tip = tri(1, 1, 0.1, 1, 1, 2, 2, 1.3, 2, 3);
	struct mp_work work = plenty();
	struct mp_meeting m;

	(void)state;
	mp_tri_meet(&floor, &tip, &work, &m);
	assert_true(work.left < UINT64_MAX);
	work.left = 5; /* what is left decides nothing here: whoever goes on looks at it */
	mp_tri_meet(&floor, &tip, &work, &m);
	assert_true(m.crosses && work.left == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_against_fractions),
	    cmocka_unit_test(test_coplanar_against_fractions),
	    cmocka_unit_test(test_beyond_the_range_of_doubles),
	    cmocka_unit_test(test_symmetry),
	    cmocka_unit_test(test_one_ulp_decides),
	    cmocka_unit_test(test_t_junction_only_touches),
	    cmocka_unit_test(test_work_is_counted),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
