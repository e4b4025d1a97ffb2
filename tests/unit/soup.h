#ifndef SOUP_H
#define SOUP_H

#include "core/bodies/nesting.h"
#include "core/topology/topology.h"

/* Triangles to test with, and the mesh that the vertex table makes of them. */

struct soup {
	double (*tri)[9];
	size_t count, room;
};

void soup_add(struct soup *, const double a[3], const double b[3], const double c[3]);
void soup_copy(struct soup *, const struct soup *from, double scale, const double shift[3]);
void soup_drop(struct soup *, size_t triangle); /* the last takes its place */
void soup_flip(struct soup *, size_t triangle);
/* Each of the triangles from ${first} on in four, on the same surface. */
void soup_divide(struct soup *, size_t first);
void soup_free(struct soup *);

/* An axis-parallel box of 12 triangles; the diagonals of opposite faces are parallel. */
void soup_box(struct soup *, const double min[3], const double max[3]);
void soup_cube(struct soup *, double x, double y, double z, double size);
void soup_tetrahedron(struct soup *, double x, double y, double z, double size);
/* Around z, winding outward: 2 * n * m triangles on n * m vertices. */
void soup_torus(struct soup *, unsigned n, unsigned m, double large, double small);
/* The side of a prism of n corners from z = 0 to z = 1, without caps. */
void soup_tube(struct soup *, unsigned n, double radius);

/* Everything known of where what is: a sequence that is the same in every run. */
uint64_t soup_random(uint64_t *state);
void soup_shuffle(struct soup *, uint64_t *state); /* the triangles, and the corners of each */

struct built {
	struct mp_vertices *vertices;
	uint32_t (*tri)[3];
	struct mp_mesh mesh;
};

/* -1 when memory is out; ${key} makes the hash key. */
int soup_build(const struct soup *, uint64_t key, struct built *, struct mp_error *);
void built_free(struct built *);

/* A mesh and what was found of it; zero but for the soup at first. */
struct found {
	struct soup soup;
	struct built built;
	struct mp_topology t;
};
void found_look(struct found *, uint32_t most); /* build and mp_topology_find() */
void found_free(struct found *);
/* Of each body; every triangle must have edges. */
void found_boxes(const struct found *, struct mp_box *);

/* Two pyramids over the polygon of ${n} corners around (x, 0, 0): two vertices of ${n} triangles.
 */
void soup_bipyramid(struct soup *s, unsigned n, double x);

#endif
