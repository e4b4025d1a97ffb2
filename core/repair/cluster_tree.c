#include <string.h>

#include "core/repair/cluster_private.h"

unsigned mp_near_depth(uint32_t count)
{
	unsigned depth = 0;

	for (uint64_t n = count; n > MP_NEAR_LEAF; n = n - n / 2)
		depth++;
	return depth;
}

static void find_box(const struct mp_near_point *a, uint32_t n, struct mp_near_node *node)
{
	memcpy(node->lo, a[0].p, sizeof node->lo);
	memcpy(node->hi, a[0].p, sizeof node->hi);
	for (uint32_t i = 1; i < n; i++) {
		for (int k = 0; k < 3; k++) {
			node->lo[k] = a[i].p[k] < node->lo[k] ? a[i].p[k] : node->lo[k];
			node->hi[k] = a[i].p[k] > node->hi[k] ? a[i].p[k] : node->hi[k];
		}
	}
}

static unsigned widest(const struct mp_near_node *node)
{
	unsigned axis = 0;

	for (unsigned k = 1; k < 3; k++) /* halves: the extent itself may be infinite */
		if (node->hi[k] / 2 - node->lo[k] / 2 > node->hi[axis] / 2 - node->lo[axis] / 2)
			axis = k;
	return axis;
}

/* By coordinate ${axis}, then the others, then the number: no two points are equal. */
static bool less(const struct mp_near_point *a, const struct mp_near_point *b, unsigned axis)
{
	for (unsigned k = 0; k < 3; k++, axis = axis == 2 ? 0 : axis + 1)
		if (a->p[axis] != b->p[axis])
			return a->p[axis] < b->p[axis];
	return a->id < b->id;
}

static uint64_t random_next(uint64_t *seed) /* splitmix64, Steele 2014 */
{
	uint64_t x = *seed += 0x9e3779b97f4a7c15u;

	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

/*
 * Bring the ${k} smallest to the front: quickselect (Hoare 1961).  Pivots that nobody can foresee
 * make it O(n) on average for any input.
 */
static void select_rank(struct mp_near_point *a, uint32_t n, uint32_t k, unsigned axis,
			uint64_t *seed)
{
	while (n > 1) {
		struct mp_near_point pivot = a[random_next(seed) % n], t;
		int64_t i = 0, j = (int64_t)n - 1;

		while (i <= j) {
			while (less(&a[i], &pivot, axis))
				i++;
			while (less(&pivot, &a[j], axis))
				j--;
			if (i > j)
				break;
			t = a[i];
			a[i++] = a[j];
			a[j--] = t;
		}
		if ((int64_t)k <= j) {
			n = (uint32_t)j + 1;
		} else if ((int64_t)k >= i) {
			a += i;
			n -= (uint32_t)i;
			k -= (uint32_t)i;
		} else {
			return;
		}
	}
}

static void build(struct mp_near_tree *t, uint32_t node, unsigned depth, uint32_t from,
		  uint32_t count, uint64_t *seed)
{
	uint32_t half = count - count / 2;

	find_box(t->point + from, count, &t->node[node]);
	t->node[node].one = count == 1;
	if (depth == t->depth)
		return;
	select_rank(t->point + from, count, half, widest(&t->node[node]), seed);
	build(t, 2 * node, depth + 1, from, half, seed);
	build(t, 2 * node + 1, depth + 1, from + half, count - half, seed);
}

void mp_near_build(struct mp_near_tree *t, uint64_t seed)
{
	build(t, 1, 0, 0, t->count, &seed);
}
