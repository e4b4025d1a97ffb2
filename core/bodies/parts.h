#ifndef MP_PARTS_H
#define MP_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"

/* The named parts of a file (see struct mp_sink): ranges of triangles, in file order. */
struct mp_part {
	uint64_t first; /* its first triangle; it ends where the next one begins */
	size_t name;    /* offset in the pool */
	size_t len;
	bool gap; /* no part at all, rather than one without a name */
};

struct mp_parts { /* all 0 is empty */
	struct mp_part *part;
	size_t count, room;
	char *pool;
	size_t used, pool_room;
};

/*
 * As mp_sink.part: triangles from ${first} on; the same ${first} again replaces the former.  The
 * name of the part before goes on with it.
 */
int mp_parts_add(struct mp_parts *, uint64_t first, const char *name, size_t len,
		 struct mp_error *err);

/* From ${first} on there is no part. */
int mp_parts_end(struct mp_parts *, uint64_t first, struct mp_error *err);

/*
 * The part of triangle ${t}, NULL where there is none.  ${*end}: the first triangle behind ${t}
 * of which that may not be true, UINT64_MAX for none.
 */
const struct mp_part *mp_parts_at(const struct mp_parts *, uint64_t t, uint64_t *end);

/*
 * The name that all of the ${count} > 0 triangles ${tri}[], ascending (NULL: 0, 1, 2 ...), go by,
 * ${*len} bytes, or NULL where there is none.  Points into the pool.
 */
const char *mp_parts_name(const struct mp_parts *, const uint32_t *tri, size_t count, size_t *len);

void mp_parts_free(struct mp_parts *);

/* By what the triangles of all files go. */
struct mp_names {
	struct mp_parts parts, objects; /* STL: solids only */
	struct mp_parts materials;      /* a file without any is a gap */
};

#endif
