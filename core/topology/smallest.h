#ifndef MP_SMALLEST_H
#define MP_SMALLEST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * The ${most} smallest of any number of keys, ascending at the end, in memory for twice as many
 * and O(n log most) time: a buffer that is sorted and halved whenever it is full.
 */
struct mp_smallest {
	uint64_t *key;
	size_t count, room, most;
	bool failed; /* memory was out: what is kept is useless */
};

void mp_smallest_add(struct mp_smallest *, uint64_t key);
int mp_smallest_finish(struct mp_smallest *); /* -1: memory was out */
void mp_smallest_free(struct mp_smallest *);

#endif
