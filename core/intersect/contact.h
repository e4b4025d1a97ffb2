#ifndef MP_CONTACT_H
#define MP_CONTACT_H

#include "core/intersect/pair_table.h"
#include "core/intersect/tri_pair.h"
#include "core/intersect/twins.h"

/* Bodies that have a part of an edge in common without crossing there. */
struct mp_contact {
	const struct mp_mesh *mesh;
	const uint8_t *winding; /* of the bodies, as in struct mp_intersect */
	struct mp_work *work;
	struct mp_twins twins; /* all 0 until the first contact */
};

/*
 * Add to ${pair} what the edges of the two triangles along each other say, ${t} of pair->body[0]
 * and ${u} of body[1].  -1: memory is out.
 */
int mp_contact_add(struct mp_contact *, const uint32_t triangle[2], const struct mp_tri *t,
		   const struct mp_tri *u, const struct mp_meeting *, struct mp_body_pair *pair);

#endif
