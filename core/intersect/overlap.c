#include <stdlib.h>
#include <string.h>

#include "core/intersect/contact.h"
#include "core/intersect/intersect_parts.h"
#include "core/intersect/wedge.h"
#include "core/topology/smallest.h"

/* Steps: a second, then two microseconds a triangle, four seconds at most. */
#define STEPS        UINT64_C(200000000)
#define PER_TRIANGLE 400
#define MOST_STEPS   UINT64_C(800000000)
enum { PAIR_STEPS = 100, BOX_STEPS = 20 };
enum { WEDGE_ALL = MP_WEDGE_BOTH | MP_WEDGE_FIRST | MP_WEDGE_SECOND };

struct finder {
	const struct mp_mesh *mesh;
	const struct mp_topology *topology;
	const struct mp_intersect *ask;
	struct mp_work work;
	struct mp_box *clip; /* of each body, what other bodies' boxes reach; empty: nothing */
	bool *flat;          /* bodies with triangles without an area */
	uint8_t *check;      /* bodies whose surface must not touch itself: CHECK_* */
	struct mp_bvh bvh;
	struct mp_pair_table table;
	struct mp_contact contact;
	bool nomem;
};

enum { CHECK_NOT, CHECK_WANTED, CHECK_FAILED };

static bool share_inside(const struct mp_box *a, const struct mp_box *b)
{
	for (unsigned k = 0; k < 3; k++)
		if (a->max[k] <= b->min[k] || b->max[k] <= a->min[k])
			return false;
	return true;
}

static bool different(void *self, uint32_t group, uint32_t other)
{
	(void)self;
	return group != other || group == MP_BVH_MIXED;
}

static void extend(struct mp_box *clip, const struct mp_box *a, const struct mp_box *b)
{
	for (unsigned k = 0; k < 3; k++) {
		double low = a->min[k] > b->min[k] ? a->min[k] : b->min[k];
		double high = a->max[k] < b->max[k] ? a->max[k] : b->max[k];

		clip->min[k] = low < clip->min[k] ? low : clip->min[k];
		clip->max[k] = high > clip->max[k] ? high : clip->max[k];
	}
}

static int meet_boxes(void *self, const struct mp_bvh_item *a, const struct mp_bvh_item *b)
{
	struct finder *f = self;
	const struct mp_box *x = &f->ask->box[a->id], *y = &f->ask->box[b->id];

	mp_work_spend(&f->work, BOX_STEPS);
	if (!share_inside(x, y))
		return 0;
	extend(&f->clip[a->id], x, y);
	extend(&f->clip[b->id], x, y);
	return 0;
}

/* Which part of each body other bodies can meet.  -1: memory or work is out. */
static int find_clips(struct finder *f, struct mp_error *err)
{
	const struct mp_bvh_visitor visitor = {f, different, meet_boxes};
	uint32_t bodies = f->topology->bodies;
	struct mp_bvh_item *item = malloc((size_t)bodies * sizeof *item);
	const double *origin = f->ask->box[0].min;
	struct mp_bvh bvh = {0};
	int ret;

	if (item == NULL)
		return mp_fail_nomem(err);
	for (uint32_t i = 0; i < bodies; i++) {
		const struct mp_box *b = &f->ask->box[i];

		item[i] = (struct mp_bvh_item){.id = i, .group = i};
		for (unsigned k = 0; k < 3; k++) {
			item[i].box.min[k] = mp_bvh_round(b->min[k], origin[k]);
			item[i].box.max[k] = mp_bvh_round(b->max[k], origin[k]);
			f->clip[i].min[k] = b->max[k];
			f->clip[i].max[k] = b->min[k];
		}
	}
	ret = mp_bvh_build(&bvh, item, bodies, err);
	if (ret == 0 && mp_bvh_pairs(&bvh, &visitor, &f->work))
		f->work.left = 0;
	mp_bvh_free(&bvh);
	return ret;
}

static bool reached(const void *self, uint32_t body, const struct mp_tri *t)
{
	const struct finder *f = self;
	const struct mp_box *clip = &f->clip[body];

	for (unsigned k = 0; k < 3; k++) {
		double a = t->p[0][k], b = t->p[1][k], c = t->p[2][k];
		double low = a < b ? a : b, high = a < b ? b : a;

		low = c < low ? c : low;
		high = c > high ? c : high;
		if (high < clip->min[k] || clip->max[k] < low)
			return false;
	}
	return true;
}

static bool undecided_pair(void *self, uint32_t group, uint32_t other)
{
	const struct finder *f = self;
	const struct mp_body_pair *p;

	if (group == MP_BVH_MIXED || other == MP_BVH_MIXED)
		return true;
	if (group == other || !share_inside(&f->ask->box[group], &f->ask->box[other]))
		return false;
	p = mp_pair_table_find(&f->table, group, other);
	return p == NULL || !p->crossed;
}

static bool more_than_points(const struct mp_meeting *m)
{
	unsigned all = 0;

	for (unsigned k = 0; k < 3; k++)
		all |= (unsigned)m->along[0][k] | m->along[1][k];
	return m->crosses || all != 0;
}

static int meet_triangles(void *self, const struct mp_bvh_item *a, const struct mp_bvh_item *b)
{
	struct finder *f = self;
	const struct mp_bvh_item *first = a->group < b->group ? a : b, *second = first == a ? b : a;
	uint32_t triangle[2] = {first->id, second->id};
	struct mp_body_pair *pair;
	struct mp_meeting m;
	struct mp_tri t, u;

	mp_tri_load(f->mesh, triangle[0], &t);
	mp_tri_load(f->mesh, triangle[1], &u);
	mp_tri_meet(&t, &u, &f->work, &m);
	if (!more_than_points(&m))
		return 0;
	pair = mp_pair_table_add(&f->table, first->group, second->group);
	if (pair == NULL)
		return -1;
	mp_work_spend(&f->work, PAIR_STEPS);
	if (m.crosses || !pair->along)
		memcpy(pair->triangle, triangle, sizeof triangle);
	if (m.crosses) {
		pair->crossed = true;
		return 0;
	}
	if (pair->wedge == WEDGE_ALL) /* only a crossing would be news */
		return 0;
	if (mp_contact_add(&f->contact, triangle, &t, &u, &m, pair) == 0)
		return 0;
	f->nomem = true;
	return -1;
}

/* A surface whose every edge joins two triangles, and which has an inside. */
static bool plain(const struct finder *f, uint32_t body)
{
	const struct mp_body_topology *b = &f->topology->body[body];

	return b->watertight && b->closed && !f->flat[body] &&
	       f->ask->winding[body] != MP_WOUND_NOT;
}

static bool needs_check(const struct finder *f, const struct mp_body_pair *p)
{
	return p->along && !p->crossed && !p->unsure && plain(f, p->body[0]) &&
	       plain(f, p->body[1]);
}

static bool to_check(void *self, uint32_t group, uint32_t other)
{
	const struct finder *f = self;

	if (group == MP_BVH_MIXED || other == MP_BVH_MIXED)
		return true;
	return group == other && f->check[group] == CHECK_WANTED;
}

static int touch_self(void *self, const struct mp_bvh_item *a, const struct mp_bvh_item *b)
{
	struct finder *f = self;
	struct mp_meeting m;
	struct mp_tri t, u;

	mp_tri_load(f->mesh, a->id, &t);
	mp_tri_load(f->mesh, b->id, &u);
	mp_tri_meet(&t, &u, &f->work, &m);
	if (m.touches || m.shared == 3)
		f->check[a->group] = CHECK_FAILED;
	return 0;
}

static bool wanted_for_check(const void *self, uint32_t body, const struct mp_tri *t)
{
	const struct finder *f = self;

	(void)t;
	return f->check[body] == CHECK_WANTED;
}

/* Do the surfaces of bodies that are in contact touch themselves?  -1: memory is out. */
static int check_bodies(struct finder *f, struct mp_error *err)
{
	const struct mp_triangle_filter filter = {f, wanted_for_check};
	const struct mp_bvh_visitor visitor = {f, to_check, touch_self};
	bool any = false;

	for (uint32_t i = 0; i < f->table.pairs; i++) {
		const struct mp_body_pair *p = &f->table.pair[i];

		if (!needs_check(f, p))
			continue;
		f->check[p->body[0]] = f->check[p->body[1]] = CHECK_WANTED;
		any = true;
	}
	mp_bvh_free(&f->bvh);
	if (!any)
		return 0;
	if (mp_bvh_of_triangles(f->mesh, f->topology, &filter, NULL, &f->work, &f->bvh, err))
		return -1;
	if (f->work.left > 0 && mp_bvh_pairs(&f->bvh, &visitor, &f->work))
		f->work.left = 0;
	return 0;
}

enum verdict { APART, OVERLAP, OPEN };

static enum verdict judge(const struct finder *f, const struct mp_body_pair *p)
{
	unsigned alone = p->wedge & (MP_WEDGE_FIRST | MP_WEDGE_SECOND);

	if (p->crossed)
		return f->ask->winding[p->body[0]] != MP_WOUND_NOT &&
			       f->ask->winding[p->body[1]] != MP_WOUND_NOT
			   ? OVERLAP
			   : OPEN;
	if (!needs_check(f, p) || f->check[p->body[0]] == CHECK_FAILED ||
	    f->check[p->body[1]] == CHECK_FAILED)
		return OPEN;
	if (!(p->wedge & MP_WEDGE_BOTH))
		return APART;
	return alone == 0 || alone == (MP_WEDGE_FIRST | MP_WEDGE_SECOND) ? OVERLAP : APART;
}

static int sum_up(struct finder *f, struct mp_crossings *out, struct mp_error *err)
{
	struct mp_smallest found = {.most = f->ask->most};
	int ret = 0;

	for (uint32_t i = 0; i < f->table.pairs; i++) {
		const struct mp_body_pair *p = &f->table.pair[i];
		uint64_t low = p->triangle[0], high = p->triangle[1], swap = low;

		switch (f->work.left > 0 || p->crossed ? judge(f, p) : OPEN) {
		case APART:
			continue;
		case OPEN:
			out->decided = false;
			continue;
		case OVERLAP:
			out->count++;
		}
		if (low > high) {
			low = high;
			high = swap;
		}
		mp_smallest_add(&found, low << 32 | high);
	}
	if (mp_smallest_finish(&found))
		ret = mp_fail_nomem(err);
	else
		ret = mp_crossings_locate(f->mesh, found.key, found.count, out, err);
	mp_smallest_free(&found);
	return ret;
}

static int find(struct finder *f, struct mp_crossings *out, struct mp_error *err)
{
	const struct mp_triangle_filter filter = {f, reached};
	const struct mp_bvh_visitor visitor = {f, undecided_pair, meet_triangles};

	if (find_clips(f, err))
		return -1;
	if (f->work.left > 0) {
		if (mp_bvh_of_triangles(f->mesh, f->topology, &filter, f->flat, &f->work, &f->bvh,
					err))
			return -1;
		if (f->work.left > 0 && mp_bvh_pairs(&f->bvh, &visitor, &f->work))
			f->work.left = 0;
	}
	if (f->nomem || f->table.nomem)
		return mp_fail_nomem(err);
	if (f->work.left > 0 && check_bodies(f, err))
		return -1;
	out->decided = f->work.left > 0;
	return sum_up(f, out, err);
}

int mp_overlapping_bodies(const struct mp_intersect *ask, struct mp_crossings *out,
			  struct mp_error *err)
{
	struct finder f = {.mesh = ask->mesh, .topology = ask->topology, .ask = ask};
	size_t bodies = ask->topology->bodies;
	int ret = -1;

	memset(out, 0, sizeof *out);
	out->asked = out->decided = true;
	if (bodies < 2)
		return 0;
	f.work = mp_work_for(ask->mesh, STEPS, PER_TRIANGLE, MOST_STEPS);
	f.contact = (struct mp_contact){ask->mesh, ask->winding, &f.work, {0}};
	mp_pair_table_begin(&f.table, ask->key);
	f.clip = malloc(bodies * sizeof *f.clip);
	f.flat = calloc(bodies, sizeof *f.flat);
	f.check = calloc(bodies, sizeof *f.check);
	if (f.clip == NULL || f.flat == NULL || f.check == NULL)
		mp_fail_nomem(err);
	else
		ret = find(&f, out, err);
	mp_bvh_free(&f.bvh);
	mp_twins_free(&f.contact.twins);
	mp_pair_table_free(&f.table);
	free(f.clip);
	free(f.flat);
	free(f.check);
	if (ret)
		mp_crossings_free(out);
	return ret;
}
