#ifndef MP_RECENT_H
#define MP_RECENT_H

#include <stdbool.h>
#include <stdint.h>

/*
 * The vertices met last, private to the vertex table: in a mesh whose triangles come side by side
 * five of six corners were met a moment ago, and the processor's own cache holds these.  One entry
 * for each value of a plain hash: whoever makes vertices fall together gains nothing but that the
 * table is asked, as it is where no order is: then this switches itself off for a while.
 */
struct mp_recent_entry {
	uint64_t word[3]; /* coordinates without -0, all bits set in an empty entry: not finite */
	uint64_t number;  /* or MP_RECENT_MISSING + place in the batch that is looked up */
};

struct mp_recent { /* all 0 at first */
	struct mp_recent_entry *entry;
	uint32_t pause;                    /* batches for which to leave it alone */
	uint32_t batches, looked, missing; /* since the last judgement */
	bool off;                          /* there was no memory: it is no need */
};

enum { MP_RECENT_BATCH = 192 }; /* corners looked up together at most */

struct mp_recent_batch {
	uint32_t missing; /* how many different corners are not among the recent ones */
	uint32_t place[MP_RECENT_BATCH];  /* of each missing one: its entry */
	uint64_t number[MP_RECENT_BATCH]; /* of each corner, as in an entry */
};

/* Whether to look here at all; says yes and no by turns where little is found. */
bool mp_recent_wanted(struct mp_recent *);

/*
 * Look for ${n} corners.  Those that are missing are left in ${word}[0 .. batch->missing), in
 * order, each value once.
 */
void mp_recent_look(struct mp_recent *, uint64_t (*word)[3], unsigned n, struct mp_recent_batch *);

/* Now they have a ${number}: write those of all ${n} corners to ${out} and remember them. */
void mp_recent_learn(struct mp_recent *, const struct mp_recent_batch *, const uint32_t *number,
		     unsigned n, uint32_t *out);

void mp_recent_free(struct mp_recent *);

#endif
