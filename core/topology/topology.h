#ifndef MP_TOPOLOGY_H
#define MP_TOPOLOGY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/decoder.h"
#include "core/error.h"
#include "core/second.h"
#include "core/topology/vertices.h"

struct mp_affine;

/*
 * The triangles around ${count} vertices from ${first} on: a link is the corner behind the vertex
 * << 32 | the one before it.  Those of vertex first + i are link[row[i] - row[0]] and on, as many
 * as row[i + 1] - row[i]; in the order of the triangles.
 */
struct mp_links {
	uint32_t first, count;
	const uint32_t *row; /* count + 1 */
	const uint64_t *link;
};

/*
 * Is shown the links of vertices by those who have them in a cache, window by window of
 * MP_LINKS_WINDOW: those of window i begin with number i * MP_LINKS_WINDOW and come ascending and
 * each once, windows in any order and two of them beside each other.
 */
#define MP_LINKS_WINDOW (1 << 14)
struct mp_links_sink {
	int (*begin)(void *self, size_t windows); /* so many; -1: no memory, and no end() */
	void (*take)(void *self, size_t window, const struct mp_links *);
	void (*end)(void *self, bool all); /* of the windows: else not worth keeping */
	void *self;
};

struct mp_mesh {
	const struct mp_vertices *vertices;
	const uint32_t (*tri)[3]; /* vertex numbers, each < mp_vertices_count(vertices) */
	uint32_t triangles;
	/*
	 * NULL, or what mp_flat_mark() said of exactly these triangles while they came; whoever
	 * moves vertices or makes one of several leaves it NULL.
	 */
	const uint64_t *flat;
	const struct mp_affine *map; /* what loops and caps are measured under, NULL for nothing */
	/*
	 * NULL, or who is shown links by mp_topology_find(): those of all vertices if every edge is
	 * used once each way and every vertex has one fan, else maybe of some.
	 */
	const struct mp_links_sink *watcher;
	const struct mp_second *second; /* NULL, or who shares the work */
};

/*
 * mp_flat_mark(tri, count, first, flat):
 * Set bit t/MP_FLAT_GROUP of ${flat} wherever one of the ${count} triangles ${tri} (as in struct
 * mp_sink), which are numbered ${first} and on, may be degenerate; where no bit is set none is.
 */
enum { MP_FLAT_GROUP = 64 };
void mp_flat_mark(const double (*tri)[9], size_t count, uint64_t first, uint64_t *flat);
/* The same of floats as struct mp_sink has them; and by a kernel: 0 the plain one, best one last.
 */
void mp_flat_mark_floats(const float (*xyz)[MP_BLOCK], size_t count, uint64_t first,
			 uint64_t *flat);
size_t mp_flat_kernels(void);
void mp_flat_mark_with(size_t kernel, const float (*xyz)[MP_BLOCK], size_t count, uint64_t first,
		       uint64_t *flat);

#define MP_NO_BODY UINT32_MAX

/*
 * Defects with their places.  Item i names triangles[triangle_at[i] .. triangle_at[i+1]) and
 * vertices [vertex_at[i] .. vertex_at[i+1]).  Both *_at arrays have count + 1 entries.
 */
struct mp_defect_list {
	size_t count;
	size_t *triangle_at, *vertex_at; /* owned: triangle_at, the others lie behind it */
	uint32_t *triangles;             /* file order numbers, ascending within an item */
	uint32_t *vertices;              /* vertex numbers of the mesh */
};

enum mp_defect_kind {
	MP_DEFECT_BOUNDARY_EDGE, /* the triangle; both ends, in its direction */
	MP_DEFECT_BOUNDARY_LOOP, /* triangles along it; vertices in order where it is a circle */
	MP_DEFECT_NON_MANIFOLD_EDGE,   /* all its triangles; both ends, smaller number first */
	MP_DEFECT_NON_MANIFOLD_VERTEX, /* all its triangles; the vertex */
	MP_DEFECT_MISORIENTED_EDGE,    /* both triangles; both ends, in their common direction */
	MP_DEFECT_DEGENERATE_TRIANGLE, /* the triangle; its corners */
	MP_DEFECT_DUPLICATE_TRIANGLE,  /* the earliest one and this one; its corners */
	MP_DEFECT_KINDS
};

enum { MP_DEFECT_TRIANGLES = 64, MP_DEFECT_VERTICES = 1024 }; /* most listed for one defect */

/* Are two triangles with the same three corners wound the same way? */
static inline bool mp_same_winding(const uint32_t a[3], const uint32_t b[3])
{
	return (a[0] == b[0] && a[1] == b[1]) || (a[0] == b[1] && a[1] == b[2]) ||
	       (a[0] == b[2] && a[1] == b[0]);
}

struct mp_body_topology {
	uint32_t first;     /* its smallest triangle number */
	uint32_t triangles; /* how many */
	uint64_t boundary_edges, non_manifold_edges, misoriented_edges;
	bool closed;      /* every edge is used equally often both ways */
	bool cracks_only; /* not closed, but the signed boundary is zero as a geometric current */
	bool watertight;  /* every edge is used exactly twice */
	uint64_t fans;    /* of triangles around vertices: its vertices, but where it is pinched */
	bool pinched;     /* some vertex has several of its fans */
	bool one_sided;   /* no winding of it is consistent; mp_repair_judge() finds out */
};

/*
 * Its genus, the number of its handles: (2 - V + E - F)/2.  -1 where it has none: it is not closed
 * and manifold, or it is one_sided.
 */
int64_t mp_body_genus(const struct mp_body_topology *);

/*
 * What a listed boundary loop is, measured over all of it, however few of its vertices are listed.
 * A length or area that no double holds is not defined, and 0.
 */
struct mp_loop {
	uint64_t edges, vertices;
	double min[3], max[3]; /* its box [L]; no -0 */
	double length;         /* of all its edges [L] */
	/*
	 * Of the fan that closes it, as a vector: |sum p x q|/2 over its edges p to q [L^2].  For a
	 * planar loop what it encloses.  Not defined where it neither is a circle nor runs
	 * through each of its vertices as often inward as outward.
	 */
	double area;
	/*
	 * The largest distance of its vertices from the plane through their mean at right angles to
	 * the vector area [L].  Not defined without a plane: area 0 or not defined.
	 */
	double plane_deviation;
	bool length_defined, area_defined, plane_defined;
	bool simple; /* one circle: two of its edges at each of its vertices */
	bool planar; /* a crack, or plane_deviation <= 2^-23 times the largest |coordinate| */
	bool crack;  /* its edges cancel on every line: no gap between them, area 0 */
	size_t junction_at, junctions; /* junction[junction_at .. + junctions) */
};

/* ${vertex} lies between the ends of a boundary edge of its own loop, on it. */
struct mp_junction {
	uint32_t vertex, ends[2];
};

/* Definitions: the signed and unsigned use counts of edges, see the README's table of checks. */
struct mp_topology {
	uint64_t vertices;     /* distinct vertices that a triangle with edges uses */
	uint64_t edges, faces; /* faces: triangles with three different corners */
	int64_t euler;         /* vertices - edges + faces */
	uint64_t boundary_edges, boundary_loops, non_manifold_edges, misoriented_edges;
	uint64_t unbalanced_edges; /* used more than once, and not equally often both ways */
	uint64_t non_manifold_vertices, degenerate_triangles, duplicate_triangles;
	uint64_t
	    opposite_duplicates; /* pairs of them that cancel: of p one way, q other, min(p, q) */
	uint64_t double_walls, single_walls; /* walls.c */
	bool closed, cracks_only, watertight, winding_consistent;
	uint32_t bodies;
	struct mp_body_topology *body; /* ${bodies} of them, by smallest triangle number */
	uint32_t *body_of;             /* per triangle; MP_NO_BODY where it has no edges */
	struct mp_defect_list defect[MP_DEFECT_KINDS]; /* each kind by smallest triangle number */
	struct mp_loop *loop;         /* as many as defect[MP_DEFECT_BOUNDARY_LOOP] lists */
	struct mp_junction *junction; /* by loop; MP_DEFECT_TRIANGLES of a loop at most */
	uint64_t *boundary;           /* bit per half-edge (edges.h): used once; NULL for none */
	bool truncated; /* some defect is not listed, or not all of its triangles or vertices */
};

/*
 * mp_topology_find(mesh, most, out, err):
 * Edges, vertex fans, boundary loops, bodies and defects of ${mesh}; lists at most ${most} defects
 * a kind.  O(n log n) time whatever the mesh; about 40 bytes a triangle beside it.  ${out} owns
 * its arrays, mp_topology_free() gives them back (legal on a zeroed struct).  Return 0, or -1
 * with nothing to free.
 */
int mp_topology_find(const struct mp_mesh *mesh, uint32_t most, struct mp_topology *out,
		     struct mp_error *err);
void mp_topology_free(struct mp_topology *);

#endif
