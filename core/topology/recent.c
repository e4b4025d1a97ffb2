#include "core/topology/recent.h"

#include <stdlib.h>
#include <string.h>

enum {
	BITS = 13,  /* 256 kB, less than the second level of most processors' caches */
	TRIAL = 16, /* batches between judgements */
	PAUSE = 512 /* batches until the next trial where the last one was no use */
};

#define MISSING ((uint64_t)1 << 32)

static uint32_t place_of(const uint64_t w[3])
{
	uint64_t sum =
	    w[0] * 0x9e3779b97f4a7c15u + w[1] * 0xc2b2ae3d27d4eb4fu + w[2] * 0x165667b19e3779f9u;

	return (uint32_t)((sum ^ sum >> 29) * 0xbf58476d1ce4e5b9u >> (64 - BITS));
}

static bool begin(struct mp_recent *r)
{
	size_t size = sizeof *r->entry << BITS;

	r->entry = malloc(size);
	r->off = r->entry == NULL;
	if (r->off)
		return false;
	memset(r->entry, 0xff, size);
	return true;
}

bool mp_recent_wanted(struct mp_recent *r)
{
	if (r->off)
		return false;
	if (r->entry == NULL)
		return begin(r);
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

void mp_recent_look(struct mp_recent *r, uint64_t (*word)[3], unsigned n, struct mp_recent_batch *b)
{
	uint32_t place[MP_RECENT_BATCH], missing = 0;

	for (unsigned i = 0; i < n; i++) {
		place[i] = place_of(word[i]);
		__builtin_prefetch(&r->entry[place[i]]);
	}
	for (unsigned i = 0; i < n; i++) {
		struct mp_recent_entry *e = &r->entry[place[i]];
		uint64_t x = word[i][0], y = word[i][1], z = word[i][2];

		if (((e->word[0] ^ x) | (e->word[1] ^ y) | (e->word[2] ^ z)) != 0) {
			e->word[0] = word[missing][0] = x;
			e->word[1] = word[missing][1] = y;
			e->word[2] = word[missing][2] = z;
			e->number = MISSING + missing;
			b->place[missing++] = place[i];
		}
		b->number[i] = e->number;
	}
	b->missing = missing;
	r->looked += n;
	r->missing += missing;
}

void mp_recent_learn(struct mp_recent *r, const struct mp_recent_batch *b, const uint32_t *number,
		     unsigned n, uint32_t *out)
{
	for (unsigned i = 0; i < n; i++)
		out[i] = b->number[i] < MISSING ? (uint32_t)b->number[i]
						: number[b->number[i] - MISSING];
	for (unsigned i = 0; i < b->missing; i++) /* unless another took its entry */
		if (r->entry[b->place[i]].number == MISSING + i)
			r->entry[b->place[i]].number = number[i];
}

void mp_recent_free(struct mp_recent *r)
{
	free(r->entry);
	r->entry = NULL;
}
