#ifndef MP_POLYGON_SWEEP_H
#define MP_POLYGON_SWEEP_H

#include "core/geometry/predicates.h"
#include "core/obj/polygon_private.h"

/*
 * Triangles by a sweep from left to right (Hertel & Mehlhorn 1983, doi:10.1007/3-540-12689-9_105).
 * The sweep line cuts the inside into intervals.  Each has behind it a chain of corners between
 * which there is no triangle yet, from its lower side to its upper one, bulging to the right;
 * so the corner added last is the rightmost, and any new corner sees that one.
 *
 * "Left of" is: smaller x, or equal x and smaller y.  Points where the boundary touches itself are
 * left to the ear clipping; but a bridge, two edges that are opposite and equal, is taken out, and
 * what was one boundary becomes two.
 */

struct polygon_interval {
	uint32_t lower, upper;     /* its sides, known by the corners where they begin */
	uint32_t head, tail, last; /* of the chain: lower end, upper end, the newest */
	uint32_t small, great;     /* in the tree: what lies below and above */
};

struct polygon_link { /* of a chain */
	uint32_t corner, below, above;
};

struct polygon_sweep {
	uint32_t n;
	double (*xy)[2];
	uint32_t *prev, *next; /* corners; NONE where one was taken out */
	uint32_t *order;       /* from left to right */
	uint32_t *rank;        /* place in ${order} of the first corner that is the same point */
	uint32_t *side_of;     /* of the edge from a corner: the interval, or NONE */
	struct polygon_interval *interval;
	uint32_t intervals, open;
	struct polygon_link *link;
	uint32_t links;
	uint32_t root; /* the tree of lower sides */
	uint32_t (*tri)[3];
	uint32_t done;
	bool failed; /* the boundary touches or crosses itself */
};

/* Fill order and rank and take out what is double; ${room}: 8 bytes a corner, 8-byte aligned. */
void polygon_sweep_sort(struct polygon_sweep *s, void *room);

/* As many intervals at most: each has a corner to begin in and one to end in. */
static inline uint32_t polygon_sweep_intervals(uint32_t n)
{
	return n / 2 + 1;
}

/* Another triangle; one too many is a failure. */
static inline void polygon_sweep_emit(struct polygon_sweep *s, uint32_t a, uint32_t b, uint32_t c)
{
	s->failed = s->failed || s->done == s->n - 2;
	if (s->failed)
		return;
	s->tri[s->done][0] = a;
	s->tri[s->done][1] = b;
	s->tri[s->done++][2] = c;
}

static inline int polygon_sweep_turn(const struct polygon_sweep *s, uint32_t a, uint32_t b,
				     uint32_t c)
{
	return mp_orient2d(s->xy[a], s->xy[b], s->xy[c]);
}

/*
 * The interval whose lower side is the next below the one that begins at ${v}; NONE for none.  It
 * becomes the root, or the root of what is below the root.
 */
uint32_t polygon_sweep_below(struct polygon_sweep *s, uint32_t v);

/* A new interval just above ${below}, which polygon_sweep_below() has just found. */
uint32_t polygon_sweep_open(struct polygon_sweep *s, uint32_t below, uint32_t lower,
			    uint32_t upper);

/* Out of the tree with an interval whose lower side ends at ${v}. */
void polygon_sweep_close(struct polygon_sweep *s, uint32_t old, uint32_t v);

#endif
