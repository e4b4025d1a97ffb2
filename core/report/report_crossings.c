#include "core/affine/affine.h"
#include "core/bodies/boxes.h"
#include "core/report/report_parts.h"

_Static_assert((int)MP_WOUND_NOT == (int)MP_ORIENTATION_NONE &&
		   (int)MP_WOUND_OUTWARD == (int)MP_ORIENTATION_OUTWARD &&
		   (int)MP_WOUND_INWARD == (int)MP_ORIENTATION_INWARD,
	       "struct mp_bodies says how bodies are wound");

/* Points in the frame of the report; in range, as the box is. */
static void map(const struct mp_report *r, struct mp_crossings *c)
{
	for (size_t i = 0; i < c->listed && r->mapped; i++)
		for (uint32_t k = 0; k < c->list[i].points; k++)
			(void)mp_affine_point(&r->map, c->list[i].point[k], c->list[i].point[k]);
}

static int find_overlaps(const struct mp_intersect *ask, struct mp_report *r, struct mp_error *err)
{
	struct mp_crossings *c = &r->overlaps;
	enum mp_truth apart;

	if (mp_boxes_apart(ask->box, ask->topology->bodies, &apart, err))
		return -1;
	if (apart == MP_YES)
		c->asked = c->decided = true;
	else if (mp_overlapping_bodies(ask, c, err))
		return -1;
	r->overlapping = c->count > 0 ? MP_YES : c->decided ? MP_NO : MP_UNDECIDED;
	return 0;
}

int mp_report_crossings(const struct mp_request *request, const struct mp_mesh *mesh,
			const struct mp_bodies *bodies, const uint8_t key[16], struct mp_report *r,
			struct mp_error *err)
{
	const struct mp_intersect ask = {mesh, &r->topology,    bodies->box, bodies->winding,
					 key,  request->defects};
	const struct mp_crossings *o = &r->overlaps, *s = &r->self;

	if (find_overlaps(&ask, r, err) ||
	    (request->self_intersections && mp_self_intersections(&ask, &r->self, err)))
		return -1;
	map(r, &r->overlaps);
	map(r, &r->self);
	mp_warn(r, MP_WARN_OVERLAPPING, o->count > 0);
	mp_warn(r, MP_WARN_OVERLAP_UNDECIDED, !o->decided);
	mp_warn(r, MP_WARN_SELF_INTERSECTING, s->count > 0);
	mp_warn(r, MP_WARN_SELF_UNDECIDED, s->asked && !s->decided);
	if (o->listed < o->count || s->listed < s->count)
		r->topology.truncated = true;
	return 0;
}
