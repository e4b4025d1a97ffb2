#ifndef MP_INDEX_H
#define MP_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"
#include "core/topology/places.h"
#include "core/topology/topology.h"

/*
 * The vertex numbers of files: a number has one place, so only the first corner with it is looked
 * up by its coordinates.  And what the numbers say of the edges: files may number one place twice
 * (an OBJ file with seams, Draco's edgebreaker), or two places that quantisation moved onto each
 * other.  Numbers are counted in the order in which they come.  For as long as every new one has a
 * new place, that count is the vertex, and nothing has to be kept of the triangles.
 */
struct mp_index { /* all 0: nothing has come */
	/* of each number below ${top} of the file in work, zeroed up to there; room for more */
	uint32_t *vertex; /* + 1, 0 where it has not come */
	uint32_t *count;  /* how many came before it; NULL: the same as its vertex */
	size_t top, room;
	uint32_t numbers;   /* how many came, of all files */
	uint64_t triangles; /* that had numbers; from ${kept_from} on by those counts: */
	uint64_t kept_from;
	uint32_t (*tri)[3];
	size_t tri_room;
	struct mp_places places; /* of the file in work */
	bool off;                /* some file numbers no vertices, or too many */
};

/* The checks that depend on how vertices are identified; as in struct mp_topology. */
struct mp_by_index {
	bool given; /* there are such numbers, and something below differs by coordinates */
	bool closed, watertight;
	uint64_t boundary_edges, non_manifold_edges, misoriented_edges;
};

/*
 * mp_index_add(index, vertices, tri, number, count, out, err):
 * As mp_vertices_add() of ${count} triangles, whose corners have the numbers ${number} in the file
 * in work.  4 bytes for each number up to the largest, which is to be in proportion to the file,
 * and 4 bytes more and 12 a triangle from the first number on whose place had come before.
 */
int mp_index_add(struct mp_index *, struct mp_vertices *, const double (*tri)[9],
		 const uint32_t (*number)[3], size_t count, uint32_t (*out)[3],
		 struct mp_error *err);
/* The same of floats, as mp_vertices_add_floats(). */
int mp_index_add_floats(struct mp_index *, struct mp_vertices *, const float (*xyz)[MP_BLOCK],
			const uint32_t (*number)[3], size_t count, uint32_t (*out)[3],
			struct mp_error *err);

/*
 * The numbers that come next are those of ${points}, and their triangles come as floats: whatever
 * can be found of them at once.  Makes room; where there is no memory, all goes on as without.
 */
void mp_index_expect(struct mp_index *, struct mp_vertices *, const struct mp_points *points);

/* A file is over and ${triangles} have come of all of them; the next one has its own numbers. */
void mp_index_next(struct mp_index *, size_t triangles);

/*
 * All files are over: what the numbers say of the edges, or given = false where every triangle's
 * vertices are the same by number as by coordinates, or not every triangle has numbers.
 * ${tri}: what mp_index_add() wrote of all of them, ${vertices}: how many vertices there are.  24
 * bytes a triangle for a moment where vertices differ; what was kept is given back in any case.
 */
int mp_index_find(struct mp_index *, const uint32_t (*tri)[3], uint32_t vertices,
		  struct mp_by_index *out, struct mp_error *err);

/* ${by} stays given only if it differs from what was found by coordinates. */
void mp_index_compare(struct mp_by_index *by, const struct mp_topology *topology);

void mp_index_free(struct mp_index *); /* legal on a zeroed struct, and again */

#endif
