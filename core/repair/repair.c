#include "core/repair/repair.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/bodies/bodies.h"
#include "core/moments/mass.h"
#include "core/moments/solid.h"
#include "core/repair/nearly_closed.h"
#include "core/repair/orient.h"
#include "core/repair/weld.h"

static void sum_again(const struct mp_report *r, struct mp_moments *moments)
{
	const struct mp_mesh mesh = {.vertices = r->vertices,
				     .tri = (const uint32_t(*)[3])r->tri,
				     .triangles = r->triangles};

	mp_moments_begin(moments);
	mp_solid_add(moments, &mesh, NULL, mesh.triangles);
}

static int weld(const struct mp_request *request, const uint8_t key[16], struct mp_report *r,
		struct mp_error *err)
{
	struct mp_weld done;

	if (request->weld == 0)
		return 0;
	if (mp_weld(r->vertices, r->mapped ? &r->map : NULL, r->tri, r->triangles, request->weld,
		    key, &done, err))
		return -1;
	r->welded_vertices = done.went;
	mp_warn(r, MP_WARN_WELD_UNDECIDED, !done.complete);
	return 0;
}

/* What was turned twice, by flip and by this, is as it was. */
static int orient(const struct mp_request *request, struct mp_report *r, struct mp_error *err)
{
	struct mp_oriented done;

	if (!request->orient)
		return 0;
	if (mp_orient(r->vertices, r->tri, r->triangles, &done, err))
		return -1;
	r->repaired = r->repaired || done.turned > 0;
	r->flipped_triangles = request->flip ? r->triangles - done.turned : done.turned;
	mp_oriented_free(&done);
	return 0;
}

int mp_repair(const struct mp_request *request, const uint8_t key[16], struct mp_report *r,
	      struct mp_moments *moments, struct mp_error *err)
{
	if (weld(request, key, r, err))
		return -1;
	r->repaired = r->welded_vertices > 0;
	if (orient(request, r, err))
		return -1;
	if (r->repaired)
		sum_again(r, moments);
	return 0;
}

static void mark_one_sided(const struct mp_oriented *o, struct mp_report *r)
{
	struct mp_topology *t = &r->topology;

	for (uint32_t i = 0; o->one_sided != NULL && i < r->triangles; i++)
		if (t->body_of[i] != MP_NO_BODY && (o->one_sided[i / 64] >> (i % 64)) & 1)
			t->body[t->body_of[i]].one_sided = true;
	mp_warn(r, MP_WARN_NON_ORIENTABLE, o->one_sided != NULL);
}

static int judge_winding(const struct mp_mesh *mesh, struct mp_report *r, struct mp_error *err)
{
	const struct mp_topology *t = &r->topology;
	size_t size = mesh->triangles * sizeof *mesh->tri;
	struct mp_oriented o;
	uint32_t(*tri)[3];
	int ret;

	if (t->misoriented_edges == 0 && (mp_has_volume(t) || t->boundary_edges > 0))
		return 0;
	tri = malloc(size + 1);
	if (tri == NULL)
		return mp_fail_nomem(err);
	memcpy(tri, mesh->tri, size);
	ret = mp_orient(mesh->vertices, tri, mesh->triangles, &o, err);
	free(tri);
	if (ret)
		return -1;
	mark_one_sided(&o, r);
	if (r->mapped)
		o.volume *= r->map.size.mid;
	if (o.closed && !mp_has_volume(t))
		r->volume_if_oriented_defined =
		    mp_in_range(fabsl(o.volume), &r->volume_if_oriented);
	mp_oriented_free(&o);
	return 0;
}

int mp_repair_judge(const struct mp_mesh *mesh, const uint8_t key[16], struct mp_report *r,
		    struct mp_error *err)
{
	if (judge_winding(mesh, r, err))
		return -1;
	if (r->topology.boundary_edges > 0 &&
	    mp_nearly_closed(mesh, &r->box, key, &r->closes_at_tolerance, err))
		return -1;
	mp_warn(r, MP_WARN_NEARLY_CLOSED, r->closes_at_tolerance > 0);
	return 0;
}
