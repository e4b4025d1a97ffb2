/* Densities by name, from the faces of a file to the masses of the report. */
#include "core/bodies/named.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/made_file.h"
#include "tests/unit/report_of.h"

#define BIT(w) (UINT64_C(1) << (w))

struct asked {
	struct mp_named_density list[8];
	struct mp_request request;
};

/* Of "a", "b", ... up to a NULL, each with its density; ${rest} 0: none. */
static void ask(struct asked *q, double rest, ...)
{
	const char *name;
	va_list ap;

	memset(q, 0, sizeof *q);
	q->request = request_plain();
	q->request.named = q->list;
	if (rest > 0) {
		q->request.density_kind = MP_DENSITY_GIVEN;
		q->request.density = rest;
	}
	va_start(ap, rest);
	while ((name = va_arg(ap, const char *)) != NULL) {
		struct mp_named_density *d = &q->list[q->request.named_count++];

		assert_true(q->request.named_count <= 8);
		*d = (struct mp_named_density){name, strlen(name), va_arg(ap, double), 0, 0};
	}
	va_end(ap);
}

static void box(struct mesh *m, double x, double size)
{
	const double min[3] = {x, 0, 0}, max[3] = {x + size, size, size};

	mesh_box(m, min, max);
}

static void good(const struct made_file *file, const struct mp_request *request,
		 struct mp_report *r)
{
	struct mp_error err = {0};

	if (made_report(file, 1, request, r, &err))
		fail_msg("no report: %s", err.text);
}

static struct mp_error refused(const struct made_file *files, size_t count,
			       const struct mp_request *request)
{
	struct mp_error err = {0};
	struct mp_report r;

	assert_int_equal(made_report(files, count, request, &r, &err), -1);
	assert_int_equal(err.code, MP_BAD_NAME);
	assert_true(err.text[0] != '\0');
	return err;
}

/* Two boxes: 8 of a, 27 of b, with room between. */
static const struct made_range two[] = {{0, "a"}, {12, "b"}, {0, NULL}};

static void two_boxes(struct mesh *m)
{
	box(m, 0, 2);
	box(m, 10, 3);
}

static void each_name_weighs_by_itself(void **state)
{
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = two};
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m);
	ask(&q, 0, "b", 5.0, "a", 2.0, NULL);
	q.list[0].density = 5000;
	q.list[0].divisor = 1000;
	good(&file, &q.request, &r);
	assert_relative(r.total.volume, 35, 1e-15);
	assert_relative(r.total.area, 24 + 54, 1e-15);
	assert_relative(r.total.mass, 8 * 2 + 27 * 5, 1e-15);
	assert_relative(r.density, (8 * 2 + 27 * 5) / 35.0, 1e-15);
	assert_true(r.has_density && r.density_defined);
	assert_relative(r.total.centroid[0], (16 * 1 + 135 * 11.5) / 151, 1e-15);
	assert_relative(r.total.centroid[1], (16 * 1 + 135 * 1.5) / 151, 1e-15);
	/* about the origin: m (y*y + z*z) with the extents of each */
	assert_relative(r.inertia_origin[0][0], 2 * 16 * 4 / 3.0 + 2 * 135 * 9 / 3.0, 1e-15);
	assert_relative(r.inertia_origin[0][1], -(16 * 1 * 1 + 135 * 11.5 * 1.5), 1e-15);
	assert_relative(r.body[0].mass.mass, 16, 1e-15);
	assert_relative(r.body[1].mass.mass, 135, 1e-15);
	assert_relative(r.body[1].mass.inertia[0][0], 135 * 9 / 6.0, 1e-15);
	assert_int_equal(r.warnings, 0);
	assert_int_equal(r.solid, MP_YES);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Whatever the shapes: the whole is the sum of what separate files give. */
static void sums_of_separate_files(void **state)
{
	const struct made_range names[] = {
	    {0, "ring"}, {240, "globe"}, {240 + 280, "box"}, {0, NULL}};
	const double rho[3] = {7.85, 0.01, 1234.5};
	const uint32_t last[4] = {0, 240, 240 + 280, 240 + 280 + 12};
	struct mesh m = {0};
	struct made_file file = {.mesh = &m, .materials = names};
	double mass = 0, first[3] = {0}, about[3][3] = {{0}};
	struct mp_report whole, one;
	struct asked q;

	(void)state;
	mesh_torus(&m, 5, 1, 20, 6);
	mesh_sphere(&m, 3, 20, 8);
	mesh_move(&m, 240, 20, -3, 7);
	box(&m, -40, 1.5);
	assert_int_equal(m.count, last[3]);
	ask(&q, 0, "ring", rho[0], "globe", rho[1], "box", rho[2], NULL);
	q.request.has_about = q.request.has_axis = true;
	q.request.about[0] = 3;
	q.request.about[2] = -11;
	q.request.axis_origin[0] = 3;
	q.request.axis_origin[2] = -11;
	q.request.axis_direction[1] = -2;
	good(&file, &q.request, &whole);
	for (int i = 0; i < 3; i++) {
		struct mesh part = {.tri = m.tri + last[i], .count = last[i + 1] - last[i]};
		const struct made_file alone = {.mesh = &part};
		struct mp_request plain = q.request;

		plain.named_count = 0;
		plain.density_kind = MP_DENSITY_GIVEN;
		plain.density = rho[i];
		good(&alone, &plain, &one);
		mass += one.total.mass;
		for (int k = 0; k < 3; k++) {
			first[k] += one.total.mass * one.total.centroid[k];
			for (int j = 0; j < 3; j++)
				about[k][j] += one.inertia_about[k][j];
		}
		assert_relative(whole.body[i].mass.mass, one.total.mass, 1e-15);
		mp_report_free(&one);
	}
	assert_relative(whole.total.mass, mass, 1e-15);
	for (int k = 0; k < 3; k++) {
		assert_near(whole.total.centroid[k], first[k] / mass, 1e-14);
		for (int j = 0; j < 3; j++)
			assert_near(whole.inertia_about[k][j], about[k][j], 1e-14 * about[1][1]);
	}
	assert_relative(whole.axis.moment, about[1][1], 1e-14);
	assert_relative(whole.radii_of_gyration[2],
			sqrt(whole.principal.moments[2] / whole.total.mass), 1e-14);
	mp_report_free(&whole);
	mesh_free(&m);
}

static void one_density_for_all_is_the_density(void **state)
{
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = two};
	struct mp_report named, plain;
	struct asked q;

	(void)state;
	two_boxes(&m);
	mesh_move(&m, 0, 1e6, 3e6, -2e6);
	ask(&q, 0, "a", 2.7, "b", 2.7, NULL);
	good(&file, &q.request, &named);
	ask(&q, 2.7, NULL);
	good(&file, &q.request, &plain);
	assert_relative(named.total.mass, plain.total.mass, 1e-16);
	assert_relative(named.density, 2.7, 1e-16);
	for (int i = 0; i < 9; i++)
		assert_near(named.total.inertia[i / 3][i % 3], plain.total.inertia[i / 3][i % 3],
			    1e-15 * plain.total.inertia[2][2]);
	assert_memory_equal(named.total.centroid, plain.total.centroid, 3 * sizeof(double));
	mp_report_free(&named);
	mp_report_free(&plain);
	mesh_free(&m);
}

static void other_names_take_the_density(void **state)
{
	const struct made_range names[] = {
	    {12, "steel"}, {24, "paint"}, {30, "more paint"}, {0, NULL}};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .materials = names};
	struct mp_report r;
	struct mp_error err;
	struct asked q;

	(void)state;
	box(&m, 0, 1);  /* without a name */
	box(&m, 5, 1);  /* steel */
	box(&m, 10, 1); /* in two colours */
	ask(&q, 3.0, "steel", 8.0, NULL);
	good(&file, &q.request, &r);
	assert_relative(r.total.mass, 3 + 8 + 3, 1e-15);
	assert_relative(r.total.centroid[0], (3 * 0.5 + 8 * 5.5 + 3 * 10.5) / 14, 1e-15);
	mp_report_free(&r);
	ask(&q, 0, "steel", 8.0, NULL); /* faces without a name */
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == UINT64_MAX && err.actual == 0);
	ask(&q, 3.0, "more paint", 8.0, NULL); /* half a box */
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == 0 && err.actual == 30);
	mesh_free(&m);
}

static void a_name_without_faces_is_refused(void **state)
{
	const struct made_range names[] = {{0, "a"}, {12, "b"}, {24, "none"}, {0, NULL}};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = names};
	struct mp_error err;
	struct asked q;

	(void)state;
	two_boxes(&m);
	ask(&q, 1.0, "a", 1.0, "c", 1.0, NULL);
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == 1 && err.actual == UINT64_MAX);
	ask(&q, 1.0, "none", 1.0, NULL);
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == 0 && err.actual == UINT64_MAX);
	ask(&q, 1.0, "A", 1.0, NULL); /* names are bytes */
	(void)refused(&file, 1, &q.request);
	ask(&q, 0, "a", 1.0, NULL); /* b has none */
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == UINT64_MAX && err.actual == 12);
	mesh_free(&m);
}

static void a_name_that_is_no_solid_is_refused(void **state)
{
	const struct made_range names[] = {{0, "a"}, {6, "b"}, {12, "c"}, {0, NULL}};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = names};
	struct mp_error err;
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m); /* the first is a and b */
	ask(&q, 1.0, "c", 2.0, NULL);
	good(&file, &q.request, &r);
	assert_relative(r.total.mass, 8 + 54, 1e-15);
	mp_report_free(&r);
	ask(&q, 1.0, "c", 2.0, "b", 2.0, NULL);
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == 1 && err.actual == 6);
	m.count--; /* c has a hole */
	ask(&q, 1.0, "c", 2.0, NULL);
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == 0 && err.actual == 12);
	m.count++;
	mesh_free(&m);
}

static void a_name_of_a_good_and_a_bad_body(void **state)
{
	const struct made_range names[] = {{0, "a"}, {12, "b"}, {0, NULL}};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = names};
	struct mp_error err;
	struct asked q;

	(void)state;
	two_boxes(&m);
	box(&m, 20, 1);
	m.count--;
	ask(&q, 1.0, "b", 2.0, NULL);
	err = refused(&file, 1, &q.request);
	assert_true(err.limit == 0 && err.actual == 12);
	m.count++;
	mesh_free(&m);
}

static void a_name_of_a_face_without_edges(void **state)
{
	const struct made_range names[] = {{0, "a"}, {12, "b"}, {0, NULL}};
	const double p[3] = {1, 2, 3};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = names};
	struct mp_report r;
	struct asked q;

	(void)state;
	box(&m, 0, 2);
	mesh_triangle(&m, p, p, p);
	ask(&q, 1.0, "b", 2.0, NULL);
	assert_int_equal(refused(&file, 1, &q.request).limit, 0);
	ask(&q, 1.0, "a", 2.0, NULL); /* under another name it is nothing */
	good(&file, &q.request, &r);
	assert_relative(r.total.mass, 16, 1e-15);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Then the whole is open, and says so as always. */
static void an_open_rest_has_no_mass(void **state)
{
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = two};
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m);
	m.count--;
	ask(&q, 1.0, "a", 2.0, NULL);
	good(&file, &q.request, &r);
	assert_false(r.total.volume_defined || r.total.mass_defined || r.total.centroid_defined ||
		     r.total.inertia_defined || r.density_defined || r.inertia_origin_defined);
	assert_true(r.has_density);
	assert_relative(r.body[0].mass.mass, 16, 1e-15);
	assert_false(r.body[1].mass.mass_defined);
	assert_int_equal(r.warnings, BIT(MP_WARN_OPEN));
	m.count++;
	mp_report_free(&r);
	mesh_free(&m);
}

/* Cubes that share an edge or a face in space are one body, with two names. */
static void solids_that_touch(void **state)
{
	for (int shift = 0; shift < 2; shift++) {
		const double low[3] = {0, 0, 0}, middle[3] = {1, 1, 1};
		const double from[3] = {1, shift, 0}, to[3] = {2, 1 + shift, 1};
		struct mesh m = {0};
		const struct made_file file = {.mesh = &m, .parts = two};
		struct mp_report r;
		struct asked q;

		(void)state;
		mesh_box(&m, low, middle);
		mesh_box(&m, from, to);
		ask(&q, 0, "a", 2.0, "b", 6.0, NULL);
		good(&file, &q.request, &r);
		assert_int_equal(r.topology.bodies, 1);
		assert_relative(r.total.volume, 2, 1e-15);
		assert_relative(r.total.mass, 8, 1e-15);
		assert_relative(r.total.centroid[0], (2 * 0.5 + 6 * 1.5) / 8, 1e-15);
		assert_relative(r.inertia_origin[0][1], -(2 * 0.25 + 6 * 1.5 * (0.5 + shift)),
				1e-15);
		/* one body of two densities */
		assert_true(r.body[0].mass.volume_defined);
		assert_false(r.body[0].mass.mass_defined || r.body[0].mass.inertia_defined);
		mp_report_free(&r);
		mesh_free(&m);
	}
}

/* A box whose lid meets its walls in T-junctions: open, but without a gap. */
static void cracked_box(struct mesh *m)
{
	const double min[3] = {20, 0, 0}, max[3] = {21, 1, 1};
	const double corner[5][3] = {{20, 0, 1}, {21, 0, 1}, {21, 1, 1}, {20, 1, 1}, {20.5, 0, 1}};
	size_t from = m->count, top = 0, kept = from;

	mesh_box(m, min, max);
	for (size_t i = from; i < m->count; i++) {
		const double *t = m->tri[i];

		if (t[2] == 1 && t[5] == 1 && t[8] == 1)
			top++;
		else
			memmove(m->tri[kept++], t, sizeof m->tri[0]);
	}
	assert_int_equal(top, 2);
	m->count = kept;
	mesh_triangle(m, corner[0], corner[4], corner[3]);
	mesh_triangle(m, corner[4], corner[1], corner[2]);
	mesh_triangle(m, corner[4], corner[2], corner[3]);
}

static void a_solid_with_cracks_weighs(void **state)
{
	struct mesh m = {0};
	const struct made_range names[] = {{0, "a"}, {24, "cracked"}, {0, NULL}};
	const struct made_file file = {.mesh = &m, .parts = names};
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m);
	cracked_box(&m);
	ask(&q, 0, "a", 1.0, "cracked", 4.0, NULL);
	good(&file, &q.request, &r);
	assert_false(r.topology.closed);
	assert_relative(r.total.mass, 35 + 4, 1e-15);
	assert_relative(r.total.centroid[0], (8 * 1 + 27 * 11.5 + 4 * 20.5) / 39, 1e-15);
	assert_int_equal(r.warnings, BIT(MP_WARN_CRACKS));
	mp_report_free(&r);
	mesh_free(&m);
}

/* The cavity of the housing is the housing's; what fills it is another solid. */
static void an_insert_in_a_housing(void **state)
{
	const double out[2][3] = {{0, 0, 0}, {4, 4, 4}}, in[2][3] = {{1, 1, 1}, {3, 3, 3}};
	const struct made_range names[] = {{0, "housing"}, {24, "insert"}, {0, NULL}};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .materials = names};
	struct mp_report r;
	struct asked q;

	(void)state;
	mesh_box(&m, out[0], out[1]);
	mesh_box(&m, in[0], in[1]);
	mesh_flip(&m, 12);
	mesh_box(&m, in[0], in[1]);
	ask(&q, 0, "housing", 1.0, "insert", 8.0, NULL);
	good(&file, &q.request, &r);
	assert_relative(r.total.volume, 64, 1e-15);
	assert_relative(r.total.mass, 64 - 8 + 64, 1e-15);
	assert_relative(r.total.inertia[0][0], (64 * 32 - 8 * 8) / 12.0 + 64 * 8 / 12.0, 1e-15);
	assert_false(MP_WARNED(&r, MP_WARN_NAME_AGAINST));
	mp_report_free(&r);
	mesh_free(&m);
}

static void inside_out_is_the_solid_it_means(void **state)
{
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = two};
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m);
	ask(&q, 0, "a", 2.0, "b", 5.0, NULL);
	mesh_flip(&m, 12); /* b alone */
	good(&file, &q.request, &r);
	assert_relative(r.total.volume, 8 - 27, 1e-15);
	assert_relative(r.total.mass, 16 + 135, 1e-15);
	assert_relative(r.total.centroid[0], (16 * 1 + 135 * 11.5) / 151, 1e-15);
	assert_true(MP_WARNED(&r, MP_WARN_NAME_AGAINST));
	mp_report_free(&r);
	mesh_flip(&m, 12);
	q.request.flip = true; /* both */
	good(&file, &q.request, &r);
	assert_relative(r.total.volume, -35, 1e-15);
	assert_relative(r.total.mass, 151, 1e-15);
	assert_relative(r.inertia_origin[0][1], -(16 * 1 * 1 + 135 * 11.5 * 1.5), 1e-15);
	assert_false(MP_WARNED(&r, MP_WARN_NAME_AGAINST));
	assert_true(MP_WARNED(&r, MP_WARN_INSIDE_OUT));
	mp_report_free(&r);
	mesh_free(&m);
}

static void a_whole_without_volume_has_no_centroid(void **state)
{
	const struct made_range names[] = {{0, "a"}, {12, "b"}, {0, NULL}};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = names};
	struct mp_report r;
	struct asked q;

	(void)state;
	box(&m, 0, 2);
	box(&m, 8, 2);
	mesh_flip(&m, 12);
	ask(&q, 0, "a", 2.0, "b", 5.0, NULL);
	good(&file, &q.request, &r);
	assert_true(r.total.volume_defined && r.total.volume == 0);
	assert_true(r.total.mass_defined);
	assert_relative(r.total.mass, 8 * 7, 1e-15);
	assert_false(r.total.centroid_defined || r.total.inertia_defined || r.density_defined);
	assert_true(MP_WARNED(&r, MP_WARN_ZERO_VOLUME) && MP_WARNED(&r, MP_WARN_NAME_AGAINST));
	assert_false(MP_WARNED(&r, MP_WARN_OUT_OF_RANGE));
	mp_report_free(&r);
	mesh_free(&m);
}

/* Materials go before parts, in the files that have any. */
static void which_name_counts(void **state)
{
	const struct made_range parts[] = {{0, "p"}, {12, "q"}, {0, NULL}};
	const struct made_range materials[] = {{12, "m"}, {0, NULL}};
	struct mesh m[3] = {{0}};
	const struct made_file files[3] = {
	    {.mesh = &m[0], .parts = parts},                         /* p 1, q 8 */
	    {.mesh = &m[1], .parts = parts, .materials = materials}, /* none 64, m 1 */
	    {.mesh = &m[2], .parts = parts},                         /* p 27, q 8 */
	};
	const double sizes[3][2] = {{1, 2}, {4, 1}, {3, 2}};
	const char *const want[] = {"p", "q", "", "m", "p", "q"};
	struct mp_analysis *a;
	struct mp_error err;
	struct mp_report r;
	struct asked q;
	uint64_t t = 0;

	(void)state;
	for (int i = 0; i < 3; i++) {
		box(&m[i], 100 * i, sizes[i][0]);
		box(&m[i], 100 * i + 50, sizes[i][1]);
	}
	ask(&q, 1.0, "p", 10.0, "m", 100.0, NULL);
	assert_int_equal(made_report(files, 3, &q.request, &r, &err), 0);
	assert_relative(r.total.mass, 10 * (1 + 27) + 100 * 1 + 8 + 64 + 8, 1e-15);
	assert_int_equal(r.body[2].name_len, 1); /* a body's name is the part's all the same */
	assert_memory_equal(r.body[2].name, "p", 1);
	assert_memory_equal(r.body[3].name, "q", 1);
	mp_report_free(&r);
	a = made_analysis(files, 3, &q.request, &err);
	assert_non_null(a);
	for (size_t i = 0; i < 6; i++) {
		uint64_t end;
		size_t len;
		const char *name = mp_analysis_name(a, t, false, &len, &end);

		assert_int_equal(len, strlen(want[i]));
		assert_memory_equal(name, want[i], len);
		assert_int_equal(end, t + 12);
		t = end;
	}
	mp_analysis_free(a);
	for (int i = 0; i < 3; i++)
		mesh_free(&m[i]);
}

/* Where there are no materials: groups go before the objects they are in. */
static void objects_of_several_groups(void **state)
{
	const struct made_range objects[] = {{0, "housing"}, {12, "insert"}, {0, NULL}};
	const struct made_range groups[] = {{0, "front"},  {5, "back"},    {12, "left"},
					    {18, "right"}, {24, "insert"}, {0, NULL}};
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = groups, .objects = objects};
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m); /* 8, 27 */
	box(&m, 20, 1);
	ask(&q, 0, "housing", 2.0, "insert", 5.0, NULL);
	good(&file, &q.request, &r);
	assert_relative(r.total.mass, 2 * 8 + 5 * (27 + 1), 1e-15);
	assert_int_equal(r.body[0].name_len, 7);
	assert_memory_equal(r.body[0].name, "housing", 7);
	assert_memory_equal(r.body[2].name, "insert", 6);
	mp_report_free(&r);
	ask(&q, 0, "housing", 2.0, "insert", 5.0, "front", 1.0, NULL);
	assert_int_equal(refused(&file, 1, &q.request).limit, 0); /* the rest of the housing */
	mesh_free(&m);
}

static void names_may_return(void **state)
{
	const struct made_range names[] = {{0, "a"}, {3, "b"}, {9, "a"}, {18, "b"}, {0, NULL}};
	const size_t places[24] = {0, 1, 2, 12, 13, 14, 15, 16, 17, 3,  4,  5,
				   6, 7, 8, 9,  10, 11, 18, 19, 20, 21, 22, 23};
	struct mesh m = {0}, mixed = {0};
	const struct made_file file = {.mesh = &mixed, .materials = names};
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m);
	for (size_t i = 0; i < 24; i++) {
		const double *t = m.tri[places[i]];

		mesh_triangle(&mixed, t, t + 3, t + 6);
	}
	ask(&q, 0, "a", 2.0, "b", 5.0, NULL);
	good(&file, &q.request, &r);
	assert_relative(r.total.mass, 151, 1e-15);
	mp_report_free(&r);
	mesh_free(&m);
	mesh_free(&mixed);
}

static void stl_solids_have_names(void **state)
{
	struct mp_request request;
	struct mesh m = {0};
	struct mp_error err;
	struct mp_report r;
	struct asked q;
	uint8_t *first, *second, *file;
	size_t n, k;

	(void)state;
	box(&m, 0, 2);
	first = mesh_stl_ascii(&m, "lower half", &n);
	mesh_move(&m, 0, 9, 0, 0);
	second = mesh_stl_ascii(&m, "upper", &k);
	file = malloc(n + k);
	assert_non_null(file);
	memcpy(file, first, n);
	memcpy(file + n, second, k);
	ask(&q, 0, "upper", 1.0, "lower half", 3.0, NULL);
	request = q.request;
	assert_int_equal(report_of_file(file, n + k, 7, &request, &r, &err), 0);
	assert_relative(r.total.mass, 8 + 24, 1e-15);
	assert_relative(r.total.centroid[0], (3 * 1 + 10) / 4.0, 1e-15);
	mp_report_free(&r);
	free(first);
	free(second);
	free(file);
	mesh_free(&m);
}

static void a_thousand_names(void **state)
{
	static char text[MP_MOST_NAMED][16];
	static struct mp_named_density list[MP_MOST_NAMED];
	static struct made_range names[MP_MOST_NAMED + 1];
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = names};
	struct mp_request request = request_plain();
	struct mp_report r;
	double mass = 0;

	(void)state;
	for (int i = 0; i < MP_MOST_NAMED; i++) {
		mesh_wedge(&m, 1, 1, 6);
		mesh_move(&m, 4 * (size_t)i, 0.5 * i, 0, 0); /* they all touch and overlap */
		(void)snprintf(text[i], sizeof text[i], "part %d", i);
		names[i] = (struct made_range){4 * (uint64_t)i, text[i]};
		list[MP_MOST_NAMED - 1 - i] =
		    (struct mp_named_density){text[i], strlen(text[i]), i + 1, 0, 0};
		mass += i + 1;
	}
	assert_int_equal(m.count, 4 * MP_MOST_NAMED);
	request.named = list;
	request.named_count = MP_MOST_NAMED;
	good(&file, &request, &r);
	assert_relative(r.total.mass, mass, 1e-14);
	mp_report_free(&r);
	mesh_free(&m);
}

static void out_of_range_masses_are_not_defined(void **state)
{
	struct mesh m = {0};
	const struct made_file file = {.mesh = &m, .parts = two};
	struct mp_report r;
	struct asked q;

	(void)state;
	two_boxes(&m);
	ask(&q, 1.0, "a", 1e308, NULL);
	good(&file, &q.request, &r);
	assert_true(r.total.volume_defined && r.total.centroid_defined);
	assert_false(r.total.mass_defined || r.total.inertia_defined);
	assert_true(MP_WARNED(&r, MP_WARN_OUT_OF_RANGE));
	mp_report_free(&r);
	mesh_free(&m);
}

/* All paths: bodies of their own, shared ones, several files, materials. */
static void failing_allocations(void **state)
{
	const struct made_range names[] = {{0, "a"}, {12, "b"}, {24, "c"}, {36, "d"}, {0, NULL}};
	struct mesh m[2] = {{0}};
	const struct made_file files[2] = {
	    {.mesh = &m[0], .parts = names},
	    {.mesh = &m[1], .parts = names, .materials = names},
	};
	struct mp_error err;
	struct mp_report r;
	struct asked q;
	long last;

	(void)state;
	two_boxes(&m[0]);
	box(&m[0], 30, 1);
	box(&m[0], 31, 1); /* c and d are one body */
	two_boxes(&m[1]);
	mesh_move(&m[1], 0, 0, 50, 0);
	ask(&q, 1.0, "a", 2.0, "d", 3.0, NULL);
	last = alloc_count();
	assert_int_equal(made_report(files, 2, &q.request, &r, &err), 0);
	assert_relative(r.total.mass, 16 + 27 + 1 + 3 + 16 + 27, 1e-15);
	mp_report_free(&r);
	last = alloc_count() - last;
	for (long n = 1; n <= last; n++) {
		int ret;

		alloc_fail_at(n);
		ret = made_report(files, 2, &q.request, &r, &err);
		alloc_fail_at(0);
		if (ret == 0) { /* shrinking may fail */
			assert_relative(r.total.mass, 90, 1e-15);
			mp_report_free(&r);
		} else {
			assert_int_equal(err.code, MP_NOMEM);
		}
	}
	mesh_free(&m[0]);
	mesh_free(&m[1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(each_name_weighs_by_itself),
	    cmocka_unit_test(sums_of_separate_files),
	    cmocka_unit_test(one_density_for_all_is_the_density),
	    cmocka_unit_test(other_names_take_the_density),
	    cmocka_unit_test(a_name_without_faces_is_refused),
	    cmocka_unit_test(a_name_that_is_no_solid_is_refused),
	    cmocka_unit_test(a_name_of_a_good_and_a_bad_body),
	    cmocka_unit_test(a_name_of_a_face_without_edges),
	    cmocka_unit_test(an_open_rest_has_no_mass),
	    cmocka_unit_test(solids_that_touch),
	    cmocka_unit_test(a_solid_with_cracks_weighs),
	    cmocka_unit_test(an_insert_in_a_housing),
	    cmocka_unit_test(inside_out_is_the_solid_it_means),
	    cmocka_unit_test(a_whole_without_volume_has_no_centroid),
	    cmocka_unit_test(which_name_counts),
	    cmocka_unit_test(objects_of_several_groups),
	    cmocka_unit_test(names_may_return),
	    cmocka_unit_test(stl_solids_have_names),
	    cmocka_unit_test(a_thousand_names),
	    cmocka_unit_test(out_of_range_masses_are_not_defined),
	    cmocka_unit_test(failing_allocations),
	};

	return cmocka_run_group_tests_name("density_names", tests, NULL, NULL);
}
