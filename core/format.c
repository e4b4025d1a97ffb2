#include "core/format.h"

#include <string.h>

enum line { LINE_NOTHING, LINE_VERTEX, LINE_STL };

static bool is_blank(uint8_t c)
{
	return c == ' ' || c == '\t';
}

static bool is_end(uint8_t c)
{
	return c == '\n' || c == '\r';
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

static enum line judge_line(const uint8_t *text, size_t len)
{
	size_t i = 0;

	while (i < len && is_blank(text[i]))
		i++;
	text += i;
	len -= i;
	if (begins(text, len, "solid") || begins(text, len, "facet"))
		return LINE_STL;
	if (len < 3 || text[0] != 'v' || !is_blank(text[1]))
		return LINE_NOTHING;
	for (i = 1; i < len && is_blank(text[i]); i++)
		;
	return i < len && begins_number(text[i]) ? LINE_VERTEX : LINE_NOTHING;
}

static bool is_obj(const uint8_t *head, size_t len)
{
	size_t at = len >= 3 && memcmp(head, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;

	while (at < len) {
		size_t end = at;
		enum line line;

		while (end < len && !is_end(head[end]))
			end++;
		line = judge_line(head + at, end - at);
		if (line != LINE_NOTHING)
			return line == LINE_VERTEX;
		at = end + 1;
	}
	return false;
}

enum mp_format_wish mp_format_sniff(const uint8_t *head, size_t len)
{
	if (is_draco(head, len))
		return MP_WISH_DRACO;
	while (len > 0 && head[len - 1] == '\0') /* ZBrush ends its files so */
		len--;
	/* a byte 0 is no text; in front of it may stand the header of a binary STL, any words */
	if (memchr(head, '\0', len) == NULL && is_obj(head, len))
		return MP_WISH_OBJ;
	return MP_WISH_STL;
}

const struct mp_decoder_ops *mp_format_decoder(enum mp_format_wish format, bool asked,
					       struct mp_error *err)
{
	const char *seems = asked ? "" : "this seems to be ";

	if (format == MP_WISH_OBJ)
		(void)mp_fail(err, MP_UNSUPPORTED, MP_NO_BYTE, "%s%s", seems,
			      asked ? "OBJ files are not read yet"
				    : "an OBJ file, and OBJ files are not read yet");
	else if (format == MP_WISH_DRACO)
		return &mp_draco_decoder;
	else
		return &mp_stl_decoder;
	return NULL;
}
