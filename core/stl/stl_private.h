#ifndef MP_STL_PRIVATE_H
#define MP_STL_PRIVATE_H

#include <math.h>
#include <stdbool.h>

#include "core/decoder.h"
#include "core/number/number_private.h"
#include "core/stl/stl_kernel.h"

/*
 * Which of the two formats a file is, is decided once, from its first STL_WINDOW bytes or from
 * all of it where it is shorter, never from how the bytes came.  The first rule that fits:
 * 1. the whole file is here and is 84 + 50 * count bytes long: binary, whatever it says;
 * 2. it begins (behind a byte-order mark, blanks and # lines) with the word solid, a later line
 *    with facet or endsolid in it; or with the word facet, and outer behind it: text, unless the
 *    count, or the part of a header that is all there is, holds a control character (any count
 *    below 151 million does; NULs that fill up the end are no matter);
 * 3. shorter than 84 bytes: what another kind of file begins with is refused, the rest is the
 *    beginning of a binary STL: truncated;
 * 4. only UTF-8 text: refused where another kind of file begins so, else text (the text decoder
 *    then finds the line that is wrong);
 * 5. binary; a suspicion (a zip, a binary STL that an editor has mangled) is kept as a hint and
 *    spoken out only if the facets are then not all there or not all there is.
 */
enum { STL_HEADER = 84, STL_FACET = 50, STL_WINDOW = 4096 };

enum stl_kind { STL_UNDECIDED, STL_BINARY, STL_TEXT, STL_OTHER, STL_SHORT };

/* ${*hint}: what the file seems to be if not an STL, NULL for no idea; a constant string. */
enum stl_kind stl_sniff(const uint8_t *bytes, size_t len, bool whole, const char **hint);

enum stl_class { STL_WORD, STL_BLANK, STL_NEWLINE, STL_PAD, STL_CONTROL };

/* What a byte is in a text STL; STL_PAD (NUL, Ctrl-Z) may only fill up the end of the file. */
extern const uint8_t stl_class_of[256];

/* Is the text of ${len} bytes the lower-case ${word}, in any case? */
bool stl_is_word(const char *text, size_t len, const char *word);

struct stl_binary {
	uint32_t declared; /* facets by the header */
	uint64_t done;     /* facets read */
	const char *hint;
	size_t have; /* bytes of the next facet in ${facet} */
	uint8_t facet[STL_FACET];
};

enum stl_text_mode { /* what the next byte belongs to */
		     STL_IN_BLANK,
		     STL_IN_WORD, /* one that began in an earlier chunk */
		     STL_IN_NAME,
		     STL_IN_REST, /* of a line that is passed over */
		     STL_IN_PAD
};

enum stl_expect {
	STL_WANT_FACET, /* or solid, endsolid: outside of a facet */
	STL_WANT_OUTER, /* or the normal and its numbers */
	STL_WANT_LOOP,
	STL_WANT_VERTEX, /* or endloop */
	STL_WANT_NUMBER,
	STL_WANT_ENDFACET
};

enum { STL_WORD_MOST = 256 }; /* longer ones can only be numbers, which go to ${decimal} */

enum { STL_LINES = 7 }; /* of a facet, most often */

struct stl_text {
	enum stl_text_mode mode;
	enum stl_expect expect;
	bool cr;         /* the last byte was a CR: a LF now ends the same line */
	bool in_solid;   /* solid was read, endsolid not yet */
	uint64_t solids; /* begun */
	uint64_t line;   /* 1-based */

	uint64_t facet_line;   /* of the word facet */
	uint64_t tail_line;    /* of endloop or endfacet: words behind it are passed over */
	uint64_t counted_line; /* the last one in notes->nonstandard_lines */
	uint64_t pad_line, pad_at;

	unsigned indent[STL_LINES]; /* of the lines of the last facet */
	double normal[3];
	unsigned normals; /* numbers of it that came */
	bool normal_word, normal_bad;
	unsigned corners, numbers; /* of the triangle, of the corner */

	uint64_t word_line, word_at;
	size_t word_len; /* the first STL_WORD_MOST bytes are in ${word}, more in ${decimal} */
	char word[STL_WORD_MOST];
	struct mp_decimal decimal;

	size_t name_len;
	char name[MP_NAME_MAX];
};

struct stl {
	const struct mp_sink *sink;
	const struct mp_limits *limits;
	struct mp_notes *notes;
	enum stl_kind kind;
	uint64_t at;  /* offset in the file of the chunk being pushed */
	size_t count; /* triangles in ${block} */
	double block[MP_BLOCK][9];
	struct stl_columns columns; /* instead of ${block}, for a sink of floats */
	size_t kernel;
	size_t window_len;
	uint8_t window[STL_WINDOW];
	struct stl_binary binary;
	struct stl_text text;
};

int stl_flush(struct stl *s, struct mp_error *err); /* the block to the sink */

/* The triangle in s->block[s->count] is complete. */
static inline int stl_commit(struct stl *s, struct mp_error *err)
{
	s->notes->triangles++;
	return ++s->count == MP_BLOCK ? stl_flush(s, err) : 0;
}

/* Compare a stored normal with the winding a b c of the triangle. */
static inline void stl_check_normal(struct mp_notes *notes, const double t[9], const double n[3])
{
	double ux = t[3] - t[0], uy = t[4] - t[1], uz = t[5] - t[2];
	double vx = t[6] - t[0], vy = t[7] - t[1], vz = t[8] - t[2];
	double dot =
	    n[0] * (uy * vz - uz * vy) + n[1] * (uz * vx - ux * vz) + n[2] * (ux * vy - uy * vx);
	bool finite = (n[0] - n[0]) + (n[1] - n[1]) + (n[2] - n[2]) == 0; /* else NaN */

	notes->normals_not_finite += !finite;
	notes->normals_disagreeing += finite & (dot < 0.0);
}

void stl_binary_begin(struct stl *s, const uint8_t header[STL_HEADER], const char *hint);
int stl_binary_push(struct stl *s, const uint8_t *chunk, size_t len, struct mp_error *err);
int stl_binary_finish(struct stl *s, struct mp_error *err);

void stl_text_begin(struct stl *s);
int stl_text_push(struct stl *s, const char *chunk, size_t len, struct mp_error *err);
int stl_text_finish(struct stl *s, struct mp_error *err);

/* The two halves of the text decoder: words are cut in stl_ascii.c, weighed in ..._grammar.c. */
enum stl_keyword {
	STL_KW_NONE,
	STL_KW_SOLID,
	STL_KW_FACET,
	STL_KW_NORMAL,
	STL_KW_OUTER,
	STL_KW_LOOP,
	STL_KW_VERTEX,
	STL_KW_ENDLOOP,
	STL_KW_ENDFACET,
	STL_KW_ENDSOLID
};

enum stl_keyword stl_keyword_of(const char *word, size_t len); /* in any case of letters */

/*
 * The next word; where it stands is in word_at, word_line.  Of t->word only STL_WORD_MOST bytes are
 * there, t->decimal has read it all.  Sets t->mode to what follows.
 */
int stl_text_word(struct stl *s, const char *word, size_t len, struct mp_error *err);

int stl_text_end_name(struct stl *s, struct mp_error *err); /* the name of a solid is complete */

void stl_text_nonstandard(struct stl *s, uint64_t line); /* count the line, once */

/*
 * stl_text_facet(p, end, tri, normal, line):
 * Read a facet of the usual form whole, blanks before it included, from [p, end); *end is a blank
 * that may be read.  Returns where the facet ends, ${*line} advanced, or NULL, where the facet is
 * cut or odd in any way: the words are then to be taken one at a time.
 */
const char *stl_text_facet(const char *p, const char *end, double tri[9], double normal[3],
			   uint64_t *line);

/*
 * The same for facets whose every number is as of %e and every line one of seven, in vectors: where
 * the processor can do it, the first one is so, and there is much room behind it; else NULL.  The
 * facet begins with the end of a line.  ${indent}: how many spaces began the lines the last time.
 */
bool stl_has_vector(void);
const char *stl_text_facet_vector(const char *p, const char *end, double tri[9], double normal[3],
				  unsigned indent[STL_LINES]);

#endif
