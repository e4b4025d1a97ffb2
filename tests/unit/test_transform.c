/* Reports of mapped meshes: closed forms, and the rational numbers that they are. */
#include "core/analysis.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/mesh_random.h"
#include "tests/unit/oracle.h"
#include "tests/unit/report_of.h"

typedef const double (*rows)[4];

static const double SIZE[3] = {40, 30, 20}, ORIGIN[3] = {0, 0, 0};
static const double PLAIN[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

/* Five times a turn about z, exactly. */
static const double TURN[3][4] = {{3, -4, 0, 0}, {4, 3, 0, 0}, {0, 0, 5, 0}};
static const double SHEAR[3][4] = {{1, 2, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
static const double MIRROR[3][4] = {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

static struct mp_request request_of(const double row[3][4], enum mp_precision_wish wish)
{
	struct mp_request request = request_plain();

	request.has_transform = true;
	memcpy(request.transform, row, sizeof request.transform);
	request.precision = wish;
	return request;
}

static void report_box(const struct mp_request *request, struct mp_report *r)
{
	struct mesh m = {0};

	mesh_box(&m, ORIGIN, SIZE);
	report_of_binary(&m, request, r);
	mesh_free(&m);
}

/* L C L^T for the box, whose C is diagonal. */
static double spread(const double row[3][4], int i, int j)
{
	double sum = 0;

	for (int k = 0; k < 3; k++)
		sum += row[i][k] * row[j][k] * SIZE[k] * SIZE[k] / 12;
	return sum;
}

/* Whatever the way to compute, all numbers here are small integers: nothing may be off. */
static void check_box(const double row[3][4], double volume, double area)
{
	for (int wish = MP_WISH_CERTIFIED; wish <= MP_WISH_EXACT; wish++) {
		struct mp_request request = request_of(row, (enum mp_precision_wish)wish);
		struct mp_report r;

		report_box(&request, &r);
		assert_relative(r.total.volume, volume, 1e-15);
		assert_true(fabs(r.total.volume - volume) <= r.bounds.volume);
		assert_relative(r.total.area, area, 1e-15);
		assert_true(fabs(r.total.area - area) <= r.bounds.area + 1e-15 * area);
		for (int i = 0; i < 3; i++) {
			double centre = row[i][3];

			for (int k = 0; k < 3; k++)
				centre += row[i][k] * SIZE[k] / 2;
			assert_near(r.total.centroid[i], centre, r.bounds.centroid);
			assert_near(r.surface_centroid[i], centre, 1e-12);
			for (int j = 0; j < 3; j++) {
				double want =
				    i != j ? -volume * spread(row, i, j)
					   : volume * (spread(row, (i + 1) % 3, (i + 1) % 3) +
						       spread(row, (i + 2) % 3, (i + 2) % 3));

				assert_near(r.total.inertia[i][j], want,
					    r.bounds.inertia + 4e-16 * fabs(want));
			}
			assert_true(r.closure_defect[i] == 0);
		}
		assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
		assert_int_equal(r.solid, MP_YES);
		assert_int_equal(r.flipped_triangles, 0);
		assert_int_equal(r.warnings, 0);
		mp_report_free(&r);
	}
}

static void test_box_turned_scaled_sheared_and_mirrored(void **unused)
{
	static const double SCALE[3][4] = {{2, 0, 0, 1}, {0, 3, 0, 2}, {0, 0, 0.5, 3}};
	static const double SWAP[3][4] = {{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 7}};
	static const double INSIDE[3][4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}};

	(void)unused;
	check_box(PLAIN, 24000, 5200);
	check_box(TURN, 125 * 24000, 25 * 5200);
	check_box(SCALE, 72000, 2 * (80 * 90 + 90 * 10 + 80 * 10));
	/* x + 2 y: the faces of constant x are parallelograms */
	check_box(SHEAR, 24000, 2 * (40 * 30 + 40 * 20 + 30 * 20 * sqrt(5)));
	check_box(MIRROR, 24000, 5200);
	check_box(SWAP, 24000, 5200);
	check_box(INSIDE, 24000, 5200);
}

static void test_turned_by_rounded_sines_is_near_and_bounded(void **unused)
{
	static const double ROUNDED[3][4] = {{0.6, -0.8, 0, 0}, {0.8, 0.6, 0, 0}, {0, 0, 1, 0}};
	struct mp_request request = request_of(ROUNDED, MP_WISH_EXACT);
	struct mp_report r;

	(void)unused;
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 2700;
	request.density_divisor = 1e9;
	report_box(&request, &r);
	assert_relative(r.total.volume, 24000, 3e-16);
	assert_relative(r.total.area, 5200, 1e-15);
	assert_relative(r.total.inertia[0][0], 7.02 * 0.36 + 10.8 * 0.64, 1e-15);
	assert_relative(r.total.inertia[0][1], (7.02 - 10.8) * 0.48, 1e-15);
	assert_near(r.box.min[0], -24, 1e-14);
	assert_near(r.box.max[1], 50, 1e-14);
	assert_relative(r.principal.moments[0], 7.02, 1e-15);
	assert_near(fabs(r.principal.axes[0][0]), 0.6, 1e-15);
	mp_report_free(&r);
}

static void test_far_away_nothing_is_lost(void **unused)
{
	static const double FAR[3][4] = {{1, 0, 0, 1e6}, {0, 1, 0, -2e6}, {0, 0, 1, 1e6}};
	struct mp_report far, near;

	(void)unused;
	for (int wish = MP_WISH_CERTIFIED; wish <= MP_WISH_EXACT; wish++) {
		struct mp_request request = request_of(FAR, (enum mp_precision_wish)wish);
		struct mesh m = {0};

		mesh_sphere(&m, 10, 17, 9);
		report_of_binary(&m, &request, &far);
		request.has_transform = false;
		report_of_binary(&m, &request, &near);
		assert_true(far.total.volume == near.total.volume && near.bounds.volume > 0);
		assert_true(far.bounds.volume <= 1.01 * near.bounds.volume);
		assert_true(far.total.area == near.total.area);
		assert_memory_equal(far.total.inertia, near.total.inertia,
				    sizeof near.total.inertia);
		for (int k = 0; k < 3; k++) {
			assert_true(far.total.centroid[k] == near.total.centroid[k] + FAR[k][3]);
			assert_true(far.box.min[k] == near.box.min[k] + FAR[k][3]);
		}
		mp_report_free(&far);
		mp_report_free(&near);
		mesh_free(&m);
	}
}

/* Of everything that a report says in numbers. */
static void assert_same(const struct mp_report *a, const struct mp_report *b)
{
	assert_memory_equal(&a->total, &b->total, sizeof a->total);
	assert_memory_equal(&a->box, &b->box, sizeof a->box);
	assert_memory_equal(&a->bounds, &b->bounds, sizeof a->bounds);
	assert_memory_equal(a->surface_centroid, b->surface_centroid, sizeof a->surface_centroid);
	assert_memory_equal(a->inertia_origin, b->inertia_origin, sizeof a->inertia_origin);
	assert_memory_equal(a->inertia_about, b->inertia_about, sizeof a->inertia_about);
	assert_memory_equal(&a->axis, &b->axis, sizeof a->axis);
	assert_int_equal(a->bodies_listed, b->bodies_listed);
	for (uint32_t i = 0; i < a->bodies_listed; i++) {
		assert_memory_equal(&a->body[i].mass, &b->body[i].mass, sizeof a->body[i].mass);
		assert_memory_equal(&a->body[i].box, &b->body[i].box, sizeof a->body[i].box);
	}
	assert_int_equal(a->warnings, b->warnings);
}

static void test_what_changes_nothing_changes_no_bit(void **unused)
{
	struct mp_request request = request_of(PLAIN, MP_WISH_CERTIFIED);
	struct mp_report with, without;
	struct mesh m = {0};

	(void)unused;
	mesh_torus(&m, 3, 1, 17, 9);
	report_of_binary(&m, &request, &with);
	request.has_transform = false;
	report_of_binary(&m, &request, &without);
	assert_false(with.mapped);
	assert_same(&with, &without);
	mp_report_free(&with);
	mp_report_free(&without);
	mesh_free(&m);
}

static void test_flipping_a_mirrored_solid(void **unused)
{
	struct mp_request request = request_of(MIRROR, MP_WISH_PRECISION_AUTO);
	struct mp_report r;

	(void)unused;
	request.flip = true;
	report_box(&request, &r);
	assert_true(r.total.volume == -24000 && MP_WARNED(&r, MP_WARN_INSIDE_OUT));
	assert_int_equal(r.orientation, MP_ORIENTATION_INWARD);
	assert_int_equal(r.flipped_triangles, 12);
	mp_report_free(&r);
}

static void test_points_and_axes_are_in_the_mapped_frame(void **unused)
{
	static const double MAP[3][4] = {{0, 0, 2, 100}, {2, 0, 0, 0}, {0, 2, 0, 0}};
	const double centre[3] = {120, 40, 30};

	(void)unused;
	for (int wish = MP_WISH_CERTIFIED; wish <= MP_WISH_EXACT; wish++) {
		struct mp_request request = request_of(MAP, (enum mp_precision_wish)wish);
		struct mp_report r;

		request.has_about = request.has_axis = true;
		memcpy(request.about, centre, sizeof centre);
		memcpy(request.axis_origin, centre, sizeof centre);
		request.axis_direction[1] = 3; /* was x */
		report_box(&request, &r);
		assert_true(r.inertia_about_defined && r.axis_defined);
		assert_memory_equal(r.inertia_about, r.total.inertia, sizeof r.inertia_about);
		assert_relative(r.axis.moment, 192000.0 * (60 * 60 + 40 * 40) / 12, 1e-15);
		assert_true(r.axis.direction[1] == 1);
		mp_report_free(&r);
	}
}

static void test_a_weighed_mass_stays(void **unused)
{
	struct mp_request request = request_of(TURN, MP_WISH_CERTIFIED);
	struct mp_report r;

	(void)unused;
	request.density_kind = MP_DENSITY_FROM_MASS;
	request.density = 6;
	report_box(&request, &r);
	assert_true(r.total.mass == 6 && r.density == 6.0 / 3000000);
	assert_relative(r.total.inertia[2][2], 6 * 25 * (40.0 * 40 + 30 * 30) / 12, 1e-15);
	mp_report_free(&r);
}

static void test_bodies_are_mapped_one_by_one(void **unused)
{
	const double inner[2][3] = {{10, 10, 5}, {20, 20, 10}},
		     apart[2][3] = {{100, 0, 0}, {101, 1, 1}};

	(void)unused;
	for (int wish = MP_WISH_CERTIFIED; wish <= MP_WISH_EXACT; wish++) {
		struct mp_request request = request_of(SHEAR, (enum mp_precision_wish)wish);
		struct mesh m = {0};
		struct mp_report r;

		mesh_box(&m, ORIGIN, SIZE);
		mesh_box(&m, inner[0], inner[1]);
		mesh_flip(&m, 12);
		mesh_box(&m, apart[0], apart[1]);
		report_of_binary(&m, &request, &r);
		assert_int_equal(r.bodies_listed, 3);
		assert_relative(r.total.volume, 24000 - 500 + 1, 1e-15);
		assert_true(r.body[1].cavity && r.body[1].nest.depth == 1);
		assert_relative(r.body[1].mass.volume, -500, 1e-15);
		assert_relative(r.body[1].mass.area, 2 * (100 + 50 + 50 * sqrt(5)), 1e-15);
		assert_relative(r.body[1].mass.centroid[0], 15 + 2 * 15, 1e-15);
		assert_true(r.body[1].box.min[0] == 30 && r.body[1].box.max[0] == 60);
		assert_relative(r.body[2].mass.inertia[0][0], 1 / 6.0, 1e-12);
		assert_true(r.body[2].box.min[0] == 100 && r.body[2].box.max[0] == 103);
		assert_int_equal(r.orientation, MP_ORIENTATION_OUTWARD);
		mp_report_free(&r);
		mesh_free(&m);
	}
}

static const char NAMED[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
			    "v 9 0 0\nv 11 0 0\nv 9 2 0\nv 9 0 2\n"
			    "usemtl light\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
			    "usemtl heavy\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";

static void test_densities_by_name(void **unused)
{
	static const double MAP[3][4] = {{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, -2, 0}};
	const struct mp_named_density named[2] = {{"light", 5, 3, 1, 0}, {"heavy", 5, 6, 1, 0}};
	struct mp_request request = request_of(MAP, MP_WISH_PRECISION_AUTO);
	struct mp_error err = {0};
	struct mp_report r;

	(void)unused;
	request.named = named;
	request.named_count = 2;
	assert_int_equal(
	    report_of_file((const uint8_t *)NAMED, sizeof NAMED - 1, 0, &request, &r, &err), 0);
	assert_relative(r.total.volume, 8 * (1 + 8) / 6.0, 1e-15);
	assert_relative(r.total.mass, 8 * (3 * 1 + 6 * 8) / 6.0, 1e-15);
	assert_relative(r.total.centroid[0], 2 * (0.25 * 3 + 9.5 * 48) / 51, 1e-15);
	assert_relative(r.total.centroid[2], -2 * (0.25 * 3 + 0.5 * 48) / 51, 1e-15);
	assert_relative(r.body[0].mass.mass, 4, 1e-15);
	assert_relative(r.body[1].mass.mass, 64, 1e-15);
	assert_relative(r.density, 51 / 9.0, 1e-15);
	assert_relative(r.total.area, 4 * 5 * (1.5 + sqrt(3) / 2), 1e-15);
	mp_report_free(&r);
}

static void test_defects_loops_and_caps_are_mapped(void **unused)
{
	static const double MAP[3][4] = {{2, 0, 0, 5}, {0, 3, 0, 0}, {0, 0, -1, 0}};
	struct mp_request request = request_of(MAP, MP_WISH_PRECISION_AUTO);
	struct mesh m = {0};
	struct mp_report r;
	double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX};

	(void)unused;
	mesh_box(&m, ORIGIN, SIZE);
	m.count -= 2; /* some face is missing */
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.topology.boundary_loops, 1);
	assert_relative(r.total.area + r.topology.loop[0].area, 2 * (80 * 90 + 90 * 20 + 80 * 20),
			1e-15);
	for (int k = 0; k < 3; k++) {
		const struct mp_defect_list *d = &r.topology.defect[MP_DEFECT_BOUNDARY_LOOP];

		for (size_t i = 0; i < d->vertex_at[1]; i++) {
			double x[3];

			mp_report_vertex(&r, d->vertices[i], x);
			low[k] = fmin(low[k], x[k]);
		}
		assert_true(r.topology.loop[0].min[k] == low[k]);
		assert_true(r.topology.loop[0].min[k] >= r.box.min[k]);
		assert_true(fabs(r.closure_defect[k]) == 0 ||
			    fabs(r.closure_defect[k]) == r.topology.loop[0].area);
	}
	assert_true(r.capped.volume_defined && r.capped.area_defined);
	assert_relative(r.capped.volume, 6 * 24000, 1e-14);
	assert_relative(r.capped.area, r.topology.loop[0].area, 1e-14);
	mp_report_free(&r);
	mesh_free(&m);
}

/* A corner that is off by 1/8 in the file is off by 1/64 in what is measured. */
static void test_weld_is_in_the_mapped_frame(void **unused)
{
	static const double MAP[3][4] = {{0.125, 0, 0, 1e5}, {0, 1, 0, 0}, {0, 0, -0.125, 0}};

	(void)unused;
	for (int near = 0; near < 2; near++) {
		struct mp_request request = request_of(MAP, MP_WISH_PRECISION_AUTO);
		struct mesh m = {0};
		struct mp_report r;

		mesh_box(&m, ORIGIN, SIZE);
		for (int k = 0; k < 3; k++)
			if (m.tri[3][3 * k] == SIZE[0])
				m.tri[3][3 * k] += 0.125;
		request.weld = near ? 0x1.1p-6 : 0x1p-6;
		report_of_binary(&m, &request, &r);
		assert_int_equal(r.topology.closed, near);
		assert_int_equal(r.welded_vertices > 0, near);
		assert_true(r.box.max[0] == 1e5 + (near ? 5 : 5 + 0x1p-6));
		mp_report_free(&r);
		mesh_free(&m);
	}
}

static void test_uncertainty_is_mapped(void **unused)
{
	static const double TWICE[3][4] = {{0, 2, 0, 1e3}, {0, 0, -2, 0}, {2, 0, 0, 0}};
	struct mp_request request = request_of(TWICE, MP_WISH_CERTIFIED);
	struct mp_report twice, turned, plain;
	struct mesh m = {0};

	(void)unused;
	mesh_sphere(&m, 10, 17, 9);
	mesh_move(&m, 0, 100, 0, 0); /* so that x is rounded more than the others */
	report_of_binary(&m, &request, &twice);
	memcpy(request.transform, TURN, sizeof TURN);
	report_of_binary(&m, &request, &turned);
	request.has_transform = false;
	report_of_binary(&m, &request, &plain);
	assert_relative(twice.uncertainty.volume, 8 * plain.uncertainty.volume, 1e-6);
	assert_relative(twice.uncertainty.centroid, 2 * plain.uncertainty.centroid, 1e-6);
	assert_relative(turned.uncertainty.volume, 125 * plain.uncertainty.volume, 1e-6);
	/* y is 4 x + 3 y; of 5 times the length no axis sees more */
	assert_true(turned.uncertainty.centroid > 3.99 * plain.uncertainty.centroid);
	assert_true(turned.uncertainty.centroid < 5.01 * plain.uncertainty.centroid);
	mp_report_free(&twice);
	mp_report_free(&turned);
	mp_report_free(&plain);
	mesh_free(&m);
}

/* The request that comes with the report may be another one than at the beginning. */
static void test_a_transform_may_come_after_the_file(void **unused)
{
	struct mp_request late = request_of(SHEAR, MP_WISH_CERTIFIED), early = request_plain();
	struct mp_report one, other;
	struct mp_analysis *a = mp_analysis_new(&early, NULL);
	struct mesh m = {0};
	uint8_t *file;
	size_t size;

	(void)unused;
	mesh_torus(&m, 3, 1, 17, 9);
	file = mesh_stl_binary(&m, NULL, &size);
	assert_non_null(a);
	assert_int_equal(mp_analysis_push(a, file, size, NULL), 0);
	assert_int_equal(mp_analysis_end(a, NULL), 0);
	assert_int_equal(mp_analysis_report(a, &late, &one, NULL), 0);
	report_of_binary(&m, &late, &other);
	assert_same(&one, &other);
	mp_report_free(&one);
	mp_report_free(&other);
	mp_analysis_free(a);
	free(file);
	mesh_free(&m);
}

static void check_refused(const double row[3][4])
{
	struct mp_request request = request_of(row, MP_WISH_PRECISION_AUTO);
	struct mp_error err = {0};
	struct mesh m = {0};
	struct mp_report r;
	uint8_t *file;
	size_t size;

	mesh_box(&m, ORIGIN, SIZE);
	file = mesh_stl_binary(&m, NULL, &size);
	assert_int_equal(report_of_file(file, size, 0, &request, &r, &err), -1);
	assert_int_equal(err.code, MP_BAD_MAP);
	free(file);
	mesh_free(&m);
}

static void test_singular_and_beyond_the_doubles(void **unused)
{
	static const double FLAT[3][4] = {{1, 2, 3, 0}, {2, 4, 6, 0}, {0, 0, 1, 0}};
	static const double WIDE[3][4] = {{1e307, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
	static const double HUGE_ONE[3][4] = {{1e150, 0, 0, 0}, {0, 1e150, 0, 0}, {0, 0, 1e150, 0}};
	struct mp_request request = request_of(HUGE_ONE, MP_WISH_PRECISION_AUTO);
	struct mp_report r;

	(void)unused;
	check_refused(FLAT);
	check_refused(WIDE);
	report_box(&request, &r);
	assert_false(r.total.volume_defined);
	assert_true(r.total.area_defined && r.total.centroid_defined);
	assert_relative(r.total.area, 5200e300, 1e-15);
	assert_true(MP_WARNED(&r, MP_WARN_OUT_OF_RANGE));
	assert_true(r.box.max[0] == 40e150);
	mp_report_free(&r);
}

/* Nearly singular ones among them. */
static void draw_map(uint64_t *state, struct mp_request *request)
{
	struct mp_affine map;

	do {
		for (int k = 0; k < 12; k++)
			request->transform[k / 4][k % 4] =
			    random_chance(state, 0.3) ? 0 : random_between(state, -10, 10);
		if (random_chance(state, 0.2))
			for (int k = 0; k < 3; k++)
				request->transform[2][k] =
				    request->transform[0][k] - request->transform[1][k];
	} while (!mp_affine_set(&map, (rows)request->transform));
}

static void check_exact(const struct oracle *o, const struct mp_report *r)
{
	mpq_t tensor[3][3], one;

	mpq_init(one);
	mpq_set_ui(one, 1, 1);
	assert_true(oracle_is_nearest(o->volume, r->total.volume));
	for (int i = 0; i < 3; i++) {
		assert_true(oracle_is_nearest(o->centroid[i], r->total.centroid[i]));
		mpq_inits(tensor[i][0], tensor[i][1], tensor[i][2], NULL);
	}
	oracle_inertia(o, NULL, one, tensor);
	for (int i = 0; i < 9; i++)
		assert_true(
		    oracle_is_nearest(tensor[i / 3][i % 3], r->total.inertia[i / 3][i % 3]));
	oracle_inertia(o, ORIGIN, one, tensor);
	for (int i = 0; i < 9; i++)
		assert_true(
		    oracle_is_nearest(tensor[i / 3][i % 3], r->inertia_origin[i / 3][i % 3]));
	for (int i = 0; i < 3; i++)
		mpq_clears(tensor[i][0], tensor[i][1], tensor[i][2], NULL);
	mpq_clear(one);
}

static void test_exact_results_are_the_rounded_rationals(void **unused)
{
	struct mp_request request = request_of(PLAIN, MP_WISH_EXACT);
	uint64_t state = 314159;
	int seen = 0;

	(void)unused;
	for (int i = 0; i < 300; i++) {
		struct random_mesh random;
		struct mp_report r;
		struct oracle o;

		mesh_random(&random, &state);
		draw_map(&state, &request);
		report_of_ascii(&random.mesh, &request, &r);
		oracle_init(&o);
		oracle_find_mapped(&o, (const double(*)[9])random.mesh.tri, random.mesh.count,
				   (rows)request.transform);
		if (r.precision == MP_PRECISION_EXACT && r.inertia_origin_defined) {
			check_exact(&o, &r);
			seen++;
		}
		oracle_clear(&o);
		mp_report_free(&r);
		mesh_free(&random.mesh);
	}
	assert_true(seen > 200);
}

static void test_every_allocation_may_fail(void **unused)
{
	struct mp_request request = request_of(SHEAR, MP_WISH_EXACT);
	struct mesh m = {0};

	(void)unused;
	request.weld = 0x1p-12;
	mesh_box(&m, ORIGIN, SIZE);
	report_without_memory(&m, &request, 1000);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_box_turned_scaled_sheared_and_mirrored),
	    cmocka_unit_test(test_turned_by_rounded_sines_is_near_and_bounded),
	    cmocka_unit_test(test_far_away_nothing_is_lost),
	    cmocka_unit_test(test_what_changes_nothing_changes_no_bit),
	    cmocka_unit_test(test_flipping_a_mirrored_solid),
	    cmocka_unit_test(test_points_and_axes_are_in_the_mapped_frame),
	    cmocka_unit_test(test_a_weighed_mass_stays),
	    cmocka_unit_test(test_bodies_are_mapped_one_by_one),
	    cmocka_unit_test(test_densities_by_name),
	    cmocka_unit_test(test_defects_loops_and_caps_are_mapped),
	    cmocka_unit_test(test_weld_is_in_the_mapped_frame),
	    cmocka_unit_test(test_uncertainty_is_mapped),
	    cmocka_unit_test(test_a_transform_may_come_after_the_file),
	    cmocka_unit_test(test_singular_and_beyond_the_doubles),
	    cmocka_unit_test(test_exact_results_are_the_rounded_rationals),
	    cmocka_unit_test(test_every_allocation_may_fail),
	};

	return cmocka_run_group_tests_name("transform", tests, NULL, NULL);
}
