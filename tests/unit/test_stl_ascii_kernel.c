#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/stl/stl_private.h"

/* Facets in vectors against facets by words of a line: what the former takes, the latter does. */

enum { ROOM = 2000 };

static char text[ROOM];
static uint64_t random_state = 1;

static unsigned below(unsigned n)
{
	random_state = random_state * 6364136223846793005u + 1442695040888963407u;
	return (unsigned)(random_state >> 33) % n;
}

/* Any digits, exponents of up to ${most}. */
static size_t number(char *p, unsigned most)
{
	return (size_t)sprintf(p, "%s%u.%06ue%c%02u", below(2) ? "-" : "", below(10),
			       below(1000000), "+-"[below(2)], below(most + 1));
}

/* Room behind it is filled with more of the file. */
static size_t facet(const char *end, unsigned indent, unsigned most)
{
	char *p = text;

	memset(text, ' ', sizeof text);
	p += sprintf(p, "%s%*sfacet normal", end, (int)indent, "");
	for (int line = 0; line < 4; line++) {
		for (int k = 0; k < 3; k++) {
			*p++ = ' ';
			p += number(p, most);
		}
		if (line == 0)
			p += sprintf(p, "%s%*souter loop", end, 2 * (int)indent, "");
		p += sprintf(p, "%s%*s%s", end, 2 * (int)indent, "",
			     line < 3 ? "vertex" : "endloop");
	}
	p += sprintf(p, "%s%*sendfacet", end, (int)indent, "");
	strcpy(p, "\nendsolid");
	p[9] = ' ';
	text[ROOM - 2] = 'x'; /* the blanks end before the end */
	return (size_t)(p - text);
}

/* Was it taken, and if so, as by words?  What is behind it is not to matter, but that it ends. */
static bool check(void)
{
	static char copy[ROOM];
	unsigned indent[STL_LINES] = {below(9), below(9)};
	const char *end = text + ROOM - 1, *next, *want;
	double tri[2][9], normal[2][3];
	uint64_t line = 5;

	next = stl_text_facet_vector(text, end, tri[0], normal[0], indent);
	if (next == NULL)
		return false;
	assert_true(*next == '\n' || *next == '\r');
	memcpy(copy, text, sizeof copy);
	memcpy(copy + (next - text), "\nend", 4);
	want = stl_text_facet(copy, copy + (end - text), tri[1], normal[1], &line);
	assert_non_null(want);
	assert_int_equal(next - text, want - copy);
	assert_int_equal(line, 5 + STL_LINES);
	assert_memory_equal(tri[0], tri[1], sizeof tri[0]);
	assert_memory_equal(normal[0], normal[1], sizeof normal[0]);
	return true;
}

static void the_usual_facet_is_taken(void **state)
{
	(void)state;
	for (int i = 0; i < 40000; i++) {
		unsigned most = below(4) ? 9 : 99, indent = below(4);

		(void)facet(below(4) ? "\n" : "\r\n", indent, most);
		if (i % 3 == 0)
			for (char *p = text; p < text + ROOM && i % 2; p++)
				*p = *p >= 'a' && *p <= 'z' ? (char)(*p - 'a' + 'A') : *p;
		assert_int_equal(check(), stl_has_vector());
	}
}

/* Every byte in turn becomes another: it is left alone, or nothing has changed. */
static void an_odd_byte_is_not_passed_over(void **state)
{
	static const char odd[] = "\n\r\t\v\f\x1f\x7f -+.,/:eE0159xX\x80\xff\0";
	size_t taken = 0, len;

	(void)state;
	for (int i = 0; i < 40; i++) {
		len = facet(i % 4 == 3 ? "\r\n" : "\n", (unsigned)i % 4, i % 5 ? 9 : 99);
		for (size_t at = 0; at <= len; at++) {
			char was = text[at];

			for (size_t k = 0; k < sizeof odd - 1; k++) {
				text[at] = odd[k];
				taken += check();
			}
			text[at] = was;
		}
	}
	assert_true(taken > 1000 || !stl_has_vector());
}

/* A byte more or less, anywhere. */
static void a_byte_more_or_less_is_not_passed_over(void **state)
{
	static const char more[] = " \n\r\t-+0.e9x";

	(void)state;
	for (int i = 0; i < 20; i++)
		for (size_t at = 0, len = 1; at <= len; at++)
			for (size_t k = 0; k < sizeof more; k++) {
				len = facet(i % 4 == 3 ? "\r\n" : "\n", (unsigned)i % 4, 9);
				if (more[k] == '\0') {
					memmove(text + at, text + at + 1, len + 9 - at);
				} else {
					memmove(text + at + 1, text + at, len + 10 - at);
					text[at] = more[k];
				}
				(void)check();
			}
}

/* Where there is little behind it, nothing is read beyond it. */
static void a_facet_near_the_end_is_left_alone(void **state)
{
	unsigned indent[STL_LINES] = {0};
	double tri[9], normal[3];
	size_t len = facet("\n", 2, 9);
	char *copy = malloc(len + 1);

	(void)state;
	assert_non_null(copy);
	memcpy(copy, text, len + 1);
	assert_null(stl_text_facet_vector(copy, copy + len, tri, normal, indent));
	free(copy);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(the_usual_facet_is_taken),
	    cmocka_unit_test(an_odd_byte_is_not_passed_over),
	    cmocka_unit_test(a_byte_more_or_less_is_not_passed_over),
	    cmocka_unit_test(a_facet_near_the_end_is_left_alone),
	};

	return cmocka_run_group_tests_name("stl_ascii_kernel", tests, NULL, NULL);
}
