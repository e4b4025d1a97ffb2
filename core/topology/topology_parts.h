#ifndef MP_TOPOLOGY_PARTS_H
#define MP_TOPOLOGY_PARTS_H

#include "core/topology/edges.h"
#include "core/topology/smallest.h"

/*
 * The algorithms behind mp_topology_find(), one a file, in the order in which it calls them.
 * Each fills its fields of ${out}, lists at most ${most} defects of its kinds, and returns 0, or
 * -1 when memory is out; what ${out} holds then is freed by the caller.
 */

/* degenerate.c: triangles of zero area, by index or by exact collinearity. */
int mp_degenerate_find(const struct mp_mesh *, uint32_t most, struct mp_topology *out);

/*
 * manifold.c: the short way.  Where every edge is used once in each direction, every vertex has one
 * fan and no triangle repeats another, this fills everything below but euler; else ${*good} is
 * false and nothing is filled; so it may be, too, where most corners are at vertices of more than 8
 * triangles.  4 bytes a vertex, those of a window (of two, if mesh->second shares the work), those
 * of
 * ${links} corners, half of all if that is more, where the triangles are in no order, and 4 a
 * triangle besides.
 */
struct mp_manifold_room {
	uint32_t
	    vertices; /* of a window, a power of two: 65 bytes each should have place in a cache */
	uint32_t links; /* sorted at a time, 8 bytes each; 12 where there are many vertices */
	uint32_t alone; /* most triangles that are not worth waking the second thread for */
};
int mp_manifold_find(const struct mp_mesh *, const struct mp_manifold_room *,
		     struct mp_topology *out, bool *good);

/* components.c: body_of, bodies and what each body's edges are; also the counts of all edges. */
int mp_bodies_find(const struct mp_mesh *, const struct mp_edges *, struct mp_topology *out);

/* fans.c: vertices, non-manifold vertices. */
int mp_fans_find(const struct mp_mesh *, const struct mp_edges *, uint32_t most,
		 struct mp_topology *out);

/*
 * Of the triangles that have others on the same corners: a bit for each that has an opposite one,
 * and for each that is not needed when they count once, or where as many go each way not at all.
 * Both NULL: none has.
 */
struct mp_repeats {
	uint64_t *paired, *spare;
};

/* duplicates.c; ${repeats} is for the caller to free, after a failure too. */
int mp_duplicates_find(const struct mp_mesh *, const struct mp_edges *, uint32_t most,
		       struct mp_repeats *repeats, struct mp_topology *out);

/*
 * walls.c: what divides the inside.  double_walls: connected groups of paired triangles that hang
 * on other triangles, two or more at each edge of their rim (an edge of one pair alone is free, one
 * with a single other triangle the edge of a hole).  single_walls: connected
 * groups of edges that are used 3, 5, ... times where no sheet that meets there has a boundary
 * edge; a sheet is what hangs together across edges used twice.  There spare triangles are left
 * out.
 */
int mp_walls_find(const struct mp_mesh *, const struct mp_edges *, const struct mp_repeats *,
		  struct mp_topology *out);

/* bad_edges.c: lists of non-manifold and misoriented edges, which mp_bodies_find() counted. */
int mp_bad_edges_list(const struct mp_mesh *, const struct mp_edges *, uint32_t most,
		      struct mp_topology *out);

/*
 * cracks.c: cracks_only of the mesh and of each body.  ${gap}: bits, set for the vertices at which
 * the boundary does not cancel.
 */
int mp_cracks_find(const struct mp_mesh *, const struct mp_edges *, uint64_t *gap,
		   struct mp_topology *out);

/* A total order of the lines through ${m}, of which ${p} and ${q} are other points; exact. */
int mp_compare_lines(const double m[3], const double p[3], const double q[3]);

/* loops.c: boundary edges and loops; ${gap} from cracks.c. */
int mp_loops_find(const struct mp_mesh *, const struct mp_edges *, uint32_t most,
		  const uint64_t *gap, struct mp_topology *out);

/*
 * Disjoint sets ${parent} of the vertices on the boundary half-edges ${bit}: one a loop,
 * UINT32_MAX for other vertices.  Returns how many loops there are.
 */
uint64_t mp_loops_join(const struct mp_mesh *, const uint64_t *bit, uint32_t *parent);

/*
 * loop_list.c: place the ${items} loops of smallest half-edge.  ${bit}: the boundary half-edges;
 * ${parent}: as mp_loops_join() left it.
 */
int mp_loops_list(const struct mp_mesh *, const uint64_t *bit, const uint64_t *gap,
		  uint32_t *parent, size_t items, struct mp_topology *out);

/* The first bit of ${bit}[0 .. n) at ${from} or above, n for none. */
size_t mp_bit_next(const uint64_t *bit, size_t n, size_t from);

/*
 * defects.c: memory for ${items} defects that name so many triangles and vertices in total, then
 * one call for each of them in order.
 */
int mp_defects_begin(struct mp_defect_list *, size_t items, size_t triangles, size_t vertices);
void mp_defects_add(struct mp_defect_list *, const uint32_t *triangles, size_t triangle_count,
		    const uint32_t *vertices, size_t vertex_count);
void mp_defects_free(struct mp_defect_list *);

#endif
