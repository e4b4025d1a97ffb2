#include "core/topology/recent.h"

#include <stdlib.h>
#include <string.h>

#include "core/topology/vertex_bits.h"

enum {
	BITS = 15,  /* 512 kB (doubles: 1 MB): two rows of a mesh of ten million triangles */
	TRIAL = 16, /* batches between judgements */
	PAUSE = 512 /* batches until the next trial where the last one was no use */
};

#define INLINE static inline __attribute__((always_inline))

INLINE unsigned words_of(bool wide)
{
	return wide ? 4 : 2;
}

INLINE uint32_t place_of(bool wide, const uint64_t w[3])
{
	uint64_t sum = w[0] * 0x9e3779b97f4a7c15u + w[1] * 0xc2b2ae3d27d4eb4fu +
		       (wide ? w[2] * 0x165667b19e3779f9u : 0);

	return (uint32_t)((sum ^ sum >> 29) * 0xbf58476d1ce4e5b9u >> (64 - BITS));
}

static bool begin(struct mp_recent *r, bool wide)
{
	size_t size = (sizeof *r->entry << BITS) * words_of(wide);

	free(r->entry);
	r->entry = malloc(size);
	r->off = r->entry == NULL;
	if (r->off)
		return false;
	r->wide = wide;
	memset(r->entry, 0xff, size);
	return true;
}

bool mp_recent_wanted(struct mp_recent *r, bool wide)
{
	if (r->off)
		return false;
	if (r->entry == NULL || r->wide != wide)
		return begin(r, wide);
	if (r->pause > 0) {
		r->pause--;
		return false;
	}
	if (++r->batches > TRIAL) {
		/* a look here costs about a quarter of one in the table */
		r->pause = r->missing > r->looked - r->looked / 4 ? PAUSE : 0;
		r->batches = r->looked = r->missing = 0;
	}
	return true;
}

/* The number is above the lower half of the last word. */
INLINE bool is_entry(bool wide, const uint64_t *e, const uint64_t w[3])
{
	if (wide)
		return ((e[0] ^ w[0]) | (e[1] ^ w[1]) | (e[2] ^ w[2])) == 0;
	return ((e[0] ^ w[0]) | (uint32_t)(e[1] ^ w[1])) == 0;
}

INLINE void set_entry(bool wide, uint64_t *e, const uint64_t w[3], uint32_t number)
{
	e[0] = w[0];
	if (wide) {
		e[1] = w[1];
		e[2] = w[2];
		e[3] = (uint64_t)number << 32;
	} else {
		e[1] = w[1] | (uint64_t)number << 32;
	}
}

INLINE void look(struct mp_recent *r, bool wide, char *key, unsigned n, struct mp_recent_batch *b)
{
	const unsigned words = words_of(wide), each = wide ? 24 : 12;
	uint32_t place[MP_RECENT_BATCH], missing = 0;
	uint64_t *entry = r->entry;

	for (unsigned i = 0; i < n; i++) {
		uint64_t w[3];

		load_words(wide, key + (size_t)each * i, w);
		place[i] = place_of(wide, w) * words;
		__builtin_prefetch(&entry[place[i]]);
	}
	for (unsigned i = 0; i < n; i++) {
		uint64_t *e = &entry[place[i]], w[3];

		load_words(wide, key + (size_t)each * i, w);
		if (!is_entry(wide, e, w)) {
			set_entry(wide, e, w, MP_RECENT_MISSING + missing);
			memmove(key + (size_t)each * missing, key + (size_t)each * i, each);
			b->place[missing++] = place[i];
		}
		b->number[i] = (uint32_t)(e[words - 1] >> 32);
	}
	b->missing = missing;
	r->looked += n;
	r->missing += missing;
}

void mp_recent_look_narrow(struct mp_recent *r, float (*key)[3], unsigned n,
			   struct mp_recent_batch *b)
{
	look(r, false, (char *)key, n, b);
}

void mp_recent_look_wide(struct mp_recent *r, uint64_t (*key)[3], unsigned n,
			 struct mp_recent_batch *b)
{
	look(r, true, (char *)key, n, b);
}

void mp_recent_learn(struct mp_recent *r, const struct mp_recent_batch *b, const uint32_t *number,
		     unsigned n, uint32_t *out)
{
	const unsigned last = words_of(r->wide) - 1;

	for (unsigned i = 0; i < n; i++)
		out[i] = b->number[i] < MP_RECENT_MISSING
			     ? b->number[i]
			     : number[b->number[i] - MP_RECENT_MISSING];
	for (unsigned i = 0; i < b->missing; i++) { /* unless another took its entry */
		uint64_t *word = &r->entry[b->place[i] + last];

		if (*word >> 32 == MP_RECENT_MISSING + i)
			*word = (uint32_t)*word | (uint64_t)number[i] << 32;
	}
}

void mp_recent_free(struct mp_recent *r)
{
	free(r->entry);
	r->entry = NULL;
}
