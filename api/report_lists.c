#include "api/report_lists.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "api/report_words.h"
#include "api/warnings.h"

enum { MOST_NAMED = 10 }; /* bodies in a warning */

static void number(struct api_text *t, bool defined, double x)
{
	api_text_number(t, defined ? x : NAN);
}

static void nest(struct api_text *t, const struct mp_nest *n)
{
	API_TEXT_MEMBER(t, "depth");
	if (n->decided)
		api_text_count(t, n->depth);
	else
		api_text_say(t, "null");
	API_TEXT_MEMBER(t, "parent");
	if (n->decided && n->parent != MP_NO_BODY)
		api_text_count(t, n->parent);
	else
		api_text_say(t, "null");
}

static void body_mass(struct api_text *t, const struct mp_mass *m, bool has_density)
{
	API_TEXT_MEMBER(t, "volume");
	number(t, m->volume_defined, fabs(m->volume));
	API_TEXT_MEMBER(t, "signed_volume");
	number(t, m->volume_defined, m->volume);
	API_TEXT_MEMBER(t, "surface_area");
	number(t, m->area_defined, m->area);
	API_TEXT_MEMBER(t, "mass");
	number(t, m->mass_defined && has_density, m->mass);
	API_TEXT_MEMBER(t, "centroid");
	if (m->centroid_defined)
		api_text_vector(t, m->centroid, 3);
	else
		api_text_say(t, "null");
	API_TEXT_MEMBER(t, "inertia_about_centroid");
	if (m->inertia_defined)
		api_text_matrix(t, m->inertia);
	else
		api_text_say(t, "null");
}

static void body(struct api_text *t, const struct mp_body *b, bool has_density)
{
	api_text_say(t, "{\"triangles\":");
	api_text_count(t, b->triangles);
	body_mass(t, &b->mass, has_density);
	API_TEXT_MEMBER(t, "bounding_box");
	api_text_say(t, "{\"min\":");
	api_text_vector(t, b->box.min, 3);
	API_TEXT_MEMBER(t, "max");
	api_text_vector(t, b->box.max, 3);
	api_text_say(t, "}");
	API_TEXT_MEMBER(t, "watertight");
	api_text_bool(t, b->watertight);
	API_TEXT_MEMBER(t, "orientable");
	api_text_bool(t, b->orientable);
	API_TEXT_MEMBER(t, "genus");
	if (b->genus >= 0)
		api_text_count(t, (uint64_t)b->genus);
	else
		api_text_say(t, "null");
	API_TEXT_MEMBER(t, "orientation");
	api_text_string(t, api_orientation_word(b->orientation),
			strlen(api_orientation_word(b->orientation)));
	nest(t, &b->nest);
	API_TEXT_MEMBER(t, "cavity");
	api_text_bool(t, b->cavity);
	API_TEXT_MEMBER(t, "name");
	if (b->name != NULL && b->name_len > 0)
		api_text_string(t, b->name, b->name_len);
	else
		api_text_say(t, "null");
	api_text_say(t, "}");
}

void api_bodies_text(const struct mp_report *r, struct api_text *out)
{
	api_text_say(out, "[");
	for (uint32_t i = 0; i < r->bodies_listed; i++) {
		if (i > 0)
			api_text_say(out, ",");
		body(out, &r->body[i], r->has_density);
	}
	api_text_say(out, "]");
}

static void vertex(struct api_text *t, const struct mp_report *r, uint32_t v)
{
	double xyz[3];

	mp_report_vertex(r, v, xyz);
	api_text_vector(t, xyz, 3);
}

static void junctions(struct api_text *t, const struct mp_report *r, const struct mp_loop *l)
{
	API_TEXT_MEMBER(t, "t_junctions");
	api_text_say(t, "[");
	for (size_t i = 0; i < l->junctions; i++) {
		const struct mp_junction *j = &r->topology.junction[l->junction_at + i];

		api_text_say(t, i > 0 ? ",{\"vertex\":" : "{\"vertex\":");
		vertex(t, r, j->vertex);
		API_TEXT_MEMBER(t, "edge");
		api_text_say(t, "[");
		vertex(t, r, j->ends[0]);
		api_text_say(t, ",");
		vertex(t, r, j->ends[1]);
		api_text_say(t, "]}");
	}
	api_text_say(t, "]");
}

static void loop(struct api_text *t, const struct mp_report *r, const struct mp_loop *l)
{
	API_TEXT_MEMBER(t, "edge_count");
	api_text_count(t, l->edges);
	API_TEXT_MEMBER(t, "vertex_count");
	api_text_count(t, l->vertices);
	API_TEXT_MEMBER(t, "simple");
	api_text_bool(t, l->simple);
	API_TEXT_MEMBER(t, "length");
	number(t, l->length_defined, l->length);
	API_TEXT_MEMBER(t, "area");
	number(t, l->area_defined, l->area);
	API_TEXT_MEMBER(t, "planar");
	api_text_bool(t, l->planar);
	API_TEXT_MEMBER(t, "plane_deviation");
	number(t, l->plane_defined, l->plane_deviation);
	API_TEXT_MEMBER(t, "crack");
	api_text_bool(t, l->crack);
	junctions(t, r, l);
	API_TEXT_MEMBER(t, "bounding_box");
	api_text_say(t, "{\"min\":");
	api_text_vector(t, l->min, 3);
	API_TEXT_MEMBER(t, "max");
	api_text_vector(t, l->max, 3);
	api_text_say(t, "}");
}

/* What the entries of some kinds have beside triangles and vertices. */
static void extras(struct api_text *t, const struct mp_report *r, enum mp_defect_kind kind,
		   const struct mp_defect_list *d, size_t i)
{
	const uint32_t *pair = d->triangles + d->triangle_at[i];

	if (kind == MP_DEFECT_BOUNDARY_LOOP)
		loop(t, r, &r->topology.loop[i]);
	if (kind == MP_DEFECT_DUPLICATE_TRIANGLE) {
		API_TEXT_MEMBER(t, "opposite");
		api_text_bool(t, !mp_same_winding(r->tri[pair[0]], r->tri[pair[1]]));
	}
}

static void defect(struct api_text *t, const struct mp_report *r, enum mp_defect_kind kind,
		   size_t i)
{
	const struct mp_defect_list *d = &r->topology.defect[kind];

	api_text_say(t, "{\"triangles\":[");
	for (size_t k = d->triangle_at[i]; k < d->triangle_at[i + 1]; k++) {
		if (k > d->triangle_at[i])
			api_text_put(t, ",", 1);
		api_text_count(t, d->triangles[k]);
	}
	api_text_say(t, "],\"vertices\":[");
	for (size_t k = d->vertex_at[i]; k < d->vertex_at[i + 1]; k++) {
		if (k > d->vertex_at[i])
			api_text_put(t, ",", 1);
		vertex(t, r, d->vertices[k]);
	}
	api_text_say(t, "]");
	extras(t, r, kind, d, i);
	api_text_say(t, "}");
}

bool api_defects_text(const struct mp_report *r, enum mp_defect_kind kind, size_t most,
		      struct api_text *out)
{
	const struct mp_defect_list *d = &r->topology.defect[kind];
	size_t i = 0, at = out->len;

	api_text_say(out, "[");
	for (; i < d->count && out->len - at < most && !out->failed; i++) {
		if (i > 0)
			api_text_say(out, ",");
		defect(out, r, kind, i);
	}
	api_text_say(out, "]");
	return i == d->count;
}

/* The sentence, with the numbers of the first few bodies it is about. */
static void message(struct api_text *t, size_t row, const char *text, const struct mp_report *r)
{
	struct api_text all = {0};
	unsigned named = 0;

	if (row != MP_WARN_NON_ORIENTABLE) {
		api_text_string(t, text, strlen(text));
		return;
	}
	api_text_say(&all, text);
	for (uint32_t i = 0; i < r->bodies_listed; i++) {
		if (r->body[i].orientable || ++named > MOST_NAMED)
			continue;
		api_text_say(&all, named == 1 ? " Bodies: " : ", ");
		api_text_count(&all, i);
	}
	if (named > 0)
		api_text_say(&all, named > MOST_NAMED ? " and more." : ".");
	if (all.failed)
		t->failed = true;
	else
		api_text_string(t, all.text, all.len);
	free(all.text);
}

size_t api_warnings_text(const struct mp_report *r, const struct api_options *o, bool lists_cut,
			 struct api_text *out)
{
	const struct api_warning *w;
	size_t listed = 0;

	api_text_say(out, "[");
	for (size_t i = 0; (w = api_warning_row(i)) != NULL; i++) {
		if (!api_warning_applies(i, r, o, lists_cut))
			continue;
		api_text_say(out, listed++ > 0 ? ",{\"code\":" : "{\"code\":");
		api_text_string(out, w->code, strlen(w->code));
		API_TEXT_MEMBER(out, "message");
		message(out, i, w->message, r);
		api_text_say(out, "}");
	}
	api_text_say(out, "]");
	return listed;
}
