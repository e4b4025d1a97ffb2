#ifndef MP_INDEX_H
#define MP_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"
#include "core/topology/topology.h"

/*
 * The same triangles by the vertex numbers of their files: kept while they arrive, counted when
 * all are there, and given back then.  Files may number one place twice (an OBJ file with seams,
 * Draco's edgebreaker), or two places that quantisation moved onto each other.
 */
struct mp_index { /* all 0: nothing has come */
	uint32_t (*tri)[3];
	size_t triangles, room;
	uint32_t base,
	    top;  /* the file in work numbers from ${base} on; all numbers are below top */
	bool off; /* some file numbers no vertices, or too many */
};

/* The checks that depend on how vertices are identified; as in struct mp_topology. */
struct mp_by_index {
	bool given; /* there are such numbers, and something below differs by coordinates */
	bool closed, watertight;
	uint64_t boundary_edges, non_manifold_edges, misoriented_edges;
};

/* As mp_sink.indices. */
int mp_index_add(struct mp_index *, const uint32_t (*tri)[3], size_t count, struct mp_error *err);

/* A file is over and ${triangles} have come of all of them; the next one has its own numbers. */
void mp_index_next(struct mp_index *, size_t triangles);

/*
 * All files are over: what the numbers say of the edges, or given = false where every triangle's
 * vertices are the same by number as by coordinates, or not every triangle has numbers.
 * ${vertices}: how many different coordinates the triangles have.  24 bytes a triangle for a
 * moment where vertices differ; what was kept is given back in any case.
 */
int mp_index_find(struct mp_index *, uint32_t vertices, struct mp_by_index *out,
		  struct mp_error *err);

/* ${by} stays given only if it differs from what was found by coordinates. */
void mp_index_compare(struct mp_by_index *by, const struct mp_topology *topology);

void mp_index_free(struct mp_index *); /* legal on a zeroed struct, and again */

#endif
