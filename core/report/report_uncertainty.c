#include <math.h>
#include <string.h>

#include "core/moments/mass.h"
#include "core/report/report_parts.h"

/* In the frame of the file; ${stored} knows its centroid there. */
static void describe_stored(const struct mp_box *box, const struct mp_solid *stored,
			    struct mp_rounded_solid *s)
{
	memcpy(s->min, box->min, sizeof s->min);
	memcpy(s->max, box->max, sizeof s->max);
	s->volume = stored->has_centroid ? (double)stored->volume : 0;
	for (int k = 0; k < 3; k++)
		s->centroid[k] = (double)stored->centroid[k];
}

static struct mp_rounded_solid describe(const struct mp_mesh *mesh, const struct mp_report *r)
{
	struct mp_rounded_solid s = {.mesh = mesh,
				     .float32 = true,
				     .step = r->notes.quantisation_step,
				     .volume = r->total.volume,
				     .map = mesh->map};

	memcpy(s.min, r->box.min, sizeof s.min);
	memcpy(s.max, r->box.max, sizeof s.max);
	memcpy(s.centroid, r->total.centroid, sizeof s.centroid);
	return s;
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
			  struct mp_report *r, struct mp_error *err)
{
	struct mp_uncertainty *u = &r->uncertainty;
	struct mp_rounded_solid s = describe(mesh, r);
	struct mp_deviation d;

	/* formats that have names say nothing of their rounding */
	u->source = request->named_count == 0 ? r->notes.rounding : MP_ROUNDING_UNKNOWN;
	if (u->source == MP_ROUNDING_UNKNOWN || !r->total.volume_defined)
		return 0;
	if (r->mapped)
		describe_stored(box, stored, &s);
	if (mp_uncertainty_find(&s, &d, err))
		return -1;
	u->volume_defined = mp_in_range(d.volume, &u->volume);
	put_mass(request, &d, r);
	if (!r->mapped || stored->has_centroid)
		put_centroid(&d, r);
	return 0;
}
