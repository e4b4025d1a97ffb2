#include <string.h>

#include "core/stl/stl_private.h"

/* The usual facet in one go; stl_ascii.c takes what this refuses and gives the same answers. */

#define INLINE static inline __attribute__((always_inline))

static const char *any_blanks(const char *p, const char *end, uint64_t *line)
{
	uint64_t n = *line;

	for (; p < end && (unsigned char)*p <= ' '; p++) {
		if (*p == '\n')
			n++;
		else if (*p == '\r' ? p + 1 == end || p[1] != '\n' : *p != ' ' && *p != '\t')
			return NULL;
	}
	*line = n;
	return p == end ? NULL : p;
}

/* What blanks() may look at, and each of the others leaves before the end. */
enum { BLANKS_ROOM = 11, WORD_ROOM = 8 + BLANKS_ROOM, ROOM = MP_NUMBER_ROOM + BLANKS_ROOM };

/*
 * One blank at least; NULL where there is none, or one that needs thought, or the end.  First what
 * nearly all are: one space; a line end and at most 8 spaces.
 */
INLINE const char *blanks(const char *p, const char *end, uint64_t *line)
{
	if (*p == ' ' && (unsigned char)p[1] > ' ')
		return p + 1;
	p += *p == '\r' && p[1] == '\n';
	if (*p == '\n') {
		uint64_t odd = mp_text8(p + 1) ^ UINT64_C(0x2020202020202020);
		const char *next = p + 1 + (odd != 0 ? __builtin_ctzll(odd) >> 3 : 8);

		if ((unsigned char)*next > ' ') {
			++*line;
			return next;
		}
	}
	return (unsigned char)*p > ' ' ? NULL : any_blanks(p, end, line);
}

/* ${name}, ${len} letters filled up to 8 with NULs, in any case, and blanks behind them. */
INLINE const char *word(const char *p, const char *end, const char name[8], size_t len,
			uint64_t *line)
{
	static const char letters[16] = {-1, -1, -1, -1, -1, -1, -1, -1};
	const uint64_t low = 0x2020202020202020; /* tells A from a and no letter from another */
	uint64_t have, want, mask;

	if (p == NULL || end - p < WORD_ROOM)
		return NULL;
	memcpy(&have, p, 8);
	memcpy(&want, name, 8);
	memcpy(&mask, letters + 8 - len, 8);
	return ((have | low) & mask) == want ? blanks(p + len, end, line) : NULL;
}

/* Three finite numbers, each with blanks behind it. */
INLINE const char *numbers(const char *p, const char *end, double out[3], uint64_t *line)
{
	for (int i = 0; i < 3; i++) {
		if (p == NULL || end - p < ROOM)
			return NULL;
		p = mp_number_scan(p, &out[i]);
		if (p == NULL)
			return NULL;
		p = blanks(p, end, line);
	}
	return p;
}

const char *stl_text_facet(const char *p, const char *end, double tri[9], double normal[3],
			   uint64_t *line)
{
	uint64_t n = *line, after;

	if (p < end && (unsigned char)*p <= ' ')
		p = any_blanks(p, end, &n);
	p = word(p, end, "facet\0\0", 5, &n);
	p = word(p, end, "normal\0", 6, &n);
	if (p != NULL)
		p = numbers(p, end, normal, &n);
	p = word(p, end, "outer\0\0", 5, &n);
	p = word(p, end, "loop\0\0\0", 4, &n);
	for (int i = 0; i < 3; i++) {
		p = word(p, end, "vertex\0", 6, &n);
		if (p != NULL)
			p = numbers(p, end, tri + 3 * i, &n);
	}
	p = word(p, end, "endloop", 7, &n);
	after = n;
	if (word(p, end, "endfacet", 8, &after) == NULL)
		return NULL;
	*line = n;
	return p + 8;
}
