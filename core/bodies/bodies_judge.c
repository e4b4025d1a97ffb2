#include <string.h>

#include "core/bodies/bodies.h"

/* How the bodies that have a volume and a known depth are wound. */
struct tally {
	uint64_t as_wanted, against; /* of outward at even depth, inward at odd depth */
	uint64_t flat, undecided;
	bool outward_inside; /* one at odd depth is wound like the whole */
};

/*
 * How bodies that lie in no other are wound.  Where the whole is below 0 some may be inward, or it
 * comes from what lies inside them.
 */
static enum mp_orientation outermost(const struct mp_bodies *b, bool negative)
{
	for (uint32_t i = 0; negative && i < b->count; i++)
		if (b->nest[i].decided && b->nest[i].depth == 0 &&
		    b->winding[i] == MP_ORIENTATION_INWARD)
			return MP_ORIENTATION_INWARD;
	return MP_ORIENTATION_OUTWARD;
}

static struct tally count(const struct mp_bodies *b, bool inside_out)
{
	enum mp_orientation outside = outermost(b, inside_out);
	struct tally t = {0};

	for (uint32_t i = 0; i < b->count; i++) {
		bool odd = b->nest[i].depth % 2 != 0;

		if (!b->nest[i].decided)
			t.undecided++;
		else if (b->winding[i] == MP_ORIENTATION_NONE)
			t.flat++;
		else if ((b->winding[i] == MP_ORIENTATION_OUTWARD) != odd)
			t.as_wanted++;
		else
			t.against++;
		if (b->nest[i].decided && odd && b->winding[i] == outside)
			t.outward_inside = true;
	}
	return t;
}

static enum mp_orientation orientation(const struct tally *t)
{
	if (t->against == 0)
		return t->as_wanted > 0 ? MP_ORIENTATION_OUTWARD : MP_ORIENTATION_NONE;
	return t->as_wanted > 0 ? MP_ORIENTATION_MIXED : MP_ORIENTATION_INWARD;
}

static enum mp_truth is_solid(const struct mp_report *r, const struct tally *t)
{
	if (!r->topology.closed || r->orientation != MP_ORIENTATION_OUTWARD || t->flat > 0)
		return MP_NO;
	if ((r->total.volume_defined && r->total.volume == 0) || r->overlapping == MP_YES)
		return MP_NO;
	return t->undecided == 0 && r->overlapping == MP_NO ? MP_YES : MP_UNDECIDED;
}

void mp_bodies_judge(const struct mp_bodies *b, struct mp_report *r)
{
	bool inside_out = r->total.volume_defined && r->total.volume < 0;
	struct tally t = count(b, inside_out);

	r->orientation = r->topology.closed ? orientation(&t) : MP_ORIENTATION_NONE;
	r->solid = is_solid(r, &t);
	mp_warn(r, MP_WARN_INSIDE_OUT, inside_out);
	mp_warn(r, MP_WARN_MIXED_BODIES, r->orientation == MP_ORIENTATION_MIXED);
	mp_warn(r, MP_WARN_CAVITY_OUTWARD, t.outward_inside);
	mp_warn(r, MP_WARN_NESTING_UNDECIDED, t.undecided > 0);
}
