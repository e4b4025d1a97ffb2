#include <string.h>

#include "core/intersect/intersect_parts.h"
#include "core/topology/smallest.h"

/* Steps: two seconds, then five microseconds a triangle, eight seconds at most. */
#define STEPS        UINT64_C(400000000)
#define PER_TRIANGLE 1000
#define MOST_STEPS   UINT64_C(1600000000)

struct finder {
	const struct mp_mesh *mesh;
	struct mp_work work;
	uint64_t count;
	struct mp_smallest found;
};

static bool any(void *self, uint32_t group, uint32_t other)
{
	(void)self;
	(void)group;
	(void)other;
	return true;
}

static int look(void *self, const struct mp_bvh_item *a, const struct mp_bvh_item *b)
{
	struct finder *f = self;
	uint64_t low = a->id < b->id ? a->id : b->id, high = a->id < b->id ? b->id : a->id;
	struct mp_meeting m;
	struct mp_tri t, u;

	mp_tri_load(f->mesh, a->id, &t);
	mp_tri_load(f->mesh, b->id, &u);
	mp_tri_meet(&t, &u, &f->work, &m);
	if (!m.intersects)
		return 0;
	f->count++;
	mp_smallest_add(&f->found, low << 32 | high);
	return f->found.failed ? -1 : 0;
}

int mp_self_intersections(const struct mp_intersect *ask, struct mp_crossings *out,
			  struct mp_error *err)
{
	struct finder f = {.mesh = ask->mesh, .found.most = ask->most};
	struct mp_bvh_visitor visitor = {.self = &f, .wanted = any, .pair = look};
	struct mp_bvh bvh;
	int ret = -1;

	memset(out, 0, sizeof *out);
	f.work = mp_work_for(ask->mesh, STEPS, PER_TRIANGLE, MOST_STEPS);
	if (mp_bvh_of_triangles(ask->mesh, ask->topology, NULL, NULL, &f.work, &bvh, err) == 0) {
		out->asked = true;
		out->decided = f.work.left > 0 && mp_bvh_pairs(&bvh, &visitor, &f.work) == 0;
		out->count = f.count;
		if (mp_smallest_finish(&f.found))
			ret = mp_fail_nomem(err);
		else
			ret = mp_crossings_locate(ask->mesh, f.found.key, f.found.count, out, err);
	}
	mp_bvh_free(&bvh);
	mp_smallest_free(&f.found);
	return ret;
}
