#include "core/bodies/bodies.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/geometry/predicates.h"
#include "core/moments/solid.h"

bool mp_bodies_alone(const struct mp_mesh *mesh, const struct mp_topology *t)
{
	return t->bodies == 1 && t->body[0].triangles == mesh->triangles;
}

/* Counting sort by body; what has no body goes behind. */
static void group(const struct mp_mesh *mesh, const struct mp_topology *t, struct mp_bodies *b)
{
	uint32_t at = 0, *next = b->start + 1; /* ends as start of the body behind */

	for (uint32_t i = 0; i < b->count; i++) {
		next[i] = at;
		at += t->body[i].triangles;
	}
	b->start[0] = 0;
	if (b->order == NULL) {
		next[0] = mesh->triangles;
		return;
	}
	for (uint32_t i = 0; i < mesh->triangles; i++) {
		uint32_t body = t->body_of[i];

		if (body == MP_NO_BODY)
			b->order[at++] = i;
		else
			b->order[next[body]++] = i;
	}
}

static void find_box(const struct mp_mesh *mesh, const uint32_t *order, uint32_t count,
		     struct mp_box *box)
{
	for (uint64_t i = 0; i < 3 * (uint64_t)count; i++) {
		double x[3];

		mp_vertices_get(mesh->vertices, mesh->tri[order[i / 3]][i % 3], x);
		for (int k = 0; k < 3; k++) {
			if (i == 0 || x[k] < box->min[k])
				box->min[k] = x[k] + 0.0; /* no -0 */
			if (i == 0 || x[k] > box->max[k])
				box->max[k] = x[k] + 0.0;
		}
	}
}

static void take_box(const struct mp_moments *m, struct mp_box *box)
{
	memcpy(box->min, m->min, sizeof box->min);
	memcpy(box->max, m->max, sizeof box->max);
}

static bool all_collinear(const struct mp_mesh *mesh, const uint32_t *order, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		double p[3][3];

		for (int k = 0; k < 3; k++)
			mp_vertices_get(mesh->vertices, mesh->tri[order[i]][k], p[k]);
		if (!mp_collinear(p[0], p[1], p[2]))
			return false;
	}
	return true;
}

/* If every triangle is degenerate, area and volume are 0, whatever rounding left in the sums. */
static void set_zero(struct mp_solid *solid)
{
	memset(solid, 0, sizeof *solid);
	solid->in_range = solid->area_in_range = true;
}

static void measure(const struct mp_mesh *mesh, const struct mp_topology *t, struct mp_bodies *b,
		    uint32_t i, struct mp_solid *solid)
{
	const uint32_t *order = mp_bodies_order(b, i);
	uint32_t count = b->start[i + 1] - b->start[i];
	struct mp_moments m;

	mp_moments_begin(&m);
	mp_solid_add(&m, mesh, order, count);
	mp_solid_find(&m, mesh, order, count, mp_body_has_volume(&t->body[i]), solid);
	if (!solid->in_range && all_collinear(mesh, order, count))
		set_zero(solid);
	take_box(&m, &b->box[i]);
}

static void set_winding(struct mp_bodies *b, uint32_t i, const struct mp_solid *solid)
{
	b->in_range = b->in_range && solid->in_range;
	if (!solid->in_range || solid->volume == 0)
		b->winding[i] = MP_ORIENTATION_NONE;
	else
		b->winding[i] = solid->volume > 0 ? MP_ORIENTATION_OUTWARD : MP_ORIENTATION_INWARD;
}

/*
 * Every body about its own reference; true where they sum up to the whole.  Of an open body that
 * is not listed only the box is wanted.
 */
static bool measure_all(const struct mp_mesh *mesh, const struct mp_topology *t,
			const struct mp_moments *total, const struct mp_solid *whole,
			struct mp_named *named, struct mp_bodies *b, struct mp_merge *merge)
{
	bool sum_up = b->count > 0;

	for (uint32_t i = 0; i < b->count; i++) {
		bool closed = mp_body_has_volume(&t->body[i]);
		struct mp_solid solid;

		sum_up = sum_up && closed;
		if (mp_bodies_alone(mesh, t)) {
			solid = *whole;
			take_box(total, &b->box[i]);
		} else if (closed || i < b->listed) {
			measure(mesh, t, b, i, &solid);
		} else {
			find_box(mesh, mp_bodies_order(b, i), t->body[i].triangles, &b->box[i]);
			continue;
		}
		if (closed) {
			set_winding(b, i, &solid);
			if (!mp_bodies_alone(mesh, t)) /* else it is the sum */
				mp_merge_add(merge, &solid);
			mp_named_add(named, i, &solid);
		}
		if (i < b->listed)
			b->solid[i] = solid;
	}
	return sum_up && b->in_range;
}

/* Every count stands for memory that is there already, so none is absurd. */
static int allocate(const struct mp_mesh *mesh, bool alone, struct mp_bodies *b,
		    struct mp_error *err)
{
	size_t count = (size_t)b->count + 1, listed = (size_t)b->listed + 1; /* never 0 bytes */

	b->start = calloc(count, sizeof *b->start);
	b->order = alone ? NULL : calloc((size_t)mesh->triangles + 1, sizeof *b->order);
	b->box = calloc(count, sizeof *b->box);
	b->nest = calloc(count, sizeof *b->nest);
	b->winding = calloc(count, sizeof *b->winding);
	b->solid = calloc(listed, sizeof *b->solid);
	if (b->start == NULL || (b->order == NULL && !alone) || b->box == NULL || b->nest == NULL ||
	    b->winding == NULL || b->solid == NULL)
		return mp_fail_nomem(err);
	return 0;
}

/* Nobody lies in anybody where there is no second body or none has an inside. */
static bool may_nest(const struct mp_bodies *b)
{
	for (uint32_t i = 0; b->count > 1 && i < b->count; i++)
		if (b->winding[i] != MP_ORIENTATION_NONE)
			return true;
	for (uint32_t i = 0; i < b->count; i++)
		b->nest[i] = (struct mp_nest){.decided = true, .depth = 0, .parent = MP_NO_BODY};
	return false;
}

/*
 * An area of 0 is true only if every triangle is degenerate.  Else its squares underflowed, unless
 * products that are no smaller cancelled: then it is 0 within its bound.
 */
static void settle_zero(const struct mp_topology *t, uint32_t triangles, struct mp_solid *whole)
{
	if (t->degenerate_triangles < triangles) {
		if (whole->area == 0 && whole->area_bound < DBL_MIN)
			whole->area_in_range = false;
		return;
	}
	set_zero(whole);
}

int mp_bodies_measure(const struct mp_mesh *mesh, const struct mp_topology *t, uint32_t most,
		      struct mp_moments *total, struct mp_named *named, struct mp_solid *whole,
		      struct mp_bodies *out, struct mp_error *err)
{
	bool alone = mp_bodies_alone(mesh, t);
	long double origin[3];
	struct mp_merge merge;

	memset(out, 0, sizeof *out);
	out->count = t->bodies;
	out->listed = most < t->bodies ? most : t->bodies;
	out->in_range = true;
	if (allocate(mesh, alone, out, err))
		return -1;
	group(mesh, t, out);
	mp_solid_find(total, mesh, NULL, mesh->triangles, mp_has_volume(t) && alone, whole);
	for (int k = 0; k < 3; k++)
		origin[k] =
		    whole->has_surface_centroid ? whole->surface_centroid[k] : total->reference[k];
	mp_merge_begin(&merge, origin);
	out->sum_up = measure_all(mesh, t, total, whole, named, out, &merge);
	if (out->sum_up && !alone) {
		mp_merge_solve(&merge, whole);
		whole->in_range = true;
	} else if (mp_has_volume(t) && !alone) {
		mp_solid_find(total, mesh, NULL, mesh->triangles, true, whole);
	}
	settle_zero(t, mesh->triangles, whole);
	return 0;
}

int mp_bodies_nest(const struct mp_mesh *mesh, const struct mp_topology *t, struct mp_bodies *out,
		   struct mp_error *err)
{
	return may_nest(out) ? mp_nesting_find(mesh, t, out->box, out->nest, err) : 0;
}

void mp_bodies_free(struct mp_bodies *b)
{
	free(b->start);
	free(b->order);
	free(b->box);
	free(b->nest);
	free(b->winding);
	free(b->solid);
	memset(b, 0, sizeof *b);
}
