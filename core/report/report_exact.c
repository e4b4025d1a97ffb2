#include <math.h>
#include <string.h>

#include "core/exact/exact.h"
#include "core/moments/bounds.h"
#include "core/report/report_parts.h"

/*
 * Triangles that take less than a millisecond, by the width of the grid (exact.h), a wide margin
 * left for slow machines: about 20, 50 and 100 ns each, through GMP about a microsecond.
 */
static uint32_t most_by_width(const struct mp_exact_grid *grid)
{
	if (grid->bits == 0 || !grid->lossless)
		return 500;
	return grid->bits <= 30 ? 20000 : grid->bits <= 48 ? 8000 : 5000;
}

/* Even finding the grid takes its time: from here on nobody needs to look. */
enum { MOST_AUTO = 20000 };

static bool possible(const struct mp_request *request, const struct mp_report *r)
{
	return request->precision != MP_WISH_CERTIFIED && request->named_count == 0 &&
	       (request->precision == MP_WISH_EXACT || r->triangles <= MOST_AUTO);
}

/* What makes masses: the density of the request, NULL for 1. */
static const struct mp_exact_density *density_of(const struct mp_request *request,
						 const struct mp_exact *whole,
						 struct mp_exact_density *out)
{
	*out = (struct mp_exact_density){request->density, 1, NULL};
	if (request->density_kind == MP_DENSITY_NONE)
		return NULL;
	if (request->density_kind == MP_DENSITY_FROM_MASS)
		out->over = whole;
	else
		out->divisor = request->density_divisor;
	return out;
}

/* Its bound, with what a change of units may have added to the density. */
static double widened(double value, double bound, double relative)
{
	return relative == 0
		   ? bound
		   : mp_round_up(((long double)bound + relative * fabsl(value)) * (1 + 0x1p-40L));
}

/* What the sums come to: found once, used for the results, their ranges and their bounds. */
struct values {
	struct mp_exact_value volume, mass, centroid[3];
	struct mp_exact_tensor inertia; /* about the centroid */
	bool has_centroid;
};

/* ${about_origin}: the tensor about there, or NULL. */
static void evaluate(const struct mp_exact *e, const struct mp_exact_density *density,
		     struct values *v, struct mp_exact_tensor *about_origin)
{
	static const double origin[3];

	mp_exact_volume(e, &v->volume);
	v->mass = v->volume;
	v->mass.value = fabs(v->mass.value);
	if (density != NULL)
		mp_exact_mass(e, density, &v->mass);
	v->has_centroid = mp_exact_centroid(e, v->centroid);
	mp_exact_inertias(e, density, origin, &v->inertia, about_origin);
}

static void put_mass(const struct values *v, struct mp_mass *m)
{
	if (m->volume_defined && v->volume.defined)
		m->volume = v->volume.value;
	if (m->mass_defined && v->mass.defined)
		m->mass = v->mass.value;
	if (m->centroid_defined && v->has_centroid)
		for (int k = 0; k < 3; k++)
			m->centroid[k] = v->centroid[k].value;
	if (m->inertia_defined && v->inertia.defined)
		memcpy(m->inertia, v->inertia.value, sizeof m->inertia);
}

/* The tensors and the moment that are not of the centroid. */
static void put_inertia(const struct mp_request *request, const struct mp_exact *e,
			const struct mp_exact_density *density,
			const struct mp_exact_tensor *about_origin, struct mp_report *r)
{
	struct mp_exact_value moment, radius;
	struct mp_exact_tensor t;

	if (r->inertia_origin_defined && about_origin->defined) {
		memcpy(r->inertia_origin, about_origin->value, sizeof r->inertia_origin);
		r->bounds.inertia_origin = about_origin->bound;
	}
	if (r->inertia_about_defined) {
		mp_exact_inertia(e, density, request->about, &t);
		if (t.defined)
			memcpy(r->inertia_about, t.value, sizeof r->inertia_about);
	}
	if (!r->axis_defined)
		return;
	mp_exact_axis_moment(e, density, request->axis_origin, request->axis_direction, &moment,
			     &radius);
	if (moment.defined)
		r->axis.moment = moment.value;
	if (radius.defined && r->axis.radius_defined)
		r->axis.radius_of_gyration = radius.value;
}

static void put_bounds(const struct mp_request *request, const struct values *v,
		       struct mp_report *r)
{
	double relative = request->density_kind == MP_DENSITY_GIVEN ? request->density_error : 0,
	       largest = 0;
	const struct mp_exact_value *c = v->centroid;
	const struct mp_exact_tensor *t = &v->inertia;
	double mass_bound = widened(v->mass.value, v->mass.bound, relative);
	struct mp_ball mass = mp_ball(v->mass.value, mass_bound);

	r->bounds.volume = v->volume.bound;
	if (r->total.mass_defined)
		r->bounds.mass = mass_bound;
	if (r->total.centroid_defined && v->has_centroid)
		r->bounds.centroid = fmax(c[0].bound, fmax(c[1].bound, c[2].bound));
	if (!r->total.inertia_defined)
		return;
	for (int i = 0; i < 9; i++)
		largest = fmax(largest, fabs(t->value[i / 3][i % 3]));
	r->bounds.inertia = widened(largest, t->bound, relative);
	r->bounds.inertia_origin =
	    widened(fmax(fabs(r->inertia_origin[0][0]),
			 fmax(fabs(r->inertia_origin[1][1]), fabs(r->inertia_origin[2][2]))),
		    r->bounds.inertia_origin, relative);
	mp_report_principal(r, 3 * r->bounds.inertia, mass);
	if (r->total.inertia_defined)
		mp_bounds_of_principal(3 * r->bounds.inertia, mass, r);
}

/* Are all results that there are within the range of doubles for the exact numbers too? */
static bool all_defined(const struct values *v, const struct mp_exact_tensor *about_origin,
			const struct mp_report *r)
{
	const struct mp_mass *m = &r->total;

	return v->volume.defined && m->centroid_defined && v->has_centroid &&
	       (!m->mass_defined || v->mass.defined) &&
	       (!m->inertia_defined || v->inertia.defined) &&
	       (!r->inertia_origin_defined || about_origin->defined);
}

/* A volume that the certified sums could not tell from 0 is one after all. */
static void revive(struct mp_mass *m)
{
	m->centroid_defined = true;
	m->inertia_defined = m->mass_defined;
}

static void certify(const struct mp_report_later *later, struct mp_report *r)
{
	if (later->solid != NULL)
		mp_report_certify(later->solid, later->solid, later->density, r);
}

/* What is certified of the results in all cases. */
static void certify_area(const struct mp_report_later *later, struct mp_report *r)
{
	const struct mp_solid *s = later->solid;

	if (s != NULL && r->total.area_defined)
		r->bounds.area = mp_ball_distance(mp_ball(s->area, s->area_bound), r->total.area);
}

static void put_whole(const struct mp_report_later *later, const struct mp_request *request,
		      const struct mp_exact *e, const struct mp_exact_density *density,
		      struct mp_report *r)
{
	struct mp_mass before = r->total;
	bool origin_before = r->inertia_origin_defined;
	struct mp_exact_tensor about_origin;
	struct mp_exact_value mean;
	struct values v;

	if (mp_exact_sign(e) == 0) {
		certify(later, r);
		if (r->total.volume != 0)
			return;
		r->bounds.volume = 0;
		r->precision = MP_PRECISION_EXACT;
		return;
	}
	if (!before.centroid_defined) {
		revive(&r->total);
		r->inertia_origin_defined = r->total.inertia_defined;
	}
	evaluate(e, density, &v, &about_origin);
	if (!all_defined(&v, &about_origin, r)) {
		r->total = before;
		r->inertia_origin_defined = origin_before;
		certify(later, r);
		return;
	}
	certify_area(later, r);
	put_mass(&v, &r->total);
	put_inertia(request, e, density, &about_origin, r);
	put_bounds(request, &v, r);
	if (request->density_kind == MP_DENSITY_FROM_MASS && r->density_defined) {
		mp_exact_density(density, &mean);
		r->density = mean.defined ? mean.value : r->density;
	}
	r->precision = MP_PRECISION_EXACT;
}

/* The sums over those triangles, as mapped by the request.  -1: memory is out, nothing to free. */
static int find_mapped(const struct mp_mesh *mesh, const struct mp_exact_grid *grid,
		       const struct mp_report *r, const uint32_t *order, uint32_t count,
		       struct mp_exact *out, struct mp_error *err)
{
	if (mp_exact_find(mesh, grid, order, count, out, err))
		return -1;
	if (!r->mapped || mp_exact_map(out, (const double(*)[4])r->map.row, err) == 0)
		return 0;
	mp_exact_free(out);
	return -1;
}

/* Which way the bodies are wound that seemed to be flat. */
static int settle_winding(const struct mp_mesh *mesh, const struct mp_exact_grid *grid,
			  const struct mp_report *r, struct mp_bodies *bodies, struct mp_error *err)
{
	for (uint32_t b = 0; b < bodies->count; b++) {
		struct mp_exact e;
		int sign;

		if (bodies->winding[b] != MP_ORIENTATION_NONE ||
		    !mp_body_has_volume(&r->topology.body[b]))
			continue;
		if (mp_exact_find(mesh, grid, mp_bodies_order(bodies, b),
				  bodies->start[b + 1] - bodies->start[b], &e, err))
			return -1;
		sign = mp_exact_sign(&e);
		if (sign != 0)
			bodies->winding[b] =
			    (uint8_t)(sign > 0 ? MP_ORIENTATION_OUTWARD : MP_ORIENTATION_INWARD);
		mp_exact_free(&e);
	}
	return 0;
}

/* 1: exact numbers cannot be had; -1: memory is out. */
static int find_whole(struct mp_report_exact *x, const struct mp_request *request,
		      const struct mp_mesh *mesh, struct mp_bodies *bodies, struct mp_report *r,
		      struct mp_exact *whole, struct mp_error *err)
{
	if (!possible(request, r))
		return 1;
	if (mp_exact_grid_find(mesh, &x->grid, err))
		return -1;
	x->wanted = request->precision == MP_WISH_EXACT || r->triangles <= most_by_width(&x->grid);
	if (!x->wanted)
		return 1;
	if (settle_winding(mesh, &x->grid, r, bodies, err))
		return -1;
	if (!mp_has_volume(&r->topology) || !r->total.volume_defined)
		return 1;
	return find_mapped(mesh, &x->grid, r, NULL, mesh->triangles, whole, err);
}

int mp_report_exact_whole(struct mp_report_exact *x, const struct mp_request *request,
			  const struct mp_mesh *mesh, struct mp_bodies *bodies,
			  const struct mp_report_later *later, struct mp_report *r,
			  struct mp_error *err)
{
	struct mp_exact_density made;
	struct mp_exact whole;
	int found = find_whole(x, request, mesh, bodies, r, &whole, err);

	if (found > 0)
		certify(later, r);
	if (found != 0)
		return found < 0 ? -1 : 0;
	put_whole(later, request, &whole, density_of(request, &whole, &made), r);
	mp_exact_free(&whole);
	return 0;
}

static void put_body(const struct mp_exact *e, const struct mp_exact_density *density,
		     struct mp_body *body)
{
	struct values v;

	if (mp_exact_sign(e) == 0)
		return;
	if (!body->mass.centroid_defined)
		revive(&body->mass);
	evaluate(e, density, &v, NULL);
	put_mass(&v, &body->mass);
}

/* The only body of a mesh has its numbers already. */
static bool same_as_whole(const struct mp_mesh *mesh, const struct mp_bodies *bodies, uint32_t b,
			  const struct mp_report *r)
{
	const struct mp_mass *m = &r->body[b].mass;

	return bodies->start[b + 1] - bodies->start[b] == mesh->triangles &&
	       r->precision == MP_PRECISION_EXACT && m->centroid_defined &&
	       m->mass_defined == r->total.mass_defined &&
	       m->inertia_defined == r->total.inertia_defined && r->total.centroid_defined;
}

static void put_same(const struct mp_mass *whole, struct mp_mass *m)
{
	m->volume = whole->volume;
	m->mass = whole->mass;
	memcpy(m->centroid, whole->centroid, sizeof m->centroid);
	memcpy(m->inertia, whole->inertia, sizeof m->inertia);
}

int mp_report_exact_bodies(const struct mp_report_exact *x, const struct mp_request *request,
			   const struct mp_mesh *mesh, const struct mp_bodies *bodies,
			   struct mp_report *r, struct mp_error *err)
{
	struct mp_exact_density made;
	const struct mp_exact_density *density;
	struct mp_exact whole = {.limb = NULL};
	int rc = 0;

	if (!x->wanted)
		return 0;
	if (request->density_kind == MP_DENSITY_FROM_MASS &&
	    find_mapped(mesh, &x->grid, r, NULL, mesh->triangles, &whole, err))
		return -1;
	density = density_of(request, &whole, &made);
	for (uint32_t b = 0; b < r->bodies_listed && rc == 0; b++) {
		struct mp_exact e;

		if (!r->body[b].mass.volume_defined)
			continue;
		if (same_as_whole(mesh, bodies, b, r)) {
			put_same(&r->total, &r->body[b].mass);
			continue;
		}
		rc = find_mapped(mesh, &x->grid, r, mp_bodies_order(bodies, b),
				 bodies->start[b + 1] - bodies->start[b], &e, err);
		if (rc == 0) {
			put_body(&e, density, &r->body[b]);
			mp_exact_free(&e);
		}
	}
	mp_exact_free(&whole);
	return rc;
}

void mp_report_exact_free(struct mp_report_exact *x)
{
	mp_exact_grid_free(&x->grid);
}
