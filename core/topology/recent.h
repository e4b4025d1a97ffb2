#ifndef MP_RECENT_H
#define MP_RECENT_H

#include <stdbool.h>
#include <stdint.h>

/*
 * The vertices met last, private to the vertex table: in a mesh whose triangles come side by side
 * five of six corners were met a moment ago, and the processor's own cache holds these.  One entry
 * for each value of a plain hash: whoever makes vertices fall together gains nothing but that the
 * table is asked, as it is where no order is: then this switches itself off for a while.
 *
 * An entry has the words of a vertex (vertex_bits.h) and its number, or MP_RECENT_MISSING + its
 * place in the batch that is looked up; all bits are set in an empty one: no finite coordinates.
 * Floats: two words, the number above the second float of the second word; doubles: four words.
 */
struct mp_recent { /* all 0 at first */
	uint64_t *entry;
	bool wide;                         /* what the entries are of */
	uint32_t pause;                    /* batches for which to leave it alone */
	uint32_t batches, looked, missing; /* since the last judgement */
	bool off;                          /* there was no memory: it is no need */
};

enum { MP_RECENT_BATCH = 192 };              /* corners looked up together at most */
#define MP_RECENT_MISSING (UINT32_MAX - 255) /* and above: no numbers of vertices */

struct mp_recent_batch {
	uint32_t missing; /* how many different corners are not among the recent ones */
	uint32_t place[MP_RECENT_BATCH];  /* of each missing one: its entry */
	uint32_t number[MP_RECENT_BATCH]; /* of each corner, as in an entry */
};

/* Whether to look here at all; says yes and no by turns where little is found. */
bool mp_recent_wanted(struct mp_recent *, bool wide);

/*
 * Look for ${n} corners without -0, floats or the bits of doubles, whichever were wanted.  Those
 * that are missing are left in front, ${batch}->missing of them, in order, each value once.
 */
void mp_recent_look_narrow(struct mp_recent *, float (*key)[3], unsigned n,
			   struct mp_recent_batch *);
void mp_recent_look_wide(struct mp_recent *, uint64_t (*key)[3], unsigned n,
			 struct mp_recent_batch *);

/* Now they have a ${number}: write those of all ${n} corners to ${out} and remember them. */
void mp_recent_learn(struct mp_recent *, const struct mp_recent_batch *, const uint32_t *number,
		     unsigned n, uint32_t *out);

void mp_recent_free(struct mp_recent *);

#endif
