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
#include "topology_reference.h"

#define CHECK_SAME(a, b, field) assert_int_equal((a)->field, (b)->field)

static void same_counts(const struct mp_topology *a, const struct mp_topology *b)
{
	CHECK_SAME(a, b, vertices);
	CHECK_SAME(a, b, edges);
	CHECK_SAME(a, b, faces);
	CHECK_SAME(a, b, euler);
	CHECK_SAME(a, b, boundary_edges);
	CHECK_SAME(a, b, boundary_loops);
	CHECK_SAME(a, b, non_manifold_edges);
	CHECK_SAME(a, b, misoriented_edges);
	CHECK_SAME(a, b, non_manifold_vertices);
	CHECK_SAME(a, b, degenerate_triangles);
	CHECK_SAME(a, b, duplicate_triangles);
	CHECK_SAME(a, b, closed);
	CHECK_SAME(a, b, cracks_only);
	CHECK_SAME(a, b, watertight);
	CHECK_SAME(a, b, winding_consistent);
	CHECK_SAME(a, b, bodies);
}

static void same_bodies(const struct mp_mesh *m, const struct mp_topology *a,
			const struct mp_topology *b)
{
	for (uint32_t i = 0; i < a->bodies; i++) {
		CHECK_SAME(&a->body[i], &b->body[i], first);
		CHECK_SAME(&a->body[i], &b->body[i], triangles);
		CHECK_SAME(&a->body[i], &b->body[i], boundary_edges);
		CHECK_SAME(&a->body[i], &b->body[i], non_manifold_edges);
		CHECK_SAME(&a->body[i], &b->body[i], misoriented_edges);
		CHECK_SAME(&a->body[i], &b->body[i], closed);
		CHECK_SAME(&a->body[i], &b->body[i], cracks_only);
		CHECK_SAME(&a->body[i], &b->body[i], watertight);
	}
	assert_memory_equal(a->body_of, b->body_of, m->triangles * sizeof *a->body_of);
}

static void a_cube_is_watertight(void **unused)
{
	struct found f = {0};

	(void)unused;
	soup_cube(&f.soup, 0, 0, 0, 1);
	found_look(&f, 100);
	assert_true(f.t.closed && f.t.watertight && f.t.winding_consistent);
	assert_false(f.t.cracks_only || f.t.truncated);
	assert_int_equal(f.t.vertices, 8);
	assert_int_equal(f.t.edges, 18);
	assert_int_equal(f.t.faces, 12);
	assert_int_equal(f.t.euler, 2);
	assert_int_equal(f.t.bodies, 1);
	assert_true(f.t.body[0].closed && f.t.body[0].watertight);
	for (int k = 0; k < MP_DEFECT_KINDS; k++)
		assert_int_equal(f.t.defect[k].count, 0);
	found_free(&f);
}

static void nothing_is_neither_closed_nor_a_body(void **unused)
{
	const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0};
	struct found f = {0}, g = {0};

	(void)unused;
	found_look(&f, 100);
	assert_false(f.t.closed || f.t.watertight || f.t.cracks_only);
	assert_int_equal(f.t.bodies + f.t.edges + f.t.vertices, 0);
	found_free(&f);
	soup_add(&g.soup, a, a, b); /* no edges */
	found_look(&g, 100);
	assert_false(g.t.closed || g.t.watertight || g.t.cracks_only);
	assert_int_equal(g.t.bodies + g.t.edges + g.t.vertices + g.t.faces, 0);
	assert_int_equal(g.t.body_of[0], MP_NO_BODY);
	assert_int_equal(g.t.degenerate_triangles, 1);
	found_free(&g);
}

static void boxes_that_share_an_edge_are_closed(void **unused)
{
	const double min[3] = {1, 1, 0}, max[3] = {2, 2, 1};
	struct found f = {0};
	const struct mp_defect_list *l;

	(void)unused;
	soup_cube(&f.soup, 0, 0, 0, 1);
	soup_box(&f.soup, min, max);
	found_look(&f, 100);
	assert_int_equal(f.t.faces, 24);
	assert_int_equal(f.t.vertices, 14);
	assert_int_equal(f.t.edges, 35);
	assert_int_equal(f.t.euler, 3);
	assert_true(f.t.closed && f.t.winding_consistent);
	assert_false(f.t.watertight || f.t.cracks_only);
	assert_int_equal(f.t.non_manifold_edges, 1);
	assert_int_equal(f.t.non_manifold_vertices, 0);
	assert_int_equal(f.t.bodies, 1);
	l = &f.t.defect[MP_DEFECT_NON_MANIFOLD_EDGE];
	assert_int_equal(l->count, 1);
	assert_int_equal(l->triangle_at[1], 4);
	assert_int_equal(l->vertex_at[1], 2);
	assert_true(l->vertices[0] < l->vertices[1]);
	for (size_t i = 1; i < 4; i++)
		assert_true(l->triangles[i - 1] < l->triangles[i]);
	found_free(&f);
}

static void boxes_that_share_a_face_are_closed(void **unused)
{
	struct found f = {0};

	(void)unused;
	soup_cube(&f.soup, 0, 0, 0, 1);
	soup_cube(&f.soup, 1, 0, 0, 1);
	found_look(&f, 100);
	assert_int_equal(f.t.vertices, 12);
	assert_int_equal(f.t.edges, 31);
	assert_int_equal(f.t.euler, 5);
	assert_true(f.t.closed);
	assert_false(f.t.watertight);
	assert_int_equal(f.t.non_manifold_edges, 5); /* the rim and the diagonal */
	assert_int_equal(f.t.duplicate_triangles, 2);
	assert_int_equal(f.t.bodies, 1);
	assert_int_equal(f.t.defect[MP_DEFECT_DUPLICATE_TRIANGLE].count, 2);
	assert_int_equal(f.t.defect[MP_DEFECT_DUPLICATE_TRIANGLE].triangles[0], 2);
	assert_int_equal(f.t.defect[MP_DEFECT_DUPLICATE_TRIANGLE].triangle_at[2], 4);
	found_free(&f);
}

static void boxes_that_share_a_vertex_are_two_fans(void **unused)
{
	struct found f = {0};
	const struct mp_defect_list *l;

	(void)unused;
	soup_cube(&f.soup, 0, 0, 0, 1);
	soup_cube(&f.soup, 1, 1, 1, 1);
	found_look(&f, 100);
	assert_true(f.t.closed && f.t.watertight);
	assert_int_equal(f.t.non_manifold_vertices, 1);
	assert_int_equal(f.t.bodies, 2);
	assert_int_equal(f.t.euler, 3);
	l = &f.t.defect[MP_DEFECT_NON_MANIFOLD_VERTEX];
	assert_int_equal(l->count, 1);
	assert_int_equal(l->vertex_at[1], 1);
	for (size_t i = 0; i < l->triangle_at[1]; i++) {
		const uint32_t *v = f.built.tri[l->triangles[i]];

		assert_true(v[0] == l->vertices[0] || v[1] == l->vertices[0] ||
			    v[2] == l->vertices[0]);
		assert_true(i == 0 || l->triangles[i - 1] < l->triangles[i]);
	}
	assert_int_equal(l->triangle_at[1], 12); /* both ends of the diagonals: 6 each */
	found_free(&f);
}

static void a_flipped_facet_is_misoriented(void **unused)
{
	struct found f = {0};
	const struct mp_defect_list *l;

	(void)unused;
	soup_cube(&f.soup, 0, 0, 0, 1);
	soup_flip(&f.soup, 4);
	found_look(&f, 100);
	assert_int_equal(f.t.misoriented_edges, 3);
	assert_true(f.t.watertight);
	assert_false(f.t.closed || f.t.winding_consistent || f.t.cracks_only);
	l = &f.t.defect[MP_DEFECT_MISORIENTED_EDGE];
	assert_int_equal(l->count, 3);
	for (size_t i = 0; i < 3; i++) /* the direction is that of both triangles */
		for (size_t j = 0; j < 2; j++) {
			const uint32_t *v = f.built.tri[l->triangles[2 * i + j]];
			int at = 0;

			while (v[at] != l->vertices[2 * i])
				at++;
			assert_int_equal(v[(at + 1) % 3], l->vertices[2 * i + 1]);
		}
	found_free(&f);
}

/* A strip of 2 n triangles whose ends are joined with half a turn, on a Moebius band. */
static void a_moebius_strip_is_one_sided(void **unused)
{
	enum { N = 9 };
	struct found f = {0};
	double p[2 * N][3];

	(void)unused;
	for (int i = 0; i < N; i++) {
		for (int s = 0; s < 2; s++) {
			double u = 6.283185307179586 * i / N, w = s ? 0.3 : -0.3;

			p[2 * i + s][0] = (1 + w * cos(u / 2)) * cos(u);
			p[2 * i + s][1] = (1 + w * cos(u / 2)) * sin(u);
			p[2 * i + s][2] = w * sin(u / 2);
		}
	}
	for (int i = 0; i < N; i++) {
		int last = i == N - 1;
		const double *a = p[2 * i], *b = p[2 * i + 1];
		const double *c = p[last ? 1 : 2 * i + 2], *d = p[last ? 0 : 2 * i + 3];

		soup_add(&f.soup, a, c, b);
		soup_add(&f.soup, b, c, d);
	}
	found_look(&f, 100);
	assert_int_equal(f.t.boundary_edges, 2 * N);
	assert_int_equal(f.t.boundary_loops, 1);
	assert_int_equal(f.t.misoriented_edges, 1);
	assert_int_equal(f.t.euler, 0);
	assert_int_equal(f.t.defect[MP_DEFECT_BOUNDARY_LOOP].vertex_at[1], 2 * N);
	assert_false(f.t.closed || f.t.cracks_only);
	found_free(&f);
}

static void every_count_agrees_with_the_definitions(void **unused)
{
	uint64_t state = 4242;

	(void)unused;
	for (int round = 0; round < 4000; round++) {
		struct found f = {0};
		struct mp_topology want;
		double size = (double)(1 + soup_random(&state) % 3);

		if (round % 2)
			soup_cube(&f.soup, 0, 0, 0, size);
		if (round % 3)
			soup_tetrahedron(&f.soup, (double)(soup_random(&state) % 3), 0, 0, 2);
		for (uint64_t i = soup_random(&state) % 9; i-- > 0;) { /* surgery */
			double p[9];
			size_t t = f.soup.count ? soup_random(&state) % f.soup.count : 0;
			uint64_t what = f.soup.count ? soup_random(&state) % 4 : 3;

			for (int k = 0; k < 9; k++)
				p[k] = what == 0 ? f.soup.tri[t][k]
						 : (double)(soup_random(&state) % (k % 3 ? 3 : 2));
			if (what == 1)
				soup_drop(&f.soup, t);
			else if (what == 2)
				soup_flip(&f.soup, t);
			else
				soup_add(&f.soup, p, p + 3, p + 6);
		}
		soup_shuffle(&f.soup, &state);
		found_look(&f, 1000);
		reference_topology(&f.built.mesh, &want);
		same_counts(&f.t, &want);
		same_bodies(&f.built.mesh, &f.t, &want);
		mp_topology_free(&want);
		found_free(&f);
	}
}

static void order_and_key_change_no_count(void **unused)
{
	uint64_t state = 31337;
	struct found f = {0};

	(void)unused;
	soup_torus(&f.soup, 20, 12, 5, 1);
	soup_tube(&f.soup, 30, 9);
	soup_cube(&f.soup, 20, 0, 0, 1);
	soup_cube(&f.soup, 21, 0, 0, 1);
	soup_drop(&f.soup, 3);
	soup_flip(&f.soup, 100);
	found_look(&f, 10);
	for (uint64_t key = 1; key < 20; key++) {
		struct built b;
		struct mp_topology t;

		soup_shuffle(&f.soup, &state);
		assert_int_equal(soup_build(&f.soup, key, &b, NULL), 0);
		assert_int_equal(mp_topology_find(&b.mesh, 10, &t, NULL), 0);
		same_counts(&t, &f.t);
		mp_topology_free(&t);
		built_free(&b);
	}
	found_free(&f);
}

static void a_failed_allocation_leaves_nothing(void **unused)
{
	struct found f = {0};
	long total, failures = 0;

	(void)unused;
	soup_tube(&f.soup, 30, 1);
	soup_cube(&f.soup, 20, 0, 0, 1);
	soup_cube(&f.soup, 21, 0, 0, 1);
	soup_cube(&f.soup, 22, 1, 1, 1);
	soup_drop(&f.soup, 3);
	soup_flip(&f.soup, 10);
	total = -alloc_count();
	found_look(&f, 50);
	total += alloc_count();
	mp_topology_free(&f.t);
	for (long n = 1; n <= total; n++) {
		struct mp_error err = {.code = MP_OK};
		bool failed;

		alloc_fail_at(n);
		failed = mp_topology_find(&f.built.mesh, 50, &f.t, &err) != 0;
		alloc_fail_at(0);
		assert_int_equal(err.code, failed ? MP_NOMEM : MP_OK);
		if (failed)
			assert_null(f.t.body);
		mp_topology_free(&f.t);
		failures += failed;
	}
	assert_true(failures > 30); /* all but giving memory back */
	found_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_cube_is_watertight),
	    cmocka_unit_test(nothing_is_neither_closed_nor_a_body),
	    cmocka_unit_test(boxes_that_share_an_edge_are_closed),
	    cmocka_unit_test(boxes_that_share_a_face_are_closed),
	    cmocka_unit_test(boxes_that_share_a_vertex_are_two_fans),
	    cmocka_unit_test(a_flipped_facet_is_misoriented),
	    cmocka_unit_test(a_moebius_strip_is_one_sided),
	    cmocka_unit_test(every_count_agrees_with_the_definitions),
	    cmocka_unit_test(order_and_key_change_no_count),
	    cmocka_unit_test(a_failed_allocation_leaves_nothing),
	};

	return cmocka_run_group_tests_name("topology", tests, NULL, NULL);
}
