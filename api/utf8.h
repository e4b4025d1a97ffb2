#ifndef API_UTF8_H
#define API_UTF8_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Bytes of an uploader as text that may be shown: what is no UTF-8 (RFC 3629) and what is a control
 * character becomes U+FFFD, once for every maximal bad sequence.
 */

/* True where nothing of ${text} would have to be replaced. */
bool api_utf8_clean(const char *text, size_t len);

/*
 * Write the cleaned ${text} to ${out} of ${cap} > 0 bytes, cut between characters where it does not
 * fit (3 * len + 1 always do), NUL behind it.  Returns the length.
 */
size_t api_utf8_copy(char *out, size_t cap, const char *text, size_t len);

/* The same on the heap; NULL when memory is out. */
char *api_utf8_dup(const char *text, size_t len);

#endif
