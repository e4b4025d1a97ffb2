#ifndef API_MEDIA_H
#define API_MEDIA_H

#include "api/problem.h"

/* Media types that a body may claim; the bytes decide the format all the same. */
extern const char *const api_media_types[]; /* NULL behind the last */

/*
 * Judge the values of Content-Type and Content-Encoding (NULL: absent).  0, or -1 with ${p}
 * unsupported_media_type or unsupported_encoding.
 */
int api_media_check(const char *content_type, const char *content_encoding, struct api_problem *p);

#endif
