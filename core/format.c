#include "core/format.h"

#include <string.h>

enum line { LINE_NOTHING, LINE_EMPTY, LINE_COMMENT, LINE_OBJ, LINE_STL };

static bool is_blank(uint8_t c)
{
	return c == ' ' || c == '\t';
}

static bool is_end(uint8_t c)
{
	return c == '\n' || c == '\r';
}

/* ZBrush ends its files with NUL and LF, DOS with Ctrl-Z. */
static bool is_padding(uint8_t c)
{
	return c == '\0' || c == 0x1a || is_blank(c) || is_end(c);
}

static bool begins_number(uint8_t c)
{
	return (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
}

static bool begins(const uint8_t *text, size_t len, const char *word)
{
	size_t n = strlen(word), i = 0;

	while (i < n && i < len && (text[i] | 0x20) == (uint8_t)word[i])
		i++;
	return i == n;
}

/* Version 0 to 2, mesh or point cloud, one of two methods: text goes on differently. */
static bool is_draco(const uint8_t *head, size_t len)
{
	return len >= 9 && memcmp(head, "DRACO", 5) == 0 && head[5] <= 2 && head[7] <= 1 &&
	       head[8] <= 1;
}

/* What OBJ files begin with: the word, and whether a number follows. */
static const struct {
	const char *word;
	bool number;
} obj_words[] = {
    {"v", true},   {"f", true},           {"vn", true},         {"vt", true},      {"vp", true},
    {"o", false},  {"g", false},          {"mtllib", false},    {"usemtl", false}, {"s", false},
    {"p", true},   {"l", true},           {"cstype", false},    {"fo", true},      {"call", false},
    {"lod", true}, {"shadow_obj", false}, {"trace_obj", false},
};

static bool is_obj_line(const uint8_t *text, size_t len)
{
	size_t word = 0, at;

	while (word < len && !is_blank(text[word]))
		word++;
	for (at = word; at < len && is_blank(text[at]); at++)
		;
	if (at == len)
		return false;
	for (size_t i = 0; i < sizeof obj_words / sizeof obj_words[0]; i++)
		if (strlen(obj_words[i].word) == word && memcmp(text, obj_words[i].word, word) == 0)
			return !obj_words[i].number || begins_number(text[at]);
	return false;
}

static enum line judge_line(const uint8_t *text, size_t len)
{
	size_t i = 0;

	while (i < len && is_blank(text[i]))
		i++;
	text += i;
	len -= i;
	if (len == 0)
		return LINE_EMPTY;
	if (text[0] == '#')
		return LINE_COMMENT;
	if (begins(text, len, "solid") || begins(text, len, "facet"))
		return LINE_STL;
	return is_obj_line(text, len) ? LINE_OBJ : LINE_NOTHING;
}

/* The first line that says something decides; if there are only comments, they are OBJ's. */
static bool is_obj(const uint8_t *head, size_t len)
{
	size_t at = len >= 3 && memcmp(head, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	bool comment = false, other = false;

	while (at < len) {
		size_t end = at;
		enum line line;

		while (end < len && !is_end(head[end]))
			end++;
		line = judge_line(head + at, end - at);
		if (line >= LINE_OBJ)
			return line == LINE_OBJ;
		comment = comment || line == LINE_COMMENT;
		other = other || line == LINE_NOTHING;
		at = end + 1;
	}
	return comment && !other;
}

enum mp_format_wish mp_format_sniff(const uint8_t *head, size_t len)
{
	if (is_draco(head, len))
		return MP_WISH_DRACO;
	while (len > 0 && is_padding(head[len - 1]))
		len--;
	/* a byte 0 is no text; in front of it may stand the header of a binary STL, any words */
	if (memchr(head, '\0', len) == NULL && is_obj(head, len))
		return MP_WISH_OBJ;
	return MP_WISH_STL;
}

const struct mp_decoder_ops *mp_format_decoder(enum mp_format_wish format)
{
	switch (format) {
	case MP_WISH_OBJ:
		return &mp_obj_decoder;
	case MP_WISH_DRACO:
		return &mp_draco_decoder;
	default:
		return &mp_stl_decoder;
	}
}
