/* checks=closed: reports without a table, against those with one. */
#include "core/analysis.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/predicates.h"
#include "tests/unit/alloc_fail.h"
#include "tests/unit/mesh_random.h"
#include "tests/unit/report_of.h"

static struct mp_request request_closed(void)
{
	struct mp_request r = request_plain();

	r.checks = MP_CHECKS_CLOSED;
	return r;
}

/* Of both kinds, from the same bytes. */
struct pair {
	struct mp_report full, closed;
};

static void look(const struct mesh *m, bool flip, struct pair *p)
{
	struct mp_request full = request_plain(), closed = request_closed();

	full.precision = MP_WISH_CERTIFIED;
	full.flip = closed.flip = flip;
	report_of_ascii(m, &full, &p->full);
	report_of_ascii(m, &closed, &p->closed);
}

static void forget(struct pair *p)
{
	mp_report_free(&p->full);
	mp_report_free(&p->closed);
}

static void assert_bounded(double a, double bound_a, double b, double bound_b)
{
	if (!(fabs(a - b) <= bound_a + bound_b))
		fail_msg("%.17g +- %g and %.17g +- %g", a, bound_a, b, bound_b);
}

static void assert_agree(const struct pair *p)
{
	const struct mp_report *f = &p->full, *c = &p->closed;

	assert_true(c->streamed && !f->streamed);
	assert_int_equal(c->topology.closed, f->topology.closed);
	assert_int_equal(c->topology.degenerate_triangles, f->topology.degenerate_triangles);
	assert_int_equal(c->triangles, f->triangles);
	assert_int_equal(c->flipped_triangles, f->flipped_triangles);
	assert_memory_equal(&c->box, &f->box, sizeof c->box);
	assert_int_equal(c->precision, MP_PRECISION_CERTIFIED);
	if (c->total.area_defined && f->total.area_defined)
		assert_bounded(c->total.area, c->bounds.area, f->total.area, f->bounds.area);
	if (!f->topology.closed) {
		assert_false(c->total.volume_defined || c->total.centroid_defined);
		assert_true(MP_WARNED(c, MP_WARN_NOT_CLOSED));
		assert_int_equal(c->solid, MP_NO);
		assert_int_equal(c->orientation, MP_ORIENTATION_NONE);
		return;
	}
	assert_false(MP_WARNED(c, MP_WARN_NOT_CLOSED));
	if (c->total.volume_defined && f->total.volume_defined)
		assert_bounded(c->total.volume, c->bounds.volume, f->total.volume,
			       f->bounds.volume);
	if (c->total.inertia_defined && f->total.inertia_defined)
		for (int i = 0; i < 9; i++)
			assert_bounded(c->total.inertia[i / 3][i % 3], c->bounds.inertia,
				       f->total.inertia[i / 3][i % 3], f->bounds.inertia);
	assert_true(c->solid == MP_UNDECIDED || (c->solid == MP_NO && f->solid == MP_NO));
	if (c->total.volume_defined && c->total.volume != 0)
		assert_int_equal(c->orientation, c->total.volume > 0 ? MP_ORIENTATION_OUTWARD
								     : MP_ORIENTATION_INWARD);
}

static void reverse(double tri[9])
{
	for (int k = 0; k < 3; k++) {
		double x = tri[3 + k];

		tri[3 + k] = tri[6 + k];
		tri[6 + k] = x;
	}
}

/* Something that may or may not open the mesh. */
static void damage(struct mesh *m, uint64_t *state)
{
	size_t i = random_bits(state) % m->count, j = random_bits(state) % m->count;
	double t[9]; /* the list may move */

	memcpy(t, m->tri[i], sizeof t);
	switch (random_bits(state) % 8) {
	case 0:
		memmove(m->tri + i, m->tri + i + 1, (--m->count - i) * sizeof *m->tri);
		break;
	case 1:
		reverse(m->tri[i]);
		break;
	case 2:
		mesh_triangle(m, t, t + 3, t + 6);
		break;
	case 3: /* the same, and its other side */
		mesh_triangle(m, t, t + 6, t + 3);
		mesh_triangle(m, t, t + 3, t + 6);
		break;
	case 4: /* a corner moves to another place */
		memcpy(m->tri[i] + 3, m->tri[j], 3 * sizeof(double));
		break;
	case 5: /* a corner twice, a needle along an edge */
		mesh_triangle(m, t, t, t + 3);
		break;
	case 6: /* the last digit of a coordinate */
		m->tri[i][4] = nextafter(m->tri[i][4], 0);
		break;
	default:
		break;
	}
}

static void test_verdicts_are_those_of_the_table(void **unused)
{
	uint64_t state = 11;
	int closed = 0, open = 0;

	(void)unused;
	for (int i = 0; i < 3000; i++) {
		struct random_mesh r;
		struct pair p;

		mesh_random(&r, &state);
		for (int k = i % 3; k > 0 && r.mesh.count > 2; k--)
			damage(&r.mesh, &state);
		look(&r.mesh, i % 5 == 0, &p);
		assert_agree(&p);
		closed += p.full.topology.closed;
		open += !p.full.topology.closed;
		forget(&p);
		mesh_free(&r.mesh);
	}
	print_message("# closed: %d, open: %d\n", closed, open);
	assert_true(closed > 1000 && open > 1000);
}

/* The order of facets changes roundings, within their bounds, and nothing else. */
static void test_the_order_of_facets_changes_no_verdict(void **unused)
{
	uint64_t state = 12;

	(void)unused;
	for (int i = 0; i < 100; i++) {
		struct mp_request request = request_closed();
		struct mp_report before, after;
		struct random_mesh r;

		mesh_random(&r, &state);
		if (i % 2 == 0)
			r.mesh.count--;
		report_of_ascii(&r.mesh, &request, &before);
		for (size_t n = r.mesh.count; n > 1; n--) {
			size_t k = random_bits(&state) % n;
			double t[9];

			memcpy(t, r.mesh.tri[n - 1], sizeof t);
			memcpy(r.mesh.tri[n - 1], r.mesh.tri[k], sizeof t);
			memcpy(r.mesh.tri[k], t, sizeof t);
		}
		report_of_ascii(&r.mesh, &request, &after);
		assert_int_equal(before.topology.closed, after.topology.closed);
		assert_int_equal(before.topology.closed, i % 2 != 0);
		assert_int_equal(before.topology.degenerate_triangles,
				 after.topology.degenerate_triangles);
		assert_memory_equal(&before.box, &after.box, sizeof before.box);
		if (before.total.volume_defined && after.total.volume_defined)
			assert_bounded(before.total.volume, before.bounds.volume,
				       after.total.volume, after.bounds.volume);
		mp_report_free(&before);
		mp_report_free(&after);
		mesh_free(&r.mesh);
	}
}

/* Both formats, every key, every chunk: one report. */
static void test_chunks_and_keys_change_nothing(void **unused)
{
	static const size_t STEP[] = {1, 7, 49, 50, 51, 84, 4096, 65536};
	struct mesh m = {0};

	(void)unused;
	mesh_torus(&m, 3.3, 1.1, 40, 20);
	for (int text = 0; text < 2; text++) {
		size_t size;
		uint8_t *file =
		    text ? mesh_stl_ascii(&m, "ring", &size) : mesh_stl_binary(&m, NULL, &size);
		struct mp_request request = request_closed();
		struct mp_report whole, other;
		struct mp_error err;

		assert_int_equal(report_of_file(file, size, 0, &request, &whole, &err), 0);
		assert_true(whole.topology.closed);
		for (size_t i = 0; i < sizeof STEP / sizeof *STEP; i++) {
			request.key[i] ^= 0x55;
			assert_int_equal(
			    report_of_file(file, size, STEP[i], &request, &other, &err), 0);
			assert_memory_equal(&whole, &other, sizeof whole); /* it owns nothing */
			mp_report_free(&other);
		}
		mp_report_free(&whole);
		free(file);
	}
	mesh_free(&m);
}

/* As many allocations and no larger ones, however long the file. */
static void test_nothing_is_allocated_for_a_triangle(void **unused)
{
	struct mp_request request = request_closed();
	long asked[2];

	(void)unused;
	request.limits.max_triangles = 10; /* is for tables */
	for (int i = 0; i < 2; i++) {
		struct mp_error err;
		struct mp_report r;
		struct mesh m = {0};
		struct mp_analysis *a;
		uint8_t *file;
		size_t size;

		mesh_torus(&m, 3.3, 1.1, i == 0 ? 10 : 300, 100);
		file = mesh_stl_binary(&m, NULL, &size);
		asked[i] = alloc_count();
		a = mp_analysis_new(&request, &err);
		assert_non_null(a);
		assert_int_equal(mp_analysis_push(a, file, size, &err), 0);
		assert_int_equal(mp_analysis_end(a, &err), 0);
		assert_int_equal(mp_analysis_report(a, &request, &r, &err), 0);
		asked[i] = alloc_count() - asked[i];
		assert_int_equal(r.triangles, m.count);
		assert_true(r.topology.closed);
		mp_report_free(&r);
		mp_analysis_free(a);
		free(file);
		mesh_free(&m);
	}
	assert_int_equal(asked[0], asked[1]);
	assert_true(asked[0] < 10);
}

static void test_each_allocation_may_fail(void **unused)
{
	struct mp_request request = request_closed();
	struct mesh m = {0};
	size_t size;
	uint8_t *file;
	int ret = -1;

	(void)unused;
	mesh_wedge(&m, 1, 2, 3);
	file = mesh_stl_binary(&m, NULL, &size);
	for (long n = 1; ret != 0; n++) {
		struct mp_analysis *a;
		struct mp_report r = {0};
		struct mp_error err = {0};

		alloc_fail_at(n);
		a = mp_analysis_new(&request, &err);
		ret = a == NULL || mp_analysis_push(a, file, size, &err) ||
			      mp_analysis_end(a, &err) || mp_analysis_report(a, &request, &r, &err)
			  ? -1
			  : 0;
		alloc_fail_at(0);
		if (ret != 0)
			assert_int_equal(err.code, MP_NOMEM);
		mp_report_free(&r);
		mp_analysis_free(a);
	}
	free(file);
	mesh_free(&m);
}

/* The same error, byte and line as with a table. */
static void test_a_facet_that_is_not_finite_is_refused_alike(void **unused)
{
	struct mp_request full = request_plain(), closed = request_closed();
	struct mesh m = {0};

	(void)unused;
	mesh_sphere(&m, 1, 30, 20);
	for (size_t at = 0; at < m.count; at += 97) {
		struct mp_error a = {0}, b = {0};
		struct mp_report r;
		size_t size;
		uint8_t *file = mesh_stl_binary(&m, NULL, &size);

		memcpy(file + 84 + 50 * at + 12 + 4 * (at % 9), "\0\0\xc0\x7f", 4);
		assert_int_equal(report_of_file(file, size, 0, &full, &r, &a), -1);
		assert_int_equal(report_of_file(file, size, 333, &closed, &r, &b), -1);
		assert_int_equal(a.code, MP_NON_FINITE);
		assert_int_equal(b.code, a.code);
		assert_int_equal(b.byte, a.byte);
		assert_string_equal(b.text, a.text);
		free(file);
	}
	mesh_free(&m);
}

static void test_other_formats_are_refused(void **unused)
{
	static const char OBJ[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
	struct mp_request request = request_closed();
	struct mp_report r;
	struct mp_error err = {0};

	(void)unused;
	assert_int_equal(
	    report_of_file((const uint8_t *)OBJ, sizeof OBJ - 1, 0, &request, &r, &err), -1);
	assert_int_equal(err.code, MP_BAD_CHECKS);
	request.format = MP_WISH_DRACO;
	assert_null(mp_analysis_new(&request, &err));
	assert_int_equal(err.code, MP_BAD_CHECKS);
}

/* Two reports of the same files, with the option before or behind them. */
static int both(const char *const *file, const size_t *size, int files, bool late,
		struct mp_report *out, struct mp_error *err)
{
	struct mp_request first = late ? request_plain() : request_closed();
	struct mp_request last = request_closed();
	struct mp_analysis *a = mp_analysis_new(&first, err);
	int ret = 0;

	memset(out, 0, sizeof *out);
	assert_non_null(a);
	for (int i = 0; i < files && ret == 0; i++) {
		ret = i > 0 ? mp_analysis_next(a, err) : 0;
		ret = ret ? ret : mp_analysis_push(a, (const uint8_t *)file[i], size[i], err);
	}
	ret = ret ? ret : mp_analysis_end(a, err);
	ret = ret ? ret : mp_analysis_report(a, &last, out, err);
	mp_analysis_free(a);
	return ret;
}

static void test_the_option_may_come_behind_the_files(void **unused)
{
	static const char OBJ[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
	uint64_t state = 13;

	(void)unused;
	for (int i = 0; i < 60; i++) {
		struct mp_report early, late;
		struct mp_error err = {0};
		struct random_mesh r = {.narrow = false};
		size_t size[2];
		char *file[2];

		do {
			mesh_free(&r.mesh);
			mesh_random(&r, &state);
		} while (!r.narrow);
		if (i % 3 == 0)
			damage(&r.mesh, &state);
		file[0] = (char *)mesh_stl_binary(&r.mesh, NULL, &size[0]);
		file[1] = (char *)mesh_stl_ascii(&r.mesh, "again", &size[1]);
		assert_int_equal(both((const char *const *)file, size, 2, false, &early, &err), 0);
		assert_int_equal(both((const char *const *)file, size, 2, true, &late, &err), 0);
		assert_int_equal(early.notes.format, MP_FORMAT_MIXED);
		mp_vertices_free(late.vertices);
		free(late.tri);
		late.vertices = NULL;
		late.tri = NULL;
		assert_memory_equal(&early, &late, sizeof early);
		free(file[0]);
		file[0] = malloc(sizeof OBJ);
		memcpy(file[0], OBJ, size[0] = sizeof OBJ - 1);
		assert_int_equal(both((const char *const *)file, size, 2, true, &late, &err), -1);
		assert_int_equal(err.code, MP_BAD_CHECKS);
		free(file[0]);
		free(file[1]);
		mesh_free(&r.mesh);
	}
}

/* A flat surface of two sides has no volume, and nobody knows a sign. */
static void test_a_sheet_has_no_orientation(void **unused)
{
	struct mp_request request = request_closed();
	const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0.25}, c[3] = {0, 1, 0.5};
	struct mp_report r;
	struct mesh m = {0};

	(void)unused;
	mesh_triangle(&m, a, b, c);
	mesh_triangle(&m, a, c, b);
	report_of_binary(&m, &request, &r);
	assert_true(r.topology.closed && r.total.volume_defined);
	assert_true(r.total.volume == 0 && !r.total.centroid_defined);
	assert_int_equal(r.orientation, MP_ORIENTATION_NONE);
	assert_int_equal(r.solid, MP_UNDECIDED);
	assert_true(MP_WARNED(&r, MP_WARN_ZERO_VOLUME));
	mp_report_free(&r);
	mesh_free(&m);
}

/* Nothing but triangles without edges is no closed surface. */
static void test_no_edges_are_not_closed(void **unused)
{
	const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0.25}, c[3] = {2, 0, 0.5};
	struct mesh m = {0};
	struct pair p;

	(void)unused;
	mesh_triangle(&m, a, b, b);
	mesh_triangle(&m, c, c, c);
	look(&m, false, &p);
	assert_false(p.closed.topology.closed);
	assert_agree(&p);
	forget(&p);
	mesh_triangle(&m, a, b, c); /* a needle and its other side: no area, yet edges */
	mesh_triangle(&m, b, a, c);
	look(&m, false, &p);
	assert_true(p.closed.topology.closed);
	assert_int_equal(p.closed.topology.degenerate_triangles, 4);
	assert_true(p.closed.total.volume_defined && p.closed.total.volume == 0);
	assert_agree(&p);
	forget(&p);
	mesh_free(&m);
}

static void test_collinear_triangles_are_counted_exactly(void **unused)
{
	uint64_t state = 14;

	(void)unused;
	for (int i = 0; i < 3000; i++) {
		double t[1][9], e = ldexp(1, (int)(random_bits(&state) % 600) - 300);
		double s = random_between(&state, -2, 2), *p = t[0];

		for (int k = 0; k < 3; k++) {
			p[k] = e * (double)(int)(random_bits(&state) % 64);
			p[3 + k] = e * (double)(int)(random_bits(&state) % 64);
			p[6 + k] = i % 4 == 0   ? 2 * p[3 + k] - p[k]
				   : i % 4 == 1 ? p[k] + s * (p[3 + k] - p[k])
						: e * (double)(int)(random_bits(&state) % 4);
		}
		assert_int_equal(mp_collinear_count((const double(*)[9])t, 1),
				 mp_collinear(p, p + 3, p + 6));
		if (i % 4 == 0)
			assert_int_equal(mp_collinear_count((const double(*)[9])t, 1), 1);
	}
}

/* Triangles of floats: every third on a line, some nearly so, in blocks of every size. */
static void test_all_kernels_count_the_same_collinear_triangles(void **unused)
{
	uint64_t state = 15;

	(void)unused;
	for (size_t i = 0; i < 2000; i++) {
		size_t count = i < 30 ? i : random_bits(&state) % (MP_BLOCK + 1), want = 0;
		float(*xyz)[MP_BLOCK] = malloc(9 * sizeof *xyz);
		int exponent = (int)(random_bits(&state) % 240) - 130;
		double chance = i % 2 == 0 ? 0.01 : 0.3;

		assert_non_null(xyz);
		for (size_t t = 0; t < count; t++) {
			double p[9];

			for (size_t k = 0; k < 9; k++)
				p[k] = (double)(int)(random_bits(&state) % 64);
			for (size_t k = 0; k < 3 && random_chance(&state, chance); k++)
				p[6 + k] = 2 * p[3 + k] - p[k];
			for (size_t k = 0; k < 9; k++) {
				xyz[k][t] = (float)ldexp(p[k], exponent);
				p[k] = (double)xyz[k][t];
			}
			want += (size_t)mp_collinear(p, p + 3, p + 6);
		}
		for (size_t k = 0; k < mp_collinear_kernels(); k++)
			assert_int_equal(
			    mp_collinear_count_with(k, (const float(*)[MP_BLOCK])xyz, count), want);
		assert_int_equal(mp_collinear_count_floats((const float(*)[MP_BLOCK])xyz, count),
				 want);
		free(xyz);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_all_kernels_count_the_same_collinear_triangles),
	    cmocka_unit_test(test_verdicts_are_those_of_the_table),
	    cmocka_unit_test(test_the_order_of_facets_changes_no_verdict),
	    cmocka_unit_test(test_chunks_and_keys_change_nothing),
	    cmocka_unit_test(test_nothing_is_allocated_for_a_triangle),
	    cmocka_unit_test(test_each_allocation_may_fail),
	    cmocka_unit_test(test_a_facet_that_is_not_finite_is_refused_alike),
	    cmocka_unit_test(test_other_formats_are_refused),
	    cmocka_unit_test(test_the_option_may_come_behind_the_files),
	    cmocka_unit_test(test_a_sheet_has_no_orientation),
	    cmocka_unit_test(test_no_edges_are_not_closed),
	    cmocka_unit_test(test_collinear_triangles_are_counted_exactly),
	};

	return cmocka_run_group_tests_name("streamed", tests, NULL, NULL);
}
