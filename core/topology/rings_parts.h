#ifndef MP_RINGS_PARTS_H
#define MP_RINGS_PARTS_H

#include <stdatomic.h>

#include "core/topology/ring_window.h"
#include "core/topology/rings.h"

/*
 * Private to rings.c and rings_far.c.  The work is done window by window of vertices, so that the
 * links in work stay in a cache; by two sides where there is a second thread.
 */
enum { MP_RINGS_BLOCK = 1024 /* triangles */ };

struct mp_rings_span {
	uint32_t min, max; /* windows of a block's vertices */
};

struct mp_rings_place {
	uint64_t next, step; /* where its next link goes; 1, or 0 if it is not wanted now */
};

struct mp_rings_look;

struct mp_rings_side { /* what one thread has to itself */
	struct mp_rings_look *look;
	uint32_t begin, end; /* its half of the blocks */
	struct mp_ring_window w;
	uint64_t visits; /* how often its blocks would be read, were they read for each window */
	uint64_t used, corners;       /* of its windows: vertices with links; links */
	uint64_t *links;              /* of its blocks, by window: how many */
	struct mp_rings_place *place; /* far: of each window */
	int good;                     /* as mp_rings_find() */
};

struct mp_rings_look {
	struct mp_rings *r;
	struct mp_rings_side side[2];
	unsigned sides;             /* 1 or 2 */
	uint32_t window;            /* vertices of each but the last, a power of two */
	unsigned shift;             /* its logarithm */
	size_t windows;             /* how many */
	struct mp_rings_span *span; /* of every block */
	uint32_t blocks;            /* how many */
	uint32_t *block; /* near: those of window i are block[first[i]] .. block[first[i + 1]] */
	uint64_t *first; /* far: those of window i end at first[i + 1] of links */
	void *link;      /* far: those of windows from .. to - 1, in order */
	size_t from, to;
	bool wide; /* as struct mp_ring_link, else narrow: rings_far.c */
	/* Windows next .. end - 1 are for whoever is free, until one of them is bad. */
	atomic_size_t next;
	size_t end;
	atomic_bool over;
	void (*add)(struct mp_rings_side *, size_t window); /* all of its links */
};

/* work(side) for each of them, beside each other. */
void mp_rings_share(struct mp_rings_look *, void (*work)(void *side));

/* Windows ${from} .. ${to} - 1: 1 if all are good, 0 or -1 as mp_rings_find(). */
int mp_rings_look_at(struct mp_rings_look *, size_t from, size_t to,
		     void (*add)(struct mp_rings_side *, size_t window));

/* Count the links of block ${b} in side->links. */
void mp_rings_count(struct mp_rings_side *, uint32_t b);

/* rings_far.c: triangles in no order; as mp_rings_find(). */
int mp_rings_look_far(struct mp_rings_look *);

static inline uint32_t mp_rings_block_end(const struct mp_rings *r, uint32_t block)
{
	uint32_t left = r->mesh->triangles - block * MP_RINGS_BLOCK;

	return block * MP_RINGS_BLOCK + (left < MP_RINGS_BLOCK ? left : MP_RINGS_BLOCK);
}

#endif
