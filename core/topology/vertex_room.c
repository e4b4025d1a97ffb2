#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/topology/vertex_bits.h"
#include "core/topology/vertex_slots.h"
#include "core/topology/vertex_table.h"

static int grow_slots(struct mp_vertices *v, unsigned bits, struct mp_error *err)
{
	uint64_t old = (uint64_t)1 << v->bits, mask = ((uint64_t)1 << bits) - 1;
	void *memory;
	uint64_t *slot = new_slots(bits, &memory);

	if (slot == NULL)
		return mp_fail_nomem(err);
	for (uint64_t i = 0; i < old; i++) {
		uint64_t at;

		if (v->slot[i] == 0)
			continue;
		at = home((uint32_t)(v->slot[i] >> 32), bits);
		while (slot[at] != 0)
			at = (at + 1) & mask;
		slot[at] = v->slot[i];
	}
	free(v->memory);
	v->memory = memory;
	v->slot = slot;
	v->bits = bits;
	return 0;
}

int mp_table_resize(struct mp_vertices *v, uint64_t room, bool wide, struct mp_error *err)
{
	uint64_t each = 3 * (wide ? sizeof(double) : sizeof(float));
	size_t bytes, used = 3 * (size_t)v->count * (v->wide ? sizeof(double) : sizeof(float));
	bool shrinks = room <= v->room && wide == v->wide;
	void *p;

	if (room > SIZE_MAX / each - 1)
		return mp_fail_nomem(err);
	bytes = (size_t)(room * each) + sizeof(double); /* one behind: vertices.h */
	p = shrinks ? realloc(v->xyz, bytes) : mp_huge_grow(v->xyz, used, bytes);
	if (p == NULL)
		return mp_fail_nomem(err);
	v->xyz = p;
	v->room = room;
	return 0;
}

/* Those that have no slot yet, of which there are enough. */
static void hash_rest(struct mp_vertices *v)
{
	uint64_t mask = ((uint64_t)1 << v->bits) - 1;
	size_t each = 3 * (v->wide ? sizeof(double) : sizeof(float));

	for (; v->hashed < v->count; v->hashed++) {
		uint32_t tag = hash(v->key, v->wide, (const char *)v->xyz + v->hashed * each);
		uint64_t at = home(tag, v->bits);

		while (v->slot[at] != 0)
			at = (at + 1) & mask;
		v->slot[at] = (uint64_t)tag << 32 | (v->hashed + 1);
	}
}

int mp_table_widen(struct mp_vertices *v, struct mp_error *err)
{
	unsigned char *bytes;

	if (v->room > 0 && mp_table_resize(v, v->room, true, err))
		return -1;
	bytes = v->xyz;
	for (size_t i = 3 * (size_t)v->count; i-- > 0;) {
		float narrow;
		double x;

		memcpy(&narrow, bytes + i * sizeof narrow, sizeof narrow);
		x = (double)narrow;
		memcpy(bytes + i * sizeof x, &x, sizeof x);
	}
	v->wide = true;
	/* doubles have other hashes than floats: all slots anew, in memory that was there before */
	memset(v->slot, 0, sizeof *v->slot << v->bits);
	v->hashed = 0;
	hash_rest(v);
	return 0;
}

/* At most 5 of 8 slots are taken: a miss looks at 4 slots on average, a hit at 2. */
static bool is_full(unsigned bits, uint64_t vertices)
{
	return vertices > ((uint64_t)5 << bits) / 8;
}

int mp_table_reserve_xyz(struct mp_vertices *v, uint64_t want, struct mp_error *err)
{
	return want > v->room ? mp_table_resize(v, want + want / 2, v->wide, err) : 0;
}

int mp_table_reserve(struct mp_vertices *v, unsigned extra, struct mp_error *err)
{
	uint64_t want = (uint64_t)v->count + extra;

	while (is_full(v->bits, want))
		if (grow_slots(v, v->bits + 1, err))
			return -1;
	hash_rest(v);
	return mp_table_reserve_xyz(v, want, err);
}

int mp_table_expect(struct mp_vertices *v, uint64_t vertices, struct mp_error *err)
{
	unsigned bits = v->bits;

	while (is_full(bits, vertices))
		bits++;
	return bits > v->bits ? grow_slots(v, bits, err) : 0;
}
