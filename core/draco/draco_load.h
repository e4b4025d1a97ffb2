#ifndef MP_DRACO_LOAD_H
#define MP_DRACO_LOAD_H

#include "core/decoder.h"
#include "core/draco/draco_wrap.h"

/*
 * Positions out of what libdraco delivered, private to core/draco: of a shape that was checked, so
 * that each of its values lies in its data.
 */

/* Bytes of a coordinate; 0: of a type that is not read. */
uint64_t mp_draco_size_of(enum mp_draco_type type);

/* Whether all of them are float32 and none is NaN or infinite. */
bool mp_draco_are_floats(const struct mp_draco_shape *s);

/*
 * The triangles of the ${count} <= MP_BLOCK triples of values at ${corner}, none of them above
 * ${most} < s->values, as struct mp_sink has floats; only where mp_draco_are_floats().
 */
void mp_draco_load_floats(const struct mp_draco_shape *s, const uint32_t (*corner)[3], size_t count,
			  uint32_t most, float (*xyz)[MP_BLOCK]);

/*
 * The same as doubles, whatever their type; ${first} is the number of the first triangle in the
 * file.  -1: MP_NON_FINITE.
 */
int mp_draco_load(const struct mp_draco_shape *s, uint64_t first, const uint32_t (*corner)[3],
		  size_t count, double (*tri)[9], struct mp_error *err);

#endif
