#ifndef MP_PAIR_TABLE_H
#define MP_PAIR_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What is known of pairs of bodies whose surfaces meet. */
struct mp_body_pair {
	uint32_t body[2];     /* ascending */
	uint32_t triangle[2]; /* of the one and of the other: where they meet */
	uint8_t wedge;        /* MP_WEDGE_*, with body[0] as the first */
	bool crossed;         /* surfaces pass through each other at the triangles */
	bool along;           /* they have more than points in common, without that */
	bool unsure;          /* of some of it no wedge could be made */
};

enum { MP_MOST_BODY_PAIRS = 1 << 20 };

/*
 * Pairs by their bodies: open addressing under a multiplicative hash with secret factors
 * (Dietzfelbinger et al. 1997, doi:10.1006/jagm.1997.0873), so that an uploader cannot aim.
 */
struct mp_pair_table {
	struct mp_body_pair *pair; /* in the order they came */
	uint32_t *slot;            /* number + 1 */
	uint32_t pairs, slots;     /* slots: 0 or a power of two */
	uint64_t factor[2];
	bool nomem;
};

void mp_pair_table_begin(struct mp_pair_table *, const uint8_t key[16]);
void mp_pair_table_free(struct mp_pair_table *);

/* NULL: not there.  ${a} and ${b} in any order. */
struct mp_body_pair *mp_pair_table_find(const struct mp_pair_table *, uint32_t a, uint32_t b);

/* NULL: memory is out (nomem), or there are MP_MOST_BODY_PAIRS.  Good until the next call. */
struct mp_body_pair *mp_pair_table_add(struct mp_pair_table *, uint32_t a, uint32_t b);

#endif
