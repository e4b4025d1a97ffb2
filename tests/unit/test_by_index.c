/* checks.by_index: the same edges with vertices as the files number them. */
#include "core/topology/index.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/made_file.h"
#include "tests/unit/report_of.h"
#include "tests/unit/soup.h"

/* A mesh and the numbers of its corners. */
struct numbered {
	struct mesh mesh;
	uint32_t (*index)[3];
};

/* By coordinates, in the order of their first appearance: what a careful writer does. */
static void number_by_place(struct numbered *n)
{
	size_t corners = 3 * n->mesh.count;
	const double(*at)[3] = (const double(*)[3])n->mesh.tri;
	uint32_t next = 0;

	n->index = malloc(n->mesh.count * sizeof *n->index);
	assert_non_null(n->index);
	for (size_t i = 0; i < corners; i++) {
		size_t j = 0;

		while (j < i && memcmp(at[i], at[j], sizeof at[i]) != 0)
			j++;
		n->index[i / 3][i % 3] = j < i ? n->index[j / 3][j % 3] : next++;
	}
}

/* A torus whose coordinates are floats. */
static struct numbered torus(int around, int section)
{
	struct numbered n = {.index = NULL};

	mesh_torus(&n.mesh, 3, 1, around, section);
	for (size_t i = 0; i < 9 * n.mesh.count; i++)
		n.mesh.tri[i / 9][i % 9] = (double)(float)n.mesh.tri[i / 9][i % 9];
	number_by_place(&n);
	return n;
}

static struct numbered cube(double x, double size)
{
	const double min[3] = {x, 0, 0}, max[3] = {x + size, size, size};
	struct numbered n = {.index = NULL};

	mesh_box(&n.mesh, min, max);
	number_by_place(&n);
	return n;
}

static void drop(struct numbered *n)
{
	mesh_free(&n->mesh);
	free(n->index);
	n->index = NULL;
}

static void report_as(enum made_form form, const struct numbered *files, size_t count,
		      struct mp_report *r)
{
	const struct mp_request request = request_plain();
	struct made_file made[3] = {{.mesh = NULL}};
	struct mp_error err;

	assert_true(count <= 3);
	for (size_t i = 0; i < count; i++)
		made[i] = (struct made_file){.mesh = &files[i].mesh,
					     .index = (const uint32_t(*)[3])files[i].index,
					     .form = files[i].index == NULL ? MADE_BLOCKS : form};
	assert_int_equal(made_report(made, count, &request, r, &err), 0);
}

/* Vertices are the same in whatever form they come. */
static void assert_same_mesh(const struct mp_report *a, const struct mp_report *b)
{
	assert_int_equal(a->triangles, b->triangles);
	assert_memory_equal(a->tri, b->tri, a->triangles * sizeof *a->tri);
	assert_int_equal(mp_vertices_count(a->vertices), mp_vertices_count(b->vertices));
	for (uint32_t i = 0; i < mp_vertices_count(a->vertices); i++) {
		double p[3], q[3];

		mp_vertices_get(a->vertices, i, p);
		mp_vertices_get(b->vertices, i, q);
		assert_memory_equal(p, q, sizeof p);
	}
	assert_memory_equal(&a->by_index, &b->by_index, sizeof a->by_index);
	assert_memory_equal(&a->total, &b->total, sizeof a->total);
}

/* What is reported of ${count} files; of the topology only the counts are good afterwards. */
static struct mp_by_index look(const struct numbered *files, size_t count,
			       struct mp_topology *topology)
{
	struct mp_by_index by;
	struct mp_report r, other;

	report_as(MADE_BLOCKS, files, count, &r);
	for (enum made_form form = MADE_FLOATS; form <= MADE_EXPECTED; form++) {
		report_as(form, files, count, &other);
		assert_same_mesh(&r, &other);
		mp_report_free(&other);
	}
	by = r.by_index;
	if (topology != NULL)
		*topology = r.topology;
	mp_report_free(&r);
	return by;
}

static void assert_counts(const struct mp_by_index *by, bool closed, bool watertight,
			  uint64_t boundary, uint64_t non_manifold, uint64_t misoriented)
{
	assert_true(by->given);
	assert_int_equal(by->closed, closed);
	assert_int_equal(by->watertight, watertight);
	assert_int_equal(by->boundary_edges, boundary);
	assert_int_equal(by->non_manifold_edges, non_manifold);
	assert_int_equal(by->misoriented_edges, misoriented);
}

static void same_vertices_are_not_repeated(void **state)
{
	struct numbered n = cube(0, 1);
	struct mp_topology t;
	uint32_t swap;

	(void)state;
	assert_false(look(&n, 1, &t).given);
	assert_true(t.watertight);
	for (size_t i = 0; i < 3 * n.mesh.count; i++) /* whatever the numbers are */
		n.index[i / 3][i % 3] = 1000003 - 1009 * n.index[i / 3][i % 3];
	assert_false(look(&n, 1, NULL).given);
	mesh_flip(&n.mesh, 11); /* a bad mesh is as bad by index */
	swap = n.index[11][1];
	n.index[11][1] = n.index[11][2];
	n.index[11][2] = swap;
	assert_false(look(&n, 1, &t).given);
	assert_int_equal(t.misoriented_edges, 3);
	drop(&n);
}

static void faces_with_vertices_of_their_own(void **state)
{
	struct numbered n = cube(0, 1);
	struct mp_topology t;
	struct mp_by_index by;

	(void)state;
	for (size_t i = 0; i < 3 * n.mesh.count; i++) /* two triangles a face */
		n.index[i / 3][i % 3] += 8 * (uint32_t)(i / 6);
	by = look(&n, 1, &t);
	assert_counts(&by, false, false, 24, 0, 0);
	assert_true(t.closed && t.watertight && t.boundary_edges == 0);
	for (size_t i = 0; i < 3 * n.mesh.count; i++) /* triangles */
		n.index[i / 3][i % 3] = (uint32_t)i;
	by = look(&n, 1, NULL);
	assert_counts(&by, false, false, 36, 0, 0);
	drop(&n);
}

/* Two cubes share an edge in space: by coordinates it has four triangles, by index two and two. */
static void vertices_that_fell_onto_each_other(void **state)
{
	const double low[3] = {0, 0, 0}, middle[3] = {1, 1, 1}, high[3] = {2, 2, 1};
	const double corner[3] = {1, 1, 0};
	struct numbered n = {.index = NULL};
	struct mp_topology t;
	struct mp_by_index by;

	(void)state;
	mesh_box(&n.mesh, low, middle);
	mesh_box(&n.mesh, corner, high);
	number_by_place(&n);
	assert_false(look(&n, 1, &t).given);
	assert_int_equal(t.non_manifold_edges, 1);
	for (size_t i = 36; i < 72; i++)
		n.index[i / 3][i % 3] += 100;
	by = look(&n, 1, NULL);
	assert_counts(&by, true, true, 0, 0, 0);
	drop(&n);
}

static void other_vertices_with_the_same_edges_are_not_repeated(void **state)
{
	const double low[3] = {0, 0, 0}, middle[3] = {1, 1, 1}, high[3] = {2, 2, 2};
	struct numbered n = {.index = NULL};
	struct mp_topology t;

	(void)state;
	mesh_box(&n.mesh, low, middle);
	mesh_box(&n.mesh, middle, high); /* one corner in common */
	number_by_place(&n);
	for (size_t i = 36; i < 72; i++)
		n.index[i / 3][i % 3] += 100;
	assert_false(look(&n, 1, &t).given);
	assert_int_equal(t.non_manifold_vertices, 1);
	drop(&n);
}

static void an_index_twice_has_no_edges(void **state)
{
	const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 0, 0};
	struct numbered n = cube(5, 1);
	struct mp_by_index by;

	(void)state;
	mesh_triangle(&n.mesh, a, b, c);
	free(n.index);
	number_by_place(&n);
	assert_false(look(&n, 1, NULL).given); /* neither way has it edges */
	n.index[12][2] = 77;                   /* now it is a flap of three edges */
	by = look(&n, 1, NULL);
	assert_counts(&by, false, false, 3, 0, 0);
	drop(&n);
}

static void each_file_has_its_own_numbers(void **state)
{
	struct numbered n[3] = {cube(0, 1), cube(10, 1), cube(20, 1)};
	struct mp_topology t;
	struct mp_by_index by;

	(void)state;
	assert_false(look(n, 3, &t).given);
	assert_int_equal(t.bodies, 3);
	for (size_t i = 0; i < 3 * n[1].mesh.count; i++)
		n[1].index[i / 3][i % 3] += 8 * (uint32_t)(i / 6);
	by = look(n, 3, NULL);
	assert_counts(&by, false, false, 24, 0, 0);
	for (size_t i = 0; i < 3; i++)
		drop(&n[i]);
}

static void not_every_file_has_numbers(void **state)
{
	for (size_t without = 0; without < 3; without++) {
		struct numbered n[3] = {cube(0, 1), cube(10, 1), cube(20, 1)};

		(void)state;
		for (size_t i = 0; i < 36; i++)
			n[0].index[i / 3][i % 3] = n[1].index[i / 3][i % 3] =
			    n[2].index[i / 3][i % 3] = (uint32_t)i;
		assert_true(look(n, 3, NULL).given);
		free(n[without].index);
		n[without].index = NULL;
		assert_false(look(n, 3, NULL).given);
		for (size_t i = 0; i < 3; i++)
			drop(&n[i]);
	}
}

static void numbers_beyond_the_keys_are_left_out(void **state)
{
	struct numbered n[2] = {cube(0, 1), cube(10, 1)};

	(void)state;
	for (size_t i = 0; i < 36; i++)
		n[0].index[i / 3][i % 3] = n[1].index[i / 3][i % 3] = (uint32_t)i;
	n[0].index[3][1] = UINT32_MAX;
	assert_false(look(n, 1, NULL).given);
	n[0].index[3][1] = 0x80000000;
	assert_false(look(n, 2, NULL).given);
	n[0].index[3][1] = 1000000;
	assert_true(look(n, 2, NULL).given);
	n[1].index[11][2] = 0x80000000; /* some had been kept */
	assert_false(look(n, 2, NULL).given);
	drop(&n[0]);
	drop(&n[1]);
}

/* Every edge against every other one. */
static struct mp_by_index reference(const struct numbered *n)
{
	struct mp_by_index by = {.closed = true, .watertight = true};
	size_t halves = 3 * n->mesh.count;

	for (size_t i = 0; i < halves; i++) {
		const uint32_t *v = n->index[i / 3];
		uint32_t a = v[i % 3], b = v[(i + 1) % 3];
		size_t with = 0, against = 0;
		bool earlier = false;

		if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
			continue;
		for (size_t j = 0; j < halves; j++) {
			const uint32_t *w = n->index[j / 3];
			uint32_t c = w[j % 3], d = w[(j + 1) % 3];

			if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0])
				continue;
			with += a == c && b == d;
			against += a == d && b == c;
			earlier = earlier || (j < i && ((a == c && b == d) || (a == d && b == c)));
		}
		by.closed = by.closed && with == against;
		by.watertight = by.watertight && with + against == 2;
		by.boundary_edges += !earlier && with + against == 1;
		by.non_manifold_edges += !earlier && with + against > 2;
		by.misoriented_edges += !earlier && with + against == 2 && with != against;
	}
	return by;
}

/* Every corner that is ${number} moves to where ${other} is. */
static void move(struct numbered *n, uint32_t number, uint32_t other)
{
	double place[3] = {0, 0, 0};

	for (size_t i = 0; i < 3 * n->mesh.count; i++)
		if (n->index[i / 3][i % 3] == other)
			memcpy(place, &n->mesh.tri[i / 3][3 * (i % 3)], sizeof place);
	for (size_t i = 0; i < 3 * n->mesh.count; i++)
		if (n->index[i / 3][i % 3] == number)
			memcpy(&n->mesh.tri[i / 3][3 * (i % 3)], place, sizeof place);
}

static void random_numbers(void **state)
{
	uint64_t random = 11;
	int given = 0;

	(void)state;
	for (int round = 0; round < 300; round++) {
		struct numbered n = torus(4, 3); /* vertices 0 to 11 */
		struct mp_by_index by, want;
		struct mp_topology t;

		for (int i = 0; i < round % 4; i++)
			move(&n, (uint32_t)(soup_random(&random) % 12),
			     (uint32_t)(soup_random(&random) % 12));
		for (int i = 0; i < round % 7; i++) { /* some corners get numbers of their own */
			uint32_t *corner =
			    &n.index[soup_random(&random) % n.mesh.count][soup_random(&random) % 3];

			*corner = *corner % 12 + 12 * (uint32_t)(soup_random(&random) % 3);
		}
		by = look(&n, 1, &t);
		want = reference(&n);
		want.given = true;
		mp_index_compare(&want, &t);
		assert_int_equal(by.given, want.given);
		if (want.given)
			assert_counts(&by, want.closed, want.watertight, want.boundary_edges,
				      want.non_manifold_edges, want.misoriented_edges);
		given += by.given;
		drop(&n);
	}
	assert_true(given > 100);
}

static void failing_allocations(void **state)
{
	const struct mp_request request = request_plain();
	struct numbered n = torus(30, 10);

	(void)state;
	n.index[0][0] = 500;
	for (enum made_form form = MADE_BLOCKS; form <= MADE_EXPECTED; form++) {
		struct made_file made = {&n.mesh, (const uint32_t(*)[3])n.index, .form = form};
		struct mp_report r;
		struct mp_error err;
		long last = alloc_count();

		assert_int_equal(made_report(&made, 1, &request, &r, &err), 0);
		assert_true(r.by_index.given);
		mp_report_free(&r);
		last = alloc_count() - last;
		for (long count = 1; count <= last; count++) {
			int ret;

			alloc_fail_at(count);
			ret = made_report(&made, 1, &request, &r, &err);
			alloc_fail_at(0);
			if (ret == 0) { /* what only helps may fail */
				assert_int_equal(r.by_index.boundary_edges, 4);
				assert_int_equal(mp_vertices_count(r.vertices), 300);
				mp_report_free(&r);
			} else {
				assert_int_equal(err.code, MP_NOMEM);
			}
		}
	}
	drop(&n);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(same_vertices_are_not_repeated),
	    cmocka_unit_test(faces_with_vertices_of_their_own),
	    cmocka_unit_test(vertices_that_fell_onto_each_other),
	    cmocka_unit_test(other_vertices_with_the_same_edges_are_not_repeated),
	    cmocka_unit_test(an_index_twice_has_no_edges),
	    cmocka_unit_test(each_file_has_its_own_numbers),
	    cmocka_unit_test(not_every_file_has_numbers),
	    cmocka_unit_test(numbers_beyond_the_keys_are_left_out),
	    cmocka_unit_test(random_numbers),
	    cmocka_unit_test(failing_allocations),
	};

	return cmocka_run_group_tests_name("by_index", tests, NULL, NULL);
}
