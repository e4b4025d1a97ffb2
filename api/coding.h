#ifndef API_CODING_H
#define API_CODING_H

#include <stddef.h>
#include <stdint.h>

#include "api/problem.h"

/*
 * Content codings (RFC 9110, 8.4): encoded bytes are pushed in as they arrive, decoded ones go to a
 * sink in pieces.  Nothing is collected; where a chunk ends changes neither the decoded bytes nor
 * the verdict.
 */

/* Takes bytes; 0, or -1 with ${p}, after which nothing more comes.  Keeps no pointer to them. */
struct api_sink {
	int (*bytes)(void *self, const uint8_t *bytes, size_t len, struct api_problem *p);
	void *self;
};

enum api_coding_kind { API_CODING_IDENTITY, API_CODING_GZIP, API_CODING_ZSTD, API_CODINGS };

extern const char *const api_coding_names[API_CODINGS];

/*
 * The value of Content-Encoding (NULL: absent).  One coding beside identity is taken: a body that
 * was compressed twice is refused.  0, or -1 with ${p} unsupported_encoding.
 */
int api_coding_read(const char *header, enum api_coding_kind *out, struct api_problem *p);

struct api_coding;

/*
 * ${most}: decoded bytes that may come out.  ${sink} is copied.  NULL: memory is out.
 * Memory: about 110 kB for gzip; for zstd the window that the stream asks for, at most 128 MiB.
 */
struct api_coding *api_coding_new(enum api_coding_kind kind, uint64_t most,
				  const struct api_sink *sink);

/*
 * Take ${len} encoded bytes.  gzip: members one behind the other are one file (RFC 1952, 2.2), and
 * zeros may fill up its end; zstd: frames, and skippable ones between them (RFC 8878, 3.1).
 * -1 with ${p}: bad_encoding with the offset in the encoded body up to which it was good (zstd: at
 * which the damaged header or block begins);
 * decoded_too_large with the limit and, since the true figure would have to be decoded first, the
 * next number as the actual one; too_expensive; or what the sink said, which has got all that was
 * decoded until then.  Only api_coding_free() is legal afterwards.
 */
int api_coding_push(struct api_coding *, const uint8_t *bytes, size_t len, struct api_problem *p);

/* The body is over: -1 with bad_encoding where the stream is not. */
int api_coding_finish(struct api_coding *, struct api_problem *p);

uint64_t api_coding_decoded(const struct api_coding *); /* bytes that went to the sink */

void api_coding_free(struct api_coding *); /* takes NULL */

#endif
