#include <math.h>
#include <string.h>

#include "core/number/number.h"
#include "core/obj/obj_private.h"

static const struct {
	const char *word;
	enum obj_statement statement;
} statements[] = {
    {"v", OBJ_VERTEX},
    {"f", OBJ_FACE},
    {"fo", OBJ_FACE}, /* so until version 2.11 */
    {"usemtl", OBJ_MATERIAL},
    {"g", OBJ_GROUP},
    {"o", OBJ_OBJECT},
    {"s", OBJ_PASSED_OVER},
    {"vt", OBJ_PASSED_OVER},
    {"vn", OBJ_PASSED_OVER},
    {"p", OBJ_POINT},
    {"l", OBJ_LINE},
    {"mtllib", OBJ_PASSED_OVER},
    {"vp", OBJ_PASSED_OVER},
    {"mg", OBJ_PASSED_OVER},
    {"bevel", OBJ_PASSED_OVER},
    {"lod", OBJ_PASSED_OVER},
    {"maplib", OBJ_PASSED_OVER},
    {"usemap", OBJ_PASSED_OVER},
    {"c_interp", OBJ_PASSED_OVER},
    {"ctech", OBJ_PASSED_OVER},
    {"d_interp", OBJ_PASSED_OVER},
    {"stech", OBJ_PASSED_OVER},
    {"shadow_obj", OBJ_PASSED_OVER},
    {"call", OBJ_CALL},
    {"trace_obj", OBJ_PASSED_OVER},
    {"csh", OBJ_CALL},
    {"cstype", OBJ_FREE_FORM},
    {"deg", OBJ_FREE_FORM},
    {"bmat", OBJ_FREE_FORM},
    {"step", OBJ_FREE_FORM},
    {"curv", OBJ_FREE_FORM},
    {"curv2", OBJ_FREE_FORM},
    {"surf", OBJ_FREE_FORM},
    {"parm", OBJ_FREE_FORM},
    {"trim", OBJ_FREE_FORM},
    {"hole", OBJ_FREE_FORM},
    {"scrv", OBJ_FREE_FORM},
    {"sp", OBJ_FREE_FORM},
    {"end", OBJ_FREE_FORM},
    {"con", OBJ_FREE_FORM},
    {"bsp", OBJ_FREE_FORM},
    {"bzp", OBJ_FREE_FORM},
    {"cdc", OBJ_FREE_FORM},
    {"cdp", OBJ_FREE_FORM},
    {"res", OBJ_FREE_FORM},
};

int obj_fail(const struct obj *o, struct mp_error *err, enum mp_code code, const char *what)
{
	return mp_fail_line(err, code, o->word_at, o->word_line, "%s", what);
}

static bool is_control(char c)
{
	return (unsigned char)c < ' ' || c == 0x7f;
}

/* The first word of a line.  Only words without control characters are passed over. */
static int unknown(struct obj *o, const char *word, size_t len, struct mp_error *err)
{
	if (len > OBJ_WORD_MOST) /* as many as are kept of one that came in pieces */
		len = OBJ_WORD_MOST;
	for (size_t i = 0; i < len; i++)
		if (is_control(word[i]))
			return mp_fail_line(err, MP_SYNTAX, o->word_at, o->word_line,
					    "the control character 0x%02x in text",
					    (unsigned)word[i]);
	o->notes->nonstandard_lines++;
	o->statement = OBJ_UNKNOWN;
	o->mode = OBJ_IN_REST;
	return 0;
}

static int begin_statement(struct obj *o, const char *word, struct mp_error *err)
{
	switch (o->statement) {
	case OBJ_VERTEX:
		o->numbers = 0;
		o->mode = OBJ_IN_BLANK;
		return 0;
	case OBJ_FACE:
		o->mode = OBJ_IN_BLANK;
		return obj_begin_face(o, err);
	case OBJ_GROUP:
	case OBJ_OBJECT:
	case OBJ_MATERIAL:
		o->name.len = 0;
		o->name_gap = true;
		o->mode = OBJ_IN_NAME;
		return 0;
	case OBJ_CALL:
		return mp_fail_line(err, MP_UNSUPPORTED, o->word_at, o->word_line,
				    "the statement %s, which has other files read or commands run",
				    word);
	case OBJ_FREE_FORM:
		return mp_fail_line(err, MP_UNSUPPORTED, o->word_at, o->word_line,
				    "the free-form statement %s; only polygons are read", word);
	default:
		o->notes->points += o->statement == OBJ_POINT;
		o->notes->lines += o->statement == OBJ_LINE;
		o->mode = OBJ_IN_REST;
		return 0;
	}
}

static int take_keyword(struct obj *o, const char *word, size_t len, struct mp_error *err)
{
	for (size_t i = 0; i < sizeof statements / sizeof statements[0]; i++) {
		const char *known = statements[i].word;

		if (len > 10 || strlen(known) != len || memcmp(known, word, len) != 0)
			continue;
		o->known++;
		o->statement = statements[i].statement;
		return begin_statement(o, known, err);
	}
	return unknown(o, word, len, err);
}

/*
 * x y z; x y z w: the weight is for free-form surfaces; x y z r g b; x y z r g b a.  Colours may be
 * NaN.
 */
static int take_number(struct obj *o, const char *word, size_t len, struct mp_error *err)
{
	double value;
	int ret;

	if (word == o->word && len > OBJ_WORD_MOST)
		ret = mp_decimal_finish(&o->decimal, &value);
	else
		ret = mp_number_parse(word, len, &value);
	if (ret != 0)
		return obj_fail(o, err, MP_SYNTAX, "a vertex with a word that is no number");
	if (o->numbers < 3) {
		if (!isfinite(value))
			return mp_fail_line(err, MP_NON_FINITE, o->word_at, o->word_line,
					    "%c of vertex %llu is not finite", "xyz"[o->numbers],
					    (unsigned long long)o -> vertices + 1);
		o->xyz[o->numbers] = value;
	}
	if (++o->numbers > 7)
		return obj_fail(o, err, MP_SYNTAX, "a vertex with more than 7 numbers");
	return 0;
}

int obj_word(struct obj *o, const char *word, size_t len, struct mp_error *err)
{
	o->word_len = 0;
	o->mode = OBJ_IN_BLANK;
	if (o->statement == OBJ_NONE)
		return take_keyword(o, word, len, err);
	if (o->statement == OBJ_VERTEX)
		return take_number(o, word, len, err);
	if (word != o->word)
		obj_corner_feed(&o->word_corner, word, len);
	if (!obj_corner_finish(&o->word_corner))
		return obj_fail(o, err, MP_SYNTAX,
				"a face with a corner that is not v, v/vt, v//vn or v/vt/vn");
	return obj_add_corner(o, &o->word_corner, err);
}

static int end_vertex(struct obj *o, struct mp_error *err)
{
	if (o->numbers < 3 || o->numbers == 5)
		return mp_fail_line(err, MP_SYNTAX, o->statement_at, o->statement_line,
				    "a vertex with %u numbers; it takes 3, 4, 6 or 7", o->numbers);
	return obj_add_vertex(o, err);
}

typedef int tell(void *self, uint64_t first, const char *name, size_t len, struct mp_error *err);

/* Tell the sink of a name that is now in force and was not before. */
static int set_name(struct obj *o, struct obj_name *name, const struct obj_name *new, tell *sink,
		    struct mp_error *err)
{
	if (name->len == new->len && memcmp(name->text, new->text, new->len) == 0)
		return 0;
	memcpy(name->text, new->text, new->len);
	name->len = new->len;
	return sink == NULL ? 0
			    : sink(o->sink->self, o->notes->triangles, name->text, name->len, err);
}

/* Without a name, or under the name default, there is no group; a new object ends the group. */
static int end_name(struct obj *o, struct mp_error *err)
{
	struct obj_name *n = &o->name;

	while (n->len > 0 && obj_class_of[(uint8_t)n->text[n->len - 1]] == OBJ_BLANK)
		n->len--;
	if (o->statement == OBJ_MATERIAL)
		return set_name(o, &o->material, n, o->sink->material, err);
	o->group.len = 0;
	if (o->statement == OBJ_OBJECT && set_name(o, &o->object, n, o->sink->object, err))
		return -1;
	if (o->statement == OBJ_GROUP && !(n->len == 7 && memcmp(n->text, "default", 7) == 0))
		(void)set_name(o, &o->group, n, NULL, err);
	return set_name(o, &o->part, o->group.len > 0 ? &o->group : &o->object, o->sink->part, err);
}

int obj_end_statement(struct obj *o, struct mp_error *err)
{
	int ret = 0;

	switch (o->statement) {
	case OBJ_VERTEX:
		ret = end_vertex(o, err);
		break;
	case OBJ_FACE:
		ret = obj_end_face(o, err);
		break;
	case OBJ_GROUP:
	case OBJ_OBJECT:
	case OBJ_MATERIAL:
		ret = end_name(o, err);
		break;
	default:
		break;
	}
	o->statement = OBJ_NONE;
	o->mode = OBJ_AT_LINE;
	return ret;
}
