#ifndef STL_SEEN_H
#define STL_SEEN_H

/* Runs mp_stl_decoder over bytes cut in any way and keeps what came out, for comparing. */

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/decoder.h"

enum { SEEN_TRIANGLES = 1024 };

struct seen {
	int ret;
	struct mp_error err; /* zero if ret == 0 */
	struct mp_notes notes;
	double tri[SEEN_TRIANGLES][9]; /* the first ones */
	uint64_t count;
	uint64_t hash;    /* of all triangles and parts */
	bool ended;       /* a block of fewer than MP_BLOCK triangles came: it must be the last */
	bool wrong;       /* an empty block, one after the last, a name too long, ... */
	char parts[512];  /* "first:name;" of every part */
	uint64_t fail_at; /* the sink refuses the block with this triangle; 0 = never */
	bool fail_part;
	bool floats; /* ask for the triangles as floats, where the format has them */
};

static inline void seen_hash(struct seen *s, const void *bytes, size_t len)
{
	const uint8_t *b = bytes;

	for (size_t i = 0; i < len; i++)
		s->hash = (s->hash ^ b[i]) * 1099511628211u; /* FNV-1a */
}

static inline int seen_block(void *self, const double (*tri)[9], size_t count, struct mp_error *err)
{
	struct seen *s = self;

	if (count == 0 || count > MP_BLOCK || s->ended)
		s->wrong = true;
	s->ended = count < MP_BLOCK;
	if (s->fail_at > s->count && s->fail_at <= s->count + count)
		return mp_fail(err, MP_BUG, 7, "the sink is full");
	for (size_t i = 0; i < count && s->count + i < SEEN_TRIANGLES; i++)
		memcpy(s->tri[s->count + i], tri[i], sizeof tri[i]);
	seen_hash(s, tri, count * sizeof tri[0]);
	s->count += count;
	return 0;
}

static inline int seen_floats(void *self, const float (*xyz)[MP_BLOCK], size_t count,
			      struct mp_error *err)
{
	static double tri[MP_BLOCK][9];

	for (size_t i = 0; i < count && count <= MP_BLOCK; i++)
		for (size_t k = 0; k < 9; k++)
			tri[i][k] = (double)xyz[k][i];
	return seen_block(self, (const double(*)[9])tri, count, err);
}

static inline int seen_part(void *self, uint64_t first, const char *name, size_t len,
			    struct mp_error *err)
{
	struct seen *s = self;
	size_t have = strlen(s->parts);

	if (len > MP_NAME_MAX)
		s->wrong = true;
	snprintf(s->parts + have, sizeof s->parts - have, "%llu:%.*s;", (unsigned long long)first,
		 (int)len, name);
	seen_hash(s, &first, sizeof first);
	seen_hash(s, name, len);
	return s->fail_part ? mp_fail(err, MP_BUG, 8, "no part") : 0;
}

/* Cut behind ${first} bytes, then every ${step}; each chunk is a heap copy of its exact size. */
static inline void seen_decode(struct seen *s, const void *bytes, size_t len, size_t first,
			       size_t step, uint64_t most)
{
	const struct mp_sink sink = {.block = seen_block,
				     .part = seen_part,
				     .self = s,
				     .floats = s->floats ? seen_floats : NULL};
	const struct mp_limits limits = {most};
	uint64_t fail_at = s->fail_at;
	bool fail_part = s->fail_part, floats = s->floats;
	size_t at = 0, n = first;
	void *state = NULL;

	memset(s, 0, offsetof(struct seen, tri));
	memset(&s->count, 0, sizeof *s - offsetof(struct seen, count));
	s->fail_at = fail_at;
	s->fail_part = fail_part;
	s->floats = floats;
	s->ret = mp_stl_decoder.begin(&state, &sink, &limits, &s->notes, &s->err);
	while (s->ret == 0 && at < len) {
		uint8_t *chunk;

		if (n > len - at)
			n = len - at;
		chunk = malloc(n > 0 ? n : 1);
		if (chunk == NULL)
			abort();
		memcpy(chunk, (const uint8_t *)bytes + at, n);
		s->ret = mp_stl_decoder.push(state, chunk, n, &s->err);
		if (s->ret != 0 && s->err.code == MP_TRUNCATED) /* only finish may say so */
			s->wrong = true;
		free(chunk);
		at += n;
		n = step;
	}
	if (s->ret == 0)
		s->ret = mp_stl_decoder.finish(state, &s->err);
	if (s->ret == 0 && (s->notes.triangles != s->count || s->notes.bytes != len))
		s->wrong = true;
	if (s->ret != 0 && (s->ret != -1 || s->err.code == MP_OK))
		s->wrong = true;
	mp_stl_decoder.end(state);
}

/* Where a chunk ends never matters, not even for the wording of an error. */
static inline bool seen_same(const struct seen *a, const struct seen *b)
{
	if (a->wrong || b->wrong || a->ret != b->ret || a->count != b->count || a->hash != b->hash)
		return false;
	if (a->ret != 0)
		return a->err.code == b->err.code && a->err.line == b->err.line &&
		       a->err.byte == b->err.byte && a->err.limit == b->err.limit &&
		       a->err.actual == b->err.actual && strcmp(a->err.text, b->err.text) == 0;
	return memcmp(&a->notes, &b->notes, sizeof a->notes) == 0;
}

#endif
