#include "core/repair/cluster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/repair/cluster_private.h"
#include "core/topology/disjoint.h"

/*
 * Work limit: pairs of nodes looked at, a pair of leaves counting for LEAVES.  A mesh takes about
 * two a vertex at most, whatever the distance.
 */
enum { STEPS = 1 << 24, STEPS_PER_POINT = 64, LEAVES = 8 };

/* What hangs together: vertices, or some of them, or all of them mapped. */
struct cloud {
	const struct mp_vertices *vertices;
	const uint32_t *which;
	const struct mp_affine *map;
};

struct joiner {
	struct mp_near_tree tree;
	uint32_t *parent; /* disjoint sets of places in tree.point */
	double scale;     /* power of two that brings the distance to about 1 */
	double limit;     /* (distance * scale)^2 */
	uint64_t steps;
	bool complete;
};

/* A part of the tree: a node, its depth and its points. */
struct part {
	uint32_t node, from, count;
	unsigned depth;
};

static struct part child(const struct part *p, bool second)
{
	uint32_t half = p->count - p->count / 2;
	struct part c = {2 * p->node + second, p->from + (second ? half : 0),
			 second ? p->count - half : half, p->depth + 1};

	return c;
}

/*
 * Differences, squares and their sum are monotone also when rounded: where a box is smaller than
 * the distance by this rule, every pair of points in it is, and where two boxes are not nearer, no
 * pair is.  So cutting corners by boxes never changes what is near.
 */
static bool is_near(const struct joiner *j, const double d[3])
{
	double x = d[0] * j->scale, y = d[1] * j->scale, z = d[2] * j->scale;

	return x * x + y * y + z * z < j->limit;
}

static bool points_near(const struct joiner *j, uint32_t a, uint32_t b)
{
	const double *p = j->tree.point[a].p, *q = j->tree.point[b].p;
	const double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};

	return is_near(j, d);
}

static bool all_near(const struct joiner *j, uint32_t node)
{
	const struct mp_near_node *n = &j->tree.node[node];
	const double d[3] = {n->hi[0] - n->lo[0], n->hi[1] - n->lo[1], n->hi[2] - n->lo[2]};

	return is_near(j, d);
}

/* Whether the boxes allow some pair (${farthest}: ensure that every pair is) near. */
static bool boxes_near(const struct joiner *j, uint32_t a, uint32_t b, bool farthest)
{
	const struct mp_near_node *m = &j->tree.node[a], *n = &j->tree.node[b];
	double d[3];

	for (int k = 0; k < 3; k++) {
		double up = m->hi[k] - n->lo[k], down = n->hi[k] - m->lo[k];

		if (farthest)
			d[k] = up > down ? up : down;
		else
			d[k] = up < 0 ? up : down < 0 ? down : 0;
	}
	return is_near(j, d);
}

static bool same_set(const struct joiner *j, const struct part *a, const struct part *b)
{
	return mp_set_find(j->parent, a->from) == mp_set_find(j->parent, b->from);
}

static bool is_one(const struct joiner *j, const struct part *p)
{
	return j->tree.node[p->node].one;
}

static void mark(const struct joiner *j, const struct part *p)
{
	struct part c[2];

	j->tree.node[p->node].one = true;
	if (p->depth == j->tree.depth)
		return;
	for (int i = 0; i < 2; i++) {
		c[i] = child(p, i);
		mark(j, &c[i]);
	}
}

static void join_leaves(struct joiner *j, const struct part *a, const struct part *b)
{
	for (uint32_t x = a->from; x < a->from + a->count; x++)
		for (uint32_t y = b->from; y < b->from + b->count; y++)
			if (points_near(j, x, y))
				mp_set_unite(j->parent, x, y);
}

static bool take_steps(struct joiner *j, uint64_t steps)
{
	if (j->steps < steps) {
		j->complete = false;
		return false;
	}
	j->steps -= steps;
	return true;
}

/* All near pairs of a point in ${a} and one in ${b}, two different parts. */
static void join(struct joiner *j, const struct part *a, const struct part *b)
{
	bool leaves = a->depth == j->tree.depth && b->depth == j->tree.depth;

	if (!boxes_near(j, a->node, b->node, false) || !take_steps(j, leaves ? LEAVES : 1))
		return;
	if (is_one(j, a) && is_one(j, b)) {
		if (same_set(j, a, b))
			return;
		if (boxes_near(j, a->node, b->node, true)) {
			mp_set_unite(j->parent, a->from, b->from);
			return;
		}
	}
	if (leaves) {
		join_leaves(j, a, b);
		return;
	}
	if (a->count < b->count || a->depth == j->tree.depth) {
		const struct part *t = a;

		a = b;
		b = t;
	}
	for (int i = 0; i < 2; i++) {
		struct part c = child(a, i);

		if (is_one(j, a)) /* then so are its parts */
			j->tree.node[c.node].one = true;
		join(j, &c, b);
	}
}

static void join_leaf(struct joiner *j, const struct part *p)
{
	bool one = true;

	for (uint32_t x = p->from + 1; x < p->from + p->count; x++)
		for (uint32_t y = p->from; y < x; y++)
			if (points_near(j, x, y))
				mp_set_unite(j->parent, x, y);
	for (uint32_t x = p->from + 1; x < p->from + p->count && one; x++)
		one = mp_set_find(j->parent, x) == mp_set_find(j->parent, p->from);
	j->tree.node[p->node].one = one;
}

/* All near pairs within ${p}. */
static void join_self(struct joiner *j, const struct part *p)
{
	struct part c[2];

	if (all_near(j, p->node)) {
		for (uint32_t x = p->from + 1; x < p->from + p->count; x++)
			mp_set_unite(j->parent, p->from, x);
		mark(j, p);
		return;
	}
	if (p->depth == j->tree.depth) {
		join_leaf(j, p);
		return;
	}
	for (int i = 0; i < 2; i++) {
		c[i] = child(p, i);
		join_self(j, &c[i]);
	}
	join(j, &c[0], &c[1]);
	j->tree.node[p->node].one =
	    is_one(j, &c[0]) && is_one(j, &c[1]) && same_set(j, &c[0], &c[1]);
}

static void set_distance(struct joiner *j, double distance)
{
	int e = ilogb(distance);

	e = e < -1022 ? -1022 : e > 1022 ? 1022 : e;
	j->scale = ldexp(1.0, -e);
	j->limit = distance * j->scale * (distance * j->scale);
}

static bool before(const double *p, const double *q)
{
	for (int k = 0; k < 3; k++)
		if (p[k] != q[k])
			return p[k] < q[k];
	return false;
}

/* Point ${i} of the cloud. */
static uint32_t vertex(const struct cloud *c, uint32_t i)
{
	return c->which != NULL ? c->which[i] : i;
}

/* Is place ${x} of the tree smaller than ${y}? */
static bool smaller(const struct joiner *j, const struct cloud *c, uint32_t x, uint32_t y)
{
	const struct mp_near_point *a = &j->tree.point[x], *b = &j->tree.point[y];
	double p[3], q[3];

	if (before(a->p, b->p) || before(b->p, a->p) || c->map == NULL)
		return before(a->p, b->p);
	mp_vertices_get(c->vertices, vertex(c, a->id), p);
	mp_vertices_get(c->vertices, vertex(c, b->id), q);
	return before(p, q);
}

/* Which place each set goes by. */
static void elect(const struct joiner *j, const struct cloud *c, uint32_t *leader)
{
	const struct mp_near_point *point = j->tree.point;
	uint32_t *best = j->parent; /* of each root, once leader[] has the roots */

	for (uint32_t x = 0; x < j->tree.count; x++)
		best[x] = mp_set_find(j->parent, x);
	for (uint32_t x = 0; x < j->tree.count; x++)
		leader[point[x].id] = best[x];
	for (uint32_t x = 0; x < j->tree.count; x++) {
		uint32_t root = leader[point[x].id];

		if (smaller(j, c, x, best[root]))
			best[root] = x;
	}
	for (uint32_t i = 0; i < j->tree.count; i++)
		leader[i] = vertex(c, point[best[leader[i]]].id);
}

static uint64_t seed_of(const uint8_t key[16])
{
	uint64_t half[2];

	memcpy(half, key, sizeof half);
	return half[0] ^ (half[1] << 1);
}

/* Where it is. */
static void get_point(const struct cloud *c, uint32_t i, double p[3])
{
	mp_vertices_get(c->vertices, vertex(c, i), p);
	if (c->map != NULL)
		(void)mp_affine_point(c->map, p, p);
}

int mp_cluster_find(const struct mp_vertices *vertices, const struct mp_affine *map,
		    const uint32_t *which, uint32_t count, double distance, const uint8_t key[16],
		    uint32_t *leader, bool *complete, struct mp_error *err)
{
	const struct cloud cloud = {vertices, which, map};
	const unsigned depth = mp_near_depth(count);
	struct joiner j = {.tree = {.count = count, .depth = depth}, .complete = true};
	const struct part all = {1, 0, count, 0};
	int ret = -1;

	*complete = true;
	if (count == 0)
		return 0;
	j.tree.point = malloc(count * sizeof *j.tree.point);
	j.tree.node = malloc(((size_t)2 << depth) * sizeof *j.tree.node);
	j.parent = malloc(count * sizeof *j.parent);
	if (j.tree.point == NULL || j.tree.node == NULL || j.parent == NULL) {
		(void)mp_fail_nomem(err);
		goto out;
	}
	for (uint32_t i = 0; i < count; i++) {
		get_point(&cloud, i, j.tree.point[i].p);
		j.tree.point[i].id = i;
		j.parent[i] = i;
	}
	set_distance(&j, distance);
	j.steps = STEPS + (uint64_t)STEPS_PER_POINT * count;
	mp_near_build(&j.tree, seed_of(key));
	join_self(&j, &all);
	elect(&j, &cloud, leader);
	*complete = j.complete;
	ret = 0;
out:
	free(j.parent);
	free(j.tree.node);
	free(j.tree.point);
	return ret;
}
