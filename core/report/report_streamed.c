#include <string.h>

#include "core/analysis_state.h"
#include "core/report/report_parts.h"

/* The report under checks=closed: what a single pass that keeps no triangle can tell. */

int mp_report_no_stream(struct mp_error *err)
{
	return mp_fail(err, MP_BAD_CHECKS, MP_NO_BYTE,
		       "checks=closed is for STL files, and this is none");
}

/*
 * The option came behind the file, when the table was there already; it says the same of the same
 * mesh.
 */
static int check_table(const struct mp_analysis *a, struct mp_report *r, struct mp_error *err)
{
	const struct mp_mesh mesh = {.vertices = r->vertices,
				     .tri = (const uint32_t(*)[3])r->tri,
				     .triangles = r->triangles};
	struct mp_topology found;

	if (a->not_stl)
		return mp_report_no_stream(err);
	if (mp_topology_find(&mesh, 0, &found, err))
		return -1;
	r->topology.closed = found.closed;
	r->topology.degenerate_triangles = found.degenerate_triangles;
	mp_topology_free(&found);
	return 0;
}

/*
 * Where 0 is all that there is to be summed, for underflow or because every triangle lies in a
 * plane through the reference, the volume is 0: |V| is at most what the products lost: each less
 * than 2^-1073.
 */
static void take_zeros(const struct mp_moments *m, struct mp_solid *whole)
{
	long double extent = 1;

	for (int k = 0; k < 3; k++)
		extent += (long double)m->max[k] - m->min[k];
	if (m->doubt.hi != 0 || m->a0.hi != 0)
		return;
	whole->in_range = true;
	whole->volume_bound = 0x1p-1070L * extent * (long double)m->triangles;
}

/* One reference for all of it, and no second pass about a better one. */
static void solve(const struct mp_analysis *a, const struct mp_report *r, struct mp_solid *whole)
{
	mp_moments_solve(&a->moments, whole);
	if (whole->in_range)
		return;
	if (r->topology.degenerate_triangles == r->triangles) {
		memset(whole, 0, sizeof *whole); /* whatever rounding has left in the sums */
		whole->in_range = whole->area_in_range = true;
	} else {
		take_zeros(&a->moments, whole);
	}
}

/* A volume that is proven to be negative is proof that it is none; nothing here proves one. */
static void judge(struct mp_report *r)
{
	const struct mp_mass *m = &r->total;
	double volume = m->volume_defined ? m->volume : 0;

	r->solid = !r->topology.closed || volume < 0 ? MP_NO : MP_UNDECIDED;
	r->overlapping = MP_UNDECIDED;
	r->orientation = volume > 0   ? MP_ORIENTATION_OUTWARD
			 : volume < 0 ? MP_ORIENTATION_INWARD
				      : MP_ORIENTATION_NONE;
	mp_warn(r, MP_WARN_NOT_CLOSED, !r->topology.closed);
	mp_warn(r, MP_WARN_INSIDE_OUT, volume < 0);
}

int mp_report_streamed(const struct mp_analysis *a, const struct mp_request *request,
		       struct mp_report *r, struct mp_error *err)
{
	static const struct mp_named nobody = {0};
	struct mp_density density;
	struct mp_solid whole;
	bool later = false;

	r->streamed = true;
	memcpy(r->box.min, a->moments.min, sizeof r->box.min);
	memcpy(r->box.max, a->moments.max, sizeof r->box.max);
	if (a->streamed) {
		r->topology.closed = a->edges && mp_fingerprint_closed(&a->fingerprint);
		r->topology.degenerate_triangles = a->degenerate;
	} else if (check_table(a, r, err)) {
		return -1;
	}
	solve(a, r, &whole);
	mp_report_masses(request, NULL, &nobody, NULL, &whole, &density, &later, r);
	mp_report_warn_file(r);
	judge(r);
	return 0;
}
