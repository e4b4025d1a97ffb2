#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "alloc_fail.h"
#include "core/topology/topology.h"
#include "soup.h"

/* A polygon's corners in order, each edge with a triangle that has its tip far below. */
static void rim(struct soup *s, const double (*p)[3], size_t n)
{
	const double tip[3] = {p[0][0], p[0][1], p[0][2] - 1000};

	for (size_t i = 0; i < n; i++)
		soup_add(s, p[(i + 1) % n], p[i], tip);
}

static double relative(double x, double want)
{
	return fabs(x - want) / fabs(want);
}

/* ---- Junctions ---- */

enum { LENGTH = 64, LONG = 3 * LENGTH };

/*
 * The three edges of a triangle, each divided at the places of set bits on either side: the upper
 * side a fan to a tip above, the lower one to a tip below.  ${corner}: its corners, LENGTH steps
 * of whole numbers from each other.
 */
static void divided(struct soup *s, const double corner[3][3], const uint64_t bits[2][3])
{
	for (int side = 0; side < 2; side++) {
		const double tip[3] = {0.5, 0.25, side ? -900 : 1000};

		for (int e = 0; e < 3; e++) {
			const double *a = corner[e], *b = corner[(e + 1) % 3];
			double last[3];

			memcpy(last, a, sizeof last);
			for (int i = 1; i <= LENGTH; i++) {
				double v[3];

				if (i < LENGTH && !(bits[side][e] >> i & 1))
					continue;
				for (int k = 0; k < 3; k++)
					v[k] = a[k] + (b[k] - a[k]) * i / LENGTH;
				soup_add(s, side ? v : last, side ? last : v, tip);
				memcpy(last, v, sizeof last);
			}
		}
	}
}

static unsigned count_bits(uint64_t x)
{
	return (unsigned)__builtin_popcountll(x & ~(uint64_t)1);
}

/* On the same line and strictly between, for whole numbers. */
static bool lies_between(const double a[3], const double b[3], const double v[3])
{
	double dot = 0, length = 0;

	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		if ((b[i] - a[i]) * (v[j] - a[j]) != (b[j] - a[j]) * (v[i] - a[i]))
			return false;
		dot += (v[k] - a[k]) * (b[k] - a[k]);
		length += (b[k] - a[k]) * (b[k] - a[k]);
	}
	return 0 < dot && dot < length;
}

static void check_junction(const struct found *f, const struct mp_junction *j)
{
	double v[3], a[3], b[3];

	mp_vertices_get(f->built.vertices, j->vertex, v);
	mp_vertices_get(f->built.vertices, j->ends[0], a);
	mp_vertices_get(f->built.vertices, j->ends[1], b);
	assert_true(lies_between(a, b, v));
}

static void every_junction_of_a_crack_is_found(void **unused)
{
	uint64_t state = 5;

	(void)unused;
	for (int round = 0; round < 2000; round++) {
		struct found f = {0};
		double corner[3][3];
		uint64_t bits[2][3];
		unsigned want = 0, found = 0;

		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				corner[i][k] =
				    LENGTH * (double)(soup_random(&state) % 5 + (i == k ? 6 : 0)) -
				    (k == 2 ? 128 : 0);
		for (int e = 0; e < 3; e++) {
			for (int side = 0; side < 2; side++)
				bits[side][e] =
				    soup_random(&state) & soup_random(&state) & soup_random(&state);
			want += count_bits(bits[0][e] ^ bits[1][e]);
		}
		divided(&f.soup, (const double(*)[3])corner, (const uint64_t(*)[3])bits);
		soup_shuffle(&f.soup, &state);
		found_look(&f, 100);
		assert_true(f.t.closed || f.t.cracks_only);
		for (size_t i = 0; i < f.t.boundary_loops; i++) {
			const struct mp_loop *l = &f.t.loop[i];

			assert_true(l->crack && l->planar && l->area_defined && l->area == 0);
			for (size_t j = 0; j < l->junctions; j++)
				check_junction(&f, &f.t.junction[l->junction_at + j]);
			found += (unsigned)l->junctions;
		}
		if (!f.t.truncated) {
			assert_int_equal(found, want);
		}
		found_free(&f);
	}
}

/* More junctions than are listed. */
static void junctions_are_cut(void **unused)
{
	const double corner[3][3] = {{0, 0, 0}, {64, 0, 0}, {0, 64, 0}};
	const uint64_t bits[2][3] = {{UINT64_MAX - 1, UINT64_MAX - 1, 0}, {0, 0, 0}};
	struct found f = {0};

	(void)unused;
	divided(&f.soup, corner, bits);
	found_look(&f, 100);
	assert_int_equal(f.t.boundary_loops, 1);
	assert_int_equal(f.t.loop[0].junctions, MP_DEFECT_TRIANGLES);
	assert_true(f.t.loop[0].crack && f.t.truncated);
	found_free(&f);
}

/* A vertex an ulp beside the edge is no junction, and the loop no crack. */
static void beside_the_edge_is_no_junction(void **unused)
{
	const double a[3] = {0, 0, 0}, b[3] = {2, 2, 0}, m[3] = {1, 1 + 0x1p-52, 0};
	const double up[3] = {0, 1, 5}, down[3] = {0, 1, -5};
	struct found f = {0};

	(void)unused;
	soup_add(&f.soup, a, b, up);
	soup_add(&f.soup, b, m, down);
	soup_add(&f.soup, m, a, down);
	found_look(&f, 100);
	assert_int_equal(f.t.boundary_loops, 1);
	assert_int_equal(f.t.loop[0].junctions, 0);
	assert_false(f.t.loop[0].crack);
	found_free(&f);
}

/* ---- Measures ---- */

/* A flat rectangle in any attitude, far away: the bounds of the doubles it is stored in. */
static void a_tilted_hole_is_planar_within_the_files_rounding(void **unused)
{
	uint64_t state = 3;

	(void)unused;
	for (int round = 0; round < 200; round++) {
		double a = (double)(soup_random(&state) % 1000), b = a / 3 + 1, far = 1e4 * a;
		double u[3] = {cos(a), sin(a) * cos(b), sin(a) * sin(b)};
		double v[3] = {-sin(a), cos(a) * cos(b), cos(a) * sin(b)}, p[4][3];
		struct found f = {0};
		const struct mp_loop *l;

		for (int i = 0; i < 4; i++)
			for (int k = 0; k < 3; k++)
				p[i][k] = (float)(far + (i == 1 || i == 2 ? 30 : 0) * u[k] +
						  (i > 1 ? 20 : 0) * v[k]);
		rim(&f.soup, (const double(*)[3])p, 4);
		found_look(&f, 100);
		assert_int_equal(f.t.boundary_loops, 1);
		l = &f.t.loop[0];
		assert_true(l->simple && l->planar && l->plane_defined && l->area_defined);
		assert_true(l->plane_deviation <= 0x1p-23 * (far + 100));
		assert_true(relative(l->area, 600) <= 0x1p-20 * (far + 100) / 10);
		assert_true(relative(l->length, 100) <= 0x1p-20 * (far + 100) / 10);
		found_free(&f);
	}
}

static void a_saddle_is_not_planar(void **unused)
{
	const double p[4][3] = {{0, 0, 1}, {2, 0, -1}, {2, 2, 1}, {0, 2, -1}};
	const double low[3] = {0, 0, -1}, high[3] = {2, 2, 1};
	struct found f = {0};

	(void)unused;
	rim(&f.soup, p, 4);
	found_look(&f, 100);
	assert_false(f.t.loop[0].planar || f.t.loop[0].crack);
	assert_true(f.t.loop[0].plane_deviation == 1);
	assert_true(f.t.loop[0].area == 4);
	assert_true(relative(f.t.loop[0].length, 4 * sqrt(8)) < 1e-15);
	assert_memory_equal(f.t.loop[0].min, low, sizeof low);
	assert_memory_equal(f.t.loop[0].max, high, sizeof high);
	found_free(&f);
}

/* A hole no wider than a unit, ten million units away, in doubles. */
static void a_small_hole_far_away_keeps_its_digits(void **unused)
{
	static const double eighths[8][2] = {{2, 0}, {6, 0}, {8, 2}, {8, 6},
					     {6, 8}, {2, 8}, {0, 6}, {0, 2}};
	struct found f = {0};
	double p[8][3];

	(void)unused;
	for (int i = 0; i < 8; i++) {
		p[i][0] = 1e7 + eighths[i][0] / 8;
		p[i][1] = -2e7 + eighths[i][1] / 8;
		p[i][2] = 3e7;
	}
	rim(&f.soup, (const double(*)[3])p, 8);
	found_look(&f, 100);
	assert_true(f.t.loop[0].simple && f.t.loop[0].planar);
	assert_true(f.t.loop[0].plane_deviation == 0);
	assert_true(f.t.loop[0].area == 0.875);
	assert_true(relative(f.t.loop[0].length, 2 + sqrt(2)) < 1e-15);
	found_free(&f);
}

static void extremes_are_left_out_not_made_up(void **unused)
{
	const double big[3][3] = {{-1e308, -1e308, 0}, {1e308, -1e308, 0}, {0, 1e308, 0}};
	const double small[3][3] = {{0, 0, 0}, {1e-300, 0, 0}, {0, 1e-300, 0}};
	struct found f = {0}, g = {0};

	(void)unused;
	soup_add(&f.soup, big[0], big[1], big[2]);
	found_look(&f, 100);
	assert_false(f.t.loop[0].length_defined || f.t.loop[0].area_defined);
	assert_true(f.t.loop[0].length == 0 && f.t.loop[0].area == 0);
	assert_true(f.t.loop[0].min[0] == -1e308 && f.t.loop[0].max[1] == 1e308);
	found_free(&f);
	soup_add(&g.soup, small[0], small[1], small[2]);
	found_look(&g, 100);
	assert_true(g.t.loop[0].length_defined && g.t.loop[0].length > 3e-300);
	assert_false(g.t.loop[0].area_defined);
	found_free(&g);
}

/* Only as many loops as are listed are measured, the first ones. */
static void as_many_loops_as_are_listed_are_measured(void **unused)
{
	struct found f = {0};

	(void)unused;
	for (int i = 0; i < 10; i++) {
		const double a[3] = {10.0 * i, 0, 0}, b[3] = {10.0 * i + 3, 0, 0},
			     c[3] = {10.0 * i, 4, 0};

		soup_add(&f.soup, a, b, c);
	}
	found_look(&f, 4);
	assert_int_equal(f.t.boundary_loops, 10);
	assert_int_equal(f.t.defect[MP_DEFECT_BOUNDARY_LOOP].count, 4);
	for (int i = 0; i < 4; i++) {
		assert_true(f.t.loop[i].min[0] == 10 * i);
		assert_true(f.t.loop[i].length == 12 && f.t.loop[i].area == 6);
	}
	found_free(&f);
	f = (struct found){0};
	found_free(&f);
}

/* ---- Walls ---- */

/* ${n} boxes in a row along x; ${walls}: how many sides the face between two has. */
static void row_of_boxes(struct soup *s, int n, int walls)
{
	for (int i = 0; i < n; i++) {
		struct soup one = {0};

		soup_cube(&one, i, 0, 0, 1); /* 0, 1: x min, 2, 3: x max */
		for (size_t t = 0; t < one.count; t++) {
			bool left = t < 2 && i > 0, right = (t == 2 || t == 3) && i < n - 1;

			if ((left && walls < 2) || (right && walls < 1))
				continue;
			soup_add(s, one.tri[t], one.tri[t] + 3, one.tri[t] + 6);
		}
		soup_free(&one);
	}
}

static void walls_are_counted_whatever_the_order(void **unused)
{
	uint64_t state = 11;

	(void)unused;
	for (int round = 0; round < 300; round++) {
		int n = 2 + round % 5, walls = round % 3;
		struct found f = {0};

		row_of_boxes(&f.soup, n, walls);
		soup_shuffle(&f.soup, &state);
		found_look(&f, 100);
		assert_int_equal(f.t.double_walls, walls == 2 ? n - 1 : 0);
		assert_int_equal(f.t.single_walls, walls == 1 ? n - 1 : 0);
		assert_int_equal(f.t.opposite_duplicates, walls == 2 ? 2 * (n - 1) : 0);
		assert_int_equal(f.t.closed, walls != 1);
		assert_int_equal(f.t.boundary_edges, 0);
		found_free(&f);
	}
}

/* A rim of the mesh elsewhere, whichever triangle comes first. */
static void a_hole_elsewhere_hides_no_double_wall(void **unused)
{
	const double a[3] = {100, 0, 0}, b[3] = {101, 0, 0}, c[3] = {100, 1, 0};
	uint64_t state = 13;

	(void)unused;
	for (int round = 0; round < 100; round++) {
		struct found f = {0};

		row_of_boxes(&f.soup, 3, 2);
		soup_add(&f.soup, a, b, c);
		soup_shuffle(&f.soup, &state);
		found_look(&f, 100);
		assert_int_equal(f.t.boundary_edges, 3);
		assert_int_equal(f.t.double_walls, 2);
		found_free(&f);
	}
}

/* Walls that meet in a line are one; a wall with a hole in it is none, nor is one over a hole. */
static void what_is_no_wall(void **unused)
{
	struct found f = {0}, g = {0}, h = {0}, again = {0};

	(void)unused;
	for (int i = 0; i < 4; i++)
		soup_cube(&f.soup, i % 2, i / 2, 0, 1);
	found_look(&f, 100);
	assert_int_equal(f.t.double_walls, 1);
	assert_true(f.t.closed);
	found_free(&f);

	row_of_boxes(&g.soup, 2, 1);
	soup_drop(&g.soup, 2); /* half of the single wall */
	found_look(&g, 100);
	assert_int_equal(g.t.boundary_edges, 1);
	assert_int_equal(g.t.single_walls, 0);
	found_free(&g);

	soup_cube(&h.soup, 0, 0, 0, 1);
	soup_add(&h.soup, h.soup.tri[0] + 3, h.soup.tri[0], h.soup.tri[0] + 6);
	found_look(&h, 100);
	assert_int_equal(h.t.opposite_duplicates, 1);
	assert_int_equal(h.t.double_walls + h.t.single_walls, 0);
	found_free(&h);

	row_of_boxes(&again.soup, 2, 1); /* a single wall of which half is there twice */
	for (size_t i = 0, n = again.soup.count; i < n; i++) {
		double v[9];

		memcpy(v, again.soup.tri[i], sizeof v);
		if (v[0] == 1 && v[3] == 1 && v[6] == 1)
			soup_add(&again.soup, v, v + 3, v + 6);
	}
	found_look(&again, 100);
	assert_int_equal(again.t.duplicate_triangles, 2);
	assert_int_equal(again.t.single_walls, 1);
	assert_int_equal(again.t.double_walls, 0);
	found_free(&again);
}

/* ---- Memory ---- */

static void every_allocation_may_fail(void **unused)
{
	const double corner[3][3] = {{0, 0, 0}, {64, 0, 0}, {0, 64, 0}};
	const uint64_t bits[2][3] = {{2, 4, 8}, {16, 0, 32}};
	const double beside[3] = {1000, 0, 0}, behind[3] = {1000, 1000, 0};
	struct soup more = {0};
	struct found f = {0};
	long n = 1;

	(void)unused;
	divided(&f.soup, corner, bits);
	row_of_boxes(&more, 3, 2);
	soup_copy(&f.soup, &more, 1, beside);
	soup_free(&more);
	row_of_boxes(&more, 2, 1);
	soup_copy(&f.soup, &more, 1, behind);
	soup_free(&more);
	assert_int_equal(soup_build(&f.soup, 9, &f.built, NULL), 0);
	for (;; n++) {
		struct mp_error err = {0};
		long before = alloc_count();
		int ret;

		alloc_fail_at(n);
		ret = mp_topology_find(&f.built.mesh, 100, &f.t, &err);
		alloc_fail_at(0);
		if (alloc_count() - before < n) /* none failed */
			break;
		if (ret != 0)
			assert_int_equal(err.code, MP_NOMEM);
		mp_topology_free(&f.t); /* one that only gives memory back may fail unnoticed */
	}
	assert_true(n > 30);
	assert_true(f.t.loop[0].junctions > 1);
	assert_true(f.t.double_walls == 2 && f.t.single_walls == 1);
	found_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_junction_of_a_crack_is_found),
	    cmocka_unit_test(junctions_are_cut),
	    cmocka_unit_test(beside_the_edge_is_no_junction),
	    cmocka_unit_test(a_tilted_hole_is_planar_within_the_files_rounding),
	    cmocka_unit_test(a_saddle_is_not_planar),
	    cmocka_unit_test(a_small_hole_far_away_keeps_its_digits),
	    cmocka_unit_test(extremes_are_left_out_not_made_up),
	    cmocka_unit_test(as_many_loops_as_are_listed_are_measured),
	    cmocka_unit_test(walls_are_counted_whatever_the_order),
	    cmocka_unit_test(a_hole_elsewhere_hides_no_double_wall),
	    cmocka_unit_test(what_is_no_wall),
	    cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
