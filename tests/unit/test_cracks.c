#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/topology/topology.h"
#include "soup.h"

/* A tube without caps has no vector area, but its rims are no cracks. */
static void a_tube_without_caps_is_open(void **unused)
{
	struct found f = {0};

	(void)unused;
	soup_tube(&f.soup, 12, 2);
	found_look(&f, 100);
	assert_int_equal(f.t.boundary_loops, 2);
	assert_int_equal(f.t.boundary_edges, 24);
	assert_false(f.t.closed || f.t.cracks_only);
	assert_int_equal(f.t.defect[MP_DEFECT_BOUNDARY_LOOP].count, 2);
	assert_int_equal(f.t.defect[MP_DEFECT_BOUNDARY_LOOP].vertex_at[1], 12);
	found_free(&f);
}

/*
 * A box of which the top has a vertex more on its edges than the sides: facets of the top are
 * fans from the middle, ${parts} pieces an edge.
 */
static void box_with_divided_top(struct soup *s, int parts, double bump)
{
	const double middle[3] = {0.5 * parts, 0.5 * parts, 1};
	double size = parts;
	const double corner[4][3] = {{0, 0, 1}, {size, 0, 1}, {size, size, 1}, {0, size, 1}};
	const double min[3] = {0, 0, 0}, max[3] = {size, size, 1};

	soup_box(s, min, max);
	soup_drop(s, 11);
	soup_drop(s, 10);
	for (int i = 0; i < 4; i++) {
		const double *a = corner[i], *b = corner[(i + 1) % 4];

		for (int j = 0; j < parts; j++) {
			double p[2][3];

			for (int e = 0; e < 2; e++)
				for (int k = 0; k < 3; k++)
					p[e][k] = a[k] + (b[k] - a[k]) * (j + e) / size;
			if (j > 0)
				p[0][2] += bump;
			if (j < parts - 1)
				p[1][2] += bump;
			soup_add(s, p[0], p[1], middle);
		}
	}
}

static void t_junctions_are_cracks(void **unused)
{
	uint64_t state = 1;

	(void)unused;
	for (int parts = 2; parts < 9; parts++) {
		struct found f = {0};

		box_with_divided_top(&f.soup, parts, 0);
		soup_shuffle(&f.soup, &state);
		found_look(&f, 100);
		assert_false(f.t.closed || f.t.watertight);
		assert_true(f.t.cracks_only);
		assert_int_equal(f.t.boundary_edges, 4 * parts + 4);
		assert_int_equal(f.t.boundary_loops, 1); /* cracks hang together at the corners */
		assert_int_equal(f.t.bodies, 2);
		/* The lid alone has a rim, and so has the rest. */
		assert_false(f.t.body[0].cracks_only || f.t.body[1].cracks_only);
		found_free(&f);
	}
}

/* A crack that is open by one ulp is open. */
static void nearly_collinear_is_no_crack(void **unused)
{
	struct found f = {0};

	(void)unused;
	box_with_divided_top(&f.soup, 2, 0x1p-52);
	found_look(&f, 100);
	assert_false(f.t.closed || f.t.cracks_only);
	found_free(&f);
}

/* Each of two bodies is judged by itself. */
static void bodies_are_judged_apart(void **unused)
{
	const double a[3] = {9, 0, 0}, m[3] = {10, 0, 0}, b[3] = {11, 0, 0};
	const double c[3] = {10, 2, 0}, d[3] = {10, 1, 5};
	struct found f = {0};

	(void)unused;
	soup_add(&f.soup, a, b, d); /* a tetrahedron a b c d with m on the edge a b */
	soup_add(&f.soup, b, c, d);
	soup_add(&f.soup, c, a, d);
	soup_add(&f.soup, a, c, m);
	soup_add(&f.soup, c, b, m);
	soup_cube(&f.soup, 0, 0, 0, 1);
	found_look(&f, 100);
	assert_true(f.t.cracks_only && f.t.body[0].cracks_only);
	assert_false(f.t.body[0].closed);
	assert_true(f.t.body[1].closed && !f.t.body[1].cracks_only);
	found_free(&f);
	soup_add(&f.soup, a, b, d);
	soup_add(&f.soup, b, c, d);
	soup_add(&f.soup, c, a, d);
	soup_add(&f.soup, a, c, m);
	soup_add(&f.soup, c, b, m);
	soup_cube(&f.soup, 0, 0, 0, 1);
	soup_drop(&f.soup, 16);
	found_look(&f, 100);
	assert_false(f.t.cracks_only || f.t.body[1].cracks_only);
	assert_true(f.t.body[0].cracks_only);
	found_free(&f);
}

/* The same wall twice the wrong way round is no crack: the excess has to cancel, not only match. */
static void orientation_counts(void **unused)
{
	struct found f = {0};

	(void)unused;
	box_with_divided_top(&f.soup, 3, 0);
	for (size_t i = 10; i < f.soup.count; i++)
		soup_flip(&f.soup, i);
	found_look(&f, 100);
	assert_false(f.t.cracks_only);
	found_free(&f);
}

/* Many lines through one point, each a slit, in less than quadratic time. */
static void one_vertex_bears_any_number_of_cracks(void **unused)
{
	enum { N = 20000 };
	const double o[3] = {0, 0, 0};
	struct found f = {0};

	(void)unused;
	for (int i = 0; i < N;
	     i++) { /* o p and o m p, m halfway: closed by a flat triangle's place */
		double p[3] = {2, 2 * i, 2}, m[3] = {1, i, 1}, q[3] = {2, 2 * i, 4};

		soup_add(&f.soup, o, p, q);
		soup_add(&f.soup, m, o, q);
		soup_add(&f.soup, p, m, q);
	}
	found_look(&f, 0);
	assert_int_equal(f.t.boundary_edges, 3 * N);
	assert_true(f.t.cracks_only);
	assert_int_equal(f.t.bodies, N);
	for (uint32_t b = 0; b < N; b++)
		assert_true(f.t.body[b].cracks_only);
	found_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_tube_without_caps_is_open),
	    cmocka_unit_test(t_junctions_are_cracks),
	    cmocka_unit_test(nearly_collinear_is_no_crack),
	    cmocka_unit_test(bodies_are_judged_apart),
	    cmocka_unit_test(orientation_counts),
	    cmocka_unit_test(one_vertex_bears_any_number_of_cracks),
	};

	return cmocka_run_group_tests_name("cracks", tests, NULL, NULL);
}
