#ifndef MP_VERTEX_SLOTS_H
#define MP_VERTEX_SLOTS_H

#include <stdint.h>
#include <stdlib.h>

#include "core/memory/huge.h"

/*
 * The slots of the vertex table, private to it: tag << 32 | number + 1, 0 = empty.  The tag is the
 * hash, its top bits are the place, a whole line of the cache.  Linear probing from the first slot
 * of the line: mostly this one line decides, and all of its slots are compared at once.  Lines are
 * in the order of their tags but for the probing, so doubling the table is one pass over both, in
 * order, that needs no coordinates.
 */
enum { SLOTS_OF_LINE = 8, BYTES_OF_LINE = 64 };

static inline uint64_t home(uint32_t tag, unsigned bits)
{
	return ((uint64_t)tag << 32) >> (64 - bits) & ~(uint64_t)(SLOTS_OF_LINE - 1);
}

/*
 * 1 << ${bits} empty slots, at the begin of a line; *memory is to be freed.  NULL: no memory.
 * calloc() because large ones come as pages that are empty already.
 */
static inline uint64_t *new_slots(unsigned bits, void **memory)
{
	uint64_t count = ((uint64_t)1 << bits) + SLOTS_OF_LINE;

	*memory = count > SIZE_MAX / sizeof count ? NULL : calloc((size_t)count, sizeof count);
	if (mp_huge(*memory, (size_t)(count * sizeof count)) == NULL)
		return NULL;
	return (uint64_t *)(void *)((char *)*memory + (-(uintptr_t)*memory & (BYTES_OF_LINE - 1)));
}

struct mp_slot_corner {
	uint64_t at; /* every slot from its home to here is taken by other tags */
	uint32_t tag;
	uint32_t number; /* the answer */
};

/*
 * For each of ${n} corners find ${at}: the slot with its tag, or the empty one, and ask memory for
 * the coordinates to compare, ${each} bytes a vertex in ${xyz}.  Vertices added later take empty
 * slots only, so a search may go on from there.
 */
void mp_slots_find(const uint64_t *slot, unsigned bits, const void *xyz, size_t each,
		   struct mp_slot_corner *corner, unsigned n);

#endif
