#ifndef MP_INTERSECT_PARTS_H
#define MP_INTERSECT_PARTS_H

#include "core/intersect/bvh.h"
#include "core/intersect/intersect.h"
#include "core/intersect/tri_pair.h"

/* What mp_self_intersections() and mp_overlapping_bodies() share. */

void mp_tri_load(const struct mp_mesh *, uint32_t triangle, struct mp_tri *out);

/* Steps for a mesh: so many and so many per triangle, up to a limit. */
struct mp_work mp_work_for(const struct mp_mesh *, uint64_t steps, uint64_t per_triangle,
			   uint64_t most);

/*
 * A hierarchy of the triangles that have an area and that ${wanted} (NULL: all) wants, by body.
 * Where one is left out because it has no area, flat[body] is set (NULL: not asked).  More than
 * MP_MOST_IN_BVH (about 500 MB) are too many: then it is empty and no work is left.
 */
enum { MP_MOST_IN_BVH = 8000000 };
struct mp_triangle_filter {
	const void *self;
	bool (*wanted)(const void *self, uint32_t body, const struct mp_tri *);
};
int mp_bvh_of_triangles(const struct mp_mesh *, const struct mp_topology *,
			const struct mp_triangle_filter *, bool *flat, struct mp_work *,
			struct mp_bvh *out, struct mp_error *err);

/* Locate the ${count} pairs, smaller triangle << 32 | larger, ascending. */
int mp_crossings_locate(const struct mp_mesh *, const uint64_t *pair, size_t count,
			struct mp_crossings *out, struct mp_error *err);

#endif
