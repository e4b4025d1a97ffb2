#include <string.h>

#include "core/stl/stl_private.h"

const uint8_t stl_class_of[256] = {
    STL_PAD,     STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL,
    STL_CONTROL, STL_CONTROL, STL_BLANK,   STL_NEWLINE, STL_BLANK,   STL_BLANK,   STL_NEWLINE,
    STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL,
    STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_PAD,     STL_CONTROL,
    STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_CONTROL, STL_BLANK}; /* the rest: STL_WORD = 0 */

/* What else comes under the name of .stl; begins with ${bytes}, in any case if ${text}. */
static const struct {
	const char *bytes;
	uint8_t len;
	bool text;
	const char *what;
} signatures[] = {
    {"\x1f\x8b", 2, false, "a gzip file"},
    {"PK\x03\x04", 4, false, "a zip archive (or 3MF)"},
    {"PK\x05\x06", 4, false, "a zip archive (or 3MF)"},
    {"\x89PNG", 4, false, "a PNG picture"},
    {"\xff\xd8\xff", 3, false, "a JPEG picture"},
    {"GIF8", 4, false, "a GIF picture"},
    {"%PDF-", 5, false, "a PDF document"},
    {"7z\xbc\xaf\x27\x1c", 6, false, "a 7z archive"},
    {"Rar!\x1a\x07", 6, false, "a RAR archive"},
    {"\xfd\x37zXZ", 5, false, "an xz file"},
    {"\x28\xb5\x2f\xfd", 4, false, "a zstd file"},
    {"BZh", 3, false, "a bzip2 file"},
    {"\xff\xfe", 2, false, "text in UTF-16; save it as ASCII or UTF-8"},
    {"\xfe\xff", 2, false, "text in UTF-16; save it as ASCII or UTF-8"},
    {"s\0o\0l\0i\0d", 9, false, "text in UTF-16; save it as ASCII or UTF-8"},
    {"\0s\0o\0l\0i\0d", 10, false, "text in UTF-16; save it as ASCII or UTF-8"},
    {"glTF", 4, false, "a GLB file"},
    {"DRACO", 5, false, "a Draco file"},
    {"version https://git-lfs", 23, true, "a Git LFS pointer; send the file it stands for"},
    {"<!doctype html", 14, true, "an HTML page"},
    {"<html", 5, true, "an HTML page"},
    {"<?xml", 5, true, "an XML document"},
    {"iso-10303-21", 12, true, "a STEP file"},
    {"ply\n", 4, true, "a PLY file"},
    {"ply\r", 4, true, "a PLY file"},
    {"off\n", 4, true, "an OFF file"},
    {"off\r", 4, true, "an OFF file"},
};

static char lower(char c)
{
	return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c;
}

static bool begins_with(const char *text, size_t len, const char *word, size_t word_len)
{
	size_t i;

	for (i = 0; i < len && i < word_len && lower(text[i]) == word[i]; i++)
		;
	return i == word_len;
}

bool stl_is_word(const char *text, size_t len, const char *word)
{
	size_t word_len = strlen(word);

	return len == word_len && begins_with(text, len, word, word_len);
}

static const char *signature(const char *text, size_t len)
{
	size_t blank = len >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;

	while (blank < len && stl_class_of[(uint8_t)text[blank]] != STL_WORD)
		blank++;
	for (size_t i = 0; i < sizeof signatures / sizeof signatures[0]; i++) {
		size_t n = signatures[i].len, skip = signatures[i].text ? blank : 0;

		if (signatures[i].text
			? begins_with(text + skip, len - skip, signatures[i].bytes, n)
			: len >= n && memcmp(text, signatures[i].bytes, n) == 0)
			return signatures[i].what;
	}
	return NULL;
}

static size_t skip_line(const char *text, size_t len, size_t at)
{
	while (at < len && stl_class_of[(uint8_t)text[at]] != STL_NEWLINE)
		at++;
	return at;
}

static size_t skip_word(const char *text, size_t len, size_t at)
{
	while (at < len && stl_class_of[(uint8_t)text[at]] == STL_WORD)
		at++;
	return at;
}

static size_t skip_other(const char *text, size_t len, size_t at)
{
	while (at < len && stl_class_of[(uint8_t)text[at]] != STL_WORD)
		at++;
	return at;
}

/* Is one of the words in text[at..len) ${a} or ${b}? */
static bool has_word(const char *text, size_t len, size_t at, const char *a, const char *b)
{
	while ((at = skip_other(text, len, at)) < len) {
		size_t end = skip_word(text, len, at);

		if (stl_is_word(text + at, end - at, a) || stl_is_word(text + at, end - at, b))
			return true;
		at = end;
	}
	return false;
}

static bool has_control(const uint8_t *b, size_t len)
{
	for (size_t i = 0; i < len; i++) {
		if (stl_class_of[b[i]] >= STL_PAD)
			return true;
	}
	return false;
}

static bool looks_like_stl_text(const char *text, size_t len, bool whole)
{
	const uint8_t *bytes = (const uint8_t *)text;
	size_t at = len >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0, end;

	while (whole && len > 0 && stl_class_of[bytes[len - 1]] == STL_PAD)
		len--;
	if (len < STL_HEADER ? has_control(bytes, len) : has_control(bytes + 80, 4))
		return false;
	while ((at = skip_other(text, len, at)) < len && text[at] == '#')
		at = skip_line(text, len, at);
	end = skip_word(text, len, at);
	if (stl_is_word(text + at, end - at, "solid"))
		return has_word(text, len, skip_line(text, len, end), "facet", "endsolid");
	return stl_is_word(text + at, end - at, "facet") &&
	       has_word(text, len, end, "outer", "outer");
}

/* In the form of UTF-8, but for a sequence that the end cuts. */
static bool is_utf8(const uint8_t *b, size_t len)
{
	for (size_t i = 0, more = 0; i < len; i++) {
		if (more > 0) {
			if (b[i] >> 6 != 2)
				return false;
			more--;
		} else if (b[i] >= 0x80) {
			if (b[i] < 0xc2 || b[i] > 0xf4)
				return false;
			more = b[i] < 0xe0 ? 1 : b[i] < 0xf0 ? 2 : 3;
		}
	}
	return true;
}

static const uint8_t *find(const uint8_t *at, const uint8_t *end, char c)
{
	return at < end ? memchr(at, c, (size_t)(end - at)) : NULL;
}

/*
 * Traces of an editor or a transfer in text mode: bytes that were no UTF-8 became U+FFFD, or every
 * LF got a CR.  Neither comes about in a good file by chance (one LF in 256 has a CR before it).
 */
static const char *mangled(const uint8_t *b, size_t len, bool utf8)
{
	const uint8_t *end = b + (len < STL_HEADER + 2 ? STL_HEADER : len - 2), *at;
	size_t lf = 0;

	for (at = b + STL_HEADER; utf8 && at < end; at++)
		if (memcmp(at, "\xef\xbf\xbd", 3) == 0)
			return "a binary STL that was saved as text (bytes became U+FFFD)";
	for (at = b + STL_HEADER; (at = find(at, end, '\n')) != NULL; at++, lf++)
		if (at[-1] != '\r')
			return NULL;
	return lf >= 4 ? "a binary STL whose line ends were converted" : NULL;
}

static uint64_t declared_size(const uint8_t *b)
{
	uint64_t count =
	    b[80] | (uint64_t)b[81] << 8 | (uint64_t)b[82] << 16 | (uint64_t)b[83] << 24;

	return STL_HEADER + STL_FACET * count;
}

enum stl_kind stl_sniff(const uint8_t *bytes, size_t len, bool whole, const char **hint)
{
	const char *text = (const char *)bytes;
	bool utf8 = is_utf8(bytes, len);

	*hint = NULL;
	if (whole && len >= STL_HEADER && declared_size(bytes) == len)
		return STL_BINARY;
	if (looks_like_stl_text(text, len, whole))
		return STL_TEXT;
	*hint = signature(text, len);
	if (len < STL_HEADER)
		return *hint != NULL ? STL_OTHER : STL_SHORT;
	if (utf8 && !has_control(bytes, len))
		return *hint != NULL ? STL_OTHER : STL_TEXT;
	if (*hint == NULL)
		*hint = mangled(bytes, len, utf8);
	return STL_BINARY;
}
