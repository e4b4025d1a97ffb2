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

static void assert_tensor(const double value[3][3], const double want[3][3], double tolerance)
{
	for (int i = 0; i < 9; i++)
		assert_near(value[i / 3][i % 3], want[i / 3][i % 3], tolerance);
}

/* The worked example of the paper on the triangular pyramid, its misprints corrected. */
static void test_wedge_of_the_paper(void **state)
{
	static const double ABOUT_ORIGIN[3][3] = {
	    {68.9, -50, -16}, {-50, 166.4, -10}, {-16, -10, 222.5}};
	static const double ABOUT_CENTROID[3][3] = {
	    {0.3445, 1 / 6.0, 0.16 / 3}, {1 / 6.0, 0.8320, 0.1 / 3}, {0.16 / 3, 0.1 / 3, 1.1125}};
	static const double CENTROID[3] = {10, 6.25, 2};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_wedge(&m, 40, 25, 8);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 1e-5;
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume_defined && r.total.mass_defined && r.total.inertia_defined);
	assert_true(r.total.volume == 4000 / 3.0 && r.total.mass == 0.04 / 3);
	assert_true(r.density_defined && r.density == 1e-5);
	for (int k = 0; k < 3; k++)
		assert_true(r.total.centroid[k] == CENTROID[k]);
	assert_tensor((const double(*)[3])r.total.inertia, ABOUT_CENTROID, 2e-16);
	assert_true(r.inertia_origin_defined);
	for (int i = 0; i < 9; i++)
		assert_relative(r.inertia_origin[i / 3][i % 3],
				0.04 / 3 * ABOUT_ORIGIN[i / 3][i % 3], 3e-16);
	assert_relative(r.total.area, 500 + 100 + 160 + sqrt(500 * 500 + 100 * 100 + 160 * 160),
			2e-16);
	assert_int_equal(r.solid, MP_YES);
	assert_int_equal(r.warnings, 0);
	mp_report_free(&r);
	mesh_free(&m);
}

/* The example of the HTTP contract. */
static void test_box_of_the_contract(void **state)
{
	const double max[3] = {40, 30, 20};
	static const double CENTRAL[3][3] = {{7.02, 0, 0}, {0, 10.8, 0}, {0, 0, 13.5}};
	static const double ABOUT_ORIGIN[3][3] = {
	    {28.08, -19.44, -12.96}, {-19.44, 43.2, -9.72}, {-12.96, -9.72, 54}};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 2700;
	request.density_divisor = 1e9;
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume == 24000 && r.total.area == 5200 && r.total.mass == 0.0648);
	for (int k = 0; k < 3; k++) {
		assert_true(r.total.centroid[k] == max[k] / 2);
		assert_true(r.surface_centroid_defined && r.surface_centroid[k] == max[k] / 2);
		assert_true(r.box.min[k] == 0 && r.box.max[k] == max[k]);
		assert_true(r.closure_defect[k] == 0);
		assert_true(r.principal.moments[k] == CENTRAL[k][k]);
		assert_relative(r.radii_of_gyration[k], sqrt(CENTRAL[k][k] / 0.0648), 2e-16);
	}
	assert_tensor((const double(*)[3])r.total.inertia, CENTRAL, 0);
	assert_tensor((const double(*)[3])r.inertia_origin, ABOUT_ORIGIN, 0);
	assert_true(r.radii_defined && r.density == 2700 / 1e9);
	assert_int_equal(r.principal.symmetry, MP_SYMMETRY_NONE);
	assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
	assert_int_equal(r.solid, MP_YES);
	assert_int_equal(r.overlapping, MP_NO);
	assert_int_equal(r.triangles, 12);
	assert_int_equal(r.notes.bytes, 684);
	assert_int_equal(r.bodies_listed, 1);
	assert_int_equal(r.warnings, 0);
	assert_false(r.inertia_about_defined || r.axis_defined);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_weighed_mass_gives_the_density(void **state)
{
	const double max[3] = {4, 3, 2};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	request.density_kind = MP_DENSITY_FROM_MASS;
	request.density = 0.7;
	report_of_binary(&m, &request, &r);
	assert_true(r.has_density && r.density_defined && r.density == 0.7 / 24);
	assert_true(r.total.mass == 0.7);
	assert_relative(r.total.inertia[0][0], 0.7 * (9 + 4) / 12, 2e-16);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_without_a_density_mass_is_volume(void **state)
{
	const double max[3] = {4, 3, 2};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	report_of_binary(&m, NULL, &r);
	assert_false(r.has_density);
	assert_false(r.density_defined);
	assert_true(r.total.mass_defined && r.total.mass == 24 && r.total.inertia[2][2] == 50);
	mp_report_free(&r);
	mesh_free(&m);
}

static void test_inertia_about_point_and_axis(void **state)
{
	const double max[3] = {4, 3, 2};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	request.has_about = request.has_axis = true;
	memcpy(request.about, max, sizeof max);
	request.axis_origin[0] = 10;
	request.axis_direction[2] = -1e-200;
	report_of_binary(&m, &request, &r);
	/* the far corner sees what the origin sees */
	assert_true(r.inertia_about_defined && r.axis_defined);
	assert_tensor((const double(*)[3])r.inertia_about, (const double(*)[3])r.inertia_origin, 0);
	assert_true(r.inertia_about[0][0] == 24 * (9 + 4) / 3.0);
	assert_true(r.inertia_about[0][1] == -24 * 2 * 1.5);
	/* I_C + m (8^2 + 1.5^2) */
	assert_true(r.axis.direction[2] == -1 && r.axis.origin[0] == 10);
	assert_true(r.axis.moment == 50 + 24 * (64 + 2.25));
	assert_true(r.axis.radius_defined);
	assert_relative(r.axis.radius_of_gyration, sqrt(50 / 24.0 + 66.25), 2e-16);
	mp_report_free(&r);
	request.axis_direction[0] = request.axis_direction[1] = 3e300;
	request.axis_direction[2] = 3e300;
	memset(request.axis_origin, 0, sizeof request.axis_origin);
	report_of_binary(&m, &request, &r);
	for (int k = 0; k < 3; k++)
		assert_relative(r.axis.direction[k], sqrt(1 / 3.0), 2e-16);
	/* d I d with the tensor about the origin, which the axis passes through */
	assert_relative(
	    r.axis.moment,
	    (r.inertia_origin[0][0] + r.inertia_origin[1][1] + r.inertia_origin[2][2] +
	     2 * (r.inertia_origin[0][1] + r.inertia_origin[1][2] + r.inertia_origin[2][0])) /
		3,
	    4e-16);
	mp_report_free(&r);
	mesh_free(&m);
}

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

/* As text every coordinate is a double: exact on a grid, however far away. */
static void test_far_away_nothing_is_lost(void **state)
{
	struct mesh m = {0};
	struct mp_report near, far;

	(void)state;
	mesh_torus(&m, 3, 1, 24, 15);
	for (size_t i = 0; i < 9 * m.count; i++)
		m.tri[i / 9][i % 9] = nearbyint(ldexp(m.tri[i / 9][i % 9], 30)) * 0x1p-30;
	report_of_ascii(&m, NULL, &near);
	mesh_move(&m, 0, 1e6, -2e6, 3e6);
	report_of_ascii(&m, NULL, &far);
	assert_true(near.total.volume == far.total.volume && near.total.area == far.total.area);
	assert_memory_equal(near.total.inertia, far.total.inertia, sizeof near.total.inertia);
	assert_relative(far.total.centroid[0], 1e6 + near.total.centroid[0], 1e-15);
	assert_relative(far.total.centroid[1], -2e6 + near.total.centroid[1], 1e-15);
	mp_report_free(&near);
	mp_report_free(&far);
	mesh_free(&m);
}

static void test_float32_far_away_nothing_is_lost(void **state)
{
	const double max[3] = {40.25, 30.5, 20.75};
	struct mesh m = {0};
	struct mp_report near, far;

	(void)state;
	mesh_box(&m, ORIGIN, max);
	report_of_binary(&m, NULL, &near);
	mesh_move(&m, 0, 1e6, 1e6, -1e6);
	report_of_binary(&m, NULL, &far);
	assert_true(near.total.volume == 40.25 * 30.5 * 20.75);
	assert_true(near.total.volume == far.total.volume);
	assert_memory_equal(near.total.inertia, far.total.inertia, sizeof near.total.inertia);
	for (int k = 0; k < 3; k++)
		assert_true(far.total.centroid[k] == (k == 2 ? -1e6 : 1e6) + max[k] / 2);
	mp_report_free(&near);
	mp_report_free(&far);
	mesh_free(&m);
}

static int refusal(const void *bytes, size_t size, size_t step, enum mp_format_wish format,
		   struct mp_error *err)
{
	struct mp_request request = request_plain();
	struct mp_report r;

	request.format = format;
	memset(err, 0, sizeof *err);
	assert_int_equal(report_of_file(bytes, size, step, &request, &r, err), -1);
	assert_true(strlen(err->text) > 0);
	return err->code;
}

static void test_formats_that_are_not_read(void **state)
{
	static const char OBJ[] = "# a comment\r\no part\r\n\r\n  v 1 -2 .5\r\nf 1 1 1\r\n";
	static const uint8_t DRACO[] = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 9, 9};
	struct mp_error err;

	(void)state;
	for (size_t step = 0; step < sizeof OBJ; step++) {
		assert_int_equal(refusal(OBJ, sizeof OBJ - 1, step, MP_WISH_AUTO, &err),
				 MP_UNSUPPORTED);
		assert_non_null(strstr(err.text, "OBJ"));
	}
	assert_int_equal(refusal(DRACO, sizeof DRACO, 1, MP_WISH_AUTO, &err), MP_UNSUPPORTED);
	assert_non_null(strstr(err.text, "Draco"));
	assert_int_equal(refusal("", 0, 0, MP_WISH_OBJ, &err), MP_UNSUPPORTED);
	assert_non_null(strstr(err.text, "OBJ"));
	assert_int_equal(refusal("", 0, 0, MP_WISH_DRACO, &err), MP_UNSUPPORTED);
	assert_non_null(strstr(err.text, "Draco"));
}

static void test_obj_longer_than_the_first_bytes(void **state)
{
	char text[20000];
	struct mp_error err;

	(void)state;
	for (size_t at = 0; at < sizeof text; at += 20)
		memcpy(text + at, "v 1.5 2.25 -0.12345\n", 20);
	assert_int_equal(refusal(text, sizeof text, 0, MP_WISH_AUTO, &err), MP_UNSUPPORTED);
	assert_int_equal(refusal(text, sizeof text, 777, MP_WISH_AUTO, &err), MP_UNSUPPORTED);
}

/* Words in the header of a binary STL, and names in a text one, mean nothing. */
static void test_stl_with_the_words_of_others(void **state)
{
	static const char *const HEADER[] = {"v 1 2 3\nv 1 2 3\nf 1 2 3\n", "DRACO is not here",
					     "solid facet normal", "OFF"};
	const double max[3] = {1, 1, 1};
	struct mp_request request = request_plain();
	struct mesh m = {0};

	(void)state;
	mesh_box(&m, ORIGIN, max);
	for (size_t i = 0; i < sizeof HEADER / sizeof *HEADER; i++) {
		size_t size;
		uint8_t *file = mesh_stl_binary(&m, HEADER[i], &size);
		struct mp_report r;
		struct mp_error err;

		assert_int_equal(report_of_file(file, size, 0, &request, &r, &err), 0);
		assert_int_equal(r.notes.format, MP_FORMAT_STL_BINARY);
		mp_report_free(&r);
		free(file);
	}
	mesh_free(&m);
}

static void test_what_is_no_mesh(void **state)
{
	struct mp_error err;

	(void)state;
	for (int format = MP_WISH_AUTO; format <= MP_WISH_STL; format++) {
		assert_int_equal(refusal("", 0, 0, (enum mp_format_wish)format, &err), MP_EMPTY);
		assert_int_equal(
		    refusal("solid nothing\nendsolid\n", 23, 1, (enum mp_format_wish)format, &err),
		    MP_NO_FACES);
	}
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

/* Every allocation fails once: an error that says so, nothing leaks, and without it all is well. */
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
		int ret = -1;

		for (long n = 1; ret != 0; n++) {
			struct mp_report r;
			struct mp_error err = {0};
			long before = alloc_count();

			alloc_fail_at(n);
			ret = report_of_file(file, size, 5000, &request, &r, &err);
			alloc_fail_at(0);
			if (ret == 0)
				assert_true(alloc_count() - before < n);
			else
				assert_int_equal(err.code, MP_NOMEM);
			assert_true(n < 10000);
			mp_report_free(&r);
		}
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
	uint8_t *file;

	(void)state;
	mesh_box(&first, ORIGIN, box[0]);
	mesh_box(&first, more[0], more[1]);
	first.count -= 3; /* the second box goes on in the next solid */
	mesh_box(&second, more[0], more[1]);
	memmove(second.tri, second.tri + 9, 3 * sizeof *second.tri);
	second.count = 3;
	mesh_box(&second, box[1], box[2]);
	file = mesh_stl_ascii(&first, "left half", &a);
	file = join(file, a, mesh_stl_ascii(&second, "right", &b), b);
	mesh_move(&second, 3, 0, 0, 10);
	memmove(second.tri, second.tri + 3, 12 * sizeof *second.tri);
	second.count = 12;
	file = join(file, a + b, mesh_stl_ascii(&second, "", &c), c);
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
	    cmocka_unit_test(test_wedge_of_the_paper),
	    cmocka_unit_test(test_box_of_the_contract),
	    cmocka_unit_test(test_weighed_mass_gives_the_density),
	    cmocka_unit_test(test_without_a_density_mass_is_volume),
	    cmocka_unit_test(test_inertia_about_point_and_axis),
	    cmocka_unit_test(test_where_a_chunk_ends_never_matters),
	    cmocka_unit_test(test_key_never_matters),
	    cmocka_unit_test(test_flip_is_a_reversed_file),
	    cmocka_unit_test(test_options_may_follow_the_file),
	    cmocka_unit_test(test_far_away_nothing_is_lost),
	    cmocka_unit_test(test_float32_far_away_nothing_is_lost),
	    cmocka_unit_test(test_formats_that_are_not_read),
	    cmocka_unit_test(test_obj_longer_than_the_first_bytes),
	    cmocka_unit_test(test_stl_with_the_words_of_others),
	    cmocka_unit_test(test_what_is_no_mesh),
	    cmocka_unit_test(test_triangle_limit),
	    cmocka_unit_test(test_every_allocation_may_fail),
	    cmocka_unit_test(test_bodies_take_the_names_of_solids),
	};

	return cmocka_run_group_tests_name("analysis", tests, NULL, NULL);
}
