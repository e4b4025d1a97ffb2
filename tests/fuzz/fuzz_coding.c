/*
 * Any bytes as gzip and as zstd: cut in any way they decode to the same bytes and the same verdict,
 * and never to more than the limit.  The cuts hang on the bytes themselves.
 */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define ZSTD_STATIC_LINKING_ONLY /* for ZSTD_getFrameHeader(), which has long been there */
#include <zstd.h>

#include "api/coding.h"
#include "cut.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MOST = 256 << 10, WINDOW = 32 << 10 };

struct seen {
	int ret;
	struct api_problem problem;
	uint64_t len, hash;
};

static void must(bool truth)
{
	if (!truth)
		abort();
}

static int take(void *self, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	struct seen *s = self;

	(void)p;
	must(len > 0);
	s->len += len;
	for (size_t i = 0; i < len; i++) /* FNV-1a, to which pieces are all one */
		s->hash = (s->hash ^ bytes[i]) * 1099511628211u;
	return 0;
}

static struct seen decode(enum api_coding_kind kind, uint64_t most, const uint8_t *data,
			  size_t size, size_t first, size_t step)
{
	struct seen s = {.hash = 14695981039346656037u};
	const struct api_sink sink = {take, &s};
	struct api_coding *c = api_coding_new(kind, most, &sink);

	must(c != NULL);
	for (size_t at = 0, n = first; at < size && s.ret == 0; at += n, n = step) {
		uint8_t *copy;

		n = n < size - at ? n : size - at;
		if (n == 0)
			continue;
		copy = malloc(n);
		must(copy != NULL);
		memcpy(copy, data + at, n);
		s.ret = api_coding_push(c, copy, n, &s.problem);
		free(copy);
	}
	if (s.ret == 0)
		s.ret = api_coding_finish(c, &s.problem);
	must((s.ret == 0) == (s.problem.code == API_OK));
	must(s.len <= most && s.len == api_coding_decoded(c));
	api_coding_free(c);
	return s;
}

static void must_be_same(const struct seen *a, const struct seen *b)
{
	must(a->len == b->len && a->hash == b->hash);
	must(a->problem.code == b->problem.code && a->problem.byte == b->problem.byte);
	must(strcmp(a->problem.detail, b->problem.detail) == 0);
}

/* That zstd is to lay out; a large one takes the sanitizer up to milliseconds. */
static uint64_t window_of(const uint8_t *data, size_t size)
{
	ZSTD_frameHeader head;

	return ZSTD_getFrameHeader(&head, data, size) == 0 ? head.windowSize : 0;
}

/* As the coding that its first byte promises, now and then as the other one. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const uint64_t dice = cut_dice(data, size);
	const struct cut cut = cut_of(dice, size);
	const uint64_t most = (dice >> 48) % 8 == 0 ? dice % 1000 : MOST;
	bool zstd = size > 0 && data[0] != 0x1f;
	enum api_coding_kind kind;
	struct seen whole, other;

	if ((dice >> 20) % 16 == 0 || (window_of(data, size) > WINDOW && (dice >> 24) % 64 != 0))
		zstd = !zstd;
	kind = zstd ? API_CODING_ZSTD : API_CODING_GZIP;
	whole = decode(kind, most, data, size, size, size);
	other = decode(kind, most, data, size, cut.first, cut.step);
	must_be_same(&whole, &other);
	return 0;
}
