#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/geometry/predicates.h"
#include "core/intersect/intersect_parts.h"

enum { AHEAD = 16, LIST_STEPS = 200000000 };

void mp_tri_load(const struct mp_mesh *mesh, uint32_t triangle, struct mp_tri *out)
{
	for (unsigned k = 0; k < 3; k++) {
		out->v[k] = mesh->tri[triangle][k];
		mp_vertices_get(mesh->vertices, out->v[k], out->p[k]);
	}
}

/* Would an exact sign of these coordinates need integers? */
static bool beyond(const struct mp_mesh *mesh)
{
	uint32_t vertices = mp_vertices_count(mesh->vertices);

	for (uint32_t v = 0; v < vertices; v++) {
		double x[3];

		mp_vertices_get(mesh->vertices, v, x);
		for (unsigned k = 0; k < 3; k++)
			if (x[k] != 0 && !(fabs(x[k]) >= 0x1p-300 && fabs(x[k]) <= 0x1p300))
				return true;
	}
	return false;
}

struct mp_work mp_work_for(const struct mp_mesh *mesh, uint64_t steps, uint64_t per_triangle,
			   uint64_t most)
{
	struct mp_work w = {.left = steps + per_triangle * mesh->triangles,
			    .exact = beyond(mesh) ? MP_WORK_WIDE : MP_WORK_EXACT};

	w.left = w.left < most ? w.left : most;
	return w;
}

static void find_box(const struct mp_tri *t, const double origin[3], struct mp_bvh_box *box)
{
	for (unsigned k = 0; k < 3; k++) {
		double a = t->p[0][k], b = t->p[1][k], c = t->p[2][k];
		double low = a < b ? a : b, high = a < b ? b : a;

		box->min[k] = mp_bvh_round(c < low ? c : low, origin[k]);
		box->max[k] = mp_bvh_round(c > high ? c : high, origin[k]);
	}
}

static bool has_area(const struct mp_topology *t, const struct mp_tri *tri)
{
	return t->degenerate_triangles == 0 || !mp_collinear(tri->p[0], tri->p[1], tri->p[2]);
}

struct list {
	struct mp_bvh_item *item;
	uint32_t count, room;
};

static struct mp_bvh_item *add(struct list *l)
{
	if (l->count == l->room) {
		uint32_t room = l->room == 0 ? 64 : l->room + l->room / 2;
		struct mp_bvh_item *item = realloc(l->item, room * sizeof *item);

		if (item == NULL)
			return NULL;
		l->item = item;
		l->room = room;
	}
	return &l->item[l->count++];
}

/* -1: memory is out.  One more than MP_MOST_IN_BVH stands for any number. */
static int collect(const struct mp_mesh *mesh, const struct mp_topology *t,
		   const struct mp_triangle_filter *filter, bool *flat, struct list *l)
{
	double origin[3];

	if (mesh->triangles > 0)
		mp_vertices_get(mesh->vertices, mesh->tri[0][0], origin);
	for (uint32_t i = 0; i < mesh->triangles && l->count <= MP_MOST_IN_BVH; i++) {
		uint32_t body = t->body_of[i];
		struct mp_bvh_item *item;
		struct mp_tri tri;

		for (unsigned k = 0; k < 3 && i + AHEAD < mesh->triangles; k++)
			mp_vertices_prefetch(mesh->vertices, mesh->tri[i + AHEAD][k]);
		if (body == MP_NO_BODY)
			continue;
		mp_tri_load(mesh, i, &tri);
		if (!has_area(t, &tri)) {
			if (flat != NULL)
				flat[body] = true;
			continue;
		}
		if (filter != NULL && !filter->wanted(filter->self, body, &tri))
			continue;
		item = add(l);
		if (item == NULL)
			return -1;
		*item = (struct mp_bvh_item){.id = i, .group = body};
		find_box(&tri, origin, &item->box);
	}
	return 0;
}

int mp_bvh_of_triangles(const struct mp_mesh *mesh, const struct mp_topology *t,
			const struct mp_triangle_filter *filter, bool *flat, struct mp_work *work,
			struct mp_bvh *out, struct mp_error *err)
{
	struct list l = {0};

	memset(out, 0, sizeof *out);
	if (collect(mesh, t, filter, flat, &l)) {
		free(l.item);
		return mp_fail_nomem(err);
	}
	if (l.count <= MP_MOST_IN_BVH)
		return mp_bvh_build(out, l.item, l.count, err);
	work->left = 0;
	free(l.item);
	return 0;
}

static void locate(const struct mp_mesh *mesh, uint64_t pair, struct mp_work *work,
		   struct mp_crossing *out)
{
	struct mp_meeting m;
	struct mp_tri t, u;

	out->triangle[0] = (uint32_t)(pair >> 32);
	out->triangle[1] = (uint32_t)pair;
	mp_tri_load(mesh, out->triangle[0], &t);
	mp_tri_load(mesh, out->triangle[1], &u);
	mp_tri_meet(&t, &u, work, &m);
	out->points = m.points < MP_CROSSING_POINTS ? m.points : MP_CROSSING_POINTS;
	for (unsigned i = 0; i < out->points; i++)
		mp_tri_point(&t, &u, &m, i, out->point[i]);
}

int mp_crossings_locate(const struct mp_mesh *mesh, const uint64_t *pair, size_t count,
			struct mp_crossings *out, struct mp_error *err)
{
	struct mp_work work = mp_work_for(mesh, LIST_STEPS, 0, LIST_STEPS);

	out->list = calloc(count + 1, sizeof *out->list);
	if (out->list == NULL)
		return mp_fail_nomem(err);
	for (size_t i = 0; i < count && work.left > 0; i++)
		locate(mesh, pair[i], &work, &out->list[out->listed++]);
	return 0;
}

void mp_crossings_free(struct mp_crossings *c)
{
	free(c->list);
	memset(c, 0, sizeof *c);
}
