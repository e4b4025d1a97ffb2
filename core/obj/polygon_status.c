#include "core/obj/polygon_sweep.h"

/* The lower sides that the sweep line cuts, in a splay tree (Sleator & Tarjan 1985,
 * doi:10.1145/3828.3835): whatever the polygon, a step takes O(log n) on average. */

/*
 * Does a side with ends ${v} and ${w}, of which ${v} is at the sweep line, lie above the lower side
 * of ${i} (1), below it (-1), or is it the same (0)?
 */
static int above(const struct polygon_sweep *s, uint32_t i, uint32_t v, uint32_t w)
{
	uint32_t a = s->interval[i].lower;
	int side = polygon_sweep_turn(s, a, s->next[a], v);

	return side != 0 ? side : polygon_sweep_turn(s, a, s->next[a], w);
}

/* The tree anew, at its root the interval whose lower side is v w, or else one next to it. */
static uint32_t splay(const struct polygon_sweep *s, uint32_t root, uint32_t v, uint32_t w)
{
	uint32_t less = POLYGON_NONE, more = POLYGON_NONE; /* what is known to be below, above */
	uint32_t *less_end = &less, *more_end = &more;
	int side;

	while ((side = above(s, root, v, w)) != 0) {
		struct polygon_interval *i = &s->interval[root];
		uint32_t *way = side > 0 ? &i->great : &i->small, child = *way, *back;

		if (child == POLYGON_NONE)
			break;
		if (above(s, child, v, w) == side) { /* twice the same way: rotate */
			back = side > 0 ? &s->interval[child].small : &s->interval[child].great;
			*way = *back;
			*back = root;
			root = child;
			i = &s->interval[root];
			way = side > 0 ? &i->great : &i->small;
			if (*way == POLYGON_NONE)
				break;
		}
		if (side > 0) {
			*less_end = root;
			less_end = way;
		} else {
			*more_end = root;
			more_end = way;
		}
		root = *way;
	}
	*less_end = s->interval[root].small;
	*more_end = s->interval[root].great;
	s->interval[root].small = less;
	s->interval[root].great = more;
	return root;
}

uint32_t polygon_sweep_below(struct polygon_sweep *s, uint32_t v)
{
	uint32_t w = s->next[v];
	struct polygon_interval *root;
	int side;

	if (s->root == POLYGON_NONE)
		return POLYGON_NONE;
	s->root = splay(s, s->root, v, w);
	root = &s->interval[s->root];
	side = above(s, s->root, v, w);
	s->failed = s->failed || side == 0;
	if (side > 0)
		return s->root;
	if (root->small != POLYGON_NONE)
		root->small = splay(s, root->small, v, w);
	return root->small;
}

uint32_t polygon_sweep_open(struct polygon_sweep *s, uint32_t below, uint32_t lower, uint32_t upper)
{
	uint32_t new = s->intervals;
	struct polygon_interval *i = &s->interval[new];

	s->failed = s->failed || new == polygon_sweep_intervals(s->n);
	if (s->failed)
		return 0;
	i->lower = lower;
	i->upper = upper;
	i->small = below;
	i->great = s->root;
	if (s->root != POLYGON_NONE && below == s->root) {
		i->great = s->interval[below].great;
		s->interval[below].great = POLYGON_NONE;
	} else if (s->root != POLYGON_NONE) {
		s->interval[s->root].small = POLYGON_NONE;
	}
	s->root = new;
	s->intervals++;
	s->open++;
	s->side_of[lower] = s->side_of[upper] = new;
	return new;
}

void polygon_sweep_close(struct polygon_sweep *s, uint32_t old, uint32_t v)
{
	struct polygon_interval *i = &s->interval[old];
	uint32_t w = i->lower;

	s->side_of[i->lower] = s->side_of[i->upper] = POLYGON_NONE;
	s->open--;
	s->root = splay(s, s->root, v, w);
	if (s->root != old) {
		s->failed = true;
		return;
	}
	s->root = i->great;
	if (i->small == POLYGON_NONE)
		return;
	s->root = splay(s, i->small, v, w);
	s->failed = s->failed || s->interval[s->root].great != POLYGON_NONE;
	s->interval[s->root].great = i->great;
}
