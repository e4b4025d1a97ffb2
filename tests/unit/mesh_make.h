#ifndef MESH_MAKE_H
#define MESH_MAKE_H

#include <stddef.h>
#include <stdint.h>

/*
 * Meshes for tests, built in memory, and the files they make.  Everything a function returns is
 * heap memory of exactly the size of its content, so that a sanitizer sees an overread.  Running
 * out of memory ends the test run.
 */
struct mesh {
	double (*tri)[9]; /* ax ay az bx by bz cx cy cz, counter-clockwise seen from outside */
	size_t count, room;
};

void mesh_free(struct mesh *); /* legal on a zeroed struct; zeroes it */

void mesh_triangle(struct mesh *, const double a[3], const double b[3], const double c[3]);
void mesh_quad(struct mesh *, const double a[3], const double b[3], const double c[3],
	       const double d[3]);

/* Appended, wound outward. */
void mesh_box(struct mesh *, const double min[3], const double max[3]); /* 12 triangles */
void mesh_wedge(struct mesh *, double x, double y, double z); /* corners: origin and on the axes */
/* Globe of ${around} meridians and ${up} steps from pole to pole; (around)*(up-1)*2 triangles. */
void mesh_sphere(struct mesh *, double radius, int around, int up);
/* Ring about z; its section is a regular polygon of ${section} corners. */
void mesh_torus(struct mesh *, double ring, double radius, int around, int section);

/* On the triangles from number ${from} on. */
void mesh_flip(struct mesh *, size_t from); /* swaps the second and third corner */
void mesh_move(struct mesh *, size_t from, double x, double y, double z);
void mesh_scale(struct mesh *, size_t from, double x, double y, double z);

/* Binary STL: coordinates as float32, ${header} (NULL: zeros) cut to 80 bytes, true normals. */
uint8_t *mesh_stl_binary(const struct mesh *, const char *header, size_t *size);
/* ASCII STL with 17 digits: every double comes back. */
uint8_t *mesh_stl_ascii(const struct mesh *, const char *name, size_t *size);

#endif
