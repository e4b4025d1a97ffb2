#include <string.h>

#include "core/obj/obj_private.h"

const uint8_t obj_class_of[256] = {
    ['\0'] = OBJ_PAD,     [0x1a] = OBJ_PAD,     [' '] = OBJ_BLANK, ['\t'] = OBJ_BLANK,
    ['\v'] = OBJ_BLANK,   ['\f'] = OBJ_BLANK,   ['#'] = OBJ_HASH,  ['\\'] = OBJ_BACKSLASH,
    ['\n'] = OBJ_NEWLINE, ['\r'] = OBJ_NEWLINE,
}; /* the rest: OBJ_WORD = 0 */

/* The piece of a chunk that is still to be read; ${begin} is at the offset o->at. */
struct piece {
	const char *begin, *p, *end;
};

static enum obj_class class_of(const char *p)
{
	return (enum obj_class)obj_class_of[(uint8_t)*p];
}

static uint64_t offset(const struct obj *o, const struct piece *in)
{
	return o->at + (uint64_t)(in->p - in->begin);
}

/* Keep a piece of a word of which there is more in the next chunk, on the next line or before. */
static void keep_piece(struct obj *o, const char *p, size_t len)
{
	size_t had = o->word_len, room = had < OBJ_WORD_MOST ? OBJ_WORD_MOST - had : 0;

	memcpy(o->word + (OBJ_WORD_MOST - room), p, len < room ? len : room);
	o->word_len += len;
	if (o->statement == OBJ_FACE)
		obj_corner_feed(&o->word_corner, p, len);
	if (o->statement != OBJ_VERTEX || o->word_len <= OBJ_WORD_MOST)
		return;
	if (had <= OBJ_WORD_MOST) {
		mp_decimal_begin(&o->decimal);
		mp_decimal_feed(&o->decimal, o->word, OBJ_WORD_MOST);
		p += room;
		len -= room;
	}
	mp_decimal_feed(&o->decimal, p, len);
}

static void begin_word(struct obj *o, uint64_t at)
{
	o->word_at = at;
	o->word_line = o->line;
	o->word_len = 0;
	if (o->mode == OBJ_AT_LINE) {
		o->statement_at = at;
		o->statement_line = o->line;
	}
	if (o->statement == OBJ_FACE)
		obj_corner_begin(&o->word_corner);
	o->mode = OBJ_IN_WORD;
}

static int take_newline(struct obj *o, struct piece *in, struct mp_error *err)
{
	o->cr = *in->p++ == '\r';
	if (obj_end_statement(o, err))
		return -1;
	o->line++;
	return 0;
}

static void take_pad(struct obj *o, struct piece *in)
{
	o->mode = OBJ_IN_PAD;
	o->pad_at = offset(o, in);
	o->pad_line = o->line;
}

/* Before a statement and between its words. */
static int in_blank(struct obj *o, struct piece *in, struct mp_error *err)
{
	switch (class_of(in->p)) {
	case OBJ_WORD:
		begin_word(o, offset(o, in));
		return 0;
	case OBJ_BLANK:
		in->p++;
		return 0;
	case OBJ_HASH:
		o->mode = OBJ_IN_COMMENT;
		return 0;
	case OBJ_PAD:
		take_pad(o, in);
		return 0;
	case OBJ_BACKSLASH:
		in->p++;
		o->backslash = true;
		return 0;
	default:
		return take_newline(o, in, err);
	}
}

/* A # ends a word, but not where the Microsoft library writes 1.#QNAN: that must not become 1. */
static bool is_in_word(const struct obj *o, const char *word, size_t len)
{
	char text[3];
	size_t had = o->word_len;

	if (o->statement != OBJ_VERTEX || had + len < 2 || had + len > 3)
		return false;
	memcpy(text, o->word, had);
	memcpy(text + had, word, len);
	len += had;
	return text[len - 1] == '.' && text[len - 2] == '1' &&
	       (len == 2 || text[0] == '-' || text[0] == '+');
}

static int in_word(struct obj *o, struct piece *in, struct mp_error *err)
{
	const char *word = in->p;
	enum obj_class class = OBJ_WORD;
	size_t len = 0;

	for (; in->p < in->end; in->p++, len++) {
		class = class_of(in->p);
		if (class == OBJ_HASH && is_in_word(o, word, len))
			class = OBJ_WORD;
		if (class != OBJ_WORD)
			break;
	}
	if (class != OBJ_WORD && class != OBJ_BACKSLASH && o->word_len == 0)
		return obj_word(o, word, len, err);
	keep_piece(o, word, len);
	if (class == OBJ_WORD)
		return 0;
	if (class != OBJ_BACKSLASH)
		return obj_word(o, o->word, o->word_len, err);
	in->p++;
	o->backslash = true;
	return 0;
}

static void add_to_name(struct obj *o, char c)
{
	bool blank = class_of(&c) == OBJ_BLANK;

	o->name_gap = blank;
	if (o->name.len < MP_NAME_MAX && (!blank || o->name.len > 0))
		o->name.text[o->name.len++] = c;
}

/* A name goes to the end of the line; # is a part of it unless there is a blank before. */
static int in_name(struct obj *o, struct piece *in, struct mp_error *err)
{
	switch (class_of(in->p)) {
	case OBJ_NEWLINE:
		return take_newline(o, in, err);
	case OBJ_PAD:
		take_pad(o, in);
		return 0;
	case OBJ_BACKSLASH:
		o->backslash = true;
		break;
	case OBJ_HASH:
		if (o->name_gap) {
			o->mode = OBJ_IN_COMMENT;
			return 0;
		}
		add_to_name(o, '#');
		break;
	default:
		add_to_name(o, *in->p);
		break;
	}
	in->p++;
	return 0;
}

static int in_rest(struct obj *o, struct piece *in, struct mp_error *err)
{
	enum obj_class stop = o->mode == OBJ_IN_COMMENT ? OBJ_NEWLINE : OBJ_BACKSLASH;

	while (in->p < in->end && class_of(in->p) < stop)
		in->p++;
	if (in->p == in->end)
		return 0;
	if (class_of(in->p) == OBJ_NEWLINE)
		return take_newline(o, in, err);
	in->p++;
	o->backslash = true;
	return 0;
}

static int in_pad(struct obj *o, struct piece *in, struct mp_error *err)
{
	enum obj_class class = class_of(in->p++);

	o->notes->nul_bytes += class == OBJ_PAD;
	if (class == OBJ_PAD || class == OBJ_BLANK || class == OBJ_NEWLINE)
		return 0;
	return mp_fail_line(err, MP_SYNTAX, o->pad_at, o->pad_line,
			    "a NUL or Ctrl-Z character in text");
}

/* The byte behind a backslash: with a line end, both are nothing; else it was a byte like others.
 */
static void after_backslash(struct obj *o, struct piece *in)
{
	o->backslash = false;
	if (class_of(in->p) == OBJ_NEWLINE) {
		o->cr = *in->p++ == '\r';
		o->line++;
		return;
	}
	if (o->mode == OBJ_AT_LINE || o->mode == OBJ_IN_BLANK)
		begin_word(o, offset(o, in) - 1);
	if (o->mode == OBJ_IN_WORD)
		keep_piece(o, "\\", 1);
	else if (o->mode == OBJ_IN_NAME)
		add_to_name(o, '\\');
}

int obj_text_push(struct obj *o, const char *begin, const char **p, const char *end,
		  struct mp_error *err)
{
	static int (*const take[])(struct obj *, struct piece *, struct mp_error *) = {
	    [OBJ_AT_LINE] = in_blank, [OBJ_IN_BLANK] = in_blank, [OBJ_IN_WORD] = in_word,
	    [OBJ_IN_NAME] = in_name,  [OBJ_IN_REST] = in_rest,   [OBJ_IN_COMMENT] = in_rest,
	    [OBJ_IN_PAD] = in_pad};
	struct piece in = {begin, *p, end};
	uint64_t line = o->line;

	do {
		bool lf = o->cr && *in.p == '\n';

		o->cr = false;
		if (lf)
			in.p++;
		else if (o->backslash)
			after_backslash(o, &in);
		else if (take[o->mode](o, &in, err))
			return -1;
	} while (in.p < end && (o->mode != OBJ_AT_LINE || o->line == line));
	*p = in.p;
	return 0;
}

int obj_text_finish(struct obj *o, struct mp_error *err)
{
	if (o->mode == OBJ_IN_WORD && o->word_len > 0 && obj_word(o, o->word, o->word_len, err))
		return -1;
	return obj_end_statement(o, err);
}
