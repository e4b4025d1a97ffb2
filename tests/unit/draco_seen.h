#ifndef DRACO_SEEN_H
#define DRACO_SEEN_H

/*
 * Writes Draco meshes by hand (sequential method, uncompressed, so that every byte has its place),
 * runs mp_draco_decoder over them cut in any way and keeps what came out.
 */

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/decoder.h"

enum { DRACO_FILE = 1 << 16, DRACO_SEEN = 1024 };

enum draco_data { D_I8 = 1, D_U8, D_I16, D_U16, D_I32, D_U32, D_I64, D_U64, D_F32, D_F64, D_BOOL };

struct draco_file {
	uint8_t bytes[DRACO_FILE];
	size_t len;
	unsigned version; /* major << 8 | minor */
};

static inline void draco_put(struct draco_file *f, const void *bytes, size_t len)
{
	if (len > sizeof f->bytes - f->len)
		abort();
	memcpy(f->bytes + f->len, bytes, len);
	f->len += len;
}

static inline void draco_u8(struct draco_file *f, unsigned v)
{
	uint8_t byte = (uint8_t)v;

	draco_put(f, &byte, 1);
}

static inline void draco_u32(struct draco_file *f, uint32_t v)
{
	for (unsigned i = 0; i < 4; i++)
		draco_u8(f, v >> 8 * i & 0xff);
}

static inline void draco_varint(struct draco_file *f, uint32_t v)
{
	for (; v >= 0x80; v >>= 7)
		draco_u8(f, (v & 0x7f) | 0x80);
	draco_u8(f, v);
}

/* Counts of connectivity are varints from 2.2 on, those of attributes from 2.0 on. */
static inline void draco_count(struct draco_file *f, uint32_t v, unsigned since)
{
	if (f->version >= since)
		draco_varint(f, v);
	else
		draco_u32(f, v);
}

static inline void draco_f32(struct draco_file *f, float v)
{
	uint32_t bits;

	memcpy(&bits, &v, sizeof bits);
	draco_u32(f, bits);
}

static inline void draco_head(struct draco_file *f, unsigned version, unsigned kind,
			      unsigned method, unsigned flags)
{
	f->len = 0;
	f->version = version;
	draco_put(f, "DRACO", 5);
	draco_u8(f, version >> 8);
	draco_u8(f, version & 0xff);
	draco_u8(f, kind);
	draco_u8(f, method);
	draco_u8(f, flags & 0xff);
	draco_u8(f, flags >> 8);
}

/* ${points} < 256 */
static inline void draco_faces(struct draco_file *f, uint32_t faces, uint32_t points,
			       const uint8_t *corner)
{
	draco_count(f, faces, 0x202);
	draco_count(f, points, 0x202);
	draco_u8(f, 1); /* not compressed */
	draco_put(f, corner, 3 * (size_t)faces);
}

/* One attribute's description and decoder: 0 raw, 1 integers, 2 quantised. */
struct draco_attribute {
	unsigned type, data, components, normalised, decoder;
};

/* All of one decoder of attributes; their values follow. */
static inline void draco_attributes(struct draco_file *f, const struct draco_attribute *a,
				    unsigned count)
{
	draco_u8(f, 1);
	draco_count(f, count, 0x200);
	for (unsigned i = 0; i < count; i++) {
		draco_u8(f, a[i].type);
		draco_u8(f, a[i].data);
		draco_u8(f, a[i].components);
		draco_u8(f, a[i].normalised);
		draco_u8(f, i); /* its number: a varint from 1.3 on, 16 bits before */
		if (f->version < 0x103)
			draco_u8(f, 0);
	}
	for (unsigned i = 0; i < count; i++)
		draco_u8(f, a[i].decoder);
}

struct draco_seen {
	int ret;
	struct mp_error err;
	struct mp_notes notes;
	double tri[DRACO_SEEN][9];
	uint32_t index[DRACO_SEEN][3];
	size_t count, indices;
	uint64_t expected; /* triangles; 0: it did not say */
	bool wrong;
	size_t fail_at; /* the sink refuses the block with this triangle; 0 = never */
	bool fail_indices;
	bool as_floats; /* have them as floats, if the decoder does so */
};

static inline int draco_seen_indices(void *self, const uint32_t (*tri)[3], size_t count,
				     struct mp_error *err)
{
	struct draco_seen *s = self;

	if (s->indices != s->count) /* just before the block of the same triangles */
		s->wrong = true;
	if (s->fail_indices)
		return mp_fail(err, MP_BUG, 8, "no indices");
	for (size_t i = 0; i < count && s->indices + i < DRACO_SEEN; i++)
		memcpy(s->index[s->indices + i], tri[i], sizeof tri[i]);
	s->indices += count;
	return 0;
}

static inline int draco_seen_block(void *self, const double (*tri)[9], size_t count,
				   struct mp_error *err)
{
	struct draco_seen *s = self;

	if (count == 0 || count > MP_BLOCK || s->count % MP_BLOCK != 0 ||
	    s->indices != s->count + count)
		s->wrong = true;
	if (s->fail_at > s->count && s->fail_at <= s->count + count)
		return mp_fail(err, MP_BUG, 7, "the sink is full");
	for (size_t i = 0; i < count && s->count + i < DRACO_SEEN; i++)
		memcpy(s->tri[s->count + i], tri[i], sizeof tri[i]);
	s->count += count;
	return 0;
}

/* What was expected is what comes. */
static inline int draco_seen_floats(void *self, const float (*xyz)[MP_BLOCK], size_t count,
				    struct mp_error *err)
{
	struct draco_seen *s = self;
	double tri[MP_BLOCK][9];

	s->wrong |= s->expected == 0 || s->count + count > s->expected;
	for (size_t i = 0; i < 9 * count; i++)
		tri[i / 9][i % 9] = (double)xyz[i % 9][i / 9];
	return draco_seen_block(self, (const double(*)[9])tri, count, err);
}

static inline void draco_seen_expect(void *self, uint64_t triangles, const struct mp_points *p)
{
	struct draco_seen *s = self;

	s->wrong |= s->expected != 0 || s->count != 0 || triangles == 0;
	s->expected = triangles;
	for (size_t i = 0; i < p->count; i++) { /* all of them are there, and numbers */
		float xyz[3];

		memcpy(xyz, p->data + i * p->stride, sizeof xyz);
		for (unsigned k = 0; k < 3; k++)
			s->wrong |= !(xyz[k] - xyz[k] == 0);
	}
}

/* Cut behind ${first} bytes, then every ${step}; each chunk is a heap copy of its exact size. */
static inline void draco_decode(struct draco_seen *s, const uint8_t *bytes, size_t len,
				size_t first, size_t step, uint64_t most)
{
	const struct mp_sink sink = {.block = draco_seen_block,
				     .self = s,
				     .indices = draco_seen_indices,
				     .floats = s->as_floats ? draco_seen_floats : NULL,
				     .expect = draco_seen_expect};
	const struct mp_limits limits = {most};
	size_t fail_at = s->fail_at, at = 0, n = first;
	bool fail_indices = s->fail_indices, as_floats = s->as_floats;
	void *state = NULL;

	memset(s, 0,
	       offsetof(struct draco_seen, tri)); /* the triangles beyond count are nobody's */
	memset(&s->count, 0, sizeof *s - offsetof(struct draco_seen, count));
	s->fail_at = fail_at;
	s->fail_indices = fail_indices;
	s->as_floats = as_floats;
	s->ret = mp_draco_decoder.begin(&state, &sink, &limits, &s->notes, &s->err);
	while (s->ret == 0 && at < len) {
		uint8_t *chunk;

		if (n > len - at)
			n = len - at;
		chunk = malloc(n > 0 ? n : 1);
		if (chunk == NULL)
			abort();
		memcpy(chunk, bytes + at, n);
		s->ret = mp_draco_decoder.push(state, chunk, n, &s->err);
		free(chunk);
		s->wrong |= s->ret != 0 && s->err.code == MP_TRUNCATED; /* only finish may */
		at += n;
		n = step;
	}
	if (s->ret == 0)
		s->ret = mp_draco_decoder.finish(state, &s->err);
	s->wrong |= s->ret == 0 && (s->notes.triangles != s->count || s->notes.bytes != len ||
				    s->notes.format != MP_FORMAT_DRACO || s->count == 0);
	s->wrong |= s->ret != 0 && (s->ret != -1 || s->err.code == MP_OK);
	mp_draco_decoder.end(state);
}

/* Neither where a chunk ends nor the form matters, not even for the wording of an error. */
static inline bool draco_same(const struct draco_seen *a, const struct draco_seen *b)
{
	size_t kept;

	if (a->wrong || b->wrong || a->ret != b->ret || a->count != b->count)
		return false;
	if (a->ret != 0)
		return a->err.code == b->err.code && a->err.byte == b->err.byte &&
		       a->err.limit == b->err.limit && a->err.actual == b->err.actual &&
		       strcmp(a->err.text, b->err.text) == 0;
	kept = a->count < DRACO_SEEN ? a->count : DRACO_SEEN;
	return memcmp(&a->notes, &b->notes, sizeof a->notes) == 0 &&
	       memcmp(a->tri, b->tri, kept * sizeof a->tri[0]) == 0 &&
	       memcmp(a->index, b->index, kept * sizeof a->index[0]) == 0;
}

#endif
