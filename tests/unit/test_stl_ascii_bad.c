#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stl_text_file.h"

/* Text STL: what is refused, and with which line. */

static void a_facet_has_three_vertices_of_three_numbers(void **state)
{
	(void)state;
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"
			  "endfacet\n"),
		      MP_SYNTAX, 6);
	check_refused(
	    STL("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
		"vertex 0 1 0\nendloop\nendfacet\n"),
	    MP_SYNTAX, 7);
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\n"), MP_SYNTAX,
		      5);
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0 0 0 0\n"), MP_SYNTAX, 4);
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0 abc 0\n"), MP_SYNTAX, 4);
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0 0x10 0\n"), MP_SYNTAX, 4);
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0 1,5 0\n"), MP_SYNTAX, 4);
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0,1,0\n"), MP_SYNTAX, 4);
	check_refused_bytes(STL("facet normal 0 0 1\nouter loop\nvertex 0 1e 0\n"),
			    strlen(STL("facet normal 0 0 1\nouter loop\nvertex 0 1e 0\n")),
			    MP_SYNTAX, 4, 8 + 19 + 11 + 9);
}

static void unknown_words_are_refused_with_their_line(void **state)
{
	(void)state;
	check_refused(STL("face normal 0 0 1\n" LOOP "endfacet\n"), MP_SYNTAX, 2);
	check_refused(STL(FACET "color 1 0 0\n"), MP_SYNTAX, 9);
	check_refused(STL("facet normal 0 0 1\nouterloop\n" FACET), MP_SYNTAX, 3);
	check_refused(STL("facet normal 0 0 1\nouter\nvertex 0 0 0\n"), MP_SYNTAX, 4);
	check_refused(STL("facet normal normal 0 0 1\n" LOOP "endfacet\n"), MP_SYNTAX, 2);
	check_refused(STL("facet normal 0 0 1\nfacet normal 0 0 1\n"), MP_SYNTAX, 3);
	check_refused(STL("facet normal 0 0 1\n" LOOP "endsolid\n"), MP_SYNTAX, 8);
	check_refused(STL("facet normal 0 0 1\n" LOOP LOOP "endfacet\n"), MP_SYNTAX, 8);
	check_refused(STL(FACET) "endsolid\n", MP_SYNTAX, 10);
	check_refused(STL(FACET) "and so on\n", MP_SYNTAX, 10);
	check_refused(STL(FACET) "v 0 0 0\n", MP_SYNTAX, 10);
	check_refused("solid\r\rx\r\n\nfacet\n endsolid", MP_SYNTAX, 3); /* 4 ways to end a line */
	check_refused("solid\r\n\r\nx\r\nfacet", MP_SYNTAX, 3);
	check_refused_bytes("solid\n\n  facets\n facet", 22, MP_SYNTAX, 3, 9);
	check_refused_bytes("\xef\xbb\xbfsolid\nx\nfacet", 16, MP_SYNTAX, 2, 9);
}

static void what_is_not_finite_is_refused_with_its_line(void **state)
{
	static const char *const words[] = {"nan",    "-NaN",    "inf",      "-Infinity", "1e999",
					    "-1e400", "1.#QNAN", "nan(ind)", "1.#INF000"};
	char text[400];

	(void)state;
	for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
		sprintf(text,
			"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n vertex 1 %s 0\n"
			"vertex 0 1 0\nendloop\nendfacet\nendsolid\n",
			words[i]);
		check_refused_bytes(text, strlen(text), MP_NON_FINITE, 5, 61);
		assert_non_null(strstr(whole.err.text, "y of vertex 2"));
	}
}

static void an_end_inside_a_facet_is_truncation(void **state)
{
	const char *text = STL(FACET FACET);
	size_t last = strlen(STL(FACET FACET)) - strlen("\nendsolid s\n");

	(void)state;
	for (size_t n = 1; n < last; n++) {
		uint64_t line = 1;

		seen_decode(&whole, text, n, all, all, roomy);
		for (size_t i = 0; i < n; i++)
			line += text[i] == '\n';
		if (n >= 93 && n <= 94) { /* the first facet is complete, nothing of the next */
			assert_int_equal(whole.ret, 0);
			assert_int_equal(whole.notes.missing_endsolid, 1);
			continue;
		}
		assert_int_equal(whole.ret, -1);
		assert_int_equal(whole.err.code, MP_TRUNCATED);
		assert_int_equal(whole.err.byte, n);
		if (n > 12)
			assert_int_equal(whole.err.line, line);
		seen_decode(&other, text, n, 3, 1, roomy);
		assert_true(seen_same(&whole, &other));
	}
	check_refused(STL(FACET) "solid t\n" FACET "endsol", MP_TRUNCATED, 18);
	check_refused(STL(FACET) "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0.1e",
		      MP_TRUNCATED, 13);
}

static void a_solid_without_facets_has_no_faces(void **state)
{
	(void)state;
	check_refused("solid OpenSCAD_Model\nendsolid OpenSCAD_Model\n", MP_NO_FACES, 0);
	check_refused("solid\nendsolid", MP_NO_FACES, 0);
	check_refused("solid a\nendsolid a\nsolid b\nendsolid b\n", MP_NO_FACES, 0);
	check_refused("solid a\nsolid b\n#\n#\n#\nendsolid", MP_NO_FACES, 0);
}

static void control_characters_are_refused_but_for_padding_at_the_end(void **state)
{
	static const char padded[] = STL(FACET) "\0\0\x1a\0 \r\n\0";
	static const char nul[] = STL(FACET "facet normal 0 0 1\0\n" LOOP "endfacet\n");
	static const char name[] = "solid a\0b\n" FACET "endsolid\n";
	static const char unpadded[] = STL(FACET) "\0\0\nsolid\n";
	char text[200];

	(void)state;
	decode_text(padded, sizeof padded - 1);
	assert_int_equal(whole.ret, 0);
	assert_int_equal(whole.notes.trailing_bytes, 8);
	decode_text("solid s\n" FACET "endsolid s\0", sizeof "solid s\n" FACET "endsolid s");
	assert_int_equal(whole.ret, 0);
	assert_int_equal(whole.notes.trailing_bytes, 1);
	check_refused_bytes(nul, sizeof nul - 1, MP_SYNTAX, 9, strlen(nul));
	check_refused_bytes(name, sizeof name - 1, MP_SYNTAX, 1, 7);
	check_refused_bytes(unpadded, sizeof unpadded - 1, MP_SYNTAX, 10, strlen(unpadded));
	for (char c = 1; c < 32; c++) {
		if (strchr("\t\n\v\f\r\x1a", c) != NULL)
			continue;
		strcpy(text, STL(FACET FACET));
		text[30] = c;
		check_refused_bytes(text, strlen(text), MP_SYNTAX, 3, 30);
	}
}

static void the_limit_judges_what_has_come(void **state)
{
	(void)state;
	for (size_t step = 1; step < 400; step++) {
		const char *text = STL(FACET FACET FACET);

		seen_decode(&whole, text, strlen(text), step, step, 3);
		assert_int_equal(whole.ret, 0);
		seen_decode(&whole, text, strlen(text), step, step, 2);
		assert_int_equal(whole.err.code, MP_LIMIT);
		assert_int_equal(whole.err.limit, 2);
		assert_int_equal(whole.err.actual, 3);
		assert_int_equal(whole.err.byte, 8 + 3 * strlen(FACET) - 9);
	}
}

static void a_sink_that_fails_stops_the_decoder(void **state)
{
	const char *text = STL(FACET);

	(void)state;
	whole.fail_at = 1;
	seen_decode(&whole, text, strlen(text), all, all, roomy);
	assert_int_equal(whole.err.code, MP_BUG);
	assert_int_equal(whole.err.byte, 7);
	whole.fail_at = 0;
	whole.fail_part = true;
	seen_decode(&whole, text, strlen(text), all, all, roomy);
	assert_int_equal(whole.err.byte, 8);
	seen_decode(&whole, FACET, strlen(FACET), all, all, roomy);
	assert_int_equal(whole.err.byte, 8);
	whole.fail_part = false;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_facet_has_three_vertices_of_three_numbers),
	    cmocka_unit_test(unknown_words_are_refused_with_their_line),
	    cmocka_unit_test(what_is_not_finite_is_refused_with_its_line),
	    cmocka_unit_test(an_end_inside_a_facet_is_truncation),
	    cmocka_unit_test(a_solid_without_facets_has_no_faces),
	    cmocka_unit_test(control_characters_are_refused_but_for_padding_at_the_end),
	    cmocka_unit_test(the_limit_judges_what_has_come),
	    cmocka_unit_test(a_sink_that_fails_stops_the_decoder),
	};

	return cmocka_run_group_tests_name("stl_ascii_bad", tests, NULL, NULL);
}
