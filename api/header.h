#ifndef API_HEADER_H
#define API_HEADER_H

#include <stdbool.h>
#include <stddef.h>

/* Pieces of header values (RFC 9110, 5.6). */

/* The value of a hexadecimal digit, for %-escapes; -1 for anything else. */
int api_hex(char c);

/*
 * The first word of a header value: moves ${*value} behind leading blanks and returns the length
 * up to one of the characters of ${end}, without the blanks before it.
 */
size_t api_header_word(const char **value, const char *end);

/* ; name=value or ; name="value" */
struct api_param {
	const char *name, *value; /* into the header, ${value} without its quotes */
	size_t name_len, value_len;
	bool quoted;
};

/*
 * Take the next parameter from ${*at}, which stands behind a word or parameter, up to ${end}.
 * 1: it is there; 0: no more; -1: malformed.  Empty ones (;;) are passed over.
 */
int api_param_next(const char **at, const char *end, struct api_param *out);

bool api_param_is(const struct api_param *, const char *name); /* in any case of letters */

/*
 * The value, NUL behind it, cut to ${cap} - 1 bytes.  In quotes a backslash quotes a backslash and
 * a quote alone: old browsers send C:\part.stl as it is.  Returns the length before the cut.
 */
size_t api_param_text(const struct api_param *, char *out, size_t cap);

#endif
