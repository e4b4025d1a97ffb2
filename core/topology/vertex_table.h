#ifndef MP_VERTEX_TABLE_H
#define MP_VERTEX_TABLE_H

#include <stdbool.h>

#include "core/topology/recent.h"
#include "core/topology/vertex_bits.h"
#include "core/topology/vertex_slots.h"
#include "core/topology/vertices.h"

/* What the vertex table is made of and how it gets more memory, private to it. */
struct mp_vertices {
	uint64_t key[6];
	void *memory;   /* where slot lies */
	uint64_t *slot; /* 1 << bits of them, from the begin of a line */
	unsigned bits;
	uint32_t count;
	uint32_t
	    hashed;    /* of them that have a slot; the rest get one before anything is looked up */
	uint64_t room; /* vertices that xyz has memory for */
	bool wide;     /* xyz holds doubles, else floats */
	void *xyz;     /* 3 * count coordinates */
	struct mp_recent recent;
};

/*
 * Make room for ${extra} more vertices, so that nothing moves while a batch is looked up, and give
 * all there are a slot.
 */
int mp_table_reserve(struct mp_vertices *, unsigned extra, struct mp_error *);

/* Memory for the coordinates of ${want} vertices in all, and some more; for just ${room}. */
int mp_table_reserve_xyz(struct mp_vertices *, uint64_t want, struct mp_error *);
int mp_table_resize(struct mp_vertices *, uint64_t room, bool wide, struct mp_error *);

/* Slots for ${vertices} at once. */
int mp_table_expect(struct mp_vertices *, uint64_t vertices, struct mp_error *);

/* After mp_table_reserve(): from floats to doubles, in place from the end.  Numbers stay as they
 * are. */
int mp_table_widen(struct mp_vertices *, struct mp_error *);

#endif
