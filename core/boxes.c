#include "core/boxes.h"

#include <stdlib.h>

enum { WORK = 33333333 }; /* comparisons an axis */

struct entry {
	double from;
	uint32_t box;
	uint32_t active; /* another use of the array: the boxes that the sweep plane cuts */
};

static int by_from(const void *a, const void *b)
{
	const struct entry *x = a, *y = b;

	if (x->from != y->from)
		return x->from < y->from ? -1 : 1;
	return x->box < y->box ? -1 : x->box > y->box;
}

static bool share_inside(const struct mp_box *a, const struct mp_box *b)
{
	for (int k = 0; k < 3; k++)
		if (a->max[k] <= b->min[k] || b->max[k] <= a->min[k])
			return false;
	return true;
}

/* MP_YES: apart, MP_NO: not, MP_UNDECIDED: too much work along this axis. */
static enum mp_truth sweep(const struct mp_box *box, uint32_t count, struct entry *e, int axis)
{
	uint64_t work = 0;
	uint32_t active = 0;

	for (uint32_t i = 0; i < count; i++)
		e[i] = (struct entry){box[i].min[axis], i, 0};
	qsort(e, count, sizeof *e, by_from);
	for (uint32_t i = 0; i < count; i++) {
		const struct mp_box *b = &box[e[i].box];
		uint32_t kept = 0;

		work += active;
		if (work > WORK)
			return MP_UNDECIDED;
		for (uint32_t k = 0; k < active; k++) {
			const struct mp_box *other = &box[e[k].active];

			if (other->max[axis] <= b->min[axis])
				continue; /* behind the plane, for good */
			if (share_inside(other, b))
				return MP_NO;
			e[kept++].active = e[k].active;
		}
		e[kept++].active = e[i].box;
		active = kept;
	}
	return MP_YES;
}

int mp_boxes_apart(const struct mp_box *box, uint32_t count, enum mp_truth *out,
		   struct mp_error *err)
{
	enum mp_truth apart = MP_UNDECIDED;
	struct entry *e;

	*out = MP_YES;
	if (count < 2)
		return 0;
	if ((uint64_t)count * sizeof *e > SIZE_MAX || (e = malloc(count * sizeof *e)) == NULL)
		return mp_fail_nomem(err);
	for (int axis = 0; axis < 3 && apart == MP_UNDECIDED; axis++)
		apart = sweep(box, count, e, axis);
	free(e);
	*out = apart == MP_YES ? MP_YES : MP_UNDECIDED;
	return 0;
}
