#include <math.h>

#include "core/obj/obj_private.h"

/* Each of these returns the byte behind what it read, or NULL where that needs thought. */

static inline const char *blanks(const char *p)
{
	while (*p == ' ' || *p == '\t')
		p++;
	return p;
}

static inline const char *line_end(const char *p)
{
	if (*p == '\n')
		return p + 1;
	return *p == '\r' && p[1] == '\n' ? p + 2 : NULL;
}

static inline bool ends_word(char c)
{
	return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

/* Behind the v: 3, 4, 6 or 7 numbers. */
static const char *vertex(struct obj *o, const char *p, const char *stop)
{
	double number[7], *xyz;
	unsigned n = 0;

	if (o->vertices == o->vertex_room || o->vertices == o->vertex_most)
		return NULL;
	for (p = blanks(p); n < 7 && *p != '\n' && *p != '\r'; n++) {
		p = stop - p < MP_NUMBER_ROOM ? mp_number_scan_bytes(p, stop, &number[n])
					      : mp_number_scan_text(p, &number[n]);
		if (p == NULL || !ends_word(*p))
			return NULL;
		p = blanks(p);
	}
	p = line_end(p);
	if (p == NULL || n < 3 || n == 5 || !isfinite(number[0]) || !isfinite(number[1]) ||
	    !isfinite(number[2]))
		return NULL;
	xyz = o->vertex[o->vertices++];
	xyz[0] = number[0];
	xyz[1] = number[1];
	xyz[2] = number[2];
	return p;
}

/* Behind a /: an index or nothing. */
static inline const char *other_index(const char *p)
{
	bool negative = *p == '-';

	p += negative;
	if (negative && !mp_is_digit(*p))
		return NULL;
	while (mp_is_digit(*p))
		p++;
	return p;
}

/* A corner; its vertex, from 0, must be there already. */
static inline const char *corner(const char *p, size_t vertices, uint32_t *vertex)
{
	bool negative = *p == '-';
	const char *first = p += negative;
	uint64_t value = 0;

	for (; mp_is_digit(*p); p++)
		value = 10 * value + mp_digit(*p);
	if (p == first || p - first > 15 || value == 0 || value > vertices)
		return NULL;
	*vertex = (uint32_t)(negative ? vertices - value : value - 1);
	for (int i = 0; i < 2 && *p == '/'; i++)
		if ((p = other_index(p + 1)) == NULL)
			return NULL;
	return ends_word(*p) ? p : NULL;
}

/* Behind the f; the corners go to the beginning of o->corner. */
static const char *face(struct obj *o, const char *p, size_t *n)
{
	const uint64_t left = o->limits->max_triangles - o->notes->triangles;

	if (o->held > 0)
		return NULL;
	for (p = blanks(p); *p != '\n' && *p != '\r'; p = blanks(p)) {
		if (*n == o->corner_room)
			return NULL;
		p = corner(p, o->vertices, &o->corner[*n]);
		if (p == NULL)
			return NULL;
		++*n;
	}
	return *n >= 3 && *n - 2 <= left ? line_end(p) : NULL;
}

static int take_face(struct obj *o, const char **p, struct mp_error *err)
{
	size_t n = 0;

	*p = face(o, *p, &n);
	if (*p == NULL)
		return 0;
	o->known++;
	o->notes->triangles += n - 2;
	o->notes->polygons += n > 3;
	return obj_split_face(o, o->corner, n, err);
}

/* From p on, 8 bytes at a time, none of which ends what rest() passes over. */
static inline const char *skip(const char *p, const char *stop)
{
	const uint64_t each = UINT64_C(0x0101010101010101);

	for (; stop - p >= 8; p += 8) {
		uint64_t text = mp_text8(p), backslash = text ^ each * '\\';
		uint64_t low = (text - each * ('\r' + 1)) & ~text;
		uint64_t found = (low | ((backslash - each) & ~backslash)) & each * 0x80;

		if (found != 0) /* the lowest is true, and all below it is not */
			return p + (__builtin_ctzll(found) >> 3);
	}
	return p;
}

/* The rest of a line up to ${most}, the class that stops it, or the line's end. */
static const char *rest(const char *p, const char *stop, enum obj_class most)
{
	p = skip(p, stop);
	while (obj_class_of[(uint8_t)*p] < most)
		p++;
	return line_end(p);
}

int obj_take_lines(struct obj *o, const char **at, const char *stop, struct mp_error *err)
{
	const char *p = *at;

	while (p <= stop) {
		char c = *p, d = p < stop ? p[1] : '\n';

		if (c == 'v' && d == ' ') {
			p = vertex(o, p + 2, stop);
			o->known += p != NULL;
		} else if (c == 'f' && d == ' ') {
			p += 2;
			if (take_face(o, &p, err))
				return -1;
		} else if (c == 'v' && (d == 't' || d == 'n') && p[2] == ' ') {
			p = rest(p + 3, stop, OBJ_BACKSLASH);
			o->known += p != NULL;
		} else if (c == '#') {
			p = rest(p + 1, stop, OBJ_NEWLINE);
		} else {
			p = line_end(p);
		}
		if (p == NULL)
			break;
		o->line++;
		*at = p;
	}
	return 0;
}
