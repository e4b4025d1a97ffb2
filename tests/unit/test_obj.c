#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/obj_seen.h"

static struct seen seen, other;

#define V4 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void decode(const char *text, size_t len)
{
	seen_decode(&seen, text, len, SIZE_MAX, SIZE_MAX, 1000);
	assert_false(seen.wrong);
	for (size_t cut = 0; cut <= len; cut++) { /* the same in two pieces, wherever it is cut */
		seen_decode(&other, text, len, cut, SIZE_MAX, 1000);
		assert_true(seen_same(&seen, &other));
	}
	for (size_t step = 1; step < 5; step++) {
		seen_decode(&other, text, len, step, step, 1000);
		assert_true(seen_same(&seen, &other));
	}
}

#define ACCEPT(text) accept(text, sizeof(text) - 1)

static void accept(const char *text, size_t len)
{
	decode(text, len);
	if (seen.ret != 0)
		print_error("%s\n", seen.err.text);
	assert_int_equal(seen.ret, 0);
}

#define REFUSE(text, code, line) refuse(text, sizeof(text) - 1, code, line)

static void refuse(const char *text, size_t len, enum mp_code code, uint64_t line)
{
	decode(text, len);
	assert_int_equal(seen.ret, -1);
	if (seen.err.code != code || seen.err.line != line)
		print_error("%s\n", seen.err.text);
	assert_int_equal(seen.err.code, code);
	assert_int_equal(seen.err.line, line);
	assert_true(strlen(seen.err.text) > 0);
	/* nothing of the file gets into the text */
	assert_null(strstr(seen.err.text, "@"));
}

static void check_triangle(uint64_t i, uint32_t a, uint32_t b, uint32_t c)
{
	assert_true(i < seen.count);
	assert_int_equal(seen.index[i][0], a);
	assert_int_equal(seen.index[i][1], b);
	assert_int_equal(seen.index[i][2], c);
}

static void test_a_triangle(void **state)
{
	static const double TRI[9] = {0.5, -1e3, 0, 1, 0, 0.25, 1, 1, 0};

	(void)state;
	ACCEPT("v .5 -1E+003 0\nv 1 0 .25\nv 1 1 0\nf 1 2 3\n");
	assert_int_equal(seen.count, 1);
	assert_memory_equal(seen.tri[0], TRI, sizeof TRI);
	check_triangle(0, 0, 1, 2);
	assert_int_equal(seen.notes.format, MP_FORMAT_OBJ);
	assert_int_equal(seen.notes.vertices_in_file, 3);
	assert_int_equal(seen.notes.polygons, 0);
	assert_int_equal(seen.notes.nonstandard_lines, 0);
}

static void test_numbers_are_nearest_doubles(void **state)
{
	(void)state;
	ACCEPT("v 0.1 1e-5 12345678.901234567\nv 9007199254740993 4.9e-324 1.7976931348623157e308"
	       "\nv -0 +.5e0 5.\nf 1 2 3\n");
	assert_true(seen.tri[0][0] == 0.1 && seen.tri[0][1] == 1e-5);
	assert_true(seen.tri[0][2] == 12345678.901234567);
	assert_true(seen.tri[0][3] == 9007199254740992.0 && seen.tri[0][4] == 4.9e-324);
	assert_true(seen.tri[0][5] == 1.7976931348623157e308);
	assert_true(seen.tri[0][6] == 0 && seen.tri[0][7] == 0.5 && seen.tri[0][8] == 5);
}

static void test_weights_and_colours(void **state)
{
	(void)state;
	ACCEPT("v 1 2 3 1\nv 4 5 6 0.5\nv 7 8 9 0 .1 .2\nv 0 0 0 1 2 3 4\nf 1 2 3\nf 2 3 4\n");
	assert_int_equal(seen.count, 2);
	assert_true(seen.tri[0][3] == 4 && seen.tri[0][4] == 5 && seen.tri[0][5] == 6);
	ACCEPT("v 1 2 3 nan NaN -nan(ind)\nv 4 5 6 inf 0 0\nv 7 8 9\nf 1 2 3\n");
	REFUSE("v 1 2 3\nv 4 5\nv 7 8 9\nf 1 2 3\n", MP_SYNTAX, 2);
	REFUSE("v 1 2 3\n\nv\n", MP_SYNTAX, 3);
	REFUSE("v 1 2 3 4 5\n", MP_SYNTAX, 1);
	REFUSE("v 1 2 3 4 5 6 7 8\n", MP_SYNTAX, 1);
	REFUSE("v 1 2 3 4 red 6\n", MP_SYNTAX, 1);
	REFUSE(V4 "v 1 2 3 4 5\nf 1 2 3\n", MP_SYNTAX, 5);
	REFUSE(V4 "v 1 2\nf 1 2 3\n", MP_SYNTAX, 5);
	REFUSE(V4 "v 1 2 3 4 5 6 7 8\nf 1 2 3\n", MP_SYNTAX, 5);
	REFUSE(V4 "v 1 2 3 4 5 6 red\nf 1 2 3\n", MP_SYNTAX, 5);
	REFUSE(V4 "v 1 1e999 3\nf 1 2 3\n", MP_NON_FINITE, 5);
}

static void test_numbers_that_are_none(void **state)
{
	(void)state;
	REFUSE("v 1 2 3\nv 1 abc@ 3\n", MP_SYNTAX, 2);
	assert_int_equal(seen.err.byte, 12);
	REFUSE("v 1 2 0x10\n", MP_SYNTAX, 1);
	REFUSE("v 1,5 2 3\n", MP_SYNTAX, 1);
	REFUSE("v 1 2 3-\n", MP_SYNTAX, 1);
	REFUSE("v 1 2 \x01\n", MP_SYNTAX, 1);
	REFUSE("v 1 2 3\\4\n", MP_SYNTAX, 1);
	REFUSE("v 1 2 3 \\ \n4 5 6\n", MP_SYNTAX, 1);
	REFUSE("#\nv 1 nan 3\n", MP_NON_FINITE, 2);
	assert_non_null(strstr(seen.err.text, "y of vertex 1"));
	REFUSE("v 0 0 0\r\nv -inf 2 3\r\n", MP_NON_FINITE, 2);
	REFUSE("v 1 2 1e999\n", MP_NON_FINITE, 1);
	REFUSE("v 1 2 1.#QNAN\n", MP_NON_FINITE, 1);
	REFUSE("v -1.#IND00 2 3\n", MP_NON_FINITE, 1);
	REFUSE("v 1 2 1\\\n.\\\n#INF\n", MP_NON_FINITE, 1);
	ACCEPT("v 1 2 11.#INF\nv 0 0 2.#INF\nv 1 1 1#.\nf 1 2 3#4\n"); /* comments */
}

static void test_forms_of_corners(void **state)
{
	(void)state;
	ACCEPT(V4 "f 1/1 2/2 3/3\nf 1//1 2//2 3//3\nf 1/1/1 2/2/2 3/3/3\nf 1// 2// 3//\n"
		  "f 1/ 2/ 3/\nf 1/-1/-2 2/0/0 3//-7\nf 1/5/ 2 0003//\nfo 1 2 3\n");
	assert_int_equal(seen.count, 8);
	for (uint64_t i = 0; i < 8; i++)
		check_triangle(i, 0, 1, 2);
	REFUSE(V4 "f 1 2 3 a\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3.0\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 +3\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3/1/1/1\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3///\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 /3\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3/-\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3/-/1\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 --3\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3-\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 -\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1, 2, 3\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3/x\n", MP_SYNTAX, 5);
	assert_int_equal(seen.err.byte, 32 + 6);
	REFUSE("\xef\xbb\xbf" V4 "f 1 2 3/x\n", MP_SYNTAX, 5);
	assert_int_equal(seen.err.byte, 3 + 32 + 6);
	/* the same once a face has been read */
	REFUSE(V4 "f 1 2 3\nf 1 2 3/\nf 1 2 3//x\n", MP_SYNTAX, 7);
	REFUSE(V4 "f 1 2 3\nf 1 2 3/-\nf 1 2 3\n", MP_SYNTAX, 6);
	REFUSE(V4 "f 1 2 3\nf 1 2 3/1/1/1\nf 1 2 3\n", MP_SYNTAX, 6);
	REFUSE(V4 "f 1 2 3\nf 1 2 0\nf 1 2 3\n", MP_BAD_INDEX, 6);
	REFUSE(V4 "f 1 2 3\nf 1 2 -5\nf 1 2 3\n", MP_BAD_INDEX, 6);
	REFUSE(V4 "f 1 2 3\nf 1 2 5\nf 1 2 3\n", MP_BAD_INDEX, 6);
}

static void test_faces_need_three_corners(void **state)
{
	(void)state;
	REFUSE(V4 "f 1 2 3\nf\n", MP_SYNTAX, 6);
	REFUSE(V4 "f 1\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1// 2//\nf 1 2 3\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2 3\nf 1 2\nf 1 2 3\n", MP_SYNTAX, 6);
	REFUSE(V4 "f 1 2 3\nf 1 2 \\\n\nf 1 2 3\n", MP_SYNTAX, 6);
	ACCEPT(V4 "f 1 1 1\n"); /* the mesh is judged elsewhere */
}

static void test_negative_indices(void **state)
{
	(void)state;
	ACCEPT("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4/-1 -2//-1 -1\n");
	check_triangle(0, 0, 1, 2);
	check_triangle(1, 0, 2, 3);
	REFUSE("v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 1 1 0\n", MP_BAD_INDEX, 3);
	REFUSE("f -1 -2 -3\n", MP_BAD_INDEX, 1);
	REFUSE(V4 "f -1 -2 -0\n", MP_BAD_INDEX, 5);
}

static void test_faces_before_their_vertices(void **state)
{
	(void)state;
	ACCEPT("f 1 2 3\nf 2 3 4\n" V4 "f 1 2 3 4\n");
	assert_int_equal(seen.count, 4);
	check_triangle(0, 0, 1, 2);
	check_triangle(1, 1, 2, 3);
	check_triangle(2, 0, 1, 2);
	check_triangle(3, 0, 2, 3);
	/* the order stays that of the file, and so do names */
	ACCEPT(
	    "v 0 0 0\ng a\nf 1 2 3\nv 1 0 0\nv 1 1 0\ng b\nf 1 3 4\nf 1 2 3\nv 0 1 0\nf 1 1 1\n");
	check_triangle(0, 0, 1, 2);
	check_triangle(1, 0, 2, 3);
	check_triangle(2, 0, 1, 2);
	check_triangle(3, 0, 0, 0);
	assert_string_equal(seen.names, "g0:a;g1:b;");
	REFUSE(V4 "f 1 2 3\n\nf 1 2 5\nf 1 2 6\n", MP_BAD_INDEX, 7);
	REFUSE(V4 "f 1 2 3\nf 1 2 7\nf 1 2 5\nv 5 5 5\n", MP_BAD_INDEX, 6);
	REFUSE("f 1 2 3\n", MP_BAD_INDEX, 1);
	REFUSE(V4 "f 0 1 2\n", MP_BAD_INDEX, 5);
	REFUSE(V4 "f 1 2 99999999999999999999999999\n", MP_BAD_INDEX, 5);
	REFUSE(V4 "f 1 2 -99999999999999999999999999\n", MP_BAD_INDEX, 5);
	REFUSE(V4 "f 1 2 4294967297\n", MP_BAD_INDEX, 5);
}

static void test_polygons(void **state)
{
	(void)state;
	ACCEPT(V4 "f 1 2 3 4\nf 4/1 3/2 2/3 1/4\n");
	assert_int_equal(seen.notes.polygons, 2);
	assert_int_equal(seen.count, 4);
	check_triangle(0, 0, 1, 2);
	check_triangle(1, 0, 2, 3);
	check_triangle(2, 3, 2, 1);
	check_triangle(3, 3, 1, 0);
	assert_int_equal(seen.notes.nonplanar_polygons, 0);
	ACCEPT("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\n"); /* a dart */
	assert_int_equal(seen.count, 2);
	ACCEPT("v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3 4\nf 1 2 3\n");
	assert_int_equal(seen.notes.nonplanar_polygons, 1);
	assert_int_equal(seen.notes.tangled_polygons, 0);
	ACCEPT("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\nf 1 2 3 4\n");
	assert_int_equal(seen.notes.tangled_polygons, 1);
	assert_int_equal(seen.count, 2);
}

static double area(void)
{
	double sum = 0;

	for (uint64_t i = 0; i < seen.count; i++) {
		const double *t = seen.tri[i];

		sum += fabs((t[3] - t[0]) * (t[7] - t[1]) - (t[4] - t[1]) * (t[6] - t[0])) / 2;
	}
	return sum;
}

/* A plate with a square hole: the bridge to it is used there and back. */
static void test_keyhole_polygons(void **state)
{
	(void)state;
	ACCEPT("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
	       "f 1 2 3 4 1 5 6 7 8 5\n");
	assert_int_equal(seen.count, 8);
	assert_true(area() == 12);
	assert_int_equal(seen.notes.tangled_polygons, 0);
}

static void test_continued_lines(void **state)
{
	(void)state;
	ACCEPT("v \\\n0 0\\\n 0\nv 1 0 0 \\\r\n\r\nv 1 \\\r1 0\rv 0 1 0\\\n\nf 1 2 \\\n3 4\n");
	assert_int_equal(seen.count, 2);
	assert_int_equal(seen.notes.vertices_in_file, 4);
	ACCEPT("\\\nv 0 0\\\n 0\n\\\n\\\nv 1\\\n2 0\\\r\n.5 0\nv 1 1 0\nf 1 2 3\n"); /* 12, 0.5 */
	assert_true(seen.tri[0][3] == 12 && seen.tri[0][4] == 0.5);
	ACCEPT(V4 "f \\\n1 2 3 \\\n\\\n 4\nvt 0 \\\nf 9 9 9\nusemtl a\\\nb\\c\nf 1 2 3\\");
	assert_int_equal(seen.count, 3);
	assert_string_equal(seen.names, "m2:ab\\c;");
	ACCEPT(V4 "# many comments end in a path\\\nf 1 2 3 # this one too\\\nf 1 2 3\n");
	assert_int_equal(seen.count, 2);
	/* lines are counted as an editor shows them */
	REFUSE("v 0 0 0 \\\n\\\n1\nv 1 2 \\\n\\\r\nx\n", MP_SYNTAX, 6);
	REFUSE("v 0 0 0\nv 1 \\\n\\\n2\n", MP_SYNTAX, 2);
}

static void test_line_ends(void **state)
{
	static const char *const END[] = {"\n", "\r\n", "\r", " \t\n", "# f 1 2 3\n"};

	(void)state;
	for (size_t i = 0; i < sizeof END / sizeof *END; i++) {
		static const char *const LINE[] = {"v 0 0 0", "v 1 0 0", "", "v 1 1 0", "f 1 2 3"};
		char text[200] = "";

		for (int k = 0; k < 5; k++) {
			strcat(text, LINE[k]);
			strcat(text, END[i]);
		}
		accept(text, strlen(text));
		assert_int_equal(seen.count, 1);
		strcat(text, "f 1 2");
		refuse(text, strlen(text), MP_SYNTAX, 6);
	}
	ACCEPT("v 0 0 0\n\r\nv 1 0 0\rv 1 1 0\n\n\rf 1 2 3"); /* no end at all */
	REFUSE("v 0 0 0\n\r\nv 1 0 0\rv 1 1 0\n\n\rf 1 2", MP_SYNTAX, 7);
}

static void test_blanks_and_marks(void **state)
{
	(void)state;
	ACCEPT("\xef\xbb\xbfv 0 0 0\n  v\t1  0\t0  \n \t\n\tv 1 1 0\v\n f  1\t2 3\f\n");
	assert_int_equal(seen.count, 1);
	ACCEPT("v 0 0 0#x\nv 1 0 0 # y\nv 1 1 0\nf 1 2 3#4\n#\n ##\nf 1 2 3 # 4\n");
	assert_int_equal(seen.count, 2);
	assert_int_equal(seen.notes.nonstandard_lines, 0);
}

static void test_statements_that_are_passed_over(void **state)
{
	(void)state;
	ACCEPT(V4 "vt 0 0\nvn 0 0 1\nvp 1 2\nmtllib a.mtl b.mtl\ns 1\ns off\nmg 1 2\nbevel on\n"
		  "lod 3\nc_interp on\nshadow_obj x.obj\np 1 2\nl 1 2 3\nl 1 2\nvt\nf 1 2 3\n");
	assert_int_equal(seen.count, 1);
	assert_int_equal(seen.notes.nonstandard_lines, 0);
	assert_int_equal(seen.notes.points, 1);
	assert_int_equal(seen.notes.lines, 2);
	/* words of no format, and keywords in capitals: so many lines */
	ACCEPT(V4 "vw 1 2 3\nt 1/2/3\nF 1 2 3\nVT\nf1 2 3\nf 1 2 3\n\xc3\xa9 f\n");
	assert_int_equal(seen.notes.nonstandard_lines, 6);
	assert_int_equal(seen.count, 1);
}

static void test_statements_that_are_refused(void **state)
{
	static const char *const FREE[] = {"cstype rat bspline",
					   "deg 3 3",
					   "bmat u 1",
					   "step 1",
					   "curv 0 1 1 2",
					   "curv2 1 2",
					   "surf 0 1 0 1 1",
					   "parm u 0 1",
					   "trim 0 1 1",
					   "hole 0 1 1",
					   "scrv 0 1 1",
					   "sp 1",
					   "end",
					   "con 1 0 1 1",
					   "bzp 1 2 3",
					   "bsp 1",
					   "cdc 1",
					   "cdp 1",
					   "res 1 1"};

	(void)state;
	for (size_t i = 0; i < sizeof FREE / sizeof *FREE; i++) {
		char text[200], word[20];

		(void)snprintf(text, sizeof text, V4 "f 1 2 3\n%s\n", FREE[i]);
		refuse(text, strlen(text), MP_UNSUPPORTED, 6);
		(void)snprintf(word, sizeof word, "%s", FREE[i]);
		word[strcspn(word, " ")] = '\0';
		assert_non_null(strstr(seen.err.text, "free-form statement"));
		assert_non_null(strstr(seen.err.text, word));
	}
	REFUSE("call other.obj 1 2\n", MP_UNSUPPORTED, 1);
	REFUSE(V4 "csh -ls\n", MP_UNSUPPORTED, 5);
	REFUSE(V4 "cs\\\nh\n", MP_UNSUPPORTED, 5);
}

static void test_names(void **state)
{
	(void)state;
	ACCEPT(V4 "o body\nusemtl steel\nf 1 2 3\ng  left  side \nf 1 2 3\ng left  side\nf 1 2 3\n"
		  "g\nf 1 2 3\no other\nusemtl brass#2\nf 1 2 3\n");
	assert_string_equal(seen.names, "o0:body;g0:body;m0:steel;g1:left  side;g3:body;"
					"o4:other;g4:other;m4:brass#2;");
	ACCEPT(V4 "g default\nf 1 2 3\ng a\nf 1 2 3\no b\nf 1 2 3\no\nusemtl\nf 1 2 3\n");
	assert_string_equal(seen.names, "g1:a;o2:b;g2:b;o3:;g3:;");
	ACCEPT(V4
	       "g a f 9 9 9\nf 1 2 3\nusemtl a # b\nf 1 2 3\ng#x\n g \xe9 \\y\nf 1 2 3\nf 1 2 3");
	assert_string_equal(seen.names, "g0:a f 9 9 9;m1:a;g2:;g2:\xe9 \\y;");
}

static void test_long_names_are_cut(void **state)
{
	char text[1000] = V4 "usemtl ";
	size_t len = strlen(text);

	(void)state;
	memset(text + len, 'x', 300);
	strcpy(text + len + 300, "\nf 1 2 3\n");
	accept(text, strlen(text));
	assert_int_equal(strlen(seen.names), 3 + MP_NAME_MAX + 1);
}

/* Words that are passed over are looked at as far as they are kept, whole or in pieces. */
static void test_control_characters_in_unknown_words(void **state)
{
	char line[800] = "# \n"; /* the first 3 bytes of a file come in pieces always */

	(void)state;
	for (size_t at = 250; at < 262; at++) {
		memset(line + 3, 'x', 600);
		line[3 + at] = 1;
		strcpy(line + 603, "\n" V4 "f 1 2 3\n");
		if (at < 256)
			refuse(line, strlen(line), MP_SYNTAX, 2);
		else
			accept(line, strlen(line));
	}
}

static void test_nuls_at_the_end(void **state)
{
	(void)state;
	ACCEPT(V4 "f 1 2 3\n\n\0");
	assert_int_equal(seen.notes.nul_bytes, 1);
	ACCEPT(V4 "f 1 2 3\0\0\n\0 \x1a");
	assert_int_equal(seen.notes.nul_bytes, 4);
	assert_int_equal(seen.count, 1);
	ACCEPT(V4 "f 1 2 3\ng a\0");
	REFUSE(V4 "f 1 2 3\n\0f 1 2 3\n", MP_SYNTAX, 6);
	REFUSE(V4 "f 1 2\0 3\n", MP_SYNTAX, 5);
	REFUSE(V4 "g a\0b\n", MP_SYNTAX, 5);
	REFUSE(V4 "f 1 2\0", MP_SYNTAX, 5);
}

static void test_what_is_no_obj(void **state)
{
	(void)state;
	REFUSE("", MP_EMPTY, 0);
	REFUSE("\xff\xfev\0 \0", MP_SYNTAX, 1);
	assert_non_null(strstr(seen.err.text, "UTF-16"));
	REFUSE("\xfe\xff\0v\0 ", MP_SYNTAX, 1);
	assert_non_null(strstr(seen.err.text, "UTF-16"));
	REFUSE("v\0 \0001\0", MP_SYNTAX, 1);
	assert_non_null(strstr(seen.err.text, "UTF-16"));
	REFUSE("\x89PNG\r\n\x1a\n", MP_SYNTAX, 1);
	REFUSE("a\nb\x7f\n", MP_SYNTAX, 2);
	REFUSE("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", MP_SYNTAX, 1);
}

static void test_files_without_faces(void **state)
{
	(void)state;
	REFUSE("# nothing\n", MP_NO_FACES, 0);
	REFUSE("\n", MP_NO_FACES, 0);
	REFUSE("\xef\xbb\xbf", MP_NO_FACES, 0);
	REFUSE("v", MP_SYNTAX, 1);
	REFUSE("\0", MP_NO_FACES, 0);
	REFUSE(V4 "p 1 2\nl 1 2\nl 1 2 3\nwhat is this\n", MP_NO_FACES, 0);
	assert_non_null(strstr(seen.err.text, "4 vertices, 1 "));
	assert_non_null(strstr(seen.err.text, " 2 with lines"));
}

static void test_limits(void **state)
{
	static const char TEXT[] = V4 "f 1 2 3\nf 1 2 3 4\nf 1 2 3\n";

	(void)state;
	seen_decode(&seen, TEXT, sizeof TEXT - 1, SIZE_MAX, SIZE_MAX, 4);
	assert_int_equal(seen.ret, 0);
	for (uint64_t most = 0; most < 4; most++) {
		seen_decode(&seen, TEXT, sizeof TEXT - 1, SIZE_MAX, SIZE_MAX, most);
		assert_int_equal(seen.ret, -1);
		assert_int_equal(seen.err.code, MP_LIMIT);
		assert_int_equal(seen.err.limit, most);
		assert_int_equal(seen.err.actual, most + 1);
		for (size_t step = 1; step < 9; step++) {
			seen_decode(&other, TEXT, sizeof TEXT - 1, step, step, most);
			assert_true(seen_same(&seen, &other));
		}
	}
}

/* Vertices are held in memory: so many come to so many triangles. */
static void test_too_many_vertices(void **state)
{
	size_t most = 65536 + 3 * 10, len = (most + 1) * 8;
	char *text = malloc(len);

	(void)state;
	assert_non_null(text);
	for (size_t i = 0; i < len; i += 8)
		memcpy(text + i, "v 0 0 0\n", 8);
	seen_decode(&seen, text, len - 8, SIZE_MAX, SIZE_MAX, 10);
	assert_int_equal(seen.err.code, MP_NO_FACES);
	seen_decode(&seen, text, len, SIZE_MAX, SIZE_MAX, 10);
	assert_int_equal(seen.err.code, MP_LIMIT);
	assert_int_equal(seen.err.limit, most);
	seen_decode(&other, text, len, 1001, 1001, 10);
	assert_true(seen_same(&seen, &other));
	free(text);
}

static void test_numbers_of_many_digits(void **state)
{
	enum { DIGITS = 100000 };
	static const char HEAD[] = V4 "v 0.", MIDDLE[] = " 1 1\nf 1 2 ", TAIL[] = "5\n";
	size_t len = sizeof HEAD - 1 + DIGITS + sizeof MIDDLE - 1 + DIGITS + sizeof TAIL - 1;
	char *text = malloc(len), *p = text;

	(void)state;
	assert_non_null(text);
	memcpy(p, HEAD, sizeof HEAD - 1);
	memset(p += sizeof HEAD - 1, '3', DIGITS);
	memcpy(p += DIGITS, MIDDLE, sizeof MIDDLE - 1);
	memset(p += sizeof MIDDLE - 1, '0', DIGITS);
	memcpy(p += DIGITS, TAIL, sizeof TAIL - 1);
	for (size_t step = 1; step < len; step = 7 * step + 3) {
		seen_decode(&seen, text, len, step, step, 10);
		assert_int_equal(seen.ret, 0);
		check_triangle(0, 0, 1, 4);
		assert_true(seen.tri[0][6] == 1 / 3.0);
	}
	free(text);
}

/* Numbers in every form that a line in one go may meet, with what may stand behind them. */
static size_t random_number(char *p, unsigned *random)
{
	static const char *const form[] = {"%.0f", "%.1f", "%.6f",  "%.9g", "%g",   "%.17g",
					   "%e",   "%.8f", "%.15f", "%+f",  "%.2e", "%.18f"};
	double x;

	*random = *random * 1664525 + 1013904223;
	x = ldexp((double)(int)*random, -(int)(*random >> 7 & 31) - 4);
	return (size_t)sprintf(p, form[(*random >> 16) % (sizeof form / sizeof *form)], x);
}

static size_t random_corner(char *p, unsigned *random, unsigned vertices)
{
	static const char *const form[] = {"%u",     "%u/%u",  "%u//%u",   "%u/%u/%u",
					   "%u/-%u", "-%u/%u", "-%u//-%u", "%u/%u/"};
	unsigned v, most = 1;

	*random = *random * 1664525 + 1013904223;
	v = 1 + (*random >> 8) % vertices;
	for (unsigned digits = *random >> 4 & 15; digits > 7; digits--)
		most *= 10;
	return (size_t)sprintf(p, form[*random >> 29], v, *random % most, *random % 1000 * most);
}

/*
 * Lines that are read in one go where there is room behind them, and not where they come byte by
 * byte: the same doubles, the same triangles.
 */
static void test_lines_in_one_go_are_as_byte_by_byte(void **state)
{
	enum { VERTICES = 100, FACES = 100 };
	static char text[(VERTICES + FACES) * 200];
	unsigned random = 1;

	(void)state;
	for (int i = 0; i < 40; i++) {
		const char *end = i % 4 == 3 ? "\r\n" : "\n";
		char *p = text;

		for (int v = 0; v < VERTICES; v++) {
			int numbers = random >> 28 != 0 ? 3 : 6;

			p += sprintf(p, "v");
			for (int k = 0; k < numbers; k++) {
				*p++ = ' ';
				p += random_number(p, &random);
			}
			p += sprintf(p, "%s%s", random >> 29 ? "" : " ", end);
			p += sprintf(p, "vt 0.5 %u%s# x \\ y%s", random, end, end);
		}
		for (int f = 0; f < FACES; f++) {
			unsigned corners = 3 + (random >> 30);

			p += sprintf(p, "f");
			for (unsigned k = 0; k < corners; k++) {
				*p++ = ' ';
				p += random_corner(p, &random, VERTICES);
			}
			p += sprintf(p, "%s%s", random >> 29 ? "" : "\t ", end);
		}
		seen_decode(&seen, text, (size_t)(p - text), SIZE_MAX, SIZE_MAX, 1000);
		assert_int_equal(seen.ret, 0);
		assert_int_equal(seen.notes.vertices_in_file, VERTICES);
		seen_decode(&other, text, (size_t)(p - text), 1, 1, 1000);
		assert_true(seen_same(&seen, &other));
		seen_decode(&other, text, (size_t)(p - text), 150, 150, 1000);
		assert_true(seen_same(&seen, &other));
	}
}

/* What looks like such a line up to some byte is refused where it is wrong. */
static void test_odd_bytes_in_lines_in_one_go(void **state)
{
	static const char GOOD[] = V4 "v 10.25 -0.125 3\nf 1/12/1 2//345 3/7/123456 4\n"
				      "f 1/1/1 02/02/02 3/3/33 4/4/4\nf 1 2 3 4\n";
	static const char ODD[] = "09.-+eE/ \t\nv#\\\r";
	char text[sizeof GOOD - 1 + 200];
	size_t len = sizeof GOOD - 1;

	(void)state;
	for (size_t at = 32; at < len; at++)
		for (size_t odd = 0; odd < sizeof ODD - 1; odd++) {
			memcpy(text, GOOD, len);
			memset(text + len, '#', 199); /* room behind it, and none in the other */
			text[len + 199] = '\n';
			text[at] = ODD[odd];
			seen_decode(&seen, text, len + 200, SIZE_MAX, SIZE_MAX, 1000);
			seen_decode(&other, text, len + 200, 1, 1, 1000);
			assert_true(seen_same(&seen, &other));
		}
}

/* One face of many corners over many chunks, and the same held back. */
static void test_a_long_face(void **state)
{
	enum { N = 5000 };
	char *text = malloc(N * 80), *p = text;

	(void)state;
	assert_non_null(text);
	for (int held = 0; held < 2; held++) {
		p = text;
		for (int part = 0; part < 2; part++) {
			if (part == held) {
				for (int i = 0; i < N; i++) {
					double r = i % 2 ? 1 : 0.5, a = 6.283185307179586 * i / N;

					p +=
					    sprintf(p, "v %.17g %.17g 1\n", r * cos(a), r * sin(a));
				}
				continue;
			}
			p += sprintf(p, "f");
			for (int i = 0; i < N; i++)
				p += sprintf(p, i % 3 ? " %d/1" : " \\\n%d", i + 1);
			p += sprintf(p, "\n");
		}
		seen_decode(&seen, text, (size_t)(p - text), 100, 1000, N);
		assert_int_equal(seen.ret, 0);
		assert_int_equal(seen.count, N - 2);
		assert_int_equal(seen.notes.tangled_polygons, 0);
		seen_decode(&other, text, (size_t)(p - text), SIZE_MAX, SIZE_MAX, N);
		assert_true(seen_same(&seen, &other));
		seen_decode(&other, text, (size_t)(p - text), 777, 777, N - 3);
		assert_int_equal(other.err.code, MP_LIMIT);
	}
	free(text);
}

static void test_blocks_are_full(void **state)
{
	char text[20000] = V4;
	size_t len = strlen(text);

	(void)state;
	for (int i = 0; i < 600; i++)
		len += (size_t)sprintf(text + len,
				       i % 2 ? "f 1 2 3\n" : "f 1/1/1 2/2/2 3/3/3 4/4/4\n");
	seen_decode(&seen, text, len, SIZE_MAX, SIZE_MAX, 1000);
	assert_int_equal(seen.ret, 0);
	assert_false(seen.wrong);
	assert_int_equal(seen.count, 900);
	for (size_t step = 1; step < 3000; step = 2 * step + 1) {
		seen_decode(&other, text, len, step, step, 1000);
		assert_true(seen_same(&seen, &other));
	}
	for (uint64_t at = 1; at <= 900; at += 300) {
		memset(&seen, 0, sizeof seen);
		seen.fail_at = at;
		seen_decode(&seen, text, len, SIZE_MAX, SIZE_MAX, 1000);
		assert_int_equal(seen.ret, -1);
		assert_int_equal(seen.err.byte, 7);
	}
}

static void test_failing_allocations(void **state)
{
	static const char TEXT[] = "f 1 2 3 4 5\n" V4 "v 0.1 0.5 0\nf 1 2 3 4 5\nf 1 2 3\n";
	char text[100000];
	size_t len = sizeof TEXT - 1;
	const struct mp_sink sink = {.block = seen_block, .self = &seen};
	const struct mp_limits limits = {100000};
	long failed = 0;

	(void)state;
	memcpy(text, TEXT, len);
	for (int i = 0; i < 3000; i++) /* so that arrays have to grow */
		len += (size_t)sprintf(text + len, "v %d 0 0\n", i);
	len += (size_t)sprintf(text + len, "f");
	for (int i = 1; i < 3000; i++)
		len += (size_t)sprintf(text + len, " %d", i);
	for (long n = 1;; n++) {
		void *decoder = NULL;
		struct mp_notes notes;
		struct mp_error err;
		int ret;

		memset(&seen, 0, sizeof seen);
		alloc_fail_at(n);
		ret = mp_obj_decoder.begin(&decoder, &sink, &limits, &notes, &err);
		if (ret == 0)
			ret = mp_obj_decoder.push(decoder, (const uint8_t *)text, len, &err);
		if (ret == 0)
			ret = mp_obj_decoder.finish(decoder, &err);
		mp_obj_decoder.end(decoder);
		alloc_fail_at(0);
		if (ret == 0)
			break;
		assert_int_equal(err.code, MP_NOMEM);
		failed++;
	}
	assert_true(failed >= 8);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_a_triangle),
	    cmocka_unit_test(test_numbers_are_nearest_doubles),
	    cmocka_unit_test(test_weights_and_colours),
	    cmocka_unit_test(test_numbers_that_are_none),
	    cmocka_unit_test(test_forms_of_corners),
	    cmocka_unit_test(test_faces_need_three_corners),
	    cmocka_unit_test(test_negative_indices),
	    cmocka_unit_test(test_faces_before_their_vertices),
	    cmocka_unit_test(test_polygons),
	    cmocka_unit_test(test_keyhole_polygons),
	    cmocka_unit_test(test_continued_lines),
	    cmocka_unit_test(test_line_ends),
	    cmocka_unit_test(test_blanks_and_marks),
	    cmocka_unit_test(test_statements_that_are_passed_over),
	    cmocka_unit_test(test_statements_that_are_refused),
	    cmocka_unit_test(test_names),
	    cmocka_unit_test(test_long_names_are_cut),
	    cmocka_unit_test(test_control_characters_in_unknown_words),
	    cmocka_unit_test(test_nuls_at_the_end),
	    cmocka_unit_test(test_what_is_no_obj),
	    cmocka_unit_test(test_files_without_faces),
	    cmocka_unit_test(test_limits),
	    cmocka_unit_test(test_too_many_vertices),
	    cmocka_unit_test(test_numbers_of_many_digits),
	    cmocka_unit_test(test_lines_in_one_go_are_as_byte_by_byte),
	    cmocka_unit_test(test_odd_bytes_in_lines_in_one_go),
	    cmocka_unit_test(test_a_long_face),
	    cmocka_unit_test(test_blocks_are_full),
	    cmocka_unit_test(test_failing_allocations),
	};

	return cmocka_run_group_tests_name("obj", tests, NULL, NULL);
}
