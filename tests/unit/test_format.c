#include "core/format.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/report_of.h"

static const double ORIGIN[3] = {0, 0, 0};

static enum mp_code refusal(const void *bytes, size_t size, size_t step, enum mp_format_wish format,
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

/* Found by its first statement, however it is written. */
static void test_obj_goes_to_its_decoder(void **state)
{
	static const char *const FOUND[] = {
	    "v 0 0 0\n",
	    "# a comment\r\no part\r\n\r\n  v 1 -2 .5\r\nf 1 1 1\r\n",
	    "\xef\xbb\xbf# x\rmtllib a.mtl\r",
	    "\t\ng solid\nsolid facet",
	    "what\nf -1 -2 -3\n",
	    "f 1/2/3 4 5\\\n",
	    "vn 0 0 1",
	    "vt 1 1\n",
	    "s off\n",
	    "usemtl steel\n",
	    "cstype bezier\n",
	    "p 1\n",
	    "# only comments\n\n  #\n",
	};
	static const char *const NOT_FOUND[] = {
	    "solid v\nv 1 2 3\n",  "v\nf\no \ng\n",  "v x\nf a b c\n", "V 1 2 3\n",
	    "# x\nwhat\n",         "vertex 1 2 3\n", "\n\n",           "ply\nformat ascii 1.0\n",
	    "OFF\n8 6 0\n1 1 1\n",
	};

	(void)state;
	for (size_t i = 0; i < sizeof FOUND / sizeof *FOUND; i++) {
		char text[100];
		size_t len = strlen(FOUND[i]);

		assert_int_equal(mp_format_sniff((const uint8_t *)FOUND[i], len), MP_WISH_OBJ);
		/* ZBrush ends its files with a byte 0 and a line end */
		memcpy(text, FOUND[i], len);
		memcpy(text + len, "\n\0\n", 3);
		for (size_t more = 1; more <= 3; more++)
			assert_int_equal(mp_format_sniff((uint8_t *)text, len + more), MP_WISH_OBJ);
		/* a byte 0 in the middle is no text */
		memcpy(text + len, "\0x", 2);
		assert_int_equal(mp_format_sniff((uint8_t *)text, len + 2), MP_WISH_STL);
	}
	for (size_t i = 0; i < sizeof NOT_FOUND / sizeof *NOT_FOUND; i++)
		assert_int_equal(
		    mp_format_sniff((const uint8_t *)NOT_FOUND[i], strlen(NOT_FOUND[i])),
		    MP_WISH_STL);
}

static void test_draco_goes_to_its_decoder(void **state)
{
	static const uint8_t DRACO[] = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 9, 9};
	struct mp_error err;

	(void)state;
	assert_int_equal(refusal(DRACO, sizeof DRACO, 1, MP_WISH_AUTO, &err), MP_TRUNCATED);
	assert_int_equal(refusal(DRACO, sizeof DRACO, 1, MP_WISH_DRACO, &err), MP_TRUNCATED);
	assert_int_equal(refusal("", 0, 0, MP_WISH_DRACO, &err), MP_EMPTY);
	assert_int_equal(refusal("solid", 5, 0, MP_WISH_DRACO, &err), MP_SYNTAX);
}

static void test_obj_longer_than_the_first_bytes(void **state)
{
	char text[20000];
	struct mp_error err;

	(void)state;
	for (size_t at = 0; at < sizeof text; at++)
		text[at] = "v 1.5 2.25 -0.12345\n"[at % 20];
	assert_int_equal(refusal(text, sizeof text, 0, MP_WISH_AUTO, &err), MP_NO_FACES);
	assert_int_equal(refusal(text, sizeof text, 777, MP_WISH_AUTO, &err), MP_NO_FACES);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_obj_goes_to_its_decoder),
	    cmocka_unit_test(test_draco_goes_to_its_decoder),
	    cmocka_unit_test(test_obj_longer_than_the_first_bytes),
	    cmocka_unit_test(test_stl_with_the_words_of_others),
	    cmocka_unit_test(test_what_is_no_mesh),
	};

	return cmocka_run_group_tests_name("format", tests, NULL, NULL);
}
