#include "api/coding.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define ZLIB_CONST /* next_in points to const */
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include "api/header.h"

enum {
	PIECE = 64 << 10,
	KEPT = 128 << 10,           /* a block of zstd, at most */
	GZIP_ONLY = 16 + MAX_WBITS, /* inflateInit2: gzip's frame, neither zlib's nor none */
	WINDOW_LOG = 27,            /* what zstd --long and --ultra make; the library's own limit */
	ZSTD_MAGIC = 4,
	ZSTD_HEADER = 18, /* of a frame, at most */
	ZSTD_BLOCK_HEADER = 3
};

enum place { BETWEEN, INSIDE, PADDING }; /* of a gzip member or a zstd frame; behind the last */

struct api_coding {
	enum api_coding_kind kind;
	struct api_sink sink;
	uint64_t most, decoded;
	uint64_t at; /* encoded bytes that were taken */
	enum place place;
	bool begun; /* a member or frame began */
	z_stream gzip;
	ZSTD_DCtx *zstd;
	size_t hint;     /* what libzstd wants next */
	size_t slice;    /* bytes that it gets at once */
	size_t kept_len; /* of them, those that wait for the rest */
	uint64_t slice_at;
	uint64_t frame_at;
	uint8_t magic[ZSTD_MAGIC];
	size_t magic_len;
	uint8_t piece[]; /* PIECE bytes decoded, none for identity; with zstd, KEPT encoded ones */
};

const char *const api_coding_names[API_CODINGS] = {"identity", "gzip", "zstd"};

static bool same(const char *text, size_t len, const char *word)
{
	return strlen(word) == len && strncasecmp(text, word, len) == 0;
}

static int read_one(const char *text, size_t len, enum api_coding_kind *out, struct api_problem *p)
{
	enum api_coding_kind kind;

	if (len == 0 || same(text, len, api_coding_names[API_CODING_IDENTITY]))
		return 0;
	if (same(text, len, "gzip") || same(text, len, "x-gzip")) /* RFC 9110, 8.4.1.3 */
		kind = API_CODING_GZIP;
	else if (same(text, len, "zstd"))
		kind = API_CODING_ZSTD;
	else
		return api_problem_set(p, API_UNSUPPORTED_ENCODING,
				       "This content coding is not read: send the body as it is, "
				       "or with Content-Encoding gzip or zstd.");
	if (*out != API_CODING_IDENTITY)
		return api_problem_set(p, API_UNSUPPORTED_ENCODING,
				       "The body was encoded more than once: one of gzip and zstd "
				       "is read.");
	*out = kind;
	return 0;
}

int api_coding_read(const char *header, enum api_coding_kind *out, struct api_problem *p)
{
	*out = API_CODING_IDENTITY;
	while (header != NULL && *header != '\0') {
		size_t len = api_header_word(&header, ",");

		if (read_one(header, len, out, p))
			return -1;
		header += strcspn(header, ",");
		header += *header == ',';
	}
	return 0;
}

/* zlib's memory is ours, so that tests can make it run out. */
static void *zlib_alloc(void *unused, unsigned count, unsigned size)
{
	(void)unused;
	return calloc(count, size);
}

static void zlib_free(void *unused, void *memory)
{
	(void)unused;
	free(memory);
}

static int begin(struct api_coding *c)
{
	switch (c->kind) {
	case API_CODING_GZIP:
		c->gzip.zalloc = zlib_alloc;
		c->gzip.zfree = zlib_free;
		return inflateInit2(&c->gzip, GZIP_ONLY) == Z_OK ? 0 : -1;
	case API_CODING_ZSTD:
		c->zstd = ZSTD_createDCtx();
		return c->zstd == NULL || ZSTD_isError(ZSTD_DCtx_setParameter(
					      c->zstd, ZSTD_d_windowLogMax, WINDOW_LOG))
			   ? -1
			   : 0;
	case API_CODING_IDENTITY:
	case API_CODINGS:
		break;
	}
	return 0;
}

struct api_coding *api_coding_new(enum api_coding_kind kind, uint64_t most,
				  const struct api_sink *sink)
{
	static const size_t room[API_CODINGS] = {
	    [API_CODING_GZIP] = PIECE, [API_CODING_ZSTD] = PIECE + KEPT};
	struct api_coding *c = malloc(sizeof *c + room[kind]);

	if (c == NULL)
		return NULL;
	memset(c, 0, sizeof *c);
	c->kind = kind;
	c->most = most;
	c->sink = *sink;
	if (begin(c)) {
		api_coding_free(c);
		return NULL;
	}
	return c;
}

static int out_of_memory(struct api_problem *p)
{
	return api_problem_set(p, API_TOO_EXPENSIVE,
			       "The request needs more memory than one request may use.");
}

static int damaged(const struct api_coding *c, struct api_problem *p, const char *what)
{
	(void)api_problem_set(p, API_BAD_ENCODING, "The %s stream is damaged: %s.",
			      api_coding_names[c->kind], what);
	p->byte = c->at;
	return -1;
}

/* Decoded bytes to the sink, as many as may come: those count, whatever follows. */
static int deliver(struct api_coding *c, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	uint64_t left = c->most - c->decoded;
	size_t pass = len <= left ? len : (size_t)left;

	c->decoded += pass;
	if (pass > 0 && c->sink.bytes(c->sink.self, bytes, pass, p))
		return -1;
	if (pass == len)
		return 0;
	(void)api_problem_set(p, API_DECODED_TOO_LARGE,
			      "The body is larger than the limit of %" PRIu64 " decoded bytes.",
			      c->most);
	p->limit = c->most;
	p->actual = c->most + 1;
	return -1;
}

/* What stands between members: the next one, or zeros up to the end. */
static int between_members(struct api_coding *c, uint8_t byte, struct api_problem *p)
{
	if (byte == 0 && c->begun) {
		c->place = PADDING;
		return 0;
	}
	if (byte != 0x1f || c->place == PADDING)
		return damaged(c, p,
			       c->begun ? "there are bytes behind its end that are no gzip"
					: "it does not begin as one");
	c->place = INSIDE;
	c->begun = true;
	return inflateReset(&c->gzip) == Z_OK ? 0 : damaged(c, p, "it cannot be begun");
}

static int push_gzip(struct api_coding *c, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	z_stream *z = &c->gzip;
	bool full = false; /* the piece was: there may be more without further input */

	while (len > 0 || full) {
		size_t give = len < UINT32_MAX / 2 ? len : UINT32_MAX / 2;
		int rc;

		if (c->place != INSIDE && between_members(c, *bytes, p))
			return -1;
		if (c->place == PADDING) {
			bytes++;
			len--;
			c->at++;
			continue;
		}
		z->next_in = bytes;
		z->avail_in = (uInt)give;
		z->next_out = c->piece;
		z->avail_out = PIECE;
		rc = inflate(z, Z_NO_FLUSH);
		give -= z->avail_in;
		bytes += give;
		len -= give;
		c->at += give;
		if (deliver(c, c->piece, PIECE - z->avail_out, p))
			return -1;
		if (rc == Z_MEM_ERROR)
			return out_of_memory(p);
		if (rc == Z_STREAM_END)
			c->place = BETWEEN;
		else if (rc != Z_OK && rc != Z_BUF_ERROR)
			return damaged(c, p, z->msg != NULL ? z->msg : "it needs a dictionary");
		full = c->place == INSIDE && z->avail_out == 0;
	}
	return 0;
}

static int zstd_error(const struct api_coding *c, size_t rc, struct api_problem *p)
{
	switch (ZSTD_getErrorCode(rc)) {
	case ZSTD_error_memory_allocation:
		return out_of_memory(p);
	case ZSTD_error_frameParameter_windowTooLarge:
		return damaged(c, p, "it needs a window of more than 128 MiB");
	case ZSTD_error_dictionary_wrong:
		return damaged(c, p, "it needs a dictionary");
	default:
		return damaged(c, p, ZSTD_getErrorName(rc));
	}
}

static size_t slice_size(const struct api_coding *c)
{
	size_t size = c->hint - ZSTD_BLOCK_HEADER;

	if (c->at - c->frame_at < ZSTD_HEADER || c->hint <= ZSTD_BLOCK_HEADER)
		return 1;
	return size < KEPT ? size : KEPT;
}

/* One whole slice of ${size} bytes, and all that comes out of it. */
static int unpack_slice(struct api_coding *c, const uint8_t *bytes, size_t size,
			struct api_problem *p)
{
	ZSTD_inBuffer in = {bytes, size, 0};
	bool full = false;

	while (in.pos < in.size || full) {
		ZSTD_outBuffer out = {c->piece, PIECE, 0};

		c->hint = ZSTD_decompressStream(c->zstd, &out, &in);
		if (ZSTD_isError(c->hint)) {
			c->at = c->slice_at;
			return zstd_error(c, c->hint, p);
		}
		if (deliver(c, c->piece, out.pos, p))
			return -1;
		full = out.pos == out.size;
	}
	if (c->hint == 0)
		c->place = BETWEEN;
	return 0;
}

/*
 * ${len} > 0 bytes within a frame.  What libzstd puts out before it finds an error hangs on how it
 * is fed: it forgets what came out in the call that fails, and takes a stored block in pieces of
 * any size.  So it gets whole slices, a header or a block or less, whose ends do not hang on where
 * a chunk ends; a part of one is kept until the rest is there.  The hint counts the next block's
 * header too, and never goes beyond the frame.  The frame's header goes in byte by byte: what
 * libzstd finds wrong with one hangs on how much of it is there.
 */
static int unpack(struct api_coding *c, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	while (len > 0 && c->place == INSIDE) {
		const uint8_t *slice = bytes;
		size_t n;

		if (c->kept_len == 0) {
			c->slice = slice_size(c);
			c->slice_at = c->at;
		}
		n = c->slice - c->kept_len < len ? c->slice - c->kept_len : len;
		if (n < c->slice) {
			memcpy(c->piece + PIECE + c->kept_len, bytes, n);
			c->kept_len += n;
			slice = c->piece + PIECE;
		}
		bytes += n;
		len -= n;
		c->at += n;
		if (slice != c->piece + PIECE || c->kept_len == c->slice) {
			c->kept_len = 0;
			if (unpack_slice(c, slice, c->slice, p))
				return -1;
		}
	}
	return 0;
}

/* A frame has a known number in front; so the formats before 0.8 never reach the library. */
static bool is_frame(const uint8_t magic[ZSTD_MAGIC])
{
	return memcmp(magic, "\x28\xb5\x2f\xfd", ZSTD_MAGIC) == 0 ||
	       ((magic[0] & 0xf0) == 0x50 && memcmp(magic + 1, "\x2a\x4d\x18", 3) == 0);
}

static int push_zstd(struct api_coding *c, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	while (len > 0) {
		uint64_t before = c->at;

		if (c->place == INSIDE) {
			if (unpack(c, bytes, len, p))
				return -1;
			bytes += c->at - before;
			len -= (size_t)(c->at - before);
			continue;
		}
		c->magic[c->magic_len++] = *bytes++;
		len--;
		c->at++;
		if (c->magic_len < ZSTD_MAGIC)
			continue;
		if (!is_frame(c->magic)) {
			c->at -= ZSTD_MAGIC;
			return damaged(c, p,
				       c->begun ? "there are bytes behind its end that are no zstd"
						: "it does not begin as one");
		}
		c->magic_len = 0;
		c->begun = true;
		c->place = INSIDE;
		c->frame_at = c->slice_at = c->at - ZSTD_MAGIC;
		if (unpack_slice(c, c->magic, ZSTD_MAGIC, p))
			return -1;
	}
	return 0;
}

int api_coding_push(struct api_coding *c, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	if (c->kind == API_CODING_GZIP)
		return push_gzip(c, bytes, len, p);
	if (c->kind == API_CODING_ZSTD)
		return push_zstd(c, bytes, len, p);
	c->at += len;
	return deliver(c, bytes, len, p);
}

int api_coding_finish(struct api_coding *c, struct api_problem *p)
{
	if (c->kind == API_CODING_IDENTITY || (c->begun && c->place != INSIDE && c->magic_len == 0))
		return 0;
	(void)api_problem_set(p, API_BAD_ENCODING,
			      "The %s stream ends too early, after %" PRIu64 " bytes.",
			      api_coding_names[c->kind], c->at);
	p->byte = c->at;
	return -1;
}

uint64_t api_coding_decoded(const struct api_coding *c)
{
	return c->decoded;
}

void api_coding_free(struct api_coding *c)
{
	if (c == NULL)
		return;
	if (c->kind == API_CODING_GZIP)
		(void)inflateEnd(&c->gzip);
	ZSTD_freeDCtx(c->zstd);
	free(c);
}
