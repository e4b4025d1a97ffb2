#include <string.h>

#include "core/stl/stl_private.h"

/* The usual facet in one go; stl_ascii.c takes what this refuses and gives the same answers. */

/* One blank at least; NULL where there is none, or one that needs thought, or the end. */
static inline const char *blanks(const char *p, const char *end, uint64_t *line)
{
	const char *begin = p;

	for (; p < end && (unsigned char)*p <= ' '; p++) {
		if (*p == '\n')
			++*line;
		else if (*p == '\r' ? p + 1 == end || p[1] != '\n' : *p != ' ' && *p != '\t')
			return NULL;
	}
	return p == begin || p == end ? NULL : p;
}

/* ${name}, ${len} letters filled up to 8 with NULs, in any case, and blanks behind them. */
static inline const char *word(const char *p, const char *end, const char name[8], size_t len,
			       uint64_t *line)
{
	static const char letters[16] = {-1, -1, -1, -1, -1, -1, -1, -1};
	const uint64_t low = 0x2020202020202020; /* tells A from a and no letter from another */
	uint64_t have, want, mask;

	if (p == NULL || end - p < 8)
		return NULL;
	memcpy(&have, p, 8);
	memcpy(&want, name, 8);
	memcpy(&mask, letters + 8 - len, 8);
	return ((have | low) & mask) == want ? blanks(p + len, end, line) : NULL;
}

/* Three finite numbers, each with blanks behind it. */
static inline const char *numbers(const char *p, const char *end, double out[3], uint64_t *line)
{
	for (int i = 0; i < 3 && p != NULL; i++) {
		p = mp_number_scan(p, end, true, &out[i]);
		if (p == NULL || !isfinite(out[i]))
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
		p = blanks(p, end, &n);
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
