#ifndef MP_CONTAINMENT_H
#define MP_CONTAINMENT_H

#include "core/bodies/kdtree.h"
#include "core/topology/topology.h"

/* Which of many bodies lie inside one closed body: the geometry behind mp_nesting_find(). */

enum mp_place {
	MP_PLACE_PENDING,
	MP_PLACE_OUTSIDE,
	MP_PLACE_INSIDE,
	MP_PLACE_ON /* every vertex lies on the surface */
};

struct mp_candidate {
	uint32_t body;
	uint32_t tried; /* corners that turned out to lie on the surface */
	enum mp_place place;
};

struct mp_probe; /* one corner of a candidate */

struct mp_containment {
	const struct mp_mesh *mesh;
	const uint32_t *row; /* the triangles of body b: list[row[b] .. row[b + 1]) */
	uint32_t *list;
	uint64_t *arranged; /* a bit for each body whose triangles are in order */
	uint64_t *key;      /* to put them there */
	struct mp_probe *probe;
	struct mp_kd_point *tree;
	uint64_t steps; /* what is left of the work limit: the caller's to set */
};

/*
 * -1: memory is out, and nothing to end.  ${row} and ${list} are kept by pointer; the triangles of
 * each body are then put into another order.
 */
int mp_containment_begin(struct mp_containment *, const struct mp_mesh *, const uint32_t *row,
			 uint32_t *list, uint32_t bodies);
void mp_containment_end(struct mp_containment *); /* legal on a zeroed struct */

/* Fill place of ${n} candidates (body given, the rest zero); -1: the work limit was reached. */
int mp_containment_judge(struct mp_containment *, uint32_t container, struct mp_candidate *,
			 size_t n);

struct mp_corners {
	double p[3][3];
};

/* Whether ${p} lies on the closed triangle, edges and corners included; exact. */
bool mp_on_triangle(const struct mp_corners *tri, const double p[3]);

/*
 * What the triangle adds to the winding number at ${p}, which is not on it: the sign with which
 * the ray from p along +x crosses it, 0 for none.  Exact.  A ray through edges or corners counts
 * as the one that begins at p + (0, e, e^2) for every e small enough would.
 */
int mp_ray_crossing(const struct mp_corners *tri, const double p[3]);

#endif
