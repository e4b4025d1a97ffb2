#include <math.h>
#include <string.h>

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

/* What may be read behind the beginning of a line that quick_vertex() takes. */
enum { VERTEX_ROOM = 64 + 16 };

/*
 * A number of up to 8 digits, a point and up to 16, from p[*at] on; p[*at] becomes the blank behind
 * it.  *odd: what is no digit from there on.  False where it is of another form.
 */
static inline __attribute__((always_inline)) bool quick_number(const char *p, unsigned *at,
							       uint64_t *odd, double *value)
{
	static const uint32_t power[9] = {1,      10,      100,      1000,     10000,
					  100000, 1000000, 10000000, 100000000};
	const uint64_t last = (uint64_t)1 << 63; /* there may be none left */
	bool negative = p[*at] == '-';
	unsigned first = *at + negative, end, whole, behind = 0;
	uint64_t w;

	*odd &= *odd - negative;
	end = (unsigned)__builtin_ctzll(*odd | last);
	whole = end - first;
	if (whole > 8)
		return false;
	w = mp_digits_of(mp_text8(p + first) ^ MP_ZEROS8, whole);
	if (p[end] == '.') {
		const char *q = p + end + 1;
		uint64_t digit = mp_text8(q) ^ MP_ZEROS8;
		unsigned n;

		first = end + 1;
		*odd &= *odd - 1;
		end = (unsigned)__builtin_ctzll(*odd | last);
		behind = end - first;
		if (behind > 16)
			return false;
		n = behind < 8 ? behind : 8;
		w = w * power[n] + mp_digits_of(digit, n);
		if (behind > 8)
			w = w * power[behind - 8] +
			    mp_digits_of(mp_text8(q + 8) ^ MP_ZEROS8, behind - 8);
	}
	if (whole + behind - 1 > 18)
		return false;
	*odd &= *odd - 1;
	*at = end;
	*value = mp_number_compose(w, -(int64_t)behind, negative);
	return end < 63;
}

/* vertex(), where there is room, of the most frequent form: three such numbers, a blank between. */
static inline const char *quick_vertex(struct obj *o, const char *p)
{
	uint64_t odd = mp_not_digits64(p);
	unsigned at = 0;
	double xyz[3];

	if (!quick_number(p, &at, &odd, &xyz[0]) || p[at++] != ' ' ||
	    !quick_number(p, &at, &odd, &xyz[1]) || p[at++] != ' ' ||
	    !quick_number(p, &at, &odd, &xyz[2]))
		return NULL;
	p = line_end(p + at);
	if (p != NULL)
		memcpy(o->vertex[o->vertices++], xyz, sizeof xyz);
	return p;
}

/* Behind the v: 3, 4, 6 or 7 numbers. */
static const char *vertex(struct obj *o, const char *p, const char *stop)
{
	double number[7], *xyz;
	const char *next;
	unsigned n = 0;

	if (o->vertices == o->vertex_room || o->vertices == o->vertex_most)
		return NULL;
	if (stop - p >= VERTEX_ROOM && (next = quick_vertex(o, p)) != NULL)
		return next;
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

/*
 * ${found}, which most often is what it was the last time, ${*before}.  A branch can be foreseen,
 * so that nothing has to wait until it is known where a word ends.
 */
static inline unsigned foreseen(unsigned found, unsigned *before)
{
	unsigned guess = *before;

	if (__builtin_expect(found == guess, 1)) {
		__asm__ volatile("" : "+r"(guess)); /* else the compiler sees that it is found */
		return guess;
	}
	*before = found;
	return found;
}

/* How many digits are there, up to 7; 8 for more. */
static inline unsigned digits_at(const char *p)
{
	uint64_t odd = mp_not_digits8(mp_text8(p) ^ MP_ZEROS8);

	return odd == 0 ? 8 : (unsigned)__builtin_ctzll(odd) >> 3;
}

enum { CORNER_ROOM = 3 * 8 + 8 };

/* Are the first ${n} of eight bytes the same, 1 to 8? */
static inline bool same_text(uint64_t a, uint64_t b, unsigned n)
{
	return (a ^ b) << (64 - 8 * n) == 0;
}

/*
 * corner(), where there is room, of up to 7 digits each; ${lengths} are those of the last one.
 * Many programs write the same index three times.
 */
static inline __attribute__((always_inline)) const char *
quick_corner(const char *p, size_t vertices, uint32_t *vertex, unsigned lengths[3])
{
	uint64_t text = mp_text8(p), digit = text ^ MP_ZEROS8, odd = mp_not_digits8(digit), value;
	unsigned n;

	if (odd == 0)
		return NULL;
	value = mp_digits_below(digit, odd);
	if (value == 0 || value > vertices)
		return NULL;
	*vertex = (uint32_t)(value - 1);
	n = foreseen((unsigned)__builtin_ctzll(odd) >> 3, &lengths[0]);
	p += n;
	if (*p == '/' && same_text(mp_text8(p + 1), text, n + 1) &&
	    same_text(mp_text8(p + n + 2), text, n))
		p += 2 * n + 2;
	else
		for (int i = 1; i < 3 && *p == '/'; i++)
			p += 1 + foreseen(digits_at(p + 1), &lengths[i]);
	return ends_word(*p) ? p : NULL;
}

/* Behind the f; the corners go to the beginning of o->corner. */
static const char *face(struct obj *o, const char *p, const char *stop, size_t *n)
{
	const uint64_t left = o->limits->max_triangles - o->notes->triangles;
	const char *next;

	if (o->held > 0)
		return NULL;
	for (p = blanks(p); *p != '\n' && *p != '\r'; p = blanks(p)) {
		if (*n == o->corner_room)
			return NULL;
		next = stop - p < CORNER_ROOM
			   ? NULL
			   : quick_corner(p, o->vertices, &o->corner[*n], o->lengths);
		if (next == NULL)
			next = corner(p, o->vertices, &o->corner[*n]);
		if (next == NULL)
			return NULL;
		p = next;
		++*n;
	}
	return *n >= 3 && *n - 2 <= left ? line_end(p) : NULL;
}

static int take_face(struct obj *o, const char **p, const char *stop, struct mp_error *err)
{
	size_t n = 0;

	*p = face(o, *p, stop, &n);
	if (*p == NULL)
		return 0;
	o->known++;
	o->notes->triangles += n - 2;
	o->notes->polygons += n > 3;
	return obj_split_face(o, o->corner, n, err);
}

/* From p on, some bytes at a time, none of which ends what rest() passes over. */
static inline const char *skip(const char *p, const char *stop)
{
#ifdef __SSE2__
	for (; stop - p >= 32; p += 32) {
		unsigned found = 0;

		for (int i = 0; i < 2; i++) {
			mp_text16 text = mp_load16(p + 16 * i);

			found |= mp_bits16((mp_found16)((text <= '\r') | (text == '\\'))) << 16 * i;
		}
		if (found != 0)
			return p + __builtin_ctz(found);
	}
#else
	const uint64_t each = UINT64_C(0x0101010101010101);

	for (; stop - p >= 8; p += 8) {
		uint64_t text = mp_text8(p), backslash = text ^ each * '\\';
		uint64_t low = (text - each * ('\r' + 1)) & ~text;
		uint64_t found = (low | ((backslash - each) & ~backslash)) & each * 0x80;

		if (found != 0) /* the lowest is true, and all below it is not */
			return p + (__builtin_ctzll(found) >> 3);
	}
#endif
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
			if (take_face(o, &p, stop, err))
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
