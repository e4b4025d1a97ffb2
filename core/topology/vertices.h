#ifndef MP_VERTICES_H
#define MP_VERTICES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/decoder.h"
#include "core/error.h"

/*
 * The vertex table: identifies vertices by their coordinates (-0 = +0) while triangles arrive.
 * Vertices are numbered in the order of first appearance.  Open addressing under a hash keyed with
 * ${key} (16 secret random bytes), so that an uploader cannot aim for collisions; memory grows
 * with what has come: coordinates are kept as float32 for as long as all of them are float32
 * values (12 bytes a vertex), else as doubles (24).
 */
struct mp_vertices;

/* NULL with ${err} filled when memory is out. */
struct mp_vertices *mp_vertices_new(const uint8_t key[16], struct mp_error *err);
/* An empty one with the key of ${v}. */
struct mp_vertices *mp_vertices_new_like(const struct mp_vertices *v, struct mp_error *err);
void mp_vertices_free(struct mp_vertices *);

/*
 * Look up or add the 3*count corners of ${tri} (as in struct mp_sink) and write their numbers to
 * ${out}.  -1: memory is out, or more than 2^32 - 2 vertices (MP_LIMIT); the table is then only
 * good for mp_vertices_free().
 */
int mp_vertices_add(struct mp_vertices *, const double (*tri)[9], size_t count, uint32_t (*out)[3],
		    struct mp_error *err);
/* The same of floats as struct mp_sink has them. */
int mp_vertices_add_floats(struct mp_vertices *, const float (*xyz)[MP_BLOCK], size_t count,
			   uint32_t (*out)[3], struct mp_error *err);

/* The same of ${count} points, of which few are expected to repeat one that came just before. */
int mp_vertices_add_points(struct mp_vertices *, const double (*point)[3], size_t count,
			   uint32_t *out, struct mp_error *err);
int mp_vertices_add_float_points(struct mp_vertices *, const float (*point)[3], size_t count,
				 uint32_t *out, struct mp_error *err);

/*
 * ${count} points that are none of the table's, and of which no two are the same, get the next
 * numbers.
 */
int mp_vertices_append(struct mp_vertices *, const float (*point)[3], size_t count,
		       struct mp_error *err);

/*
 * At most ${count} more vertices are to come, which lie in memory already: makes room for them at
 * once, and for what it takes to look them up.  Where they are more, or there is no memory, it
 * grows as before.
 */
void mp_vertices_expect(struct mp_vertices *, uint64_t count, bool look_up);

uint32_t mp_vertices_count(const struct mp_vertices *);

/* Coordinates of vertex ${number} < count. */
void mp_vertices_get(const struct mp_vertices *, uint32_t number, double xyz[3]);

/* The same of the three corners of a triangle. */
void mp_vertices_corners(const struct mp_vertices *, const uint32_t number[3], double xyz[3][3]);

/*
 * All coordinates as they are kept, three a vertex, for loops that look at every one: the floats or
 * the doubles; the other pointer becomes NULL.  One more may be read behind the last, so that the
 * three of a vertex can be had as four.  Good until the next add() or seal().
 */
void mp_vertices_all(const struct mp_vertices *, const float **narrow, const double **wide);

/* A hint that get() of ${number} will follow soon, for walks in no order; changes nothing. */
void mp_vertices_prefetch(const struct mp_vertices *, uint32_t number);
void mp_vertices_prefetch_corners(const struct mp_vertices *, const uint32_t number[3]);

/* Give back the hash index (the larger part); add() is illegal afterwards, get() stays legal. */
void mp_vertices_seal(struct mp_vertices *);

#endif
