#ifndef MP_BODIES_H
#define MP_BODIES_H

#include "core/bodies/named.h"
#include "core/bodies/nesting.h"
#include "core/bodies/parts.h"
#include "core/moments/mass.h"
#include "core/report/report.h"

/* What the bodies of a mesh are: their boxes, winding, nesting, and the solid they make. */
struct mp_bodies {
	uint32_t count;
	uint32_t *start; /* count + 1: order[start[b]..start[b+1]) are the triangles of body b */
	/* Ascending within a body; those without a body come last; NULL: one body has them all. */
	uint32_t *order;
	struct mp_box *box;
	struct mp_nest *nest;
	uint8_t *winding; /* enum mp_orientation by the sign of its volume; NONE: open or flat */
	struct mp_solid *solid; /* of the first ${listed} */
	uint32_t listed;
	bool in_range; /* no body's volume left the range of a double */
	bool sum_up;   /* every body has a volume, so the whole is their sum */
};

/* Is the mesh one body and nothing else?  Then the sums of the whole are the body's. */
bool mp_bodies_alone(const struct mp_mesh *mesh, const struct mp_topology *topology);

/* The triangles of body ${b}, start[b + 1] - start[b] of them; NULL for 0, 1, 2 ... */
static inline const uint32_t *mp_bodies_order(const struct mp_bodies *b, uint32_t body)
{
	return b->order == NULL ? NULL : b->order + b->start[body];
}

/* Does what is enclosed mean something: closed, or open only along cracks of no area? */
static inline bool mp_body_has_volume(const struct mp_body_topology *t)
{
	return t->closed || t->cracks_only;
}

static inline bool mp_has_volume(const struct mp_topology *t)
{
	return t->closed || t->cracks_only;
}

/*
 * mp_bodies_measure(mesh, topology, most, total, named, whole, out, err):
 * ${total}: the sums over the whole mesh, summed again where they have to be.  ${whole}: what the
 * mesh is; where every body has a volume of its own, the sum of the bodies, each summed about its
 * own reference.  Each body with a volume goes to ${named} too (NULL: to nobody).  Solids are kept
 * of the first ${most} bodies.  ${out}: all but nest; free with mp_bodies_free(), after a failure
 * too.
 */
int mp_bodies_measure(const struct mp_mesh *mesh, const struct mp_topology *topology, uint32_t most,
		      struct mp_moments *total, struct mp_named *named, struct mp_solid *whole,
		      struct mp_bodies *out, struct mp_error *err);

/* nest: which body lies in which. */
int mp_bodies_nest(const struct mp_mesh *mesh, const struct mp_topology *topology,
		   struct mp_bodies *out, struct mp_error *err);
void mp_bodies_free(struct mp_bodies *); /* legal on a zeroed struct */

/* orientation, solid and their warnings; topology, total and overlapping must be filled. */
void mp_bodies_judge(const struct mp_bodies *, struct mp_report *report);

/* report->body, bodies_listed and names.  ${density}: of all bodies, unless ${named} has theirs. */
int mp_bodies_list(const struct mp_bodies *, const struct mp_density *density,
		   const struct mp_named *named, const struct mp_names *names,
		   struct mp_report *report, struct mp_error *err);

#endif
