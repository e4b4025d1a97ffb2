#include <string.h>

#include "api/header.h"
#include "api/options.h"

/* The raw query of a URL, application/x-www-form-urlencoded (WHATWG URL, section 5.1). */

enum { MOST_NAME = 512, MOST_VALUE = 4096 };

/* Decoded length, or -1: an escape is malformed, or the text does not fit ${cap}. */
static int decode(const char *in, size_t len, char *out, size_t cap)
{
	size_t n = 0;

	for (size_t i = 0; i < len; i++, n++) {
		if (n == cap)
			return -1;
		if (in[i] != '%') {
			out[n] = (char)(in[i] == '+' ? ' ' : in[i]);
			continue;
		}
		if (len - i < 3 || api_hex(in[i + 1]) < 0 || api_hex(in[i + 2]) < 0)
			return -1;
		out[n] = (char)(api_hex(in[i + 1]) * 16 + api_hex(in[i + 2]));
		i += 2;
	}
	return (int)n;
}

/* name=value; no '=' is an empty value */
static int take(struct api_options *o, const char *part, size_t len, struct api_problem *p)
{
	const char *equals = memchr(part, '=', len);
	size_t raw = equals != NULL ? (size_t)(equals - part) : len;
	char name[MOST_NAME], value[MOST_VALUE];
	int name_len = decode(part, raw, name, sizeof name), value_len = 0;

	if (name_len < 0)
		return api_problem_set(p, API_BAD_REQUEST,
				       "An option's name has a malformed %%-escape or is longer "
				       "than %d bytes.",
				       MOST_NAME);
	if (equals != NULL)
		value_len = decode(equals + 1, len - raw - 1, value, sizeof value);
	if (value_len < 0)
		return api_problem_option(p, API_BAD_OPTION, name, (size_t)name_len,
					  "The option's value has a malformed %%-escape or is "
					  "longer than %d bytes.",
					  MOST_VALUE);
	return api_options_set(o, name, (size_t)name_len, value, (size_t)value_len, p);
}

int api_options_query(struct api_options *o, const char *query, size_t len, struct api_problem *p)
{
	while (query != NULL && len > 0) {
		const char *amp = memchr(query, '&', len);
		size_t part = amp != NULL ? (size_t)(amp - query) : len;

		if (part > 0 && take(o, query, part, p))
			return -1;
		query += amp != NULL ? part + 1 : part;
		len -= amp != NULL ? part + 1 : part;
	}
	return 0;
}
