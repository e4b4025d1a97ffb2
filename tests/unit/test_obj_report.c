#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/report_of.h"

/* OBJ files through the whole of core. */

static void report_of(const char *text, struct mp_report *r)
{
	struct mp_request request = request_plain();
	struct mp_error err;

	if (report_of_file((const uint8_t *)text, strlen(text), 0, &request, r, &err) != 0) {
		print_error("%s\n", err.text);
		fail();
	}
	assert_int_equal(r->notes.format, MP_FORMAT_OBJ);
}

#define BOX_VERTICES "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4\n"

#define BOX          \
	BOX_VERTICES \
	"f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"

static void test_a_box_of_quads(void **state)
{
	struct mp_report r;

	(void)state;
	report_of(BOX, &r);
	assert_true(r.total.volume == 24 && r.total.area == 52);
	assert_int_equal(r.notes.polygons, 6);
	assert_int_equal(r.triangles, 12);
	assert_true(r.topology.watertight);
	assert_int_equal(r.warnings, 0);
	mp_report_free(&r);
}

/* A plate with a hole from keyhole polygons, through and through. */
static void test_a_plate_with_a_hole(void **state)
{
	struct mp_report r;

	(void)state;
	report_of("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 3 1 0\nv 3 3 0\nv 1 3 0\n"
		  "v 0 0 1\nv 4 0 1\nv 4 4 1\nv 0 4 1\nv 1 1 1\nv 3 1 1\nv 3 3 1\nv 1 3 1\n"
		  "f 9 10 11 12 9 13 16 15 14 13\nf 1 4 3 2 1 5 6 7 8 5\n"
		  "f 1 2 10 9\nf 2 3 11 10\nf 3 4 12 11\nf 4 1 9 12\n"
		  "f 5 13 14 6\nf 6 14 15 7\nf 7 15 16 8\nf 8 16 13 5\n",
		  &r);
	assert_true(r.total.volume == 12);
	assert_near(r.total.area, 2 * 12 + 16 + 8, 1e-14);
	assert_true(r.topology.watertight);
	assert_int_equal(r.topology.bodies, 1);
	assert_int_equal(r.topology.euler, 0);
	assert_int_equal(r.topology.degenerate_triangles, 0);
	assert_int_equal(r.warnings, 0);
	mp_report_free(&r);
}

static bool is_called(const struct mp_body *body, const char *name)
{
	if (name == NULL)
		return body->name == NULL;
	return body->name != NULL && body->name_len == strlen(name) &&
	       memcmp(body->name, name, strlen(name)) == 0;
}

#define TETRA(x)                                                 \
	"v " x " 0 0\nv " x ".5 0 0\nv " x " 1 0\nv " x " 0 1\n" \
	"f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\n"

#define LAST "f -4 -1 -2\n"

static void test_names_of_bodies(void **state)
{
	struct mp_report r;

	(void)state;
	report_of("o one\n" TETRA("0") LAST
		  "o two\ng a\n" TETRA("1") "g b\n" LAST "g three\nusemtl m\n" TETRA("2") LAST
		  "o\nusemtl steel\n" TETRA("3") LAST "usemtl x\n" TETRA("4") "usemtl y\n" LAST,
		  &r);
	assert_int_equal(r.bodies_listed, 5);
	assert_true(is_called(&r.body[0], "one"));
	assert_true(is_called(&r.body[1], "two")); /* of several groups */
	assert_true(is_called(&r.body[2], "three"));
	assert_true(is_called(&r.body[3], "steel"));
	assert_true(is_called(&r.body[4], NULL));
	mp_report_free(&r);
}

/* A body that is written in pieces, with others between them, has the name that all pieces have. */
static void test_names_of_bodies_in_pieces(void **state)
{
	struct mp_report r;

	(void)state;
	report_of(BOX_VERTICES "v 9 0 0\nv 9 1 0\nv 9 0 1\nv 8 0 0\n"
			       "g box\nf 1 4 3 2\nf 5 6 7 8\ng tetra\nf 9 10 11\nf 9 12 10\n"
			       "g box\nf 1 2 6 5\nf 2 3 7 6\ng tetra\nf 10 12 11\nf 9 11 12\n"
			       "g box\nf 3 4 8 7\nf 4 1 5 8\n",
		  &r);
	assert_int_equal(r.bodies_listed, 2);
	assert_true(is_called(&r.body[0], "box"));
	assert_true(is_called(&r.body[1], "tetra"));
	mp_report_free(&r);
}

/* One place under two numbers: open by number, closed by coordinates, which is what counts. */
static void test_vertices_by_number(void **state)
{
	struct mp_report r;

	(void)state;
	report_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -0\n"
		  "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 5 4 3\n",
		  &r);
	assert_true(r.topology.watertight);
	assert_true(r.by_index.given);
	assert_false(r.by_index.watertight);
	assert_int_equal(r.by_index.boundary_edges, 4);
	mp_report_free(&r);
	report_of(BOX, &r);
	assert_false(r.by_index.given);
	mp_report_free(&r);
}

static void test_what_is_warned_of(void **state)
{
	struct mp_report r;

	(void)state;
	report_of("v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3 4\nf 4 3 2 1\nF 1\n", &r);
	assert_true(MP_WARNED(&r, MP_WARN_NONPLANAR) && MP_WARNED(&r, MP_WARN_NONSTANDARD));
	assert_false(MP_WARNED(&r, MP_WARN_TANGLED) || MP_WARNED(&r, MP_WARN_NUL_BYTES));
	mp_report_free(&r);
	report_of("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\nf 1 2 3 4\nf 4 3 2 1\n\x1a", &r);
	assert_true(MP_WARNED(&r, MP_WARN_TANGLED) && MP_WARNED(&r, MP_WARN_NUL_BYTES));
	assert_false(MP_WARNED(&r, MP_WARN_NONPLANAR) || MP_WARNED(&r, MP_WARN_NONSTANDARD));
	mp_report_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_a_box_of_quads),
	    cmocka_unit_test(test_a_plate_with_a_hole),
	    cmocka_unit_test(test_names_of_bodies),
	    cmocka_unit_test(test_names_of_bodies_in_pieces),
	    cmocka_unit_test(test_vertices_by_number),
	    cmocka_unit_test(test_what_is_warned_of),
	};

	return cmocka_run_group_tests_name("obj_report", tests, NULL, NULL);
}
