#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/mesh_make.h"
#include "tests/unit/mesh_random.h"
#include "tests/unit/report_of.h"

static bool same(const double a[3], const double b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool touches(const double *t, const double *u)
{
	for (int i = 0; i < 9; i += 3)
		for (int j = 0; j < 9; j += 3)
			if (same(t + i, u + j))
				return true;
	return false;
}

/* Takes out a third of the triangles at most, no two of which touch; returns how many. */
static size_t perforate(struct mesh *m, uint64_t *state)
{
	double out[64][9];
	size_t holes = 0, most = 1 + random_bits(state) % 60;

	for (size_t tries = 0; tries < 200 && holes < most; tries++) {
		size_t t = random_bits(state) % m->count, i = 0;

		while (i < holes && !touches(out[i], m->tri[t]))
			i++;
		if (i < holes || m->count < 8)
			continue;
		memcpy(out[holes++], m->tri[t], sizeof *out);
		memmove(m->tri[t], m->tri[--m->count], sizeof *out);
	}
	return holes;
}

static double size_of(const struct mp_report *r)
{
	double size = 0;

	for (int k = 0; k < 3; k++)
		size = fmax(size, r->box.max[k] - r->box.min[k]);
	return size;
}

static double farthest(const struct mp_report *r)
{
	double far = 0;

	for (int k = 0; k < 3; k++)
		far = fmax(far, fmax(fabs(r->box.min[k]), fabs(r->box.max[k])));
	return far;
}

/*
 * Any closed mesh, anywhere, with single triangles taken out: what is missing is flat, so the
 * volume comes back, but for what the doubles of the fans' tips lose.
 */
static void single_triangles_taken_out_are_put_back(void **unused)
{
	struct mp_request certified = request_plain();
	int seen = 0;

	(void)unused;
	certified.precision = MP_WISH_CERTIFIED; /* for the bound of such sums */
	for (uint64_t seed = 0; seed < 3000; seed++) {
		uint64_t state = seed;
		struct random_mesh m;
		struct mp_report whole, open;
		double tip, area;
		size_t holes;

		mesh_random(&m, &state);
		report_of_ascii(&m.mesh, &certified, &whole);
		holes = perforate(&m.mesh, &state);
		report_of_ascii(&m.mesh, NULL, &open);
		assert_true(!whole.capped.volume_defined && !whole.capped.area_defined);
		tip = 4 * DBL_EPSILON * farthest(&whole);
		area = whole.total.area;
		if (holes > 0 && whole.topology.watertight && whole.total.area_defined &&
		    whole.total.volume_defined && open.topology.boundary_loops == holes &&
		    tip * 4 < size_of(&whole) * 1e-3 && area < 1e100 && area > 1e-100) {
			assert_true(open.capped.volume_defined && open.capped.area_defined);
			assert_near(open.capped.volume, fabs(whole.total.volume),
				    4 * whole.bounds.volume + 2 * tip * area);
			assert_near(open.capped.area + open.total.area, area,
				    1e-13 * area + tip * (double)holes * 8 * size_of(&whole));
			seen++;
		}
		mp_report_free(&whole);
		mp_report_free(&open);
		mesh_free(&m.mesh);
	}
	assert_true(seen > 1000);
}

/* Without lids: a tube of any length, wherever it stands. */
static void a_tube_gets_its_lids(void **unused)
{
	static const double far[] = {0, 1, 1e3, 1e6, 1e9, 1e12};

	(void)unused;
	for (size_t i = 0; i < sizeof far / sizeof *far; i++) {
		const double min[3] = {0, 0, 0}, max[3] = {4, 3, 2};
		struct mesh box = {0}, tube = {0};
		struct mp_report r;

		mesh_box(&box, min, max);
		for (size_t t = 0; t < box.count; t++) {
			const double *v = box.tri[t];

			if (v[2] != v[5] || v[5] != v[8])
				mesh_triangle(&tube, v, v + 3, v + 6);
		}
		assert_int_equal(tube.count, 8);
		mesh_move(&tube, 0, far[i], -2 * far[i], 3 * far[i]);
		report_of_ascii(&tube, NULL, &r);
		assert_int_equal(r.topology.boundary_loops, 2);
		assert_true(r.capped.volume_defined && r.capped.volume == 24);
		assert_true(r.capped.area_defined && r.capped.area == 24);
		mp_report_free(&r);
		mesh_free(&box);
		mesh_free(&tube);
	}
}

/* A hole in each of two bodies, and a cavity's: all are closed, each where it is. */
static void holes_of_several_bodies(void **unused)
{
	const double low[3] = {0, 0, 0}, high[3] = {10, 10, 10}, in[3] = {4, 4, 4},
		     out[3] = {6, 6, 6}, away[3] = {1e6, 0, 0}, there[3] = {1e6 + 10, 10, 10};
	struct mesh m = {0};
	struct mp_report r;

	(void)unused;
	mesh_box(&m, in, out);
	mesh_flip(&m, 0);
	mesh_box(&m, low, high);
	mesh_box(&m, away, there);
	for (size_t body = 3; body-- > 0;)
		memmove(m.tri[12 * body], m.tri[--m.count], sizeof *m.tri);
	report_of_ascii(&m, NULL, &r);
	assert_int_equal(r.topology.boundary_loops, 3);
	assert_relative(r.capped.volume, 2000 - 8, 1e-12);
	assert_relative(r.capped.area, 2 + 50 + 50, 1e-10);
	mp_report_free(&r);
	mesh_free(&m);
}

static void expect_none(const struct mesh *m)
{
	struct mp_report r;

	report_of_ascii(m, NULL, &r);
	assert_false(r.capped.volume_defined || r.capped.area_defined);
	assert_true(r.capped.volume == 0 && r.capped.area == 0);
	mp_report_free(&r);
}

/* Nothing is capped that is closed, or that caps alone would not close. */
static void what_caps_do_not_close_has_no_estimate(void **unused)
{
	const double low[3] = {0, 0, 0}, high[3] = {10, 10, 10}, a[3] = {20, 0, 0},
		     b[3] = {20, 1, 0}, c[3] = {20, 0, 1}, d[3] = {20, -1, 0}, e[3] = {20, 0, -1};
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, low, high);
	expect_none(&m);
	mesh_triangle(&m, a, b, c);
	mesh_triangle(&m, a, b, d); /* the same way along a b */
	expect_none(&m);
	m.count--;
	mesh_triangle(&m, b, a, d);
	mesh_triangle(&m, b, a, e); /* a b is used three times */
	expect_none(&m);
	mesh_free(&m);
}

static void out_of_range_is_not_made_up(void **unused)
{
	const double low[3] = {0, 0, 0}, high[3] = {1e120, 1e120, 1e120};
	const double huge[3] = {1e308, 1e308, 1e308}, nearly[3] = {-1e308, -1e308, -1e308};
	struct mp_report r;
	struct mesh m = {0};

	(void)unused;
	mesh_box(&m, low, high);
	m.count -= 2;
	report_of_ascii(&m, NULL, &r);
	assert_false(r.capped.volume_defined);
	assert_true(r.capped.area_defined);
	assert_relative(r.capped.area, 1e240, 1e-14);
	mp_report_free(&r);
	mesh_free(&m);
	mesh_box(&m, nearly, huge);
	m.count -= 2;
	expect_none(&m);
	mesh_free(&m);
}

static void every_allocation_may_fail(void **unused)
{
	const struct mp_request request = request_plain();
	const double low[3] = {0, 0, 0}, high[3] = {1, 2, 3};
	struct mesh m = {0};
	uint8_t *file;
	size_t size;
	long n = 1;

	(void)unused;
	mesh_box(&m, low, high);
	m.count -= 2;
	file = mesh_stl_binary(&m, NULL, &size);
	for (;; n++) {
		long before = alloc_count();
		struct mp_error err = {0};
		struct mp_report r;
		int ret;

		alloc_fail_at(n);
		ret = report_of_file(file, size, 0, &request, &r, &err);
		alloc_fail_at(0);
		if (ret == 0)
			assert_true(r.capped.volume_defined && r.capped.volume == 6);
		else
			assert_int_equal(err.code, MP_NOMEM);
		mp_report_free(&r);
		if (alloc_count() - before < n)
			break;
	}
	assert_true(n > 50);
	free(file);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(single_triangles_taken_out_are_put_back),
	    cmocka_unit_test(a_tube_gets_its_lids),
	    cmocka_unit_test(holes_of_several_bodies),
	    cmocka_unit_test(what_caps_do_not_close_has_no_estimate),
	    cmocka_unit_test(out_of_range_is_not_made_up),
	    cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
