#ifndef EXACT_MESHES_H
#define EXACT_MESHES_H

#include "tests/unit/soup.h"

/* Random closed meshes whose coordinates are of every kind that a double can be. */

enum exact_style { /* of coordinates; each has its own way through core/exact */
		   SMALL_INTEGERS,
		   NARROW_EDGE, /* 30 bits, with the extremes */
		   NARROW_OVER, /* just more */
		   MIDDLE_EDGE, /* 50 bits */
		   MIDDLE_OVER,
		   FIXED_EDGE, /* 62 bits */
		   FIXED_OVER,
		   DOUBLES,
		   FLOATS_FAR_AWAY,
		   MICROMETRES,
		   GIGAMETRES,
		   NEEDLE,
		   PLATE,
		   NOISE_NEAR_ZERO,
		   FLOAT_EXTREMES,
		   WIDE_SPAN,
		   ANY_DOUBLE,
		   ENDS_OF_RANGE,
		   SUBNORMAL,
		   HUGE_DOUBLES,
		   STYLES
};

double exact_coordinate(enum exact_style, int axis, uint64_t *state);

/* One to three parts, most of them crossing themselves: closed is all they are. */
void exact_mesh(enum exact_style, uint64_t *state, struct soup *out);

#endif
