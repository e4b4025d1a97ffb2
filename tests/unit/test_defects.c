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

/* The loop of a missing facet is a triangle against its direction; any hole is one loop. */
static void a_missing_facet_is_a_loop(void **unused)
{
	struct found f = {0};
	const struct mp_defect_list *l;

	(void)unused;
	soup_cube(&f.soup, 0, 0, 0, 1);
	soup_cube(&f.soup, 5, 0, 0, 1);
	soup_drop(&f.soup, 0); /* 23 is 0 now */
	found_look(&f, 100);
	assert_int_equal(f.t.boundary_edges, 3);
	assert_int_equal(f.t.boundary_loops, 1);
	assert_int_equal(f.t.bodies, 2);
	assert_false(f.t.closed || f.t.watertight || f.t.cracks_only);
	assert_true(f.t.winding_consistent);
	assert_true(f.t.body[0].closed);
	assert_false(f.t.body[1].closed || f.t.body[1].watertight);
	assert_int_equal(f.t.body[1].boundary_edges, 3);
	assert_int_equal(f.t.body[1].first, 1);
	assert_int_equal(f.t.body[1].triangles, 11);
	l = &f.t.defect[MP_DEFECT_BOUNDARY_LOOP];
	assert_int_equal(l->count, 1);
	assert_int_equal(l->vertex_at[1], 3);
	assert_int_equal(l->triangle_at[1], 3);
	l = &f.t.defect[MP_DEFECT_BOUNDARY_EDGE];
	assert_int_equal(l->count, 3);
	for (size_t i = 0; i < 3; i++) { /* both ends are next to each other in that triangle */
		const uint32_t *v = f.built.tri[l->triangles[i]];
		int at = 0;

		while (v[at] != l->vertices[2 * i])
			at++;
		assert_int_equal(v[(at + 1) % 3], l->vertices[2 * i + 1]);
		assert_true(i == 0 || l->triangles[i] >= l->triangles[i - 1]);
	}
	found_free(&f);
}

static void both_kinds_of_degenerate_triangles(void **unused)
{
	const double a[3] = {0, 0, 0}, b[3] = {1, 1, 1}, c[3] = {3, 3, 3};
	const double d[3] = {3, 3, nextafter(3, 4)};
	struct found f = {0};

	(void)unused;
	soup_cube(&f.soup, 9, 9, 9, 1);
	soup_add(&f.soup, a, b, c); /* has edges */
	soup_add(&f.soup, a, b, d); /* has area */
	soup_add(&f.soup, a, b, b); /* has neither */
	found_look(&f, 100);
	assert_int_equal(f.t.degenerate_triangles, 2);
	assert_int_equal(f.t.faces, 14);
	assert_int_equal(f.t.bodies, 2);
	assert_int_equal(f.t.body_of[14], MP_NO_BODY);
	assert_int_equal(f.t.defect[MP_DEFECT_DEGENERATE_TRIANGLE].triangles[0], 12);
	assert_int_equal(f.t.defect[MP_DEFECT_DEGENERATE_TRIANGLE].triangles[1], 14);
	assert_int_equal(f.t.defect[MP_DEFECT_DEGENERATE_TRIANGLE].vertex_at[2], 6);
	assert_int_equal(f.t.duplicate_triangles, 0);
	found_free(&f);
}

static void duplicates_are_found_in_any_order_of_corners(void **unused)
{
	const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0}, d[3] = {0, 0, 1};
	const uint32_t want[6] = {0, 2, 0, 3, 1, 4};
	struct found f = {0};

	(void)unused;
	soup_add(&f.soup, a, b, c);
	soup_add(&f.soup, a, b, d);
	soup_add(&f.soup, c, b, a);
	soup_add(&f.soup, b, c, a);
	soup_add(&f.soup, d, a, b);
	found_look(&f, 100);
	assert_int_equal(f.t.duplicate_triangles, 3);
	assert_int_equal(f.t.defect[MP_DEFECT_DUPLICATE_TRIANGLE].count, 3);
	assert_memory_equal(f.t.defect[MP_DEFECT_DUPLICATE_TRIANGLE].triangles, want, sizeof want);
	found_free(&f);
}

/* The first of everything, by smallest triangle, and a word that it is not all. */
static void lists_end_where_they_were_told_to(void **unused)
{
	struct found f = {0};
	struct mp_topology t;

	(void)unused;
	for (int i = 0; i < 40; i++) { /* every second with a facet missing, others repeated */
		soup_tetrahedron(&f.soup, 3.0 * i, 0, 0, 1);
		if (i % 2)
			soup_drop(&f.soup, f.soup.count - 1);
		else
			soup_add(&f.soup, f.soup.tri[f.soup.count - 1],
				 f.soup.tri[f.soup.count - 1] + 3,
				 f.soup.tri[f.soup.count - 1] + 6);
	}
	found_look(&f, 1000);
	assert_int_equal(f.t.boundary_loops, 20);
	assert_int_equal(f.t.non_manifold_edges, 60);
	assert_int_equal(f.t.duplicate_triangles, 20);
	assert_false(f.t.truncated);
	for (uint32_t most = 0; most < 70; most += 3) {
		assert_int_equal(mp_topology_find(&f.built.mesh, most, &t, NULL), 0);
		assert_int_equal(t.truncated, most < 60);
		for (int k = 0; k < MP_DEFECT_KINDS; k++) {
			const struct mp_defect_list *all = &f.t.defect[k], *l = &t.defect[k];
			size_t n = all->count < most ? all->count : most;

			assert_int_equal(l->count, n);
			assert_memory_equal(l->triangle_at, all->triangle_at,
					    (n + 1) * sizeof *l->triangle_at);
			assert_memory_equal(l->vertex_at, all->vertex_at,
					    (n + 1) * sizeof *l->vertex_at);
			assert_memory_equal(l->triangles, all->triangles,
					    l->triangle_at[n] * sizeof *l->triangles);
			assert_memory_equal(l->vertices, all->vertices,
					    l->vertex_at[n] * sizeof *l->vertices);
			for (size_t i = 1; i < n; i++)
				assert_true(l->triangles[l->triangle_at[i - 1]] <=
					    l->triangles[l->triangle_at[i]]);
		}
		mp_topology_free(&t);
	}
	found_free(&f);
}

/* 200,000 triangles on one edge, every tenth twice; in less than quadratic time. */
static void one_edge_bears_any_number_of_triangles(void **unused)
{
	enum { N = 200000 };
	const double a[3] = {0, 0, 0}, b[3] = {0, 0, 1};
	struct found f = {0};

	(void)unused;
	for (int i = 0; i < N; i++) {
		double p[3] = {1, i % (N - N / 10), 0};

		soup_add(&f.soup, i % 2 ? a : b, i % 2 ? b : a, p);
	}
	found_look(&f, 100);
	assert_int_equal(f.t.bodies, 1);
	assert_int_equal(f.t.duplicate_triangles, N / 10);
	assert_int_equal(f.t.non_manifold_edges, 1);
	assert_int_equal(f.t.edges, 1 + 2 * (N - N / 10));
	assert_int_equal(f.t.non_manifold_vertices, 0);
	assert_int_equal(f.t.defect[MP_DEFECT_NON_MANIFOLD_EDGE].triangle_at[1],
			 MP_DEFECT_TRIANGLES);
	assert_true(f.t.truncated);
	found_free(&f);
}

/* 100,000 loose triangles around one vertex: one loop that is no circle, 100,000 fans. */
static void one_vertex_bears_any_number_of_fans(void **unused)
{
	enum { N = 100000 };
	const double o[3] = {0, 0, 0};
	struct found f = {0};
	const struct mp_defect_list *l;

	(void)unused;
	for (int i = 0; i < N; i++) {
		double p[3] = {1, 2 * i, 0}, q[3] = {1, 2 * i + 1, 0};

		soup_add(&f.soup, o, p, q);
	}
	found_look(&f, 100);
	assert_int_equal(f.t.bodies, N);
	assert_int_equal(f.t.non_manifold_vertices, 1);
	assert_int_equal(f.t.boundary_edges, 3 * N);
	assert_int_equal(f.t.boundary_loops, 1);
	assert_false(f.t.cracks_only);
	l = &f.t.defect[MP_DEFECT_NON_MANIFOLD_VERTEX];
	assert_int_equal(l->triangle_at[1], MP_DEFECT_TRIANGLES);
	l = &f.t.defect[MP_DEFECT_BOUNDARY_LOOP];
	assert_int_equal(l->triangle_at[1], MP_DEFECT_TRIANGLES);
	assert_int_equal(l->vertex_at[1], MP_DEFECT_VERTICES);
	for (size_t i = 0; i < MP_DEFECT_VERTICES; i++) /* file order */
		assert_int_equal(l->vertices[i], i);
	found_free(&f);
}

/* The rim of a long tube is listed in order as far as it may be. */
static void a_long_loop_is_walked_and_cut(void **unused)
{
	uint64_t state = 3;
	struct found f = {0};
	const struct mp_defect_list *l;

	(void)unused;
	soup_tube(&f.soup, 1500, 7);
	soup_tube(&f.soup, 1000, 3);
	soup_shuffle(&f.soup, &state);
	found_look(&f, 100);
	l = &f.t.defect[MP_DEFECT_BOUNDARY_LOOP];
	assert_int_equal(l->count, 4);
	assert_true(f.t.truncated);
	for (size_t i = 0; i < 4; i++) {
		size_t n = l->vertex_at[i + 1] - l->vertex_at[i];
		const uint32_t *v = l->vertices + l->vertex_at[i];
		double p[3], q[3];

		assert_true(n == 1000 || n == MP_DEFECT_VERTICES);
		mp_vertices_get(f.built.vertices, v[0], p);
		for (size_t j = 1; j < n + (n == 1000); j++) {
			double far = n == 1000 ? 0.02 : 0.03;

			mp_vertices_get(f.built.vertices, v[j % n], q);
			assert_true(p[2] == q[2]);
			assert_true(hypot(p[0] - q[0], p[1] - q[1]) < far);
			memcpy(p, q, sizeof p);
		}
	}
	found_free(&f);
}

/* Two holes that touch in a vertex are one loop but no circle: every vertex once. */
static void touching_holes_are_one_loop(void **unused)
{
	struct found f = {0};
	const struct mp_defect_list *l;
	int seen[25] = {0};

	(void)unused;
	for (int i = 0; i < 16; i++) {
		int column = i % 4, row = i / 4;
		double x = column, y = row;
		double p[4][3] = {{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}};

		if (i == 5 || i == 10)
			continue;
		soup_add(&f.soup, p[0], p[1], p[2]);
		soup_add(&f.soup, p[0], p[2], p[3]);
	}
	found_look(&f, 100);
	l = &f.t.defect[MP_DEFECT_BOUNDARY_LOOP];
	assert_int_equal(f.t.boundary_loops, 2);
	assert_int_equal(f.t.boundary_edges, 16 + 8);
	assert_int_equal(f.t.non_manifold_vertices, 1);
	assert_int_equal(l->count, 2);
	assert_int_equal(l->vertex_at[1], 16);
	assert_int_equal(l->vertex_at[2] - l->vertex_at[1], 7);
	for (size_t i = 16; i < 23; i++)
		assert_int_equal(seen[l->vertices[i]]++, 0);
	found_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_missing_facet_is_a_loop),
	    cmocka_unit_test(both_kinds_of_degenerate_triangles),
	    cmocka_unit_test(duplicates_are_found_in_any_order_of_corners),
	    cmocka_unit_test(lists_end_where_they_were_told_to),
	    cmocka_unit_test(one_edge_bears_any_number_of_triangles),
	    cmocka_unit_test(one_vertex_bears_any_number_of_fans),
	    cmocka_unit_test(a_long_loop_is_walked_and_cut),
	    cmocka_unit_test(touching_holes_are_one_loop),
	};

	return cmocka_run_group_tests_name("defects", tests, NULL, NULL);
}
