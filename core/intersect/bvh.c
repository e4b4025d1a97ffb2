#include "core/intersect/bvh.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "core/sort.h"

enum { LEAF = 4 };

float mp_bvh_round(double x, double origin)
{
	double d = x - origin;

	return d > (double)FLT_MAX ? FLT_MAX : d < -(double)FLT_MAX ? -FLT_MAX : (float)d;
}

static void extend(struct mp_bvh_box *b, const struct mp_bvh_box *with)
{
	for (unsigned k = 0; k < 3; k++) {
		b->min[k] = with->min[k] < b->min[k] ? with->min[k] : b->min[k];
		b->max[k] = with->max[k] > b->max[k] ? with->max[k] : b->max[k];
	}
}

static float centre(const struct mp_bvh_item *i, unsigned axis)
{
	return 0.5F * i->box.min[axis] + 0.5F * i->box.max[axis];
}

/* The box and the group of a node, and the box of the centres. */
static void survey(const struct mp_bvh_item *item, struct mp_bvh_node *n, float low[3],
		   float high[3])
{
	n->box = item->box;
	n->group = item->group;
	for (unsigned k = 0; k < 3; k++)
		low[k] = high[k] = centre(item, k);
	for (uint32_t i = 1; i < n->count; i++) {
		extend(&n->box, &item[i].box);
		if (item[i].group != n->group)
			n->group = MP_BVH_MIXED;
		for (unsigned k = 0; k < 3; k++) {
			float c = centre(&item[i], k);

			low[k] = c < low[k] ? c : low[k];
			high[k] = c > high[k] ? c : high[k];
		}
	}
}

static uint32_t partition(struct mp_bvh_item *item, uint32_t count, unsigned axis, float middle)
{
	uint32_t i = 0, j = count;

	while (i < j) {
		struct mp_bvh_item t = item[i];

		if (centre(&t, axis) < middle) {
			i++;
			continue;
		}
		j--;
		item[i] = item[j];
		item[j] = t;
	}
	return i;
}

/* The bits of a float in an order that integers have, too. */
static uint32_t ordered(float x)
{
	uint32_t bits;

	x += 0.0F; /* no -0 */
	memcpy(&bits, &x, sizeof bits);
	return bits & 0x80000000U ? ~bits : bits | 0x80000000U;
}

/* By centre. */
static int sort(struct mp_bvh_item *item, uint32_t count, unsigned axis)
{
	uint64_t *key = malloc(count * sizeof *key);
	struct mp_bvh_item *copy = malloc(count * sizeof *copy);
	bool ready = key != NULL && copy != NULL;

	if (ready) {
		memcpy(copy, item, count * sizeof *copy);
		for (uint32_t i = 0; i < count; i++)
			key[i] = (uint64_t)ordered(centre(&item[i], axis)) << 32 | i;
		mp_sort_u64(key, count);
		for (uint32_t i = 0; i < count; i++)
			item[i] = copy[(uint32_t)key[i]];
	}
	free(key);
	free(copy);
	return ready ? 0 : -1;
}

static struct mp_bvh_node *new_node(struct mp_bvh *b)
{
	if (b->nodes == b->room) {
		uint32_t room = b->room == 0 ? 64 : b->room > UINT32_MAX / 2 ? 0 : 2 * b->room;
		struct mp_bvh_node *node = NULL;

		if (room != 0)
			node = realloc(b->node, room * sizeof *node);
		if (node == NULL)
			return NULL;
		b->node = node;
		b->room = room;
	}
	return &b->node[b->nodes++];
}

static int build(struct mp_bvh *b, uint32_t begin, uint32_t count)
{
	struct mp_bvh_node *n = new_node(b);
	struct mp_bvh_item *item = b->item + begin;
	uint32_t me = b->nodes - 1, left;
	float low[3], high[3];
	unsigned axis = 0;

	if (n == NULL)
		return -1;
	*n = (struct mp_bvh_node){.begin = begin, .count = count};
	survey(item, n, low, high);
	if (count <= LEAF)
		return 0;
	for (unsigned k = 1; k < 3; k++)
		if (high[k] - low[k] > high[axis] - low[axis])
			axis = k;
	left = partition(item, count, axis, 0.5F * low[axis] + 0.5F * high[axis]);
	if (left < count / 8 || count - left < count / 8 || left == 0 || left == count) {
		left = count / 2;
		if (low[axis] < high[axis] && sort(item, count, axis))
			return -1;
	}
	if (build(b, begin, left))
		return -1;
	b->node[me].right = b->nodes;
	return build(b, begin + left, count - left);
}

int mp_bvh_build(struct mp_bvh *b, struct mp_bvh_item *item, uint32_t count, struct mp_error *err)
{
	*b = (struct mp_bvh){.item = item, .count = count};
	if (count > 0 && build(b, 0, count))
		return mp_fail_nomem(err);
	return 0;
}

void mp_bvh_free(struct mp_bvh *b)
{
	free(b->item);
	free(b->node);
	memset(b, 0, sizeof *b);
}

struct search {
	const struct mp_bvh *bvh;
	const struct mp_bvh_visitor *visitor;
	struct mp_work *work;
};

static bool meet(const struct mp_bvh_box *a, const struct mp_bvh_box *b)
{
	return a->min[0] <= b->max[0] && b->min[0] <= a->max[0] && a->min[1] <= b->max[1] &&
	       b->min[1] <= a->max[1] && a->min[2] <= b->max[2] && b->min[2] <= a->max[2];
}

static bool wanted(const struct search *s, uint32_t a, uint32_t b)
{
	return s->visitor->wanted(s->visitor->self, a, b);
}

static int try_pair(const struct search *s, const struct mp_bvh_item *a,
		    const struct mp_bvh_item *b)
{
	if (s->work->left == 0)
		return -1;
	mp_work_spend(s->work, 1);
	if (!meet(&a->box, &b->box) || !wanted(s, a->group, b->group))
		return 0;
	return s->visitor->pair(s->visitor->self, a, b);
}

/* The pairs of two nodes, neither of which is within the other. */
static int cross(const struct search *s, const struct mp_bvh_node *a, const struct mp_bvh_node *b)
{
	const struct mp_bvh_node *node = s->bvh->node;

	if (s->work->left == 0)
		return -1;
	mp_work_spend(s->work, 1);
	if (!meet(&a->box, &b->box) || !wanted(s, a->group, b->group))
		return 0;
	if (a->right == 0 && b->right == 0) {
		for (uint32_t i = 0; i < a->count; i++)
			for (uint32_t j = 0; j < b->count; j++)
				if (try_pair(s, &s->bvh->item[a->begin + i],
					     &s->bvh->item[b->begin + j]))
					return -1;
		return 0;
	}
	if (b->right == 0 || (a->right != 0 && a->count >= b->count))
		return cross(s, a + 1, b) || cross(s, node + a->right, b) ? -1 : 0;
	return cross(s, a, b + 1) || cross(s, a, node + b->right) ? -1 : 0;
}

static int within(const struct search *s, const struct mp_bvh_node *n)
{
	const struct mp_bvh_item *item = s->bvh->item + n->begin;

	if (n->group != MP_BVH_MIXED && !wanted(s, n->group, n->group))
		return 0;
	if (n->right != 0) {
		const struct mp_bvh_node *right = s->bvh->node + n->right;

		return within(s, n + 1) || within(s, right) || cross(s, n + 1, right) ? -1 : 0;
	}
	for (uint32_t i = 0; i < n->count; i++)
		for (uint32_t j = i + 1; j < n->count; j++)
			if (try_pair(s, &item[i], &item[j]))
				return -1;
	return 0;
}

int mp_bvh_pairs(const struct mp_bvh *b, const struct mp_bvh_visitor *visitor, struct mp_work *w)
{
	struct search s = {.bvh = b, .visitor = visitor, .work = w};

	return b->nodes > 0 ? within(&s, b->node) : 0;
}
