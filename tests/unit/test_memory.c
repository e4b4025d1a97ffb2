#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/report_of.h"

/* How much memory a report of a million triangles takes at its worst moment, decoding included. */

enum { AROUND = 1000, SECTION = 500, TRIANGLES = 2 * AROUND * SECTION };

static const double TURN = 6.283185307179586;

/* Corner ${k} of triangle ${t} of a ring, as it stands in a binary STL. */
static void corner(uint32_t t, int k, float out[3])
{
	static const unsigned at[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
	const unsigned *by = at[t % 2][k];
	double u = TURN * ((t / 2 / SECTION + by[0]) % AROUND) / AROUND;
	double v = TURN * ((t / 2 % SECTION + by[1]) % SECTION) / SECTION, r = 3 + cos(v);

	out[0] = (float)(r * cos(u));
	out[1] = (float)(r * sin(u));
	out[2] = (float)sin(v);
}

typedef void spoil(uint32_t t, float xyz[9]);

static void facet(uint32_t t, spoil *how, uint8_t out[50])
{
	float xyz[9];

	memset(out, 0, 50);
	for (int k = 0; k < 3; k++)
		corner(t, k, xyz + 3 * k);
	if (how != NULL)
		how(t, xyz);
	memcpy(out + 12, xyz, sizeof xyz);
}

/* Bytes a triangle of the first ${count} of them, each as ${how} leaves it. */
static double bytes_each(uint32_t count, spoil *how, struct mp_report *r)
{
	struct mp_request request = request_plain();
	uint8_t head[84] = {0}, block[50 * 64];
	struct mp_error err = {0};
	struct mp_analysis *a;

	for (int i = 0; i < 4; i++)
		head[80 + i] = (uint8_t)(count >> 8 * i);
	alloc_peak_begin();
	a = mp_analysis_new(&request, &err);
	assert_non_null(a);
	assert_int_equal(mp_analysis_push(a, head, sizeof head, &err), 0);
	for (uint32_t t = 0; t < count;) {
		size_t len = 0;

		for (; len < sizeof block && t < count; len += 50)
			facet(t++, how, block + len);
		assert_int_equal(mp_analysis_push(a, block, len, &err), 0);
	}
	assert_int_equal(mp_analysis_end(a, &err), 0);
	assert_int_equal(mp_analysis_report(a, &request, r, &err), 0);
	mp_analysis_free(a);
	return (double)alloc_peak() / count;
}

static void a_good_mesh_takes_less_than_100_bytes_a_triangle(void **unused)
{
	struct mp_report r;
	double each = bytes_each(TRIANGLES, NULL, &r);

	(void)unused;
	print_message("# %.1f bytes a triangle\n", each);
	assert_true(r.topology.watertight);
	assert_true(each > 18 && each <= 100); /* three vertex numbers, half a vertex of 12 bytes */
	mp_report_free(&r);
}

static void a_mesh_with_a_hole_too(void **unused)
{
	struct mp_report r;
	double each = bytes_each(TRIANGLES - 1, NULL, &r);

	(void)unused;
	print_message("# %.1f bytes a triangle\n", each);
	assert_int_equal(r.topology.boundary_edges, 3);
	assert_true(r.capped.volume_defined && each <= 100);
	mp_report_free(&r);
}

static void turn_and_repeat(uint32_t t, float xyz[9])
{
	float b[3];

	if (t % 10 == 0 && t % 1009 != 3)
		return;
	if (t % 1009 == 3) /* as the one before */
		for (int k = 0; k < 3; k++)
			corner(t - 1, k, xyz + 3 * k);
	memcpy(b, xyz + 3, sizeof b);
	memcpy(xyz + 3, xyz + 6, sizeof b);
	memcpy(xyz + 6, b, sizeof b);
}

static void one_full_of_defects_too(void **unused)
{
	struct mp_report r;
	double each = bytes_each(TRIANGLES, turn_and_repeat, &r);

	(void)unused;
	print_message("# %.1f bytes a triangle\n", each);
	assert_true(r.topology.misoriented_edges > 100000);
	assert_true(r.topology.duplicate_triangles > 900 && r.topology.boundary_loops > 500);
	assert_true(each <= 100);
	mp_report_free(&r);
}

/* No two of a million triangles have a corner in common: six times the vertices of a good mesh. */
static void scatter(uint32_t t, float xyz[9])
{
	for (int k = 0; k < 3; k++) {
		xyz[3 * k] = (float)(t % 1000) + (k == 1 ? 0.5f : 0);
		xyz[3 * k + 1] = (float)(t / 1000) + (k == 2 ? 0.5f : 0);
		xyz[3 * k + 2] = 0;
	}
}

static void single_triangles_take_what_their_vertices_take(void **unused)
{
	struct mp_report r;
	double each = bytes_each(TRIANGLES, scatter, &r);

	(void)unused;
	print_message("# %.1f bytes a triangle\n", each);
	assert_int_equal(r.topology.boundary_loops, TRIANGLES);
	assert_true(each <= 250);
	mp_report_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_good_mesh_takes_less_than_100_bytes_a_triangle),
	    cmocka_unit_test(a_mesh_with_a_hole_too),
	    cmocka_unit_test(one_full_of_defects_too),
	    cmocka_unit_test(single_triangles_take_what_their_vertices_take),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
