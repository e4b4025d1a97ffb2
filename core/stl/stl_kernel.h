#ifndef MP_STL_KERNEL_H
#define MP_STL_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/decoder.h"

/*
 * Facets of a binary STL side by side, a row a number: the normal in rows 0 to 2, the corners from
 * row 3 on as struct mp_sink's floats() wants them.
 */
struct stl_columns {
	float row[12][MP_BLOCK];
};

struct stl_columns_seen {
	uint64_t normals_disagreeing, normals_not_finite; /* as in struct mp_notes */
	bool not_finite;                                  /* some coordinate is not */
};

/* The kernels that this machine can run, the plain one first, the best one last. */
size_t stl_columns_kernels(void);

/*
 * Read ${count} facets of 50 bytes from ${p} into the columns from ${at} on, at + count <=
 * MP_BLOCK, and look at them.
 */
void stl_columns_read(size_t kernel, struct stl_columns *, size_t at, const uint8_t *p,
		      size_t count, struct stl_columns_seen *seen);

#endif
