#ifndef MP_EDGES_H
#define MP_EDGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/topology/topology.h"

/*
 * The edges of a mesh, private to the topology.  Half-edge 3*t + k runs from corner k of triangle
 * t to the next.  ${use} lists all half-edges of triangles with three different corners, sorted
 * by (smaller vertex, larger vertex, half-edge), so the uses of an edge are neighbours.  An entry
 * is half-edge << 2 | MP_USE_BACK (it runs from the larger vertex) | MP_USE_FIRST (of its edge).
 */
struct mp_edges {
	uint32_t *use; /* count of them and a last one with MP_USE_FIRST, where loops end */
	size_t count;
};

#define MP_USE_FIRST      1u
#define MP_USE_BACK       2u
#define MP_MOST_TRIANGLES (UINT32_MAX / 12) /* 3 * t << 2 fits 32 bits */

/* 0, or -1 with nothing to free.  24 bytes a triangle for a moment, then 12. */
int mp_edges_build(const struct mp_mesh *mesh, struct mp_edges *out, struct mp_error *err);
void mp_edges_free(struct mp_edges *);

/* Behind the last use of the edge whose first is ${i} < count. */
static inline size_t mp_edges_end(const struct mp_edges *e, size_t i)
{
	do
		i++;
	while (!(e->use[i] & MP_USE_FIRST));
	return i;
}

static inline uint32_t mp_use_half(uint32_t use)
{
	return use >> 2;
}

static inline uint32_t mp_use_triangle(uint32_t use)
{
	return (use >> 2) / 3;
}

static inline uint32_t mp_half_next(uint32_t half)
{
	return half % 3 == 2 ? half - 2 : half + 1;
}

/* The half-edge, which is also its corner, at which the smaller or larger vertex of the edge is. */
static inline uint32_t mp_use_corner(uint32_t use, bool larger)
{
	uint32_t half = mp_use_half(use);

	return ((use & MP_USE_BACK) != 0) != larger ? mp_half_next(half) : half;
}

static inline uint32_t mp_corner_vertex(const struct mp_mesh *mesh, uint32_t corner)
{
	return mesh->tri[corner / 3][corner % 3];
}

/* Three different corners: such a triangle has edges. */
static inline bool mp_has_edges(const uint32_t tri[3])
{
	return tri[0] != tri[1] && tri[1] != tri[2] && tri[2] != tri[0];
}

#endif
