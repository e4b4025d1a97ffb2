#include "core/report/report.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/analysis_state.h"
#include "core/bodies/bodies.h"
#include "core/bodies/named.h"
#include "core/moments/bounds.h"
#include "core/moments/mass.h"
#include "core/repair/repair.h"
#include "core/report/capped.h"
#include "core/report/report_parts.h"

/* The mesh changes owner: from here on the report has it, whatever happens. */
static void take_mesh(struct mp_analysis *a, const struct mp_request *request, struct mp_report *r)
{
	memset(r, 0, sizeof *r);
	r->notes = a->notes;
	r->vertices = a->vertices;
	r->tri = a->tri;
	r->triangles = (uint32_t)a->triangles;
	a->vertices = NULL;
	a->tri = NULL;
	a->ended = false;
	if (!request->flip)
		return;
	for (uint32_t i = 0; r->tri != NULL && i < r->triangles; i++) {
		uint32_t second = r->tri[i][1];

		r->tri[i][1] = r->tri[i][2];
		r->tri[i][2] = second;
	}
	mp_moments_flip(&a->moments);
	r->flipped_triangles = r->triangles;
}

static struct mp_density find_density(const struct mp_request *request,
				      const struct mp_solid *whole, bool closed,
				      struct mp_report *r)
{
	struct mp_density d = {.asked = request->density_kind != MP_DENSITY_NONE, .value = 1};
	struct mp_ball given;

	if (request->density_kind == MP_DENSITY_GIVEN) {
		d.defined = true;
		given = mp_density_ball(request->density, request->density_divisor,
					request->density_error);
		d.value = given.mid;
		d.bound = given.rad;
	} else if (request->density_kind == MP_DENSITY_FROM_MASS) {
		d.defined = closed && whole->in_range && whole->volume != 0;
		d.value = d.defined ? request->density / fabsl(whole->volume) : 0;
		d.weighed = true;
		d.mass = request->density;
	}
	r->has_density = d.asked;
	r->density_defined = d.defined && mp_in_range(d.value, &r->density);
	mp_warn(r, MP_WARN_OUT_OF_RANGE, d.defined && !r->density_defined);
	return d;
}

static void set_surface(const struct mp_solid *whole, struct mp_report *r)
{
	bool fits = whole->has_surface_centroid;

	for (int k = 0; k < 3; k++) {
		fits = fits && fabsl(whole->surface_centroid[k]) <= DBL_MAX;
		if (!r->topology.closed) /* closed: exactly 0, every edge cancels */
			(void)mp_in_range(whole->vector_area[k], &r->closure_defect[k]);
	}
	r->surface_centroid_defined = fits;
	for (int k = 0; k < 3 && fits; k++)
		r->surface_centroid[k] = (double)whole->surface_centroid[k];
}

static void set_inertia(const struct mp_request *request, const struct mp_solid *whole,
			const struct mp_density *density, struct mp_report *r)
{
	long double mass = density->value * fabsl(whole->volume), about[3];
	bool fits = true;

	if (!r->total.centroid_defined || (density->asked && !density->defined))
		return;
	fits = r->inertia_origin_defined =
	    mp_mass_inertia(whole, mass, whole->centroid, r->inertia_origin);
	if (request->has_about) {
		for (int k = 0; k < 3; k++)
			about[k] = whole->centroid[k] - request->about[k];
		r->inertia_about_defined = mp_mass_inertia(whole, mass, about, r->inertia_about);
		fits = fits && r->inertia_about_defined;
	}
	if (request->has_axis) {
		r->axis_defined = mp_mass_axis(whole, mass, request->axis_origin,
					       request->axis_direction, &r->axis);
		fits = fits && r->axis_defined;
	}
	mp_warn(r, MP_WARN_OUT_OF_RANGE, !fits);
}

void mp_report_certify(const struct mp_solid *whole, const struct mp_solid *heavy,
		       const struct mp_density *density, struct mp_report *r)
{
	struct mp_ball mass = mp_mass_ball(heavy, density);

	if (r->total.inertia_defined)
		mp_report_principal(
		    r, mp_bounds_of_tensor(heavy, mass, (const double(*)[3])r->total.inertia),
		    mass);
	mp_bounds_find(whole, heavy, mass, r);
}

/* No principal moment will be beyond the range of doubles, which would undo the tensor. */
static bool is_moderate(const struct mp_mass *m)
{
	double most = 0;

	for (int i = 0; i < 9; i++)
		most = fmax(most, fabs(m->inertia[i / 3][i % 3]));
	return most < DBL_MAX / 16;
}

void mp_report_warn_file(struct mp_report *r)
{
	const struct mp_notes *n = &r->notes;

	mp_warn(r, MP_WARN_ZERO_VOLUME, r->total.volume_defined && r->total.volume == 0);
	mp_warn(r, MP_WARN_DEGENERATE, r->topology.degenerate_triangles > 0);
	mp_warn(r, MP_WARN_NORMALS, n->normals_disagreeing > 0);
	mp_warn(r, MP_WARN_TRAILING_BYTES, n->trailing_bytes > 0);
	mp_warn(r, MP_WARN_MISSING_END, n->missing_endsolid > 0);
	mp_warn(r, MP_WARN_NONSTANDARD, n->nonstandard_lines > 0);
	mp_warn(r, MP_WARN_SEVERAL_SOLIDS, n->parts > 1);
	mp_warn(r, MP_WARN_NONPLANAR, n->nonplanar_polygons > 0);
	mp_warn(r, MP_WARN_TANGLED, n->tangled_polygons > 0);
	mp_warn(r, MP_WARN_NUL_BYTES, n->nul_bytes > 0);
}

static void warn(struct mp_report *r)
{
	const struct mp_topology *t = &r->topology;
	bool undefined = !mp_has_volume(t);

	mp_warn(r, MP_WARN_OPEN, undefined && t->boundary_edges > 0);
	mp_warn(r, MP_WARN_WINDING,
		undefined && t->edges > 0 &&
		    (t->misoriented_edges > 0 || (t->boundary_edges == 0 && t->single_walls == 0)));
	mp_warn(r, MP_WARN_INTERNAL_WALLS, t->double_walls + t->single_walls > 0);
	mp_warn(r, MP_WARN_CRACKS, !t->closed && t->cracks_only);
	mp_warn(r, MP_WARN_NON_MANIFOLD, t->non_manifold_edges > 0);
	mp_warn(r, MP_WARN_NON_MANIFOLD_VERTEX, t->non_manifold_vertices > 0);
	mp_warn(r, MP_WARN_DUPLICATE, t->duplicate_triangles > 0);
	mp_warn(r, MP_WARN_DEFECTS_TRUNCATED, t->truncated);
	mp_report_warn_file(r);
}

/*
 * Where names have densities: ${heavy} is the whole by its mass, ${*d} what makes masses of its
 * volumes, and the density to report is the mean one.
 */
static void weigh(const struct mp_named *named, const struct mp_solid *whole, bool closed,
		  struct mp_solid *heavy, struct mp_density *d, struct mp_report *r)
{
	bool against = mp_named_weigh(named, whole, heavy);
	bool mean = closed && heavy->in_range && whole->volume != 0;

	*d = (struct mp_density){.asked = true, .defined = closed, .value = 1};
	r->has_density = true;
	r->density_defined = mean && mp_in_range(fabsl(heavy->volume / whole->volume), &r->density);
	mp_warn(r, MP_WARN_OUT_OF_RANGE, mean && !r->density_defined);
	mp_warn(r, MP_WARN_NAME_AGAINST, closed && against);
}

/* Volume and area of ${whole}, everything else of ${heavy}, which may be the same. */
static void set_total(const struct mp_solid *whole, const struct mp_solid *heavy, bool closed,
		      const struct mp_density *density, struct mp_report *r)
{
	static const struct mp_density weightless = {.asked = true};
	struct mp_mass *m = &r->total, plain;
	bool fits = mp_mass_fill(m, heavy, closed, density);

	if (heavy != whole) {
		fits = mp_mass_fill(&plain, whole, closed, &weightless) && fits;
		m->volume = plain.volume;
		m->volume_defined = plain.volume_defined;
	}
	mp_warn(r, MP_WARN_OUT_OF_RANGE, !fits);
}

void mp_report_masses(const struct mp_request *request, const struct mp_mesh *mesh,
		      const struct mp_named *named, const struct mp_box *box,
		      struct mp_solid *whole, struct mp_density *density, bool *later,
		      struct mp_report *r)
{
	const struct mp_solid *heavy = whole;
	bool closed = mp_has_volume(&r->topology);
	struct mp_solid weighted;

	if (named->count > 0) {
		weigh(named, whole, closed, &weighted, density, r);
		mp_report_map_whole(r, mesh, box, whole, &weighted);
		heavy = &weighted;
	} else {
		mp_report_map_whole(r, mesh, box, whole, NULL);
		*density = find_density(request, whole, closed, r);
	}
	set_total(whole, heavy, closed, density, r);
	set_surface(whole, r);
	set_inertia(request, heavy, density, r);
	*later = *later && heavy == whole && is_moderate(&r->total);
	if (!*later)
		mp_report_certify(whole, heavy, density, r);
}

/* Who estimates uncertainties gets to see what they are made of, while it is in the cache. */
static int find_topology(const struct mp_request *request, const struct mp_mesh *mesh,
			 const struct mp_box *box, const struct mp_moments *moments,
			 struct mp_uncertainty_state *state, struct mp_report *r,
			 struct mp_error *err)
{
	struct mp_mesh watched = *mesh;

	if (mp_report_uncertainty_begin(request, mesh, box, moments, r, state))
		watched.watcher = &state->watcher;
	return mp_topology_find(&watched, request->defects, &r->topology, err);
}

static int fill(struct mp_analysis *a, const struct mp_request *request, struct mp_report *r,
		struct mp_named *named, struct mp_bodies *bodies, struct mp_report_exact *x,
		struct mp_error *err)
{
	const struct mp_mesh mesh = {.vertices = r->vertices,
				     .tri = (const uint32_t(*)[3])r->tri,
				     .triangles = r->triangles,
				     .flat = r->repaired ? NULL : a->flat,
				     .map = r->mapped ? &r->map : NULL,
				     .second = request->second};
	struct mp_density density;
	struct mp_uncertainty_state rounded;
	struct mp_solid whole, stored; /* stored: in the file's frame, as box */
	struct mp_box box;
	struct mp_report_later left;
	bool later = true; /* exact numbers may come in the place of the certified ones */

	memcpy(box.min, a->moments.min, sizeof box.min);
	memcpy(box.max, a->moments.max, sizeof box.max);
	mp_report_map_box(&mesh, &box, r);
	if (mp_named_sort(named, request, &a->names, mesh.triangles, err) ||
	    find_topology(request, &mesh, &box, &a->moments, &rounded, r, err) ||
	    mp_repair_judge(&mesh, a->request.key, r, err) ||
	    mp_named_bodies(named, &mesh, &r->topology, err) ||
	    mp_bodies_measure(&mesh, &r->topology, request->bodies, &a->moments, named, &whole,
			      bodies, err) ||
	    mp_capped_find(&mesh, &r->topology, &a->moments, &r->capped, err) ||
	    mp_named_solve(named, &mesh, a->request.key, err) ||
	    mp_bodies_nest(&mesh, &r->topology, bodies, err))
		return -1;
	if (!r->repaired) /* else the file's numbers are of another mesh */
		r->by_index = a->by_index;
	mp_index_compare(&r->by_index, &r->topology);
	stored = whole;
	mp_report_masses(request, &mesh, named, &box, &whole, &density, &later, r);
	left = (struct mp_report_later){later ? &whole : NULL, &density};
	if (mp_report_exact_whole(x, request, &mesh, bodies, &left, r, err) ||
	    mp_report_uncertainty(request, &mesh, &box, &stored, &rounded, r, err))
		return -1;
	if (mp_report_crossings(request, &mesh, bodies, a->request.key, r, err))
		return -1;
	warn(r);
	mp_bodies_judge(bodies, r);
	mp_report_map_bodies(r, &mesh, bodies);
	if (mp_bodies_list(bodies, &density, named, &a->names, r, err))
		return -1;
	return mp_report_exact_bodies(x, request, &mesh, bodies, r, err);
}

int mp_analysis_report(struct mp_analysis *a, const struct mp_request *request,
		       struct mp_report *out, struct mp_error *err)
{
	struct mp_bodies bodies = {0};
	struct mp_named named = {0};
	struct mp_report_exact exact = {.wanted = false};
	int ret;

	if (!a->ended) {
		memset(out, 0, sizeof *out);
		return mp_fail(err, MP_BUG, MP_NO_BYTE, "a report without an ended file");
	}
	take_mesh(a, request, out);
	if (request->checks == MP_CHECKS_CLOSED)
		ret = mp_report_streamed(a, request, out, err);
	else
		ret = mp_report_map_begin(request, out, err) ||
			      mp_repair(request, a->request.key, out, &a->moments, err) ||
			      fill(a, request, out, &named, &bodies, &exact, err)
			  ? -1
			  : 0;
	mp_report_exact_free(&exact);
	mp_bodies_free(&bodies);
	mp_named_free(&named);
	if (ret)
		mp_report_free(out);
	return ret;
}

void mp_report_free(struct mp_report *r)
{
	mp_vertices_free(r->vertices);
	free(r->tri);
	mp_topology_free(&r->topology);
	mp_crossings_free(&r->overlaps);
	mp_crossings_free(&r->self);
	free(r->body);
	free(r->names);
	memset(r, 0, sizeof *r);
}
