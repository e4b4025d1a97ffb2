#include <string.h>

#include "core/stl/stl_private.h"

static uint32_t le32(const uint8_t *p)
{
	return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

void stl_binary_begin(struct stl *s, const uint8_t header[STL_HEADER], const char *hint)
{
	s->binary.declared = le32(header + 80);
	s->binary.done = 0;
	s->binary.hint = hint;
	s->binary.have = 0;
	s->notes->parts = 1;
}

static int seems(const struct stl *s, struct mp_error *err)
{
	return mp_fail(err, MP_SYNTAX, 0, "no STL: this seems to be %s", s->binary.hint);
}

static int fail_limit(const struct stl *s, struct mp_error *err)
{
	uint64_t most = s->limits->max_triangles;

	if (s->binary.hint != NULL)
		return seems(s, err);
	return mp_fail_limit(err, STL_HEADER + STL_FACET * s->binary.done, most, most + 1,
			     "more than %llu facets", (unsigned long long)most);
}

/* ${facet} (12 floats, the normal first) has a coordinate that is NaN or infinite. */
static int fail_not_finite(const struct stl *s, const uint8_t *facet, struct mp_error *err)
{
	uint64_t byte = STL_HEADER + STL_FACET * s->binary.done;
	unsigned i = 3;

	if (s->binary.hint != NULL)
		return seems(s, err);
	while (i < 11 && (le32(facet + 4 * i) & 0x7f800000) != 0x7f800000)
		i++;
	return mp_fail(err, MP_NON_FINITE, byte + 4 * i,
		       "facet %llu (from 0): %c of vertex %u is not finite",
		       (unsigned long long)s->binary.done, "xyz"[i % 3], i / 3);
}

/*
 * The facet of 12 floats at ${p}, normal first.  Sets bit 31 of bad[k] where float k is NaN or
 * infinite.  Loops, so that they become vectors.
 */
static inline void convert(const uint8_t *p, double tri[9], double normal[3], uint32_t bad[12])
{
	uint32_t bits[12];
	float f[12];

	for (size_t k = 0; k < 12; k++)
		bits[k] = le32(p + 4 * k);
	for (size_t k = 0; k < 12; k++)
		bad[k] |= (bits[k] & 0x7f800000) + 0x00800000;
	memcpy(f, bits, sizeof f);
	for (size_t k = 0; k < 9; k++)
		tri[k] = (double)f[3 + k];
	for (size_t k = 0; k < 3; k++)
		normal[k] = (double)f[k];
}

static bool is_finite(const uint8_t *facet)
{
	uint32_t bad = 0;

	for (size_t k = 3; k < 12; k++)
		bad |= (le32(facet + 4 * k) & 0x7f800000) + 0x00800000;
	return bad >> 31 == 0;
}

/* ${count} facets into the block, which has room for them. */
static void read_doubles(struct stl *s, const uint8_t *p, uint64_t count,
			 struct stl_columns_seen *seen)
{
	struct mp_notes notes = {.triangles = 0}; /* in registers */
	uint32_t bad[12] = {0}, any = 0;

	for (uint64_t i = 0; i < count; i++) {
		double *tri = s->block[s->count + i], normal[3];

		convert(p + i * STL_FACET, tri, normal, bad);
		stl_check_normal(&notes, tri, normal);
	}
	for (size_t k = 3; k < 12; k++)
		any |= bad[k];
	seen->not_finite = any >> 31 != 0;
	seen->normals_disagreeing = notes.normals_disagreeing;
	seen->normals_not_finite = notes.normals_not_finite;
}

/* Up to ${count} facets, as many as the block has room for; the number read, < 0 on failure. */
static int64_t take(struct stl *s, const uint8_t *p, uint64_t count, struct mp_error *err)
{
	uint64_t room = s->limits->max_triangles - s->notes->triangles;
	struct stl_columns_seen seen;

	if (room == 0)
		return fail_limit(s, err);
	if (count > room)
		count = room;
	if (count > MP_BLOCK - s->count)
		count = MP_BLOCK - s->count;
	if (s->sink->floats != NULL)
		stl_columns_read(s->kernel, &s->columns, s->count, p, (size_t)count, &seen);
	else
		read_doubles(s, p, count, &seen);
	while (seen.not_finite) { /* one of them: which? */
		if (!is_finite(p))
			return fail_not_finite(s, p, err);
		s->binary.done++;
		p += STL_FACET;
	}
	s->binary.done += count;
	s->count += count;
	s->notes->triangles += count;
	s->notes->normals_disagreeing += seen.normals_disagreeing;
	s->notes->normals_not_finite += seen.normals_not_finite;
	if (s->count == MP_BLOCK && stl_flush(s, err))
		return -1;
	return (int64_t)count;
}

static int take_all(struct stl *s, const uint8_t *p, uint64_t count, struct mp_error *err)
{
	while (count > 0) {
		int64_t n = take(s, p, count, err);

		if (n < 0)
			return -1;
		p += (uint64_t)n * STL_FACET;
		count -= (uint64_t)n;
	}
	return 0;
}

int stl_binary_push(struct stl *s, const uint8_t *chunk, size_t len, struct mp_error *err)
{
	struct stl_binary *b = &s->binary;

	if (b->declared == 0 && len > 0) {
		if (b->hint != NULL)
			return seems(s, err);
		return mp_fail(
		    err, MP_SYNTAX, 80,
		    "the header says 0 facets, yet bytes follow: the count was not written");
	}
	while (len > 0 && b->done < b->declared) {
		uint64_t left = b->declared - b->done, whole = len / STL_FACET;
		size_t part;

		if (b->have == 0 && whole > 0) {
			whole = whole < left ? whole : left;
			if (take_all(s, chunk, whole, err))
				return -1;
			chunk += whole * STL_FACET;
			len -= (size_t)whole * STL_FACET;
			continue;
		}
		part = STL_FACET - b->have < len ? STL_FACET - b->have : len;
		memcpy(b->facet + b->have, chunk, part);
		chunk += part;
		len -= part;
		b->have += part;
		if (b->have == STL_FACET) {
			b->have = 0;
			if (take_all(s, b->facet, 1, err))
				return -1;
		}
	}
	s->notes->trailing_bytes += len;
	return 0;
}

int stl_binary_finish(struct stl *s, struct mp_error *err)
{
	const struct stl_binary *b = &s->binary;
	unsigned long long there = b->done;

	if (b->hint != NULL && (b->done < b->declared || s->notes->trailing_bytes > 0))
		return seems(s, err);
	if (b->done < b->declared)
		return mp_fail(err, MP_TRUNCATED, s->notes->bytes,
			       "the header says %lu facets: %llu are there, %llu are missing",
			       (unsigned long)b->declared, there, b->declared - there);
	if (b->declared == 0)
		return mp_fail(err, MP_NO_FACES, 80, "a binary STL with 0 facets");
	return 0;
}
