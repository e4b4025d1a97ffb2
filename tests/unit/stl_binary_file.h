#ifndef STL_BINARY_FILE_H
#define STL_BINARY_FILE_H

/* Makes binary STL files in ${file} and checks what becomes of them; include behind cmocka.h. */

#include "stl_seen.h"

enum { MOST = 700 };
static const size_t all = SIZE_MAX; /* one chunk */
static const uint64_t roomy = 1000000;

static uint8_t file[84 + 50 * MOST + 4096];
static struct seen whole, other;

static inline void put32(uint8_t *p, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		p[i] = (uint8_t)(v >> 8 * i);
}

/* ${number}: 0 to 2 the normal, 3 to 11 the corners. */
static inline void put_float(size_t facet, size_t number, float f)
{
	uint32_t bits;

	memcpy(&bits, &f, sizeof bits);
	put32(file + 84 + 50 * facet + 4 * number, bits);
}

/* ${count} facets in z = facet number, wound counter-clockwise seen from above, normal up. */
static inline size_t make(size_t count, const char *header)
{
	size_t len = strlen(header);

	memset(file, 0, sizeof file);
	memcpy(file, header, len < 80 ? len : 80);
	put32(file + 80, (uint32_t)count);
	for (size_t i = 0; i < count; i++) {
		float z = (float)i + 0.125f;

		put_float(i, 2, 1.0f);
		put_float(i, 3, -1.5f);
		put_float(i, 5, z);
		put_float(i, 6, 3.25f);
		put_float(i, 8, z);
		put_float(i, 9, 0.1f);
		put_float(i, 10, 2.0f);
		put_float(i, 11, z);
	}
	return 84 + 50 * count;
}

static inline void decode(size_t len)
{
	seen_decode(&whole, file, len, all, all, roomy);
	assert_false(whole.wrong);
}

/* What ${whole} says is said in pieces of ${step} as well, and to a sink of floats. */
static inline void check_alike(size_t len, size_t first, size_t step)
{
	for (int floats = 0; floats < 2; floats++) {
		other.floats = floats != 0;
		seen_decode(&other, file, len, first, step, roomy);
		assert_true(seen_same(&whole, &other));
	}
	other.floats = false;
}

static inline void check_accepted(size_t len, size_t triangles)
{
	decode(len);
	if (whole.ret != 0)
		fail_msg("refused: %s", whole.err.text);
	assert_int_equal(whole.count, triangles);
	assert_int_equal(whole.notes.format, MP_FORMAT_STL_BINARY);
	check_alike(len, 1, 3);
	check_alike(len, all, all);
}

static inline void check_refused(size_t len, enum mp_code code, uint64_t byte, const char *word)
{
	decode(len);
	if (whole.ret == 0 || whole.err.code != code || whole.err.byte != byte ||
	    strstr(whole.err.text, word) == NULL)
		fail_msg("%zu bytes: %d, code %d, byte %llu: %s", len, whole.ret, whole.err.code,
			 (unsigned long long)whole.err.byte, whole.err.text);
	for (size_t step = 1; step < 80; step += 13)
		check_alike(len, step, step);
	check_alike(len, all, all);
}

#endif
