#ifndef MP_WELD_H
#define MP_WELD_H

#include "core/repair/cluster.h"

struct mp_weld {
	uint64_t went; /* vertices that are no longer used, another having taken their place */
	bool complete; /* false: the work limit was reached, some near pair may be apart */
};

/*
 * mp_weld(vertices, map, tri, triangles, distance, key, out, err):
 * Vertices that hang together by steps shorter than ${distance} [L] > 0, when mapped unless ${map}
 * is NULL, become one, at the lexicographically smallest of their places: ${tri} is renumbered,
 * ${vertices} stays (some of it is unused then).  Neither the order of triangles nor of their
 * corners changes where anything ends up.  -1: memory is out, ${tri} is unchanged.
 */
int mp_weld(const struct mp_vertices *vertices, const struct mp_affine *map, uint32_t (*tri)[3],
	    uint32_t triangles, double distance, const uint8_t key[16], struct mp_weld *out,
	    struct mp_error *err);

#endif
