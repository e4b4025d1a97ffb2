#include "core/repair/repair.h"

#include "core/moments/solid.h"
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

int mp_repair(const struct mp_request *request, const uint8_t key[16], struct mp_report *r,
	      struct mp_moments *moments, struct mp_error *err)
{
	if (weld(request, key, r, err))
		return -1;
	r->repaired = r->welded_vertices > 0;
	if (r->repaired)
		sum_again(r, moments);
	return 0;
}
