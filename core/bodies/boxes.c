#include "core/bodies/boxes.h"

#include <stdlib.h>

enum {
	DEPTH = 48, /* of groups within groups: a staircase of boxes must not fill the stack */
	SMALL = 8   /* so few are compared at once */
};
#define WORK 100000000 /* comparisons and sorting steps */

struct entry {
	double from, to; /* of the box along the axis at hand */
	uint32_t box;
	uint32_t active; /* another use of the array: the boxes that the sweep plane cuts */
};

struct search {
	const struct mp_box *box;
	uint64_t work; /* left */
};

static int by_from(const void *a, const void *b)
{
	const struct entry *x = a, *y = b;

	if (x->from != y->from)
		return x->from < y->from ? -1 : 1;
	if (x->to != y->to)
		return x->to < y->to ? -1 : 1;
	return x->box < y->box ? -1 : x->box > y->box;
}

static bool share_inside(const struct mp_box *a, const struct mp_box *b)
{
	for (int k = 0; k < 3; k++)
		if (a->max[k] <= b->min[k] || b->max[k] <= a->min[k])
			return false;
	return true;
}

/* Take ${steps} from the work that is left; false: there is not so much. */
static bool spend(struct search *s, uint64_t steps)
{
	bool enough = s->work >= steps;

	s->work = enough ? s->work - steps : 0;
	return enough;
}

/* ${e} is sorted along ${axis}.  True: no two share anything. */
static bool sweep(struct search *s, struct entry *e, uint32_t count, int axis)
{
	uint32_t active = 0;

	for (uint32_t i = 0; i < count; i++) {
		const struct mp_box *b = &s->box[e[i].box];
		uint32_t kept = 0;

		if (!spend(s, active + 1))
			return false;
		for (uint32_t k = 0; k < active; k++) {
			const struct mp_box *other = &s->box[e[k].active];

			if (other->max[axis] <= b->min[axis])
				continue; /* behind the plane, for good */
			if (share_inside(other, b))
				return false;
			e[kept++].active = e[k].active;
		}
		e[kept++].active = e[i].box;
		active = kept;
	}
	return true;
}

static bool sort(struct search *s, struct entry *e, uint32_t count, int axis)
{
	uint64_t steps = 1;

	for (uint32_t n = count; n > 0; n /= 2)
		steps += count;
	if (!spend(s, steps))
		return false;
	for (uint32_t i = 0; i < count; i++) {
		e[i].from = s->box[e[i].box].min[axis];
		e[i].to = s->box[e[i].box].max[axis];
	}
	qsort(e, count, sizeof *e, by_from);
	return true;
}

/* ${failed}: how many axes, the last ones, no plane cuts the group along.  True: apart. */
static bool cut(struct search *s, struct entry *e, uint32_t count, int axis, int failed, int depth)
{
	uint32_t begin = 0;
	double reach;

	if (count < 2)
		return true;
	if (!sort(s, e, count, axis))
		return false;
	if (count <= SMALL || failed == 3 || depth == 0)
		return sweep(s, e, count, axis);
	reach = e[0].to;
	for (uint32_t i = 1; i < count; i++) {
		if (e[i].from >= reach) {
			if (!cut(s, e + begin, i - begin, (axis + 1) % 3, 0, depth - 1))
				return false;
			begin = i;
		}
		if (i == begin || e[i].to > reach)
			reach = e[i].to;
	}
	failed = begin == 0 ? failed + 1 : 0;
	return cut(s, e + begin, count - begin, (axis + 1) % 3, failed, depth - 1);
}

int mp_boxes_apart(const struct mp_box *box, uint32_t count, enum mp_truth *out,
		   struct mp_error *err)
{
	struct search s = {box, WORK};
	struct entry *e;

	*out = MP_YES;
	if (count < 2)
		return 0;
	e = calloc(count, sizeof *e);
	if (e == NULL)
		return mp_fail_nomem(err);
	for (uint32_t i = 0; i < count; i++)
		e[i].box = i;
	*out = cut(&s, e, count, 0, 0, DEPTH) ? MP_YES : MP_UNDECIDED;
	free(e);
	return 0;
}
