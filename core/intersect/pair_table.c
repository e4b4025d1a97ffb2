#include "core/intersect/pair_table.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void mp_pair_table_begin(struct mp_pair_table *t, const uint8_t key[16])
{
	memset(t, 0, sizeof *t);
	memcpy(t->factor, key, sizeof t->factor);
	t->factor[0] |= 1;
	t->factor[1] |= 1;
}

void mp_pair_table_free(struct mp_pair_table *t)
{
	free(t->pair);
	free(t->slot);
	memset(t, 0, sizeof *t);
}

static uint32_t start(const struct mp_pair_table *t, uint32_t a, uint32_t b)
{
	uint64_t h = (a + 1) * t->factor[0] + (b + 1) * t->factor[1];

	return (uint32_t)(h >> 32) & (t->slots - 1);
}

static uint32_t *find_slot(const struct mp_pair_table *t, uint32_t a, uint32_t b)
{
	uint32_t i = start(t, a, b);

	for (; t->slot[i] != 0; i = (i + 1) & (t->slots - 1)) {
		const struct mp_body_pair *p = &t->pair[t->slot[i] - 1];

		if (p->body[0] == a && p->body[1] == b)
			break;
	}
	return &t->slot[i];
}

struct mp_body_pair *mp_pair_table_find(const struct mp_pair_table *t, uint32_t a, uint32_t b)
{
	const uint32_t *slot;

	if (t->slots == 0)
		return NULL;
	slot = find_slot(t, a < b ? a : b, a < b ? b : a);
	return *slot != 0 ? &t->pair[*slot - 1] : NULL;
}

/* Slots are at most half full. */
static int grow(struct mp_pair_table *t)
{
	uint32_t slots = t->slots == 0 ? 64 : 2 * t->slots;
	struct mp_body_pair *pair = realloc(t->pair, slots / 2 * sizeof *pair);
	uint32_t *slot = calloc(slots, sizeof *slot);

	if (pair != NULL)
		t->pair = pair;
	if (pair == NULL || slot == NULL) {
		free(slot);
		return -1;
	}
	free(t->slot);
	t->slot = slot;
	t->slots = slots;
	for (uint32_t i = 0; i < t->pairs; i++)
		*find_slot(t, pair[i].body[0], pair[i].body[1]) = i + 1;
	return 0;
}

struct mp_body_pair *mp_pair_table_add(struct mp_pair_table *t, uint32_t a, uint32_t b)
{
	struct mp_body_pair *p = mp_pair_table_find(t, a, b);

	if (p != NULL)
		return p;
	if (t->pairs == MP_MOST_BODY_PAIRS)
		return NULL;
	if (t->pairs == t->slots / 2 && grow(t)) {
		t->nomem = true;
		return NULL;
	}
	assert(t->pair != NULL); /* since the first grow() */
	p = &t->pair[t->pairs];
	*p = (struct mp_body_pair){.body = {a < b ? a : b, a < b ? b : a}};
	*find_slot(t, p->body[0], p->body[1]) = ++t->pairs;
	return p;
}
