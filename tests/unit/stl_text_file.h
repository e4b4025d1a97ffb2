#ifndef STL_TEXT_FILE_H
#define STL_TEXT_FILE_H

/* Decodes text STL files cut in every way and checks the outcome; include behind cmocka.h. */

#include "stl_seen.h"

static const size_t all = SIZE_MAX; /* one chunk */
static const uint64_t roomy = 1000000;
static struct seen whole, padded_whole, other;
enum { WINDOW = 4096 };

#define LOOP        "outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
#define FACET       "facet normal 0 0 1\n" LOOP "endfacet\n"
#define STL(facets) "solid s\n" facets "endsolid s\n"

/*
 * Cut at every place and into pieces of every size up to 199: always the same.  A text shorter than
 * the window of the sniffer is decoded in one go however it came, so the cuts are made behind
 * blanks that fill the window; from there on the answer is the one for the text alone.
 */
static inline void decode_text(const char *text, size_t len)
{
	size_t size = WINDOW + len;
	char *padded = malloc(size);
	struct seen *cut = &other;

	assert_non_null(padded);
	memset(padded, ' ', WINDOW);
	memcpy(padded + WINDOW, text, len);
	seen_decode(&padded_whole, padded, size, all, all, roomy);
	for (size_t at = 0; at <= len && len < 2000; at++) {
		seen_decode(cut, padded, size, WINDOW + at, all, roomy);
		if (!seen_same(&padded_whole, cut))
			fail_msg("cut at %zu: %s / %s", at, padded_whole.err.text, cut->err.text);
	}
	for (size_t step = 1; step < 200; step++) {
		seen_decode(cut, padded, size, WINDOW, step, roomy);
		if (!seen_same(&padded_whole, cut))
			fail_msg("step %zu: %s / %s", step, padded_whole.err.text, cut->err.text);
	}
	free(padded);
	seen_decode(&whole, text, len, all, all, roomy);
	assert_false(whole.wrong);
	seen_decode(cut, text, len, len / 2, 1, roomy);
	assert_true(seen_same(&whole, cut));
	if (len > 2 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* only at the beginning */
		return;
	assert_int_equal(whole.ret, padded_whole.ret);
	assert_int_equal(whole.err.code, padded_whole.err.code);
	assert_int_equal(whole.err.line, padded_whole.err.line);
	assert_true(whole.hash == padded_whole.hash);
}

static inline void check_accepted(const char *text, uint64_t triangles, const char *parts)
{
	decode_text(text, strlen(text));
	if (whole.ret != 0)
		fail_msg("refused: %s (line %llu) in:\n%.300s", whole.err.text,
			 (unsigned long long)whole.err.line, text);
	assert_int_equal(whole.notes.format, MP_FORMAT_STL_ASCII);
	assert_int_equal(whole.count, triangles);
	assert_string_equal(whole.parts, parts);
}

static inline void check_refused_bytes(const char *text, size_t len, enum mp_code code,
				       uint64_t line, uint64_t byte)
{
	decode_text(text, len);
	if (whole.ret == 0 || whole.err.code != code || whole.err.line != line ||
	    (byte != 0 && whole.err.byte != byte))
		fail_msg("code %d, line %llu, byte %llu: %s for:\n%.400s", whole.err.code,
			 (unsigned long long)whole.err.line, (unsigned long long)whole.err.byte,
			 whole.err.text, text);
}

static inline void check_refused(const char *text, enum mp_code code, uint64_t line)
{
	check_refused_bytes(text, strlen(text), code, line, 0);
}

#endif
