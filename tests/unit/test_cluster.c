#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/repair/cluster.h"
#include "tests/unit/alloc_fail.h"

/* Points, and what clusters they make; places that occur twice are one vertex. */
struct cloud {
	double (*p)[3];
	size_t count;
	uint32_t *number; /* vertex of each point */
	struct mp_vertices *vertices;
	uint32_t *leader; /* by vertex */
	bool complete;
};

static const uint8_t KEY[16] = {2, 7, 1, 8, 2, 8, 1, 8, 2, 8, 4, 5, 9, 0, 4, 5};

static void *need(void *p)
{
	assert_non_null(p);
	return p;
}

static struct cloud cloud_new(size_t count)
{
	struct cloud c = {.count = count};

	c.p = need(calloc(count, sizeof *c.p));
	return c;
}

static void build(struct cloud *c)
{
	struct mp_error err = {0};

	c->number = need(malloc(c->count * sizeof *c->number));
	c->vertices = need(mp_vertices_new(KEY, &err));
	for (size_t i = 0; i < c->count; i++) {
		double tri[1][9];
		uint32_t out[1][3];

		for (int k = 0; k < 9; k++)
			tri[0][k] = c->p[i][k % 3];
		assert_int_equal(
		    mp_vertices_add(c->vertices, (const double(*)[9])tri, 1, out, &err), 0);
		c->number[i] = out[0][0];
	}
}

static void find(struct cloud *c, double distance)
{
	uint32_t count = mp_vertices_count(c->vertices);
	struct mp_error err = {0};

	free(c->leader);
	c->leader = need(malloc(count * sizeof *c->leader));
	assert_int_equal(mp_cluster_find(c->vertices, NULL, NULL, count, distance, KEY, c->leader,
					 &c->complete, &err),
			 0);
}

static void cloud_free(struct cloud *c)
{
	free(c->p);
	free(c->number);
	free(c->leader);
	mp_vertices_free(c->vertices);
}

static uint32_t clusters(const struct cloud *c)
{
	uint32_t n = 0;

	for (uint32_t v = 0; v < mp_vertices_count(c->vertices); v++)
		n += c->leader[v] == v;
	return n;
}

static uint64_t next(uint64_t *s)
{
	*s ^= *s << 13;
	*s ^= *s >> 7;
	*s ^= *s << 17;
	return *s;
}

static double uniform(uint64_t *s)
{
	return (double)(next(s) >> 11) * 0x1p-53;
}

static int place_order(const void *a, const void *b)
{
	const double *p = a, *q = b;

	for (int k = 0; k < 3; k++)
		if (p[k] != q[k])
			return p[k] < q[k] ? -1 : 1;
	return 0;
}

/* The definition: spread labels over all pairs until none changes. */
static void assert_by_definition(const struct cloud *c, double distance)
{
	size_t n = c->count;
	size_t *least = need(malloc(n * sizeof *least));
	bool changed = true;

	for (size_t i = 0; i < n; i++)
		least[i] = i;
	while (changed) {
		changed = false;
		for (size_t i = 0; i < n; i++) {
			for (size_t j = 0; j < n; j++) {
				double x = c->p[i][0] - c->p[j][0], y = c->p[i][1] - c->p[j][1],
				       z = c->p[i][2] - c->p[j][2];

				if (!(sqrt(x * x + y * y + z * z) < distance) ||
				    place_order(c->p[least[j]], c->p[least[i]]) >= 0)
					continue;
				least[i] = least[j];
				changed = true;
			}
		}
	}
	for (size_t i = 0; i < n; i++)
		assert_int_equal(c->leader[c->number[i]], c->number[least[i]]);
	free(least);
}

static void clusters_are_those_of_the_definition(void **state)
{
	uint64_t seed = 99;

	(void)state;
	for (int round = 0; round < 150; round++) {
		struct cloud c = cloud_new(1 + next(&seed) % 300);
		double flat = round % 3 == 0 ? 0 : 1, line = round % 7 == 0 ? 0 : 1;

		for (size_t i = 0; i < c.count; i++) {
			c.p[i][0] = uniform(&seed);
			c.p[i][1] = uniform(&seed) * line;
			c.p[i][2] = uniform(&seed) * flat * line;
			if (round % 5 == 0) /* a lattice, many pairs at one distance */
				for (int k = 0; k < 3; k++)
					c.p[i][k] = floor(8 * c.p[i][k]);
		}
		build(&c);
		for (double d = 0.01; d < 3; d *= 1.7) {
			find(&c, d);
			assert_true(c.complete);
			assert_by_definition(&c, d);
		}
		if (round % 5 == 0) { /* nearer than, not at */
			find(&c, 1);
			assert_by_definition(&c, 1);
		}
		cloud_free(&c);
	}
}

/* 3-4-5: what is exactly at the distance stays apart at any scale. */
static void what_is_at_the_distance_is_not_nearer(void **state)
{
	static const int exponents[] = {-1060, -600, -10, 0, 3, 500, 1000};

	(void)state;
	for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
		struct cloud c = cloud_new(2);
		double five = ldexp(5, exponents[i]);

		c.p[1][0] = ldexp(3, exponents[i]);
		c.p[1][2] = ldexp(-4, exponents[i]);
		build(&c);
		find(&c, five);
		assert_int_equal(clusters(&c), 2);
		find(&c, nextafter(five, INFINITY));
		assert_int_equal(clusters(&c), 1);
		assert_int_equal(c.leader[0], 0);
		cloud_free(&c);
	}
}

/* The ends of what doubles hold: nothing overflows, nothing is lost. */
static void huge_coordinates_and_tiny_distances_are_fine(void **state)
{
	static const double p[][3] = {
	    {DBL_MAX, 0, 0}, {-DBL_MAX, 0, 0}, {1e30, 1e30, 1e30}, {0, 5e-324, 0}, {0, 0, 0},
	    {-5e-324, 0, 0}, {0, DBL_MAX, 1},  {0, DBL_MAX, -1},   {1e-30, 0, 3},  {0, 0, 3}};
	struct cloud c = cloud_new(sizeof p / sizeof *p);

	(void)state;
	memcpy(c.p, p, sizeof p);
	build(&c);
	find(&c, 5e-324);
	assert_int_equal(clusters(&c), 10);
	find(&c, 1e-323); /* twice the least double: two points one step from a third */
	assert_int_equal(clusters(&c), 8);
	assert_int_equal(c.leader[3], 5);
	assert_int_equal(c.leader[4], 5);
	find(&c, 1.5e-30);
	assert_int_equal(clusters(&c), 7);
	find(&c, 2.5);
	assert_int_equal(clusters(&c), 6);
	find(&c, DBL_MAX);
	assert_int_equal(clusters(&c), 4); /* those at the ends: DBL_MAX away at least */
	cloud_free(&c);
}

static void a_chain_hangs_together(void **state)
{
	struct cloud c = cloud_new(300000);

	(void)state;
	for (size_t i = 0; i < c.count; i++) {
		size_t at = i * 7919 % c.count; /* in no order */

		c.p[i][0] = c.p[i][1] = c.p[i][2] = (double)at * 0x1p-10;
	}
	build(&c);
	find(&c, 0x1p-9); /* sqrt(3)/1024 is nearer */
	assert_true(c.complete);
	assert_int_equal(clusters(&c), 1);
	assert_int_equal(c.leader[c.number[5]], c.number[0]);
	find(&c, 1.7 * 0x1p-10);
	assert_int_equal(clusters(&c), c.count);
	cloud_free(&c);
}

static void many_points_within_one_distance_are_one(void **state)
{
	struct cloud c = cloud_new(300000);
	uint64_t seed = 5;

	(void)state;
	for (size_t i = 0; i < c.count; i++)
		for (int k = 0; k < 3; k++)
			c.p[i][k] = uniform(&seed);
	c.p[1234][0] = -0.1;
	build(&c);
	find(&c, 2);
	assert_true(c.complete);
	assert_int_equal(clusters(&c), 1);
	assert_int_equal(c.leader[0], c.number[1234]);
	find(&c, 0.3); /* neither one node's box nor few points */
	assert_true(c.complete);
	assert_int_equal(clusters(&c), 1);
	cloud_free(&c);
}

/*
 * A rod and a ring round it, every point of the one at the distance from the middle of the other
 * or a little more: no box can tell that no two are nearer.  Work ends all the same.
 */
static void work_on_clouds_just_out_of_reach_is_bounded(void **state)
{
	struct cloud c = cloud_new(200000);
	const double r = 1.0000001;

	(void)state;
	for (size_t i = 0; i < c.count; i++) {
		double a = 6.283185307179586 * (double)i / (double)c.count, s;

		if (i % 2 == 0) {
			s = ((double)i / (double)c.count - 0.5) * 0.01;
			c.p[i][0] = c.p[i][1] = c.p[i][2] = s;
			continue;
		}
		c.p[i][0] = r * (cos(a) / sqrt(2) + sin(a) / sqrt(6));
		c.p[i][1] = r * (-cos(a) / sqrt(2) + sin(a) / sqrt(6));
		c.p[i][2] = r * (-2 * sin(a) / sqrt(6));
	}
	build(&c);
	find(&c, 1);
	assert_false(c.complete);
	for (uint32_t v = 0; v < c.count; v++) /* what was joined is right */
		assert_int_equal(c.leader[c.number[v]] % 2, c.number[v] % 2);
	cloud_free(&c);
}

static void some_of_the_vertices_may_be_looked_at_alone(void **state)
{
	static const uint32_t which[] = {5, 1, 4};
	struct cloud c = cloud_new(6);
	struct mp_error err = {0};
	uint32_t leader[3];
	bool complete;

	(void)state;
	for (size_t i = 0; i < c.count; i++)
		c.p[i][0] = (double)i;
	build(&c);
	assert_int_equal(
	    mp_cluster_find(c.vertices, NULL, which, 3, 1.5, KEY, leader, &complete, &err), 0);
	assert_int_equal(leader[0], 4);
	assert_int_equal(leader[1], 1);
	assert_int_equal(leader[2], 4);
	cloud_free(&c);
}

static void every_allocation_may_fail(void **state)
{
	struct cloud c = cloud_new(100);
	struct mp_error err = {0};
	uint32_t leader[100];
	bool complete;
	int failures = 0;

	(void)state;
	for (size_t i = 0; i < c.count; i++)
		c.p[i][0] = (double)i;
	build(&c);
	for (long n = 1; n < 10; n++) {
		int ret;

		alloc_fail_at(n);
		ret =
		    mp_cluster_find(c.vertices, NULL, NULL, 100, 0.5, KEY, leader, &complete, &err);
		alloc_fail_at(0);
		if (ret == 0)
			break;
		assert_int_equal(err.code, MP_NOMEM);
		failures++;
	}
	assert_int_equal(failures, 3);
	cloud_free(&c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(clusters_are_those_of_the_definition),
	    cmocka_unit_test(what_is_at_the_distance_is_not_nearer),
	    cmocka_unit_test(huge_coordinates_and_tiny_distances_are_fine),
	    cmocka_unit_test(a_chain_hangs_together),
	    cmocka_unit_test(many_points_within_one_distance_are_one),
	    cmocka_unit_test(work_on_clouds_just_out_of_reach_is_bounded),
	    cmocka_unit_test(some_of_the_vertices_may_be_looked_at_alone),
	    cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests_name("cluster", tests, NULL, NULL);
}
