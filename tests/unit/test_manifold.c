#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "alloc_fail.h"
#include "core/topology/topology_parts.h"
#include "soup.h"
#include "topology_reference.h"

static const struct mp_manifold_room roomy = {.vertices = 1 << 14, .links = 1 << 22};

/*
 * Who watches: every vertex once, ascending in a window, with all its links in the order of the
 * triangles.
 */
struct watch {
	const struct mp_mesh *mesh;
	uint32_t window; /* vertices */
	size_t windows;
	uint32_t *seen; /* of each window */
	bool wrong, ended, all;
};

static int begin_links(void *self, size_t windows)
{
	struct watch *w = self;

	w->windows = windows;
	w->seen = calloc(windows + 1, sizeof *w->seen);
	return w->seen == NULL ? -1 : 0;
}

static void end_links(void *self, bool all)
{
	struct watch *w = self;

	w->wrong = w->wrong || w->ended;
	w->ended = true;
	w->all = all;
}

static void check_links(void *self, size_t window, const struct mp_links *l)
{
	struct watch *w = self;
	uint32_t *at = malloc(((size_t)l->count + 1) * sizeof *at);

	assert_non_null(at);
	w->wrong =
	    w->wrong || window >= w->windows || l->first != window * w->window + w->seen[window];
	w->seen[window] += l->count;
	memcpy(at, l->row, ((size_t)l->count + 1) * sizeof *at);
	for (uint32_t t = 0; t < w->mesh->triangles; t++) {
		const uint32_t *v = w->mesh->tri[t];

		for (unsigned k = 0; k < 3 && mp_has_edges(v); k++) {
			uint64_t link = (uint64_t)v[(k + 1) % 3] << 32 | v[(k + 2) % 3];
			uint32_t i = v[k] - l->first;

			if (i < l->count)
				w->wrong = w->wrong || at[i] == l->row[i + 1] ||
					   l->link[at[i]++ - l->row[0]] != link;
		}
	}
	for (uint32_t i = 0; i < l->count; i++)
		w->wrong = w->wrong || at[i] != l->row[i + 1];
	free(at);
}

/* With so many vertices and links at a time; what it fills is the same as by definition. */
static bool is_good_by(const struct soup *soup, const struct mp_manifold_room *room)
{
	struct mp_topology t = {0}, want;
	struct built b;
	struct watch watch = {.mesh = &b.mesh, .window = room->vertices};
	const struct mp_links_sink sink = {begin_links, check_links, end_links, &watch};
	bool good = false;

	assert_int_equal(soup_build(soup, 3, &b, NULL), 0);
	b.mesh.watcher = &sink;
	assert_int_equal(mp_manifold_find(&b.mesh, room, &t, &good), 0);
	b.mesh.watcher = NULL;
	assert_false(watch.wrong);
	if (good) {
		uint32_t seen = 0;

		for (size_t i = 0; i < watch.windows; i++)
			seen += watch.seen[i];
		assert_int_equal(seen, mp_vertices_count(b.mesh.vertices));
		assert_true(watch.ended && watch.all);
		reference_topology(&b.mesh, &want);
		assert_true(want.closed && want.watertight && want.winding_consistent);
		assert_int_equal(want.non_manifold_vertices + want.duplicate_triangles, 0);
		assert_int_equal(t.vertices, want.vertices);
		assert_int_equal(t.edges, want.edges);
		assert_int_equal(t.faces, want.faces);
		assert_int_equal(t.bodies, want.bodies);
		assert_memory_equal(t.body_of, want.body_of, b.mesh.triangles * sizeof *t.body_of);
		for (uint32_t i = 0; i < t.bodies; i++) {
			assert_int_equal(t.body[i].first, want.body[i].first);
			assert_int_equal(t.body[i].triangles, want.body[i].triangles);
			assert_true(t.body[i].closed && t.body[i].watertight);
		}
		mp_topology_free(&want);
	} else {
		assert_null(t.body);
		assert_true(watch.ended ? !watch.all : watch.seen == NULL);
	}
	free(watch.seen);
	mp_topology_free(&t);
	built_free(&b);
	return good;
}

/* What the short way says of ${soup}, whatever it keeps at a time. */
static bool is_good(const struct soup *soup)
{
	bool good = is_good_by(soup, &roomy);

	for (uint32_t vertices = 1; vertices < 200; vertices *= 4)
		for (uint32_t links = 1; links < 500; links *= 16) {
			const struct mp_manifold_room room = {vertices, links, 0};

			assert_int_equal(is_good_by(soup, &room), good);
		}
	return good;
}

/*
 * A torus of several blocks of triangles, in rows and shuffled: in rows most blocks lie outside the
 * range of vertices that is looked at.
 */
static void large_meshes_are_looked_at_by_parts(void **unused)
{
	uint64_t state = 5;

	(void)unused;
	for (int round = 0; round < 4; round++) {
		struct mp_topology t = {0};
		struct soup s = {0};
		struct built b;
		bool good;

		soup_torus(&s, 60, 50, 5, 1);
		soup_cube(&s, 20, 0, 0, 1);
		if (round % 2)
			soup_shuffle(&s, &state);
		if (round / 2)
			soup_flip(&s, s.count - 1);
		assert_int_equal(soup_build(&s, 3, &b, NULL), 0);
		for (uint32_t vertices = 1; vertices < 30000; vertices *= 4) {
			const struct mp_manifold_room room = {vertices, vertices, 0};

			assert_int_equal(mp_manifold_find(&b.mesh, &room, &t, &good), 0);
			assert_int_equal(good, round / 2 == 0);
			if (good) {
				assert_int_equal(t.bodies, 2);
				assert_int_equal(t.vertices, 3008);
				assert_int_equal(t.body[0].triangles + t.body[1].triangles, 6012);
			}
			mp_topology_free(&t);
		}
		built_free(&b);
		soup_free(&s);
	}
}

static void good_meshes_take_the_short_way(void **unused)
{
	uint64_t state = 7;

	(void)unused;
	for (int round = 0; round < 40; round++) {
		struct soup s = {0};

		soup_torus(&s, 3 + (unsigned)round % 5, 5, 5, 1);
		if (round % 2)
			soup_cube(&s, 20, 0, 0, 1);
		if (round % 3)
			soup_tetrahedron(&s, 30, 0, 0, 1);
		soup_shuffle(&s, &state);
		assert_true(is_good(&s));
		soup_free(&s);
	}
}

/* Around the numbers of links from which other ways are taken. */
static void vertices_of_many_triangles_are_rings(void **unused)
{
	static const unsigned corners[] = {3, 7, 8, 9, 15, 16, 17, 33, 300};
	uint64_t state = 11;

	(void)unused;
	for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
		struct soup s = {0};

		soup_bipyramid(&s, corners[i], 0);
		assert_true(is_good(&s));
		soup_shuffle(&s, &state);
		assert_true(is_good(&s));
		soup_drop(&s, soup_random(&state) % s.count);
		assert_false(is_good(&s)); /* open */
		soup_free(&s);
		soup_bipyramid(&s, corners[i], 0);
		soup_shuffle(&s, &state);
		soup_flip(&s, soup_random(&state) % s.count);
		assert_false(is_good(&s)); /* wound against the rest */
		soup_free(&s);
	}
}

/* Nearly all corners at two vertices: there is no room for that, and the long way says the same. */
static void many_links_far_away_take_the_long_way(void **unused)
{
	struct mp_topology t = {0};
	struct soup s = {0};
	struct built b;
	bool good = true;

	(void)unused;
	soup_bipyramid(&s, 4000, 0);
	assert_int_equal(soup_build(&s, 3, &b, NULL), 0);
	assert_int_equal(mp_manifold_find(&b.mesh, &roomy, &t, &good), 0);
	assert_false(good);
	assert_int_equal(mp_topology_find(&b.mesh, 9, &t, NULL), 0);
	assert_true(t.watertight && t.winding_consistent);
	assert_int_equal(t.euler, 2);
	assert_int_equal(t.body[0].fans, 4002);
	mp_topology_free(&t);
	built_free(&b);
	soup_free(&s);
}

/* Two fans at a vertex: every link has its successor, but they are two rings. */
static void two_rings_at_a_vertex_are_not_one(void **unused)
{
	static const unsigned corners[] = {3, 4, 5, 8, 9, 40};
	uint64_t state = 13;

	(void)unused;
	for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
		struct soup s = {0}, one = {0};
		const double shift[3] = {0, 0, 2};

		soup_bipyramid(&one, corners[i], 0);
		soup_copy(&s, &one, 1, (const double[3]){0, 0, 0});
		soup_copy(&s, &one, 1, shift);
		soup_shuffle(&s, &state);
		assert_false(is_good(&s));
		soup_free(&s);
		soup_free(&one);
	}
}

/* Prisms around one axis: the links at its ends meet the other end once for each of them. */
static void an_edge_of_two_bodies_is_no_good(void **unused)
{
	for (unsigned n = 2; n < 12; n++) {
		const double a[3] = {0, 0, 0}, b[3] = {0, 0, 1};
		struct soup s = {0};

		(void)unused;
		for (unsigned i = 0; i < n; i++) {
			double x = i, y = (double)i * i + 1;
			const double c[3] = {x, y, 0}, d[3] = {-x - 1, y, 0};

			soup_add(&s, a, b, c);
			soup_add(&s, b, a, d);
			soup_add(&s, a, c, d);
			soup_add(&s, b, d, c);
		}
		assert_false(is_good(&s));
		soup_free(&s);
	}
}

static void two_sides_of_a_triangle_are_duplicates(void **unused)
{
	const double a[3] = {0, 0, 9}, b[3] = {1, 0, 9}, c[3] = {0, 1, 9};
	struct soup s = {0};

	(void)unused;
	soup_cube(&s, 0, 0, 0, 1);
	soup_add(&s, a, b, c);
	soup_add(&s, c, b, a);
	assert_false(is_good(&s));
	soup_free(&s);
}

static void triangles_without_edges_do_no_harm(void **unused)
{
	const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, far[3] = {0, 7, 8};
	struct soup s = {0}, nothing = {0};

	(void)unused;
	soup_add(&s, far, far, far); /* a vertex that nothing else uses */
	soup_tetrahedron(&s, 20, 0, 0, 1);
	soup_add(&s, b, a, a); /* the first to name vertices of the second body */
	soup_tetrahedron(&s, 40, 0, 0, 1);
	soup_cube(&s, 0, 0, 0, 1);
	assert_true(is_good(&s));
	soup_add(&nothing, a, a, b);
	assert_false(is_good(&nothing)); /* there is nothing that could be good */
	soup_free(&s);
	soup_free(&nothing);
}

static void a_failed_allocation_leaves_nothing(void **unused)
{
	struct found f = {0};
	long total;

	(void)unused;
	soup_bipyramid(&f.soup, 40, 0);
	soup_cube(&f.soup, 20, 0, 0, 1);
	assert_int_equal(soup_build(&f.soup, 1, &f.built, NULL), 0);
	total = -alloc_count();
	assert_int_equal(mp_topology_find(&f.built.mesh, 9, &f.t, NULL), 0);
	total += alloc_count();
	mp_topology_free(&f.t);
	for (long n = 1; n <= total; n++) {
		struct mp_error err = {.code = MP_OK};

		alloc_fail_at(n);
		assert_int_equal(mp_topology_find(&f.built.mesh, 9, &f.t, &err), -1);
		alloc_fail_at(0);
		assert_int_equal(err.code, MP_NOMEM);
		assert_null(f.t.body);
	}
	found_free(&f);
}

/* Marks find the same degenerate triangles as a look at all of them. */
static void marks_change_no_degenerate_triangle(void **unused)
{
	static const double scale[] = {1, 0.1, 1e-8, 1e-160, 1e-200, 0x1p-1074, 1e150, 1e300};
	uint64_t state = 17;

	(void)unused;
	for (size_t round = 0; round < 400; round++) {
		double size = scale[round % (sizeof scale / sizeof *scale)];
		struct mp_topology with = {0}, without = {0};
		uint64_t flat[4] = {0};
		struct soup s = {0};
		struct built b;
		size_t n = 1 + soup_random(&state) % 600, half = n / 2;

		for (size_t i = 0; i < n; i++) {
			double p[9];

			/* few of them are degenerate in some rounds, most in others */
			for (size_t k = 0; k < 9; k++)
				p[k] = size *
				       (double)(soup_random(&state) % (round % 3 == 0 ? 2 : 1000));
			for (size_t k = 6; k < 9 && soup_random(&state) % 64 < round % 3; k++)
				p[k] = p[k - 3] + (p[k - 3] - p[k - 6]);
			soup_add(&s, p, p + 3, p + 6);
		}
		assert_int_equal(soup_build(&s, 1, &b, NULL), 0);
		assert_int_equal(mp_topology_find(&b.mesh, 1000, &without, NULL), 0);
		mp_flat_mark((const double(*)[9])s.tri, half, 0, flat);
		mp_flat_mark((const double(*)[9])s.tri + half, n - half, half, flat);
		b.mesh.flat = flat;
		assert_int_equal(mp_topology_find(&b.mesh, 1000, &with, NULL), 0);
		assert_int_equal(with.degenerate_triangles, without.degenerate_triangles);
		assert_memory_equal(with.defect[MP_DEFECT_DEGENERATE_TRIANGLE].triangles,
				    without.defect[MP_DEFECT_DEGENERATE_TRIANGLE].triangles,
				    with.degenerate_triangles * sizeof(uint32_t));
		mp_topology_free(&with);
		mp_topology_free(&without);
		built_free(&b);
		soup_free(&s);
	}
}

static void good_triangles_are_not_marked(void **unused)
{
	uint64_t flat[4] = {0};
	struct soup s = {0};
	const double a[3] = {0.1, 0, 0}, b[3] = {0.1, 1, 0}, c[3] = {0.1, 1, 0.3};

	(void)unused;
	soup_torus(&s, 30, 10, 5, 1);
	mp_flat_mark((const double(*)[9])s.tri, s.count, 0, flat);
	assert_int_equal(flat[0] | flat[1] | flat[2] | flat[3], 0);
	soup_add(&s, a, b, c); /* seen along x only */
	soup_add(&s, a, a, c);
	mp_flat_mark((const double(*)[9])s.tri + 600, 1, 4095, flat);
	assert_int_equal(flat[0] | flat[1] | flat[2] | flat[3], 0);
	mp_flat_mark((const double(*)[9])s.tri + 601, 1, 4095, flat);
	assert_true(flat[0] == (uint64_t)1 << 63);
	soup_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(good_meshes_take_the_short_way),
	    cmocka_unit_test(large_meshes_are_looked_at_by_parts),
	    cmocka_unit_test(vertices_of_many_triangles_are_rings),
	    cmocka_unit_test(many_links_far_away_take_the_long_way),
	    cmocka_unit_test(two_rings_at_a_vertex_are_not_one),
	    cmocka_unit_test(an_edge_of_two_bodies_is_no_good),
	    cmocka_unit_test(two_sides_of_a_triangle_are_duplicates),
	    cmocka_unit_test(triangles_without_edges_do_no_harm),
	    cmocka_unit_test(a_failed_allocation_leaves_nothing),
	    cmocka_unit_test(marks_change_no_degenerate_triangle),
	    cmocka_unit_test(good_triangles_are_not_marked),
	};

	return cmocka_run_group_tests_name("manifold", tests, NULL, NULL);
}
