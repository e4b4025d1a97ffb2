#ifndef FUZZ_CUT_H
#define FUZZ_CUT_H

#include <stddef.h>
#include <stdint.h>

/*
 * Where a target cuts its input into chunks: drawn from the input itself, so that an input that
 * breaks something always breaks it.
 */
struct cut {
	size_t first, step; /* behind ${first} bytes, then every ${step} >= 1 */
};

/* FNV-1a; its low byte is the weakest. */
static inline uint64_t cut_dice(const uint8_t *data, size_t size)
{
	uint64_t hash = 14695981039346656037u;

	for (size_t i = 0; i < size; i++)
		hash = (hash ^ data[i]) * 1099511628211u;
	return hash >> 8;
}

/*
 * A few chunks; many of at most 8 bytes where the input is short, and of every 64th input, because
 * each is a heap copy of its own and these cost more than all the rest.
 */
static inline struct cut cut_of(uint64_t dice, size_t size)
{
	struct cut c = {(size_t)(dice % (size + 1)), 1 + (size_t)((dice >> 16) % (size + 1))};

	if (size <= 64 || (dice >> 32) % 64 == 0)
		c.step = 1 + (size_t)((dice >> 40) % 8);
	if ((dice >> 44) % 2 == 0)
		c.first = c.step;
	return c;
}

#endif
