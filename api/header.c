#include "api/header.h"

#include <string.h>
#include <strings.h>

static bool is_blank(char c)
{
	return c == ' ' || c == '\t';
}

int api_hex(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

size_t api_header_word(const char **value, const char *end)
{
	size_t len;

	*value += strspn(*value, " \t");
	len = strcspn(*value, end);
	while (len > 0 && is_blank((*value)[len - 1]))
		len--;
	return len;
}

static const char *skip_blanks(const char *at, const char *end)
{
	while (at < end && is_blank(*at))
		at++;
	return at;
}

/* A backslash that quotes the character behind it. */
static bool is_escape(const char *at, const char *end)
{
	return *at == '\\' && at + 1 < end && (at[1] == '"' || at[1] == '\\');
}

static int take_value(const char **at, const char *end, struct api_param *out)
{
	const char *p = *at;

	out->quoted = p < end && *p == '"';
	out->value = p + out->quoted;
	if (out->quoted) {
		for (p++; p < end && *p != '"'; p++)
			p += is_escape(p, end);
		if (p == end)
			return -1;
		out->value_len = (size_t)(p++ - out->value);
	} else {
		while (p < end && *p != ';' && *p != '"' && !is_blank(*p))
			p++;
		out->value_len = (size_t)(p - out->value);
		if (out->value_len == 0)
			return -1;
	}
	p = skip_blanks(p, end);
	*at = p;
	return p == end || *p == ';' ? 1 : -1;
}

int api_param_next(const char **at, const char *end, struct api_param *out)
{
	const char *p = skip_blanks(*at, end);

	while (p < end && *p == ';')
		p = skip_blanks(p + 1, end);
	*at = p;
	if (p == end)
		return 0;
	out->name = p;
	while (p < end && *p != '=' && *p != ';' && *p != '"' && !is_blank(*p))
		p++;
	out->name_len = (size_t)(p - out->name);
	p = skip_blanks(p, end);
	if (out->name_len == 0 || p == end || *p != '=')
		return -1;
	*at = skip_blanks(p + 1, end);
	return take_value(at, end, out);
}

bool api_param_is(const struct api_param *p, const char *name)
{
	return strlen(name) == p->name_len && strncasecmp(p->name, name, p->name_len) == 0;
}

size_t api_param_text(const struct api_param *p, char *out, size_t cap)
{
	const char *at = p->value, *end = at + p->value_len;
	size_t len = 0;

	for (; at < end; at++, len++) {
		if (p->quoted && is_escape(at, end))
			at++;
		if (len + 1 < cap)
			out[len] = *at;
	}
	if (cap > 0)
		out[len < cap ? len : cap - 1] = '\0';
	return len;
}
