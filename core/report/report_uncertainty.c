#include <math.h>
#include <string.h>

#include "core/moments/mass.h"
#include "core/report/report_parts.h"

static struct mp_rounded_solid describe(const struct mp_mesh *mesh, const struct mp_box *box,
					const struct mp_report *r)
{
	struct mp_rounded_solid s = {
	    .mesh = mesh, .float32 = true, .step = r->notes.quantisation_step, .map = mesh->map};

	memcpy(s.min, box->min, sizeof s.min);
	memcpy(s.max, box->max, sizeof s.max);
	return s;
}

/* As in the frame of the file; ${stored} knows its centroid there. */
static void put_stored(const struct mp_solid *stored, struct mp_rounded_solid *s)
{
	s->volume = stored->has_centroid ? (double)stored->volume : 0;
	for (int k = 0; k < 3; k++)
		s->centroid[k] = (double)stored->centroid[k];
}

/* Formats that have names say nothing of their rounding. */
static enum mp_rounding source_of(const struct mp_request *request, const struct mp_report *r)
{
	return request->named_count == 0 ? r->notes.rounding : MP_ROUNDING_UNKNOWN;
}

bool mp_report_uncertainty_begin(const struct mp_request *request, const struct mp_mesh *mesh,
				 const struct mp_box *box, const struct mp_moments *moments,
				 const struct mp_report *r, struct mp_uncertainty_state *state)
{
	struct mp_rounded_solid s = describe(mesh, box, r);
	struct mp_solid guess;

	if (source_of(request, r) == MP_ROUNDING_UNKNOWN)
		return false;
	mp_moments_solve(moments, &guess);
	put_stored(&guess, &s);
	mp_uncertainty_begin(state, &s);
	return true;
}

static void put_centroid(const struct mp_deviation *d, struct mp_report *r)
{
	struct mp_uncertainty *u = &r->uncertainty;

	u->centroid_defined =
	    r->total.centroid_defined &&
	    mp_in_range(fmaxl(d->centroid[0], fmaxl(d->centroid[1], d->centroid[2])), &u->centroid);
}

/* A weighed mass stays what it is. */
static void put_mass(const struct mp_request *request, const struct mp_deviation *d,
		     struct mp_report *r)
{
	struct mp_uncertainty *u = &r->uncertainty;
	bool weighed = request->density_kind == MP_DENSITY_FROM_MASS;

	u->mass_defined = r->has_density && r->total.mass_defined &&
			  mp_in_range(weighed ? 0 : d->volume * r->density, &u->mass);
}

int mp_report_uncertainty(const struct mp_request *request, const struct mp_mesh *mesh,
			  const struct mp_box *box, const struct mp_solid *stored,
			  struct mp_uncertainty_state *state, struct mp_report *r,
			  struct mp_error *err)
{
	struct mp_uncertainty *u = &r->uncertainty;
	struct mp_rounded_solid s = describe(mesh, box, r);
	struct mp_deviation d;

	u->source = source_of(request, r);
	if (u->source == MP_ROUNDING_UNKNOWN || !r->total.volume_defined)
		return 0;
	if (r->mapped) {
		put_stored(stored, &s);
	} else {
		s.volume = r->total.volume;
		memcpy(s.centroid, r->total.centroid, sizeof s.centroid);
	}
	if (mp_uncertainty_end(state, &s, &d, err))
		return -1;
	u->volume_defined = mp_in_range(d.volume, &u->volume);
	put_mass(request, &d, r);
	if (!r->mapped || stored->has_centroid)
		put_centroid(&d, r);
	return 0;
}
