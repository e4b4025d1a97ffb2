#include "api/report_json.h"

#include <math.h>
#include <stdlib.h>

#include "api/json_build.h"
#include "api/report_extras.h"
#include "api/report_lists.h"
#include "api/report_words.h"
#include "api/units.h"

/* Defects a document holds at most: 100,000 of each kind at 150 bytes are less than half. */
enum { MOST_DEFECT_TEXT = 256 << 20 };

struct doc {
	const struct mp_report *r;
	const struct api_options *o;
	struct api_json j;
	bool lists_cut;
};

static void add_transform(struct doc *d, cJSON *in)
{
	struct api_text *rows = api_json_raw(&d->j, in, "transform");

	for (int i = 0; i < 3 && d->o->has_transform; i++) {
		api_text_say(rows, i == 0 ? "[" : ",");
		api_text_vector(rows, d->o->transform[i], 4);
	}
	api_text_say(rows, d->o->has_transform ? "]" : "null");
}

static void add_input(struct doc *d, cJSON *root, const char *filename)
{
	cJSON *in = api_json_object(&d->j, root, "input");

	if (filename != NULL)
		api_json_string(&d->j, in, "filename", filename);
	else
		api_json_null(&d->j, in, "filename");
	if (d->o->sent.filenames != NULL)
		api_text_say(api_json_raw(&d->j, in, "filenames"), d->o->sent.filenames);
	api_json_string(&d->j, in, "format", api_format_word(d->r->notes.format));
	api_json_count(&d->j, in, "bytes", d->r->notes.bytes);
	api_json_string(&d->j, in, "unit", api_unit_names[d->o->unit]);
	add_transform(d, in);
	if (d->o->sent.sha256 != NULL)
		api_json_string(&d->j, in, "sha256", d->o->sent.sha256);
	else
		api_json_null(&d->j, in, "sha256");
	if (d->o->sent.digests != NULL)
		api_text_say(api_json_raw(&d->j, in, "sha256_of_files"), d->o->sent.digests);
}

/* The unit ${base}, or ${over}.${base}, to the power; their names need no backslashes. */
static void add_unit(struct doc *d, cJSON *units, const char *name, const char *over,
		     const char *base, int power)
{
	struct api_text *t = api_json_raw(&d->j, units, name);

	api_text_say(t, "\"");
	if (over != NULL) {
		api_text_say(t, over);
		api_text_say(t, ".");
	}
	api_text_say(t, base);
	if (power > 1)
		api_text_count(t, (uint64_t)power);
	api_text_say(t, "\"");
}

static void add_units(struct doc *d, cJSON *root)
{
	const char *length = api_unit_names[d->o->unit];
	const char *density = api_density_unit_names[d->o->density_unit];
	const char *mass = d->o->density_unit == API_DENSITY_FILE
			       ? density /* whatever the density's mass is in */
			       : api_mass_unit_names[d->o->mass_unit];
	cJSON *units = api_json_object(&d->j, root, "units");

	add_unit(d, units, "length", NULL, length, 1);
	add_unit(d, units, "area", NULL, length, 2);
	add_unit(d, units, "volume", NULL, length, 3);
	if (d->r->has_density) {
		api_json_string(&d->j, units, "mass", mass);
		api_json_string(&d->j, units, "density", density);
		add_unit(d, units, "inertia", mass, length, 2);
	} else {
		api_json_null(&d->j, units, "mass");
		api_json_null(&d->j, units, "density");
		add_unit(d, units, "inertia", NULL, length, 5);
	}
}

/* What is known of a table of the triangles: null under checks=closed, which has none. */
static void add_known(struct doc *d, cJSON *to, const char *name, uint64_t count)
{
	if (d->r->streamed)
		api_json_null(&d->j, to, name);
	else
		api_json_count(&d->j, to, name, count);
}

static void add_verdict(struct doc *d, cJSON *to, const char *name, bool verdict)
{
	if (d->r->streamed)
		api_json_null(&d->j, to, name);
	else
		api_json_bool(&d->j, to, name, verdict);
}

static void add_mesh(struct doc *d, cJSON *root)
{
	const struct mp_topology *t = &d->r->topology;
	const struct mp_box *box = &d->r->box;
	cJSON *mesh = api_json_object(&d->j, root, "mesh"), *b;
	double size[3];

	for (int k = 0; k < 3; k++)
		size[k] = box->max[k] - box->min[k];
	api_json_count(&d->j, mesh, "triangles", d->r->triangles);
	api_json_count(&d->j, mesh, "polygons", d->r->notes.polygons);
	api_json_count(&d->j, mesh, "surfaces", 0);
	add_known(d, mesh, "vertices", t->vertices);
	add_known(d, mesh, "edges", t->edges);
	add_known(d, mesh, "bodies", t->bodies);
	if (d->r->streamed)
		api_json_null(&d->j, mesh, "euler_characteristic");
	else
		api_json_signed(&d->j, mesh, "euler_characteristic", t->euler);
	b = api_json_object(&d->j, mesh, "bounding_box");
	api_json_vector(&d->j, b, "min", true, box->min, 3);
	api_json_vector(&d->j, b, "max", true, box->max, 3);
	api_json_vector(&d->j, b, "size", true, size, 3);
}

static void add_solid(struct doc *d, cJSON *checks)
{
	if (d->r->solid == MP_UNDECIDED)
		api_json_null(&d->j, checks, "solid");
	else
		api_json_bool(&d->j, checks, "solid", d->r->solid == MP_YES);
}

static void add_orientation(struct doc *d, cJSON *checks)
{
	const struct mp_report *r = d->r;

	if (r->streamed && r->topology.closed && r->orientation == MP_ORIENTATION_NONE)
		api_json_null(&d->j, checks, "orientation");
	else
		api_json_string(&d->j, checks, "orientation", api_orientation_word(r->orientation));
}

static void add_by_index(struct doc *d, cJSON *checks)
{
	const struct mp_by_index *by = &d->r->by_index;
	cJSON *o;

	if (!by->given) {
		api_json_null(&d->j, checks, "by_index");
		return;
	}
	o = api_json_object(&d->j, checks, "by_index");
	api_json_bool(&d->j, o, "closed", by->closed);
	api_json_bool(&d->j, o, "watertight", by->watertight);
	api_json_count(&d->j, o, "boundary_edges", by->boundary_edges);
	api_json_count(&d->j, o, "non_manifold_edges", by->non_manifold_edges);
	api_json_count(&d->j, o, "misoriented_edges", by->misoriented_edges);
}

static void add_checks(struct doc *d, cJSON *root)
{
	const struct mp_topology *t = &d->r->topology;
	struct api_json *j = &d->j;
	cJSON *c = api_json_object(j, root, "checks");

	api_json_bool(j, c, "closed", t->closed);
	add_verdict(d, c, "watertight", t->watertight);
	add_verdict(d, c, "winding_consistent", t->winding_consistent);
	add_orientation(d, c);
	add_solid(d, c);
	add_known(d, c, "boundary_edges", t->boundary_edges);
	add_known(d, c, "boundary_loops", t->boundary_loops);
	add_known(d, c, "non_manifold_edges", t->non_manifold_edges);
	add_known(d, c, "non_manifold_vertices", t->non_manifold_vertices);
	add_known(d, c, "misoriented_edges", t->misoriented_edges);
	api_json_count(j, c, "degenerate_triangles", t->degenerate_triangles);
	add_known(d, c, "duplicate_triangles", t->duplicate_triangles);
	add_known(d, c, "duplicates_same", t->duplicate_triangles - t->opposite_duplicates);
	add_known(d, c, "duplicates_opposite", t->opposite_duplicates);
	add_known(d, c, "double_walls", t->double_walls);
	add_known(d, c, "single_walls", t->single_walls);
	api_json_count(j, c, "normals_disagreeing", d->r->notes.normals_disagreeing);
	api_crossings_count(j, c, d->r);
	api_json_vector(j, c, "closure_defect", true, d->r->closure_defect, 3);
	api_json_value(j, c, "closes_at_tolerance", d->r->closes_at_tolerance > 0,
		       d->r->closes_at_tolerance);
	add_by_index(d, c);
}

static void add_axis(struct doc *d, cJSON *inertia)
{
	const struct mp_axis_moment *axis = &d->r->axis;
	cJSON *a;

	if (!d->r->axis_defined) {
		api_json_null(&d->j, inertia, "about_axis");
		return;
	}
	a = api_json_object(&d->j, inertia, "about_axis");
	api_json_vector(&d->j, a, "origin", true, axis->origin, 3);
	api_json_vector(&d->j, a, "direction", true, axis->direction, 3);
	api_json_value(&d->j, a, "moment", true, axis->moment);
	api_json_value(&d->j, a, "radius_of_gyration", axis->radius_defined,
		       axis->radius_of_gyration);
}

static void add_inertia(struct doc *d, cJSON *properties)
{
	const struct mp_report *r = d->r;
	cJSON *i;

	if (!r->total.inertia_defined && !r->inertia_origin_defined && !r->axis_defined) {
		api_json_null(&d->j, properties, "inertia");
		return;
	}
	i = api_json_object(&d->j, properties, "inertia");
	api_json_string(&d->j, i, "convention", "tensor: [0][1] = -integral of density*x*y");
	api_json_matrix(&d->j, i, "about_origin", r->inertia_origin_defined, r->inertia_origin);
	api_json_matrix(&d->j, i, "about_centroid", r->total.inertia_defined, r->total.inertia);
	api_json_matrix(&d->j, i, "about_point", r->inertia_about_defined, r->inertia_about);
	api_json_vector(&d->j, i, "point", d->o->has_about, d->o->about, 3);
	add_axis(d, i);
}

static void add_principal(struct doc *d, cJSON *properties)
{
	const struct mp_principal *p = &d->r->principal;
	cJSON *o;

	if (!d->r->total.inertia_defined) {
		api_json_null(&d->j, properties, "principal");
		return;
	}
	o = api_json_object(&d->j, properties, "principal");
	api_json_vector(&d->j, o, "moments", true, p->moments, 3);
	api_json_matrix(&d->j, o, "axes", true, p->axes);
	api_json_vector(&d->j, o, "quaternion_wxyz", true, p->quaternion, 4);
	api_json_vector(&d->j, o, "radii_of_gyration", d->r->radii_defined, d->r->radii_of_gyration,
			3);
	api_json_string(&d->j, o, "symmetry", api_symmetry_word(p->symmetry));
}

static void add_density(struct doc *d, cJSON *properties)
{
	const struct mp_mass *m = &d->r->total;
	bool defined = d->r->has_density && d->r->density_defined;
	double density = 0;

	if (d->o->named.count > 0) {
		defined = defined && m->mass_defined && m->volume_defined;
		density = defined ? api_options_mean_density(d->o, m->mass, fabs(m->volume)) : 0;
	} else if (defined) {
		density = api_options_density(d->o, fabs(m->volume));
	}
	api_json_value(&d->j, properties, "density", defined, density);
}

static void add_properties(struct doc *d, cJSON *root)
{
	const struct mp_report *r = d->r;
	const struct mp_mass *m = &r->total;
	cJSON *p = api_json_object(&d->j, root, "properties");

	api_json_value(&d->j, p, "volume", m->volume_defined, fabs(m->volume));
	api_json_value(&d->j, p, "signed_volume", m->volume_defined, m->volume);
	api_json_value(&d->j, p, "surface_area", m->area_defined, m->area);
	api_json_vector(&d->j, p, "surface_centroid", r->surface_centroid_defined,
			r->surface_centroid, 3);
	add_density(d, p);
	api_json_value(&d->j, p, "mass", r->has_density && m->mass_defined, m->mass);
	api_json_vector(&d->j, p, "centroid", m->centroid_defined, m->centroid, 3);
	add_inertia(d, p);
	add_principal(d, p);
	api_json_value(&d->j, p, "volume_if_capped", r->capped.volume_defined, r->capped.volume);
	api_json_value(&d->j, p, "cap_area", r->capped.area_defined, r->capped.area);
	api_json_value(&d->j, p, "volume_if_oriented", r->volume_if_oriented_defined,
		       r->volume_if_oriented);
}

/* Null where the result is. */
static void add_bounds(struct doc *d, cJSON *root)
{
	const struct mp_report *r = d->r;
	const struct mp_bounds *b = &r->bounds;
	const struct mp_mass *m = &r->total;
	cJSON *o = api_json_object(&d->j, root, "error_bounds");

	api_json_value(&d->j, o, "volume", m->volume_defined, b->volume);
	api_json_value(&d->j, o, "surface_area", m->area_defined, b->area);
	api_json_value(&d->j, o, "mass", r->has_density && m->mass_defined, b->mass);
	api_json_value(&d->j, o, "centroid", m->centroid_defined, b->centroid);
	api_json_value(&d->j, o, "inertia", m->inertia_defined, b->inertia);
	api_json_value(&d->j, o, "inertia_about_origin", r->inertia_origin_defined,
		       b->inertia_origin);
	api_json_value(&d->j, o, "principal_moments", m->inertia_defined, b->moments);
	api_json_value(&d->j, o, "principal_axes_rad", m->inertia_defined, b->axes);
	api_json_value(&d->j, o, "radii_of_gyration", m->inertia_defined && r->radii_defined,
		       b->radii);
	api_json_null(&d->j, o, "quadrature_estimate");
}

static void add_defects(struct doc *d, cJSON *root)
{
	static const char *const names[MP_DEFECT_KINDS] = {
	    [MP_DEFECT_BOUNDARY_EDGE] = "boundary_edges",
	    [MP_DEFECT_BOUNDARY_LOOP] = "boundary_loops",
	    [MP_DEFECT_NON_MANIFOLD_EDGE] = "non_manifold_edges",
	    [MP_DEFECT_NON_MANIFOLD_VERTEX] = "non_manifold_vertices",
	    [MP_DEFECT_MISORIENTED_EDGE] = "misoriented_edges",
	    [MP_DEFECT_DEGENERATE_TRIANGLE] = "degenerate_triangles",
	    [MP_DEFECT_DUPLICATE_TRIANGLE] = "duplicate_triangles",
	};
	cJSON *defects;
	size_t left = MOST_DEFECT_TEXT;

	if (d->r->streamed) {
		api_json_null(&d->j, root, "defects");
		return;
	}
	defects = api_json_object(&d->j, root, "defects");
	for (int k = 0; k < MP_DEFECT_KINDS; k++) {
		struct api_text *t = api_json_raw(&d->j, defects, names[k]);
		size_t before = t->len;

		if (!api_defects_text(d->r, (enum mp_defect_kind)k, left, t))
			d->lists_cut = true;
		left -= t->len - before < left ? t->len - before : left;
	}
	api_crossings_list(&d->j, defects, d->r);
	api_json_bool(&d->j, defects, "truncated", d->r->topology.truncated || d->lists_cut);
}

static void add_tail(struct doc *d, cJSON *root, const struct api_timing *timing)
{
	const double ms[] = {timing->receive, timing->queue, timing->decode, timing->analyse};
	static const char *const names[] = {"receive", "queue", "decode", "analyse"};
	cJSON *o = api_json_object(&d->j, root, "repairs");

	api_json_count(&d->j, o, "flipped_triangles", d->r->flipped_triangles);
	api_json_count(&d->j, o, "welded_vertices", d->r->welded_vertices);
	(void)api_warnings_text(d->r, d->o, d->lists_cut, api_json_raw(&d->j, root, "warnings"));
	o = api_json_object(&d->j, root, "timing_ms");
	for (int i = 0; i < 4; i++) /* whole microseconds */
		api_json_value(&d->j, o, names[i], true, round(ms[i] * 1000) / 1000);
}

char *api_report_json(const struct mp_report *report, const struct api_options *options,
		      const char *filename, const struct api_timing *timing, size_t *len)
{
	struct doc d = {.r = report, .o = options};
	cJSON *root = api_json_begin(&d.j);

	api_json_string(&d.j, root, "schema", "masspropd/1");
	api_json_string(&d.j, root, "precision", api_precision_word(report->precision));
	add_input(&d, root, filename);
	add_units(&d, root);
	add_mesh(&d, root);
	add_checks(&d, root);
	add_properties(&d, root);
	add_bounds(&d, root);
	api_uncertainty_add(&d.j, root, report);
	if (report->streamed)
		api_json_null(&d.j, root, "bodies");
	else
		api_bodies_text(report, api_json_raw(&d.j, root, "bodies"));
	add_defects(&d, root);
	api_facets_add(&d.j, root, report, (options->include & API_INCLUDE_FACETS) != 0);
	add_tail(&d, root, timing);
	return api_json_finish(&d.j, len);
}
