#ifndef MP_OBJ_PRIVATE_H
#define MP_OBJ_PRIVATE_H

#include <stdbool.h>
#include <string.h>

#include "core/decoder.h"
#include "core/number/number_private.h"
#include "core/obj/polygon.h"

/*
 * The OBJ decoder.  Bytes become words, names and lines in obj_text.c, which knows continued lines;
 * obj_statement.c knows what they mean and obj_face.c makes triangles of it.  obj_line.c takes the
 * lines that make up nearly all of a file in one go, with the same result; what it refuses, the
 * others take word by word.
 */

enum obj_class { OBJ_WORD, OBJ_BLANK, OBJ_HASH, OBJ_PAD, OBJ_BACKSLASH, OBJ_NEWLINE };

/* What a byte is; OBJ_PAD (NUL, Ctrl-Z) may only fill up the end of the file. */
extern const uint8_t obj_class_of[256];

enum obj_mode {              /* what the next byte belongs to */
		OBJ_AT_LINE, /* blanks before a statement */
		OBJ_IN_BLANK,
		OBJ_IN_WORD,
		OBJ_IN_NAME,
		OBJ_IN_REST,    /* of a statement that is passed over */
		OBJ_IN_COMMENT, /* which no backslash continues: many end with a Windows path */
		OBJ_IN_PAD
};

enum obj_statement {
	OBJ_NONE, /* before or within its first word */
	OBJ_VERTEX,
	OBJ_FACE,
	OBJ_GROUP,
	OBJ_OBJECT,
	OBJ_MATERIAL,
	OBJ_POINT,
	OBJ_LINE,
	OBJ_PASSED_OVER,
	OBJ_CALL,
	OBJ_FREE_FORM,
	OBJ_UNKNOWN
};

enum { OBJ_WORD_MOST = 256 }; /* longer ones can only be numbers and corners, read as they come */

/* A corner of a face: v, v/, v/vt, v//, v//vn, v/vt/vn; only v matters. */
struct obj_corner {
	uint64_t value;
	unsigned field;
	bool negative; /* the first field */
	bool sign, digits;
	bool bad;
};

/* A face among corner[]: three words for its number of corners and its line, then its corners. */
enum { OBJ_FACE_HEAD = 3, OBJ_MOST_CORNERS = 1000000000 };

struct obj_name {
	size_t len;
	char text[MP_NAME_MAX];
};

struct obj {
	const struct mp_sink *sink;
	const struct mp_limits *limits;
	struct mp_notes *notes;
	uint64_t at; /* offset in the file of the chunk being pushed */
	size_t head_len;
	uint8_t head[3]; /* the first bytes, until it is known what text this is */
	bool begun;

	enum obj_mode mode;
	enum obj_statement statement;
	bool cr;        /* the last byte was a CR: a LF now ends the same line */
	bool backslash; /* the last byte was one: a line end now is none */
	uint64_t line;  /* 1-based */
	uint64_t statement_line, statement_at;
	uint64_t pad_line, pad_at;
	uint64_t known; /* statements that the format knows */

	uint64_t word_line, word_at;
	size_t word_len; /* what came in pieces: OBJ_WORD_MOST bytes are in ${word} */
	char word[OBJ_WORD_MOST];
	struct mp_decimal decimal; /* all of it, once it is longer */
	struct obj_corner word_corner;

	bool name_gap; /* nothing or a blank before the next byte of a name: # is a comment there */
	struct obj_name name;
	struct obj_name group, part, object, material; /* in force */

	unsigned numbers;    /* of the statement v */
	double xyz[3];       /* the first of them */
	double (*vertex)[3]; /* all vertices so far */
	size_t vertices, vertex_room, vertex_most;

	uint32_t *corner; /* the faces held back, then the one being read; from 0 */
	size_t corners, corner_room;
	unsigned lengths[3]; /* of the indices of the last corner, in digits */
	size_t face;         /* where the one being read begins */
	uint32_t face_most;  /* the highest vertex number in it, from 1 */
	size_t held;         /* words of corner[] that are faces held back for a vertex to come */
	uint32_t held_most;
	struct mp_polygon polygon;

	size_t count; /* triangles in ${block} */
	double block[MP_BLOCK][9];
	uint32_t index[MP_BLOCK][3];
};

/* obj_text.c: take [p, end), which begins at the offset o->at, up to the end of a line or all. */
int obj_text_push(struct obj *o, const char *begin, const char **p, const char *end,
		  struct mp_error *err);
int obj_text_finish(struct obj *o, struct mp_error *err);

/*
 * obj_line.c: take whole lines of the usual kinds from *p on, which is the beginning of a line;
 * *stop is a LF that may be read.  Leaves *p at the line that needs thought, or behind ${stop}.
 */
int obj_take_lines(struct obj *o, const char **p, const char *stop, struct mp_error *err);

/*
 * obj_statement.c: the next word, at word_at, word_line.  Of o->word only OBJ_WORD_MOST bytes are
 * there; o->decimal or o->word_corner has read it all.  Sets o->mode to what follows.
 */
int obj_word(struct obj *o, const char *word, size_t len, struct mp_error *err);
int obj_end_statement(struct obj *o, struct mp_error *err);
int obj_fail(const struct obj *o, struct mp_error *err, enum mp_code code, const char *what);

/* obj_face.c */
void obj_corner_begin(struct obj_corner *);
void obj_corner_feed(struct obj_corner *, const char *text, size_t len);
bool obj_corner_finish(struct obj_corner *); /* is it one? */

int obj_begin_face(struct obj *o, struct mp_error *err);
int obj_add_corner(struct obj *o, const struct obj_corner *corner, struct mp_error *err);
int obj_end_face(struct obj *o, struct mp_error *err);
int obj_add_vertex(struct obj *o, struct mp_error *err); /* o->xyz */

/* Triangles of a face whose vertices are all there; counts nothing but the polygon's oddities. */
int obj_split_face(struct obj *o, const uint32_t *corner, size_t n, struct mp_error *err);

int obj_finish_faces(struct obj *o, struct mp_error *err); /* those held back, the last block */

int obj_flush(struct obj *o, struct mp_error *err); /* the block to the sink */

static inline int obj_triangle(struct obj *o, uint32_t a, uint32_t b, uint32_t c,
			       struct mp_error *err)
{
	double *t = o->block[o->count];

	o->index[o->count][0] = a;
	o->index[o->count][1] = b;
	o->index[o->count][2] = c;
	memcpy(t, o->vertex[a], sizeof o->vertex[a]);
	memcpy(t + 3, o->vertex[b], sizeof o->vertex[b]);
	memcpy(t + 6, o->vertex[c], sizeof o->vertex[c]);
	return ++o->count == MP_BLOCK ? obj_flush(o, err) : 0;
}

#endif
