#include <string.h>

#include "core/number/number.h"
#include "core/stl/stl_private.h"

/*
 * Words and rules:
 *   file   = { solid }
 *   solid  = "solid" NAME-TO-END-OF-LINE { facet } "endsolid" REST-OF-LINE
 *   facet  = "facet" [ "normal" { number } ] "outer" "loop" 3 * vertex "endloop" "endfacet"
 *   vertex = "vertex" number number number
 * Words may stand on any line.  Tolerated, since real files have it: a missing endsolid, facets
 * without solid, words behind the normal, endloop and endfacet on the same line, # comments.
 */

enum stl_keyword stl_keyword_of(const char *word, size_t len)
{
	static const char *const spelling[] = {"solid",  "facet",   "normal",   "outer",   "loop",
					       "vertex", "endloop", "endfacet", "endsolid"};

	for (size_t i = 0; i < sizeof spelling / sizeof spelling[0]; i++) {
		if (stl_is_word(word, len, spelling[i]))
			return (enum stl_keyword)(i + 1);
	}
	return STL_KW_NONE;
}

static int fail_word(const struct stl *s, struct mp_error *err, const char *what)
{
	return mp_fail_line(err, MP_SYNTAX, s->text.word_at, s->text.word_line, "%s", what);
}

void stl_text_nonstandard(struct stl *s, uint64_t line)
{
	if (s->text.counted_line != line)
		s->notes->nonstandard_lines++;
	s->text.counted_line = line;
}

int stl_text_end_name(struct stl *s, struct mp_error *err)
{
	struct stl_text *t = &s->text;

	while (t->name_len > 0 && stl_class_of[(uint8_t)t->name[t->name_len - 1]] != STL_WORD)
		t->name_len--;
	t->solids++;
	if (s->sink->part == NULL)
		return 0;
	return s->sink->part(s->sink->self, s->notes->triangles, t->name, t->name_len, err);
}

static int begin_facet(struct stl *s, struct mp_error *err)
{
	struct stl_text *t = &s->text;

	t->expect = STL_WANT_OUTER;
	t->facet_line = t->word_line;
	t->normal_word = t->normal_bad = false;
	t->normals = 0;
	if (t->in_solid)
		return 0;
	stl_text_nonstandard(s, t->word_line);
	t->in_solid = true;
	t->name_len = 0;
	return stl_text_end_name(s, err);
}

static int end_facet(struct stl *s, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	uint64_t most = s->limits->max_triangles;

	if (s->notes->triangles >= most)
		return mp_fail_limit(err, t->word_at, most, most + 1, "more than %llu facets",
				     (unsigned long long)most);
	if (t->normals == 3 && !t->normal_bad)
		stl_check_normal(s->notes, s->block[s->count], t->normal);
	t->expect = STL_WANT_FACET;
	t->tail_line = t->word_line;
	return stl_commit(s, err);
}

/* Words that mean nothing: passed over on the line of ${line}, refused on any other. */
static int pass_over(struct stl *s, uint64_t line, const char *what, struct mp_error *err)
{
	if (s->text.word_line != line)
		return fail_word(s, err, what);
	stl_text_nonstandard(s, line);
	return 0;
}

static int want_facet(struct stl *s, enum stl_keyword kw, struct mp_error *err)
{
	static const char *const what = "a word that is neither facet, endsolid nor solid";
	struct stl_text *t = &s->text;

	switch (kw) {
	case STL_KW_FACET:
		return begin_facet(s, err);
	case STL_KW_SOLID:
		s->notes->missing_endsolid += t->in_solid;
		t->in_solid = true;
		t->mode = STL_IN_NAME;
		t->name_len = 0;
		return 0;
	case STL_KW_ENDSOLID:
		if (!t->in_solid)
			return fail_word(s, err, "endsolid without solid");
		t->in_solid = false;
		t->mode = STL_IN_REST;
		return 0;
	case STL_KW_NONE:
		return pass_over(s, t->tail_line, what, err);
	default:
		return fail_word(s, err, what);
	}
}

/*
 * mp_number_parse() for the word, which was fed to ${decimal} where it is longer than the buffer.
 * The two agree: what is not finite by name is never that long.
 */
static int word_number(const struct stl *s, const char *word, size_t len, double *value)
{
	if (word == s->text.word && len > STL_WORD_MOST)
		return mp_decimal_finish(&s->text.decimal, value);
	return mp_number_parse(word, len, value);
}

/* Behind the word facet: normals are not needed, so bad ones are no error. */
static int want_outer(struct stl *s, enum stl_keyword kw, const char *word, size_t len,
		      struct mp_error *err)
{
	static const char *const what = "a word that is neither the normal nor outer loop";
	struct stl_text *t = &s->text;
	double v;

	if (kw == STL_KW_OUTER) {
		t->expect = STL_WANT_LOOP;
		return 0;
	}
	if (kw == STL_KW_NORMAL && !t->normal_word) {
		t->normal_word = true;
		return 0;
	}
	if (kw != STL_KW_NONE)
		return fail_word(s, err, what);
	if (word_number(s, word, len, &v) != 0) {
		t->normal_bad = true;
	} else if (t->normal_word && t->normals < 3) {
		t->normal[t->normals++] = v;
		return 0;
	}
	return pass_over(s, t->facet_line, what, err);
}

static int want_vertex(struct stl *s, enum stl_keyword kw, struct mp_error *err)
{
	struct stl_text *t = &s->text;

	if (kw == STL_KW_VERTEX && t->corners < 3) {
		t->expect = STL_WANT_NUMBER;
		t->numbers = 0;
		return 0;
	}
	if (kw == STL_KW_VERTEX)
		return fail_word(s, err, "a facet with more than 3 vertices");
	if (kw != STL_KW_ENDLOOP)
		return fail_word(s, err, "a word that is neither vertex nor endloop");
	if (t->corners < 3)
		return fail_word(s, err, "a facet with fewer than 3 vertices");
	t->expect = STL_WANT_ENDFACET;
	t->tail_line = t->word_line;
	return 0;
}

static int want_number(struct stl *s, const char *word, size_t len, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	double v;

	if (word_number(s, word, len, &v) != 0)
		return fail_word(s, err, "a vertex needs three numbers, and this word is none");
	if (!isfinite(v))
		return mp_fail_line(err, MP_NON_FINITE, t->word_at, t->word_line,
				    "%c of vertex %u is not finite", "xyz"[t->numbers],
				    t -> corners + 1);
	s->block[s->count][3 * t->corners + t->numbers] = v;
	if (++t->numbers == 3) {
		t->corners++;
		t->expect = STL_WANT_VERTEX;
	}
	return 0;
}

/* A complete word; of one that came in pieces only the beginning may be there: see word_number. */
int stl_text_word(struct stl *s, const char *word, size_t len, struct mp_error *err)
{
	struct stl_text *t = &s->text;
	enum stl_keyword kw;

	t->mode = STL_IN_BLANK;
	if (t->expect == STL_WANT_NUMBER)
		return want_number(s, word, len, err);
	kw = stl_keyword_of(word, len);
	switch (t->expect) {
	case STL_WANT_FACET:
		return want_facet(s, kw, err);
	case STL_WANT_OUTER:
		return want_outer(s, kw, word, len, err);
	case STL_WANT_LOOP:
		t->expect = STL_WANT_VERTEX;
		t->corners = 0;
		return kw == STL_KW_LOOP ? 0 : fail_word(s, err, "outer without loop");
	case STL_WANT_VERTEX:
		return want_vertex(s, kw, err);
	default:
		if (kw == STL_KW_ENDFACET)
			return end_facet(s, err);
		if (kw == STL_KW_NONE)
			return pass_over(s, t->tail_line, "a word that is not endfacet", err);
		return fail_word(s, err, "a word that is not endfacet");
	}
}
