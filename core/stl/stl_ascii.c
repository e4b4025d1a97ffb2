#include <string.h>

#include "core/stl/stl_private.h"

/* Bytes to words, lines and names; what they mean is up to stl_ascii_grammar.c. */

void stl_text_begin(struct stl *s)
{
	struct stl_text *t = &s->text;

	t->mode = STL_IN_BLANK;
	t->expect = STL_WANT_FACET;
	t->cr = t->in_solid = false;
	t->solids = 0;
	t->line = 1;
	t->facet_line = t->tail_line = t->counted_line = t->pad_line = t->pad_at = 0;
	t->word_len = t->name_len = 0;
	memset(t->indent, 0, sizeof t->indent);
}

/* Keep the piece [p, end) of a word that goes on in the next chunk, or ended with this piece. */
static void keep_piece(struct stl_text *t, const char *p, size_t len)
{
	size_t had = t->word_len, room = had < STL_WORD_MOST ? STL_WORD_MOST - had : 0;

	memcpy(t->word + (STL_WORD_MOST - room), p, len < room ? len : room);
	t->word_len += len;
	if (t->word_len <= STL_WORD_MOST)
		return;
	if (had <= STL_WORD_MOST) {
		mp_decimal_begin(&t->decimal);
		mp_decimal_feed(&t->decimal, t->word, STL_WORD_MOST);
		p += room;
		len -= room;
	}
	mp_decimal_feed(&t->decimal, p, len);
}

/* The piece of a chunk that is still to be read; ${begin} is at the offset s->at. */
struct piece {
	const char *begin, *p, *end;
	const char *stop; /* the last blank, ${begin} if there is none */
};

static const char *word_end(const char *p, const char *end)
{
	while (p < end && stl_class_of[(uint8_t)*p] == STL_WORD)
		p++;
	return p;
}

/* A byte that belongs to no text, in whatever place. */
static int take_odd(struct stl *s, const struct piece *in, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	uint64_t at = s->at + (uint64_t)(in->p - in->begin);

	if (stl_class_of[(uint8_t)*in->p] == STL_CONTROL)
		return mp_fail_line(err, MP_SYNTAX, at, t->line,
				    "the control character 0x%02x in text", (unsigned)*in->p);
	if (t->mode == STL_IN_NAME && stl_text_end_name(s, err))
		return -1;
	t->mode = STL_IN_PAD;
	t->pad_at = at;
	t->pad_line = t->line;
	return 0;
}

/* in->p is behind the word.  A control character in a word is named rather than half the word. */
static int end_word(struct stl *s, const struct piece *in, const char *word, size_t len,
		    struct mp_error *err)
{
	if (stl_class_of[(uint8_t)*in->p] == STL_CONTROL)
		return take_odd(s, in, err);
	return stl_text_word(s, word, len, err);
}

static int begin_word(struct stl *s, struct piece *in, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	const char *word = in->p;

	t->word_at = s->at + (uint64_t)(word - in->begin);
	t->word_line = t->line;
	t->cr = false;
	if (*word == '#') {
		stl_text_nonstandard(s, t->line);
		t->mode = STL_IN_REST;
		return 0;
	}
	in->p = word_end(word, in->end);
	if (in->p < in->end)
		return end_word(s, in, word, (size_t)(in->p - word), err);
	t->mode = STL_IN_WORD;
	t->word_len = 0;
	keep_piece(t, word, (size_t)(in->p - word));
	return 0;
}

static int go_on_with_word(struct stl *s, struct piece *in, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	const char *rest = in->p;

	in->p = word_end(rest, in->end);
	keep_piece(t, rest, (size_t)(in->p - rest));
	return in->p < in->end ? end_word(s, in, t->word, t->word_len, err) : 0;
}

static void take_newline(struct stl_text *t, char c)
{
	t->line += !(t->cr && c == '\n');
	t->cr = c == '\r';
}

/* The next facet in one go, to the end of the block; NULL where it has to be read by words. */
static const char *whole_facet(struct stl *s, const struct piece *in, bool vector)
{
	struct stl_text *t = &s->text;
	double *tri = s->block[s->count];
	const char *next;

	if (vector && (next = stl_text_facet_vector(in->p, in->stop, tri, t->normal, t->indent))) {
		t->line += STL_LINES;
		return next;
	}
	return stl_text_facet(in->p, in->stop, tri, t->normal, &t->line);
}

static int take_facets(struct stl *s, struct piece *in, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	bool vector = stl_has_vector();
	const char *next;

	while (in->p < in->stop && s->notes->triangles < s->limits->max_triangles &&
	       (next = whole_facet(s, in, vector))) {
		in->p = next;
		t->tail_line = t->line;
		stl_check_normal(s->notes, s->block[s->count], t->normal);
		if (stl_commit(s, err))
			return -1;
	}
	return 0;
}

static int take_blanks(struct stl *s, struct piece *in, struct mp_error *err)
{
	struct stl_text *t = &s->text;

	if (t->expect == STL_WANT_FACET && t->in_solid && !t->cr && take_facets(s, in, err))
		return -1;
	for (; in->p < in->end; in->p++) {
		switch (stl_class_of[(uint8_t)*in->p]) {
		case STL_WORD:
			return begin_word(s, in, err);
		case STL_BLANK:
			t->cr = false;
			break;
		case STL_NEWLINE:
			take_newline(t, *in->p);
			break;
		default:
			return take_odd(s, in, err);
		}
	}
	return 0;
}

/* A name or what else goes to the end of the line. */
static int take_line(struct stl *s, struct piece *in, struct mp_error *err)
{
	struct stl_text *t = &s->text;

	for (; in->p < in->end; in->p++) {
		uint8_t class = stl_class_of[(uint8_t)*in->p];

		if (class == STL_NEWLINE) {
			bool name = t->mode == STL_IN_NAME;

			t->mode = STL_IN_BLANK;
			return name ? stl_text_end_name(s, err) : 0;
		}
		if (class >= STL_PAD)
			return take_odd(s, in, err);
		if (t->mode == STL_IN_NAME && t->name_len < MP_NAME_MAX &&
		    (class == STL_WORD || t->name_len > 0))
			t->name[t->name_len++] = *in->p;
	}
	return 0;
}

static int take_pad(struct stl *s, struct piece *in, struct mp_error *err)
{
	for (; in->p < in->end; in->p++) {
		uint8_t class = stl_class_of[(uint8_t)*in->p];

		if (class == STL_WORD || class == STL_CONTROL)
			return mp_fail_line(err, MP_SYNTAX, s->text.pad_at, s->text.pad_line,
					    "a NUL or Ctrl-Z character in text");
	}
	return 0;
}

int stl_text_push(struct stl *s, const char *chunk, size_t len, struct mp_error *err)
{
	static int (*const take[])(struct stl *, struct piece *,
				   struct mp_error *) = {[STL_IN_BLANK] = take_blanks,
							 [STL_IN_WORD] = go_on_with_word,
							 [STL_IN_NAME] = take_line,
							 [STL_IN_REST] = take_line,
							 [STL_IN_PAD] = take_pad};
	struct piece in = {chunk, chunk, chunk + len, chunk + len};

	while (in.stop > chunk && (unsigned char)*--in.stop > ' ')
		;
	while (in.p < in.end) {
		if (take[s->text.mode](s, &in, err))
			return -1;
	}
	return 0;
}

/* Is the word that the end of the file cut the beginning of one that may stand here? */
static bool is_cut(const char *word, size_t len)
{
	static const char *const may[] = {"solid", "facet", "endsolid"};

	for (size_t i = 0; i < sizeof may / sizeof may[0]; i++) {
		size_t n = 0;

		while (n < len && (word[n] | 0x20) == may[i][n])
			n++;
		if (n == len && may[i][n] != '\0')
			return true;
	}
	return false;
}

static int fail_truncated(const struct stl *s, struct mp_error *err)
{
	bool inside = s->text.expect != STL_WANT_FACET;

	return mp_fail_line(err, MP_TRUNCATED, s->notes->bytes, s->text.line,
			    "the file ends inside a %s, after %llu facets",
			    inside ? "facet" : "solid", (unsigned long long)s->notes->triangles);
}

/* The word at the very end, with nothing behind it: it may be a part of one. */
static int take_last_word(struct stl *s, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	bool last = t->expect == STL_WANT_ENDFACET &&
		    stl_keyword_of(t->word, t->word_len) == STL_KW_ENDFACET;

	if (t->expect == STL_WANT_FACET ? t->word_len < 8 && is_cut(t->word, t->word_len) : !last)
		return fail_truncated(s, err);
	return stl_text_word(s, t->word, t->word_len, err);
}

int stl_text_finish(struct stl *s, struct mp_error *err)
{
	struct stl_text *t = &s->text;

	if (t->mode == STL_IN_WORD && take_last_word(s, err))
		return -1;
	if (t->mode == STL_IN_NAME && stl_text_end_name(s, err))
		return -1;
	if (t->expect != STL_WANT_FACET || (t->in_solid && s->notes->triangles == 0))
		return fail_truncated(s, err);
	if (t->solids == 0)
		return mp_fail_line(err, MP_SYNTAX, 0, 1, "text without the word solid");
	if (s->notes->triangles == 0)
		return mp_fail_line(err, MP_NO_FACES, MP_NO_BYTE, 0, "a text STL without facets");
	if (t->mode == STL_IN_PAD)
		s->notes->trailing_bytes = s->notes->bytes - t->pad_at;
	s->notes->missing_endsolid += t->in_solid;
	s->notes->parts = t->solids;
	return 0;
}
