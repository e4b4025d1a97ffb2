#ifndef API_MULTIPART_H
#define API_MULTIPART_H

#include <stddef.h>
#include <stdint.h>

#include "api/media.h"
#include "api/part.h"
#include "api/problem.h"

/*
 * multipart/form-data (RFC 7578, RFC 2046 5.1), pushed: bytes go in as they arrive and come out as
 * parts.  Only the heads of parts are collected, up to a limit; a chunk may end anywhere, in a
 * boundary too, and only the sizes of the pieces show where.
 *
 * Lines end with CRLF: a form with bare LFs is refused, since in a file that is no text there is no
 * telling them from data.  A line of the data that begins like a boundary and goes on with anything
 * but its end, "--" or blanks is data, as it is for browsers and most servers.  What stands before
 * the first and behind the last boundary is passed over.
 */

enum { API_MULTIPART_HEAD = 8192, API_MULTIPART_PARTS = 1000 };

struct api_multipart_sink { /* each 0, or -1 with ${p} */
	int (*begin)(void *self, const struct api_part *part, struct api_problem *p);
	int (*bytes)(void *self, const uint8_t *bytes, size_t len, struct api_problem *p);
	int (*end)(void *self, struct api_problem *p);
	void *self;
};

struct api_multipart { /* to be embedded; needs no end */
	struct api_multipart_sink sink;
	char delimiter[4 + API_BOUNDARY]; /* CR LF - - boundary */
	size_t delimiter_len;
	int state;
	size_t matched; /* bytes of the delimiter that were read, */
	size_t ghost;   /* so many of which never came: a CRLF in front of the content */
	uint64_t at;    /* offset in the form */
	size_t parts;
	size_t head_len;
	char head[API_MULTIPART_HEAD];
	struct api_part part;
};

/* ${boundary}: as read by api_media_read(). */
void api_multipart_begin(struct api_multipart *, const char *boundary,
			 const struct api_multipart_sink *sink);

/*
 * -1 with ${p}: bad_multipart with the offset in the form and the number of the part, or what the
 * sink said.  Nothing is legal afterwards.
 */
int api_multipart_push(struct api_multipart *, const uint8_t *bytes, size_t len,
		       struct api_problem *p);

/* The body is over: -1 with bad_multipart where the last boundary is missing. */
int api_multipart_finish(struct api_multipart *, struct api_problem *p);

#endif
