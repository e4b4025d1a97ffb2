#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stl_text_file.h"

/* Text STL: what is read.  What is refused: test_stl_ascii_bad.c; binary: test_stl.c. */

static void reads_what_was_written(void **state)
{
	static const double want[9] = {
	    0.1,      -2.5e-3,           1e22, 5e-324, 1.7976931348623157e308, -0.0, 0.3,
	    16777217, 9007199254740993.0};

	(void)state;
	check_accepted("solid box of mine\n"
		       " facet normal 0 0 0\n"
		       "  outer loop\n"
		       "   vertex 0.1 -2.5e-3 1E22\n"
		       "   vertex 4.9e-324 1.7976931348623157e308 -0\n"
		       "   vertex .3 16777217. 9007199254740993\n"
		       "  endloop\n"
		       " endfacet\n"
		       "endsolid box of mine\n",
		       1, "0:box of mine;");
	assert_memory_equal(whole.tri[0], want, sizeof want);
	assert_int_equal(whole.notes.parts, 1);
	assert_int_equal(whole.notes.missing_endsolid, 0);
	assert_int_equal(whole.notes.nonstandard_lines, 0);
	assert_int_equal(whole.notes.trailing_bytes, 0);
}

static void keywords_have_any_case_and_lines_any_end(void **state)
{
	char text[1000];

	(void)state;
	check_accepted("SOLID S\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVertex 1 0 0\n"
		       "vERTEX 0 1 0\nEndLoop\nENDFACET\nEndSolid S\n",
		       1, "0:S;");
	check_accepted("solid s\r\nfacet normal 0 0 1\r\nouter loop\r\nvertex 0 0 0\r\n"
		       "vertex 1 0 0\r\nvertex 0 1 0\r\nendloop\r\nendfacet\r\nendsolid s\r\n",
		       1, "0:s;");
	strcpy(text, STL(FACET FACET));
	for (char *p = text; *p != '\0'; p++)
		*p = *p == '\n' ? '\r' : *p;
	check_accepted(text, 2, "0:s;");
	check_accepted("solid s\nfacet\tnormal 0\v0\f1 outer loop vertex 0 0 0 vertex 1 0 0 vertex "
		       "0 1 0 endloop endfacet facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 "
		       "0 0 vertex 0 1 0 endloop endfacet endsolid",
		       2, "0:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 0);
	check_accepted("solid s\n\n\nfacet\nnormal\n0\n0\n1\nouter\nloop\nvertex\n0\n0\n0\nvertex 1"
		       " 0 0 vertex 0 1 0\n endloop\n endfacet\nendsolid\n",
		       1, "0:s;");
	check_accepted("\xef\xbb\xbf  \n\t solid s\n" FACET "endsolid", 1, "0:s;");
}

static void names_are_lines_of_any_bytes(void **state)
{
	char text[5000], parts[400] = "0:";

	(void)state;
	check_accepted("solid\n" FACET "endsolid\n", 1, "0:;");
	check_accepted("solid \t \n" FACET "endsolid\n", 1, "0:;");
	check_accepted("solid   two  words \t\r\n" FACET "endsolid\n", 1, "0:two  words;");
	check_accepted("solid solid facet normal endsolid\n" FACET
		       "endsolid solid facet normal endsolid\n",
		       1, "0:solid facet normal endsolid;");
	check_accepted("solid # 5\n" FACET "endsolid # 5\n", 1, "0:# 5;");
	check_accepted("solid caf\xe9 \xff\x7f\n" FACET "endsolid\n", 1, "0:caf\xe9 \xff\x7f;");
	for (size_t n = 200; n < 4700; n += n < 300 ? 1 : 400) { /* beyond the window, too */
		strcpy(text, "solid ");
		memset(text + 6, 'n', n);
		strcpy(text + 6 + n, "\n" FACET "endsolid\n");
		memset(parts + 2, 'n', n < 255 ? n : 255);
		strcpy(parts + 2 + (n < 255 ? n : 255), ";");
		seen_decode(&whole, text, strlen(text), 13, 200, roomy);
		assert_int_equal(whole.ret, 0);
		assert_string_equal(whole.parts, parts);
	}
}

static void several_solids_are_parts(void **state)
{
	(void)state;
	check_accepted(STL(FACET FACET) "solid t u\n" FACET "endsolid t u\n\nsolid\n" FACET
					"endsolid",
		       4, "0:s;2:t u;3:;");
	assert_int_equal(whole.notes.parts, 3);
	check_accepted("solid a\nendsolid a\n" STL(FACET), 1, "0:a;0:s;");
	assert_int_equal(whole.notes.parts, 2);
}

static void a_missing_endsolid_is_counted(void **state)
{
	(void)state;
	check_accepted("solid a\n" FACET, 1, "0:a;");
	assert_int_equal(whole.notes.missing_endsolid, 1);
	check_accepted("solid a\n" FACET "solid b\n" FACET FACET "solid c\n" FACET "endsolid", 4,
		       "0:a;1:b;3:c;");
	assert_int_equal(whole.notes.missing_endsolid, 2);
	check_accepted("solid a\nfacet normal 0 0 1\n" LOOP "endfacet", 1,
		       "0:a;"); /* no line end */
	assert_int_equal(whole.notes.missing_endsolid, 1);
}

static void normals_may_be_anything_on_their_line(void **state)
{
	(void)state;
	check_accepted(STL("facet\n" LOOP "endfacet\n"), 1, "0:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 0);
	check_accepted(STL("facet normal\n" LOOP "endfacet\n"), 1, "0:s;");
	check_accepted(STL("facet normal 0 0\n" LOOP "endfacet\n"), 1, "0:s;");
	check_accepted(STL("facet normal nan NaN -nan(ind)\n" LOOP "endfacet\n"), 1, "0:s;");
	assert_int_equal(whole.notes.normals_not_finite, 1);
	check_accepted(STL("facet normal -1.#IND 1.#QNAN 1e999\n" LOOP "endfacet\n"), 1, "0:s;");
	assert_int_equal(whole.notes.normals_not_finite, 1);
	assert_int_equal(whole.notes.nonstandard_lines, 0);
	check_accepted(STL("facet normal none at all\n" LOOP "endfacet\n"), 1, "0:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 1);
	check_accepted(STL("facet 0 0 -1\n" LOOP "endfacet\n"), 1, "0:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 1);
	check_accepted(STL("facet normal 0 0 -1 7 8\n" LOOP "endfacet\n"), 1, "0:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 1);
	assert_int_equal(whole.notes.normals_disagreeing, 1);
	check_accepted(STL("facet normal x 0 0 -1\n" LOOP "endfacet\n"), 1, "0:s;");
	assert_int_equal(whole.notes.normals_disagreeing, 0);
	check_refused(STL("facet normal\nnone\n" LOOP "endfacet\n"), MP_SYNTAX, 3);
	check_refused(STL("facet normal 0 0 1\n2\n" LOOP "endfacet\n"), MP_SYNTAX, 3);
}

static void normals_against_the_winding_are_counted(void **state)
{
	(void)state;
	check_accepted(STL(FACET "facet normal 0 0 -1\n" LOOP "endfacet\n"
				 "facet normal 0 0 0\n" LOOP "endfacet\n"
				 "facet normal 5 5 -1e-300\n" LOOP "endfacet\n"),
		       4, "0:s;");
	assert_int_equal(whole.notes.normals_disagreeing, 2);
	assert_int_equal(whole.notes.normals_not_finite, 0);
}

static void text_behind_the_end_of_things_is_passed_over(void **state)
{
	(void)state;
	check_accepted(
	    STL("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
		"endloop of no 1\nendfacet 1 of 2\n" FACET) "\n",
	    2, "0:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 2);
	check_accepted("solid s\n" FACET
		       "endsolid s, facet by facet; vertex by vertex\n" STL(FACET),
		       2, "0:s;1:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 0);
	check_refused(STL("facet normal 0 0 1\n" LOOP "endfacet vertex\n"), MP_SYNTAX, 8);
	check_refused(
	    STL("facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
		"endloop vertex 1 1 1\nendfacet\n"),
	    MP_SYNTAX, 7);
}

static void comments_are_passed_over_where_words_begin(void **state)
{
	(void)state;
	check_accepted(
	    "# made by hand\n#\n \t# facet\nsolid s\n# in between\n"
	    "facet normal 0 0 1 # up\nouter # outer\nloop\nvertex 0 #0\n0 0\nvertex 1 0 0\n"
	    "vertex 0 1 0\nendloop # 3\nendfacet # 1\nendsolid s\n# end\n",
	    1, "0:s;");
	assert_int_equal(whole.notes.nonstandard_lines, 10);
	check_refused(STL("facet normal 0 0 1\nouter loop#\n"), MP_SYNTAX, 3);
	check_refused(STL("facet normal 0 0 1\nouter loop\nvertex 0 0 0#\n"), MP_SYNTAX, 4);
}

static void a_facet_without_solid_begins_a_nameless_one(void **state)
{
	(void)state;
	check_accepted(FACET FACET, 2, "0:;");
	assert_int_equal(whole.notes.parts, 1);
	assert_int_equal(whole.notes.missing_endsolid, 1);
	assert_int_equal(whole.notes.nonstandard_lines, 1);
	check_accepted(STL(FACET) FACET "endsolid\n", 2, "0:s;1:;");
	assert_int_equal(whole.notes.missing_endsolid, 0);
}

/*
 * The number ends in one digit that is not 0, up to 10^5 places behind the point.  Blanks fill the
 * window, so that the cuts are real.
 */
static void check_long_number(char *text, size_t digits)
{
	size_t at, len;

	memset(text, ' ', WINDOW);
	strcpy(text + WINDOW, "solid s\nfacet normal 0 0 1\nouter loop\nvertex ");
	at = strlen(text);
	memset(text + at, '0', digits);
	memcpy(text + at, "9007199254740993.", 17);
	text[at + digits - 1] = '1';
	strcpy(text + at + digits, " 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid");
	len = strlen(text);
	seen_decode(&whole, text, len, all, all, roomy);
	assert_int_equal(whole.ret, 0);
	assert_true(whole.tri[0][0] == 9007199254740994.0);
	for (size_t first = 254; first < 259; first++) {
		for (size_t step = 1; step < 700; step += 1 + 3 * step) {
			seen_decode(&other, text, len, at + first, step, roomy);
			assert_true(seen_same(&whole, &other));
		}
	}
	text[at + digits / 2] = 'x'; /* a word that long which is no number */
	seen_decode(&whole, text, len, all, all, roomy);
	assert_int_equal(whole.err.code, MP_SYNTAX);
	assert_int_equal(whole.err.byte, at);
	seen_decode(&other, text, len, WINDOW, 97, roomy);
	assert_true(seen_same(&whole, &other));
}

static void numbers_of_any_length_are_exact_in_pieces(void **state)
{
	static const size_t lengths[] = {255, 256, 257, 258, 300, 2000, 100000};
	char *text = malloc(WINDOW + 100000 + 400);

	(void)state;
	assert_non_null(text);
	for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++)
		check_long_number(text, lengths[i]);
	free(text);
}

/* Many facets in the forms that writers use, so that windows, blocks and chunks all have ends. */
static void a_long_file_is_the_same_in_any_pieces(void **state)
{
	static const char *const gap[] = {" ", "\n", "\t", "\r\n", "  ", "\r", "\n\n   "};
	static const char *const number[] = {"%.6e", "%g", "%.17g", "%f", "%.9E", "%+.3f", "%.25e"};
	size_t room = 700 * 1024, len;
	char *text = malloc(room), *p = text;
	uint32_t seed = 1;

	(void)state;
	assert_non_null(text);
	p += sprintf(p, "solid long\n");
	for (int i = 0; i < 600; i++) {
		p += sprintf(p, "facet normal 0 0 1%souter loop%s", gap[i % 7], gap[i / 7 % 7]);
		for (int k = 0; k < 9; k++) {
			seed = seed * 1664525 + 1013904223;
			p += sprintf(p, k % 3 == 0 ? "vertex " : " ");
			p += sprintf(p, number[i / 3 % 7], (double)seed / 65536 - 20000);
			p += sprintf(p, "%s", k % 3 == 2 ? gap[(i + k) % 7] : "");
		}
		p += sprintf(p, "endloop%sendfacet%s", gap[i / 49 % 7],
			     i % 50 == 49 ? " 50 more\n" : gap[i / 5 % 7]);
		if (i % 100 == 99)
			p += sprintf(p, "endsolid\nsolid %d\n", i);
	}
	len = (size_t)(p - text);
	seen_decode(&whole, text, len, all, all, roomy);
	assert_int_equal(whole.ret, 0);
	assert_int_equal(whole.count, 600);
	assert_int_equal(whole.notes.parts, 7);
	for (size_t step = 1; step < 200; step++) {
		seen_decode(&other, text, len, step * 31, step, roomy);
		assert_true(seen_same(&whole, &other));
	}
	for (size_t first = 0; first < 9000; first += 7) {
		seen_decode(&other, text, len, first, 4000, roomy);
		assert_true(seen_same(&whole, &other));
	}
	free(text);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(reads_what_was_written),
	    cmocka_unit_test(keywords_have_any_case_and_lines_any_end),
	    cmocka_unit_test(names_are_lines_of_any_bytes),
	    cmocka_unit_test(several_solids_are_parts),
	    cmocka_unit_test(a_missing_endsolid_is_counted),
	    cmocka_unit_test(normals_may_be_anything_on_their_line),
	    cmocka_unit_test(normals_against_the_winding_are_counted),
	    cmocka_unit_test(text_behind_the_end_of_things_is_passed_over),
	    cmocka_unit_test(comments_are_passed_over_where_words_begin),
	    cmocka_unit_test(a_facet_without_solid_begins_a_nameless_one),
	    cmocka_unit_test(numbers_of_any_length_are_exact_in_pieces),
	    cmocka_unit_test(a_long_file_is_the_same_in_any_pieces),
	};

	return cmocka_run_group_tests_name("stl_ascii", tests, NULL, NULL);
}
