#include "core/analysis.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/report_of.h"

static const double ORIGIN[3] = {0, 0, 0};

static void assert_same_mass(const struct mp_mass *a, const struct mp_mass *b)
{
	assert_memory_equal(&a->volume, &b->volume, sizeof a->volume);
	assert_memory_equal(&a->area, &b->area, sizeof a->area);
	assert_memory_equal(&a->mass, &b->mass, sizeof a->mass);
	assert_memory_equal(a->centroid, b->centroid, sizeof a->centroid);
	assert_memory_equal(a->inertia, b->inertia, sizeof a->inertia);
	assert_int_equal(a->volume_defined, b->volume_defined);
	assert_int_equal(a->area_defined, b->area_defined);
	assert_int_equal(a->mass_defined, b->mass_defined);
	assert_int_equal(a->centroid_defined, b->centroid_defined);
	assert_int_equal(a->inertia_defined, b->inertia_defined);
}

static void assert_same_bodies(const struct mp_report *a, const struct mp_report *b)
{
	assert_int_equal(a->bodies_listed, b->bodies_listed);
	for (uint32_t i = 0; i < a->bodies_listed; i++) {
		const struct mp_body *x = &a->body[i], *y = &b->body[i];

		assert_same_mass(&x->mass, &y->mass);
		assert_memory_equal(&x->box, &y->box, sizeof x->box);
		assert_true(x->first == y->first && x->triangles == y->triangles);
		assert_true(x->orientation == y->orientation && x->cavity == y->cavity);
		assert_true(x->nest.depth == y->nest.depth && x->nest.parent == y->nest.parent);
		assert_true(x->name_len == y->name_len);
		if (x->name_len > 0)
			assert_memory_equal(x->name, y->name, x->name_len);
	}
}

static void assert_same_defects(const struct mp_topology *a, const struct mp_topology *b)
{
	for (int kind = 0; kind < MP_DEFECT_KINDS; kind++) {
		const struct mp_defect_list *x = &a->defect[kind], *y = &b->defect[kind];

		assert_int_equal(x->count, y->count);
		if (x->count == 0)
			continue;
		assert_memory_equal(x->triangle_at, y->triangle_at,
				    (x->count + 1) * sizeof *x->triangle_at);
		assert_memory_equal(x->triangles, y->triangles,
				    x->triangle_at[x->count] * sizeof *x->triangles);
		assert_memory_equal(x->vertices, y->vertices,
				    x->vertex_at[x->count] * sizeof *x->vertices);
	}
}

static void assert_same_report(const struct mp_report *a, const struct mp_report *b)
{
	assert_memory_equal(&a->notes, &b->notes, sizeof a->notes);
	assert_int_equal(a->triangles, b->triangles);
	assert_memory_equal(a->tri, b->tri, a->triangles * sizeof *a->tri);
	assert_memory_equal(&a->box, &b->box, sizeof a->box);
	assert_true(a->orientation == b->orientation && a->solid == b->solid);
	assert_true(a->overlapping == b->overlapping && a->warnings == b->warnings);
	assert_memory_equal(a->closure_defect, b->closure_defect, sizeof a->closure_defect);
	assert_same_mass(&a->total, &b->total);
	assert_memory_equal(a->surface_centroid, b->surface_centroid, sizeof a->surface_centroid);
	assert_memory_equal(a->inertia_origin, b->inertia_origin, sizeof a->inertia_origin);
	assert_memory_equal(a->principal.moments, b->principal.moments,
			    sizeof a->principal.moments);
	assert_memory_equal(a->principal.axes, b->principal.axes, sizeof a->principal.axes);
	assert_memory_equal(a->radii_of_gyration, b->radii_of_gyration,
			    sizeof a->radii_of_gyration);
	assert_same_bodies(a, b);
	assert_same_defects(&a->topology, &b->topology);
}

/* Two bodies, a hole, a degenerate triangle and a flipped one: something in every list. */
static void make_mixed(struct mesh *m)
{
	const double min[3] = {7, 0, 0}, max[3] = {8, 3, 2};

	mesh_torus(m, 3, 1, 24, 15);
	mesh_move(m, 0, 0.1, 0.2, 0.3);
	mesh_triangle(m, min, min, max);
	mesh_box(m, min, max);
	m->count--;
	mesh_flip(m, m->count - 1);
}

static void test_where_a_chunk_ends_never_matters(void **state)
{
	static const size_t STEP[] = {1, 2, 3, 7, 49, 50, 51, 79, 83, 84, 85, 4095, 4096, 4097};
	struct mp_request request = request_plain();
	struct mesh m = {0};

	(void)state;
	make_mixed(&m);
	for (int ascii = 0; ascii < 2; ascii++) {
		size_t size;
		uint8_t *file = ascii ? mesh_stl_ascii(&m, "a part", &size)
				      : mesh_stl_binary(&m, "solid in name only", &size);
		struct mp_report whole, split;
		struct mp_error err;

		assert_int_equal(report_of_file(file, size, 0, &request, &whole, &err), 0);
		for (size_t i = 0; i < sizeof STEP / sizeof *STEP; i++) {
			assert_int_equal(
			    report_of_file(file, size, STEP[i], &request, &split, &err), 0);
			assert_same_report(&whole, &split);
			mp_report_free(&split);
		}
		mp_report_free(&whole);
		free(file);
	}
	mesh_free(&m);
}

static void test_key_never_matters(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report a, b;

	(void)state;
	make_mixed(&m);
	report_of_binary(&m, &request, &a);
	memset(request.key, 0x5a, sizeof request.key);
	report_of_binary(&m, &request, &b);
	assert_same_report(&a, &b);
	mp_report_free(&a);
	mp_report_free(&b);
	mesh_free(&m);
}

/* flip answers what the file would answer with every triangle reversed, but for the stored normals.
 */
static void test_flip_is_a_reversed_file(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report flipped, file;

	(void)state;
	make_mixed(&m);
	request.flip = true;
	report_of_binary(&m, &request, &flipped);
	assert_int_equal(flipped.flipped_triangles, m.count);
	mesh_flip(&m, 0);
	request.flip = false;
	report_of_binary(&m, &request, &file);
	assert_int_equal(file.flipped_triangles, 0);
	/* vertices are numbered as they come: compare by what the triangles are */
	assert_same_mass(&flipped.total, &file.total);
	assert_same_bodies(&flipped, &file);
	assert_true(flipped.orientation == file.orientation);
	assert_true(flipped.warnings == file.warnings);
	assert_memory_equal(flipped.closure_defect, file.closure_defect,
			    sizeof file.closure_defect);
	for (uint32_t i = 0; i < 3 * file.triangles; i++) {
		double x[3], y[3];

		mp_vertices_get(flipped.vertices, flipped.tri[i / 3][i % 3], x);
		mp_vertices_get(file.vertices, file.tri[i / 3][i % 3], y);
		assert_memory_equal(x, y, sizeof x);
	}
	mp_report_free(&flipped);
	mp_report_free(&file);
	mesh_free(&m);
}

/* Options that follow the file in a form: only format, key and limits must be known before. */
static void test_options_may_follow_the_file(void **state)
{
	struct mp_request first = request_plain(), second = request_plain();
	const double max[3] = {1, 1, 1};
	struct mp_analysis *a;
	struct mp_error err;
	struct mp_report r;
	struct mesh m = {0};
	size_t size;
	uint8_t *file;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	file = mesh_stl_binary(&m, NULL, &size);
	second.flip = true;
	second.bodies = 0;
	second.density_kind = MP_DENSITY_GIVEN;
	second.density = 2;
	a = mp_analysis_new(&first, &err);
	assert_non_null(a);
	assert_int_equal(mp_analysis_push(a, file, size, &err), 0);
	assert_int_equal(mp_analysis_end(a, &err), 0);
	assert_int_equal(mp_analysis_report(a, &second, &r, &err), 0);
	assert_true(r.total.volume == -1 && r.total.mass == 2 && r.bodies_listed == 0);
	assert_int_equal(r.flipped_triangles, 12);
	mp_report_free(&r);
	mp_report_free(&r);
	assert_int_equal(mp_analysis_report(a, &second, &r, &err), -1);
	assert_int_equal(err.code, MP_BUG);
	mp_report_free(&r);
	mp_analysis_free(a);
	mp_analysis_free(NULL);
	free(file);
	mesh_free(&m);
}

static void test_triangle_limit(void **state)
{
	struct mp_request request = request_plain();
	struct mp_report r;
	struct mp_error err;
	struct mesh m = {0};
	size_t size;
	uint8_t *file;

	(void)state;
	mesh_torus(&m, 3, 1, 20, 10); /* 400: more than a block */
	file = mesh_stl_binary(&m, NULL, &size);
	request.limits.max_triangles = 400;
	assert_int_equal(report_of_file(file, size, 0, &request, &r, &err), 0);
	mp_report_free(&r);
	request.limits.max_triangles = 399;
	assert_int_equal(report_of_file(file, size, 0, &request, &r, &err), -1);
	assert_int_equal(err.code, MP_LIMIT);
	assert_int_equal(err.limit, 399);
	assert_true(err.actual >= 400);
	free(file);
	mesh_free(&m);
}

/* Every allocation fails once: an error that says so or, where it is dispensable, a whole report.
 */
static void test_every_allocation_may_fail(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};

	(void)state;
	make_mixed(&m);
	for (int ascii = 0; ascii < 2; ascii++) {
		size_t size;
		uint8_t *file =
		    ascii ? mesh_stl_ascii(&m, "named", &size) : mesh_stl_binary(&m, NULL, &size);
		struct mp_report whole, r;
		struct mp_error err;
		long asked = 0;

		assert_int_equal(report_of_file(file, size, 0, &request, &whole, &err), 0);
		for (long n = 1; asked >= n - 1; n++) {
			long before = alloc_count();
			int ret;

			alloc_fail_at(n);
			ret = report_of_file(file, size, 0, &request, &r, &err);
			asked = alloc_count() - before;
			alloc_fail_at(0);
			if (ret == 0)
				assert_same_report(&whole, &r);
			else
				assert_int_equal(err.code, MP_NOMEM);
			mp_report_free(&r);
		}
		assert_true(asked > 20);
		mp_report_free(&whole);
		free(file);
	}
	mesh_free(&m);
}

static uint8_t *join(uint8_t *a, size_t a_size, uint8_t *b, size_t b_size)
{
	uint8_t *both = malloc(a_size + b_size);

	assert_non_null(both);
	memcpy(both, a, a_size);
	memcpy(both + a_size, b, b_size);
	free(a);
	free(b);
	return both;
}

/* A body is named after the solid in which it lies whole. */
static void test_bodies_take_the_names_of_solids(void **state)
{
	const double box[3][3] = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
	const double more[2][3] = {{5, 5, 5}, {6, 6, 6}};
	struct mp_request request = request_plain();
	struct mesh first = {0}, second = {0};
	struct mp_report r;
	struct mp_error err;
	size_t a, b, c;
	uint8_t *file, *part;

	(void)state;
	mesh_box(&first, ORIGIN, box[0]);
	mesh_box(&first, more[0], more[1]);
	first.count -= 3; /* the second box goes on in the next solid */
	mesh_box(&second, more[0], more[1]);
	memmove(second.tri, second.tri + 9, 3 * sizeof *second.tri);
	second.count = 3;
	mesh_box(&second, box[1], box[2]);
	file = mesh_stl_ascii(&first, "left half", &a);
	part = mesh_stl_ascii(&second, "right", &b);
	file = join(file, a, part, b);
	mesh_move(&second, 3, 0, 0, 10);
	memmove(second.tri, second.tri + 3, 12 * sizeof *second.tri);
	second.count = 12;
	part = mesh_stl_ascii(&second, "", &c);
	file = join(file, a + b, part, c);
	assert_int_equal(report_of_file(file, a + b + c, 0, &request, &r, &err), 0);
	assert_int_equal(r.bodies_listed, 4);
	assert_int_equal(r.body[0].name_len, 9);
	assert_memory_equal(r.body[0].name, "left half", 9);
	assert_null(r.body[1].name);
	assert_int_equal(r.body[2].name_len, 5);
	assert_memory_equal(r.body[2].name, "right", 5);
	assert_null(r.body[3].name);
	assert_true(MP_WARNED(&r, MP_WARN_SEVERAL_SOLIDS));
	mp_report_free(&r);
	free(file);
	mesh_free(&first);
	mesh_free(&second);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_where_a_chunk_ends_never_matters),
	    cmocka_unit_test(test_key_never_matters),
	    cmocka_unit_test(test_flip_is_a_reversed_file),
	    cmocka_unit_test(test_options_may_follow_the_file),
	    cmocka_unit_test(test_triangle_limit),
	    cmocka_unit_test(test_every_allocation_may_fail),
	    cmocka_unit_test(test_bodies_take_the_names_of_solids),
	};

	return cmocka_run_group_tests_name("analysis", tests, NULL, NULL);
}
