#include "core/bodies/nesting.h"

#include <stdlib.h>
#include <string.h>

#include "core/bodies/containment.h"

struct pair {
	uint32_t inner, outer;
};

/* What take_candidate() reads of many bodies, in the order in which it does: no cache could help.
 */
struct upper {
	double max[3];
	uint32_t body;
};

struct nester {
	const struct mp_mesh *mesh;
	const struct mp_topology *topology;
	const struct mp_box *box;
	struct mp_nest *out;
	uint32_t container;      /* the one whose candidates are collected */
	struct mp_kd_point *low; /* lower corners of all boxes, as a k-d tree; id: place in it */
	struct upper *upper;     /* of the boxes in the order of the tree */
	struct mp_candidate *candidate;
	size_t candidates, candidate_room;
	struct pair *pair; /* inner lies inside outer */
	size_t pairs, pair_room;
	uint32_t *row, *list;          /* the triangles of each body */
	struct mp_containment *inside; /* has the work limit */
	bool nomem;
};

/*
 * Work limit in points and triangles looked at, about a second; it grows with the mesh so that
 * one look at everything is always possible.  A pair found takes PAIR_STEPS of it, which bounds
 * the memory for pairs, too.
 */
enum { STEPS = 100000000, STEPS_PER_BODY = 64, STEPS_PER_TRIANGLE = 16, PAIR_STEPS = 16 };

static bool can_contain(const struct mp_body_topology *b)
{
	return b->closed || b->cracks_only;
}

/* ${p} with room for at least one more than ${count} items; NULL and s->nomem when memory is out.
 */
static void *room_for_one(struct nester *s, void *p, size_t count, size_t *room, size_t size)
{
	size_t more = *room == 0 ? 64 : 2 * *room;

	if (count < *room)
		return p;
	p = realloc(p, more * size);
	if (p == NULL)
		s->nomem = true;
	else
		*room = more;
	return p;
}

/* Its lower corner is in the container's box: a candidate if the upper one is. */
static int take_candidate(void *self, uint32_t place)
{
	struct nester *s = self;
	const struct mp_box *outer = &s->box[s->container];
	const struct upper *inner = &s->upper[place];
	struct mp_candidate *grown;

	if (inner->body == s->container || inner->max[0] > outer->max[0] ||
	    inner->max[1] > outer->max[1] || inner->max[2] > outer->max[2])
		return 0;
	grown = room_for_one(s, s->candidate, s->candidates, &s->candidate_room, sizeof *grown);
	if (grown == NULL)
		return -1;
	s->candidate = grown;
	s->candidate[s->candidates++] = (struct mp_candidate){.body = inner->body};
	return 0;
}

/* Triangles by body: a counting sort, as the rows of edges.c. */
static int list_triangles(struct nester *s)
{
	const uint32_t *body_of = s->topology->body_of;
	uint32_t bodies = s->topology->bodies, sum = 0;

	s->row = calloc((size_t)bodies + 1, sizeof *s->row);
	s->list = malloc(((size_t)s->mesh->triangles + 1) * sizeof *s->list);
	if (s->row == NULL || s->list == NULL)
		return -1;
	for (uint32_t b = 0; b < bodies; b++) {
		s->row[b + 1] = sum;
		sum += s->topology->body[b].triangles;
	}
	for (uint32_t t = 0; t < s->mesh->triangles; t++)
		if (body_of[t] != MP_NO_BODY)
			s->list[s->row[body_of[t] + 1]++] = t;
	return 0;
}

static int keep(struct nester *s, const struct mp_candidate *c)
{
	struct pair *grown;

	if (c->place == MP_PLACE_ON)
		s->out[c->body].decided = false;
	if (c->place != MP_PLACE_INSIDE)
		return 0;
	if (s->inside->steps < PAIR_STEPS)
		return -1;
	s->inside->steps -= PAIR_STEPS;
	grown = room_for_one(s, s->pair, s->pairs, &s->pair_room, sizeof *grown);
	if (grown == NULL)
		return -1;
	s->pair = grown;
	s->pair[s->pairs++] = (struct pair){.inner = c->body, .outer = s->container};
	return 0;
}

/* All pairs of which the outer is s->container; -1: memory or steps are out. */
static int fill_container(struct nester *s)
{
	const struct mp_box *box = &s->box[s->container];

	s->candidates = 0;
	if (mp_kd_search(s->low, s->topology->bodies, box->min, box->max, &s->inside->steps,
			 take_candidate, s))
		return -1;
	if (s->candidates == 0)
		return 0;
	if (s->list == NULL &&
	    (list_triangles(s) ||
	     mp_containment_begin(s->inside, s->mesh, s->row, s->list, s->topology->bodies))) {
		s->nomem = true;
		return -1;
	}
	if (mp_containment_judge(s->inside, s->container, s->candidate, s->candidates))
		return -1;
	for (size_t i = 0; i < s->candidates; i++)
		if (keep(s, &s->candidate[i]))
			return -1;
	return 0;
}

static int find_pairs(struct nester *s)
{
	for (uint32_t b = 0; b < s->topology->bodies; b++) {
		s->container = b;
		if (can_contain(&s->topology->body[b]) && fill_container(s))
			return -1;
	}
	return 0;
}

static double volume(const struct mp_box *b)
{
	return (b->max[0] - b->min[0]) * (b->max[1] - b->min[1]) * (b->max[2] - b->min[2]);
}

/* Whether ${a} is the more inward of two containers of the same body. */
static bool more_inward(const struct nester *s, uint32_t a, uint32_t b)
{
	double va = volume(&s->box[a]), vb = volume(&s->box[b]);

	if (s->out[a].depth != s->out[b].depth)
		return s->out[a].depth > s->out[b].depth;
	if (va != vb)
		return va < vb;
	return a < b;
}

static void find_parents(struct nester *s)
{
	for (size_t i = 0; i < s->pairs; i++)
		s->out[s->pair[i].inner].depth++;
	for (size_t i = 0; i < s->pairs; i++) {
		struct mp_nest *n = &s->out[s->pair[i].inner];

		if (n->parent == MP_NO_BODY || more_inward(s, s->pair[i].outer, n->parent))
			n->parent = s->pair[i].outer;
	}
	/*
	 * A container is always less deep than what it contains, unless surfaces cross: two bodies
	 * with the same box may each have a vertex in the other.  No parent is given then, so
	 * parents never form a ring.
	 */
	for (uint32_t b = 0; b < s->topology->bodies; b++) {
		struct mp_nest *n = &s->out[b];

		if (n->parent != MP_NO_BODY && s->out[n->parent].depth >= n->depth) {
			n->parent = MP_NO_BODY;
			n->decided = false;
		}
	}
}

static void reset(struct nester *s, bool decided)
{
	for (uint32_t b = 0; b < s->topology->bodies; b++)
		s->out[b] = (struct mp_nest){.decided = decided, .parent = MP_NO_BODY};
}

static int build_tree(struct nester *s)
{
	s->low = malloc(((size_t)s->topology->bodies + 1) * sizeof *s->low);
	s->upper = malloc(((size_t)s->topology->bodies + 1) * sizeof *s->upper);
	if (s->low == NULL || s->upper == NULL)
		return -1;
	for (uint32_t b = 0; b < s->topology->bodies; b++) {
		memcpy(s->low[b].p, s->box[b].min, sizeof s->low[b].p);
		s->low[b].id = b;
	}
	mp_kd_build(s->low, s->topology->bodies);
	for (uint32_t i = 0; i < s->topology->bodies; i++) {
		memcpy(s->upper[i].max, s->box[s->low[i].id].max, sizeof s->upper[i].max);
		s->upper[i].body = s->low[i].id;
		s->low[i].id = i;
	}
	return 0;
}

static bool any_container(const struct mp_topology *t)
{
	for (uint32_t b = 0; b < t->bodies; b++)
		if (can_contain(&t->body[b]))
			return t->bodies > 1;
	return false;
}

int mp_nesting_find(const struct mp_mesh *mesh, const struct mp_topology *topology,
		    const struct mp_box *box, struct mp_nest *out, struct mp_error *err)
{
	struct mp_containment inside = {.steps = STEPS};
	struct nester s = {.mesh = mesh, .topology = topology, .box = box, .out = out};

	reset(&s, true);
	if (!any_container(topology))
		return 0;
	inside.steps += (uint64_t)STEPS_PER_BODY * topology->bodies +
			(uint64_t)STEPS_PER_TRIANGLE * mesh->triangles;
	s.inside = &inside;
	if (build_tree(&s))
		s.nomem = true;
	else if (find_pairs(&s) == 0)
		find_parents(&s);
	else
		reset(&s, false); /* out of steps: what is not known may matter to any body */
	mp_containment_end(&inside);
	free(s.list);
	free(s.row);
	free(s.pair);
	free(s.candidate);
	free(s.upper);
	free(s.low);
	return s.nomem ? mp_fail_nomem(err) : 0;
}
