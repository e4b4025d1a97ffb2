#ifndef MP_PLACES_H
#define MP_PLACES_H

#include <stdbool.h>

#include "core/topology/vertices.h"

/*
 * Where all points of a file lie in memory before the first triangle comes, what is to be known of
 * them is which ones are the same place, and most often none are: for that a few bits a point do,
 * which stay in a cache where the slots of a table would not.
 */
struct mp_places { /* all 0: nothing is known */
	bool known;
	uint32_t *first;  /* of each point the first one of its place; NULL: there are no others */
	uint32_t *vertex; /* + 1, of those first ones; 0: it has none yet */
};

/*
 * Compare ${points}, which have no vertices yet: of those of ${vertices}, there are none.  8 to
 * 12 bytes a point for a moment, and 8 while they are known if some are the same.  Where there is
 * no memory they stay unknown.
 */
void mp_places_find(struct mp_places *, const struct mp_vertices *vertices,
		    const struct mp_points *points);

/*
 * As mp_vertices_add_float_points() of ${count} known points, each for the first time, with their
 * numbers; ${point} is worked in.
 */
int mp_places_add(struct mp_places *, struct mp_vertices *, const uint32_t *number,
		  float (*point)[3], size_t count, uint32_t *out, struct mp_error *err);

void mp_places_free(struct mp_places *); /* legal on a zeroed struct, and again */

#endif
