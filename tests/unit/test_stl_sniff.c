#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stl_binary_file.h"

/* Telling binary STL, text STL and what is neither from each other. */

static void a_header_may_say_anything(void **state)
{
	static const char *const headers[] = {
	    "solid",
	    "solid name\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendsolid",
	    "facet normal 0 0 1 outer loop",
	    "SOLID\r\nFACET",
	    "\xef\xbb\xbfsolid x\nendsolid",
	    "\x80\xff\xfe caf\xe9",
	    "# solid\nsolid\nfacet",
	    "PK\x03\x04",
	    "<html>",
	    "version https://git-lfs",
	};

	(void)state;
	for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++) {
		check_accepted(make(2, headers[i]), 2);
		check_accepted(make(200, headers[i]), 200); /* longer than the window */
	}
	memset(file, 0xff, 80);
	check_accepted(84 + 50 * 200, 200);
}

static size_t put_text(const char *text)
{
	memset(file, 0, sizeof file);
	strcpy((char *)file, text);
	return strlen(text);
}

static void other_files_are_named(void **state)
{
	size_t len;

	(void)state;
	len =
	    put_text("version https://git-lfs.github.com/spec/v1\n"
		     "oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\n"
		     "size 12345\n");
	check_refused(len, MP_SYNTAX, 0, "Git LFS");
	check_refused(60, MP_SYNTAX, 0, "Git LFS");
	len = put_text("\n <!DOCTYPE html>\n<html><body>404 not found</body></html>");
	check_refused(len, MP_SYNTAX, 0, "HTML");
	memset(file + len, ' ', 5000);
	check_refused(5000, MP_SYNTAX, 0, "HTML");
	put_text("<?xml version=\"1.0\"?>");
	check_refused(21, MP_SYNTAX, 0, "XML");
	for (size_t n = 20; n < 8000; n *= 2) {
		memset(file, 0x91, sizeof file);
		memcpy(file, "\x1f\x8b\x08", 3);
		check_refused(n, MP_SYNTAX, 0, "gzip");
		memcpy(file, "PK\x03\x04", 4);
		check_refused(n, MP_SYNTAX, 0, "zip");
		memcpy(file, "\x89PNG", 4);
		check_refused(n, MP_SYNTAX, 0, "PNG");
		for (size_t i = 0; i < n; i++)
			file[i] = i % 2 ? 0 : (uint8_t) "solid a\nfacet normal "[i / 2 % 21];
		check_refused(n, MP_SYNTAX, 0, "UTF-16");
		memcpy(file, "\xff\xfes", 3);
		check_refused(n, MP_SYNTAX, 0, "UTF-16");
	}
}

static void mangled_binary_is_named(void **state)
{
	static uint8_t good[84 + 50 * 200];
	size_t size = make(200, "h"), len = 80;

	(void)state;
	memcpy(good, file, size);
	for (size_t i = 80; i < size; i++) { /* as an editor in UTF-8 saves it */
		if (good[i] < 0x80) {
			file[len++] = good[i];
		} else {
			memcpy(file + len, "\xef\xbf\xbd", 3);
			len += 3;
		}
	}
	check_refused(len, MP_SYNTAX, 0, "saved as text");
	len = 84;
	for (size_t i = 84; i < size; i++) { /* as a transfer in text mode leaves it */
		if (i % 100 == 0)
			file[len++] = '\r';
		file[len++] = i % 100 == 0 ? '\n' : good[i];
	}
	check_refused(len, MP_SYNTAX, 0, "line ends");
}

static void text_that_is_no_stl_is_a_syntax_error(void **state)
{
	size_t len = put_text("# an OBJ file of some length, so that it is no header of a binary\n"
			      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");

	(void)state;
	check_refused(len, MP_SYNTAX, 66, "neither facet");
	assert_int_equal(whole.err.line, 2);
	memset(file, 'a', 5000);
	check_refused(5000, MP_SYNTAX, 0, "neither facet");
	check_refused(200, MP_SYNTAX, 0, "neither facet");
	check_refused(83, MP_TRUNCATED, 83, "only 83 bytes"); /* may be half a header */
	memset(file, '\n', 5000);
	check_refused(5000, MP_SYNTAX, 0, "without the word solid");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_header_may_say_anything),
	    cmocka_unit_test(other_files_are_named),
	    cmocka_unit_test(mangled_binary_is_named),
	    cmocka_unit_test(text_that_is_no_stl_is_a_syntax_error),
	};

	return cmocka_run_group_tests_name("stl_sniff", tests, NULL, NULL);
}
