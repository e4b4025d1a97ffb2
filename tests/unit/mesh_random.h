#ifndef MESH_RANDOM_H
#define MESH_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

#include "tests/unit/mesh_make.h"

/*
 * Random closed meshes of 4 to a few hundred triangles: boxes, wedges, globes and rings whose
 * vertices are displaced, bent into needles and plates, turned, scaled by anything from
 * micrometres in gigametres to the ends of float32, moved far from the origin, inside out, several
 * in or beside each other, thrice the same.  A vertex is moved by what depends on its place alone,
 * so that what was closed stays so.
 */
struct random_mesh {
	struct mesh mesh;
	bool narrow; /* every coordinate is a float32 value */
};

/* The same for the same ${state}, which is changed.  mesh_free() it. */
void mesh_random(struct random_mesh *, uint64_t *state);

/* Two displaced boxes apart from each other, outward, of 12 triangles each. */
void mesh_random_boxes(struct random_mesh *, uint64_t *state);

uint64_t random_bits(uint64_t *state);                           /* splitmix64 */
double random_between(uint64_t *state, double low, double high); /* uniform */
bool random_chance(uint64_t *state, double chance);

#endif
