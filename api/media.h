#ifndef API_MEDIA_H
#define API_MEDIA_H

#include <stdbool.h>

#include "api/coding.h"
#include "api/problem.h"

/* Media types that a body may claim; the bytes decide the format all the same. */
extern const char *const api_media_types[]; /* NULL behind the last */

enum { API_BOUNDARY = 70 }; /* longest (RFC 2046, 5.1.1) */

/* What the headers say of the body. */
struct api_media {
	bool form; /* multipart/form-data */
	char boundary[API_BOUNDARY + 1];
	enum api_coding_kind coding;
};

/*
 * Judge the values of Content-Type and Content-Encoding (NULL: absent).  0, or -1 with ${p}
 * unsupported_media_type, unsupported_encoding, or bad_multipart where the boundary is missing or
 * malformed.
 */
int api_media_read(const char *content_type, const char *content_encoding, struct api_media *out,
		   struct api_problem *p);

#endif
