#include "api/report_extras.h"

#include <math.h>

void api_uncertainty_add(struct api_json *j, cJSON *root, const struct mp_report *r)
{
	const struct mp_uncertainty *u = &r->uncertainty;
	cJSON *o;

	if (u->source == MP_ROUNDING_UNKNOWN) {
		api_json_null(j, root, "input_uncertainty");
		return;
	}
	o = api_json_object(j, root, "input_uncertainty");
	api_json_string(j, o, "source",
			u->source == MP_ROUNDING_FLOAT32 ? "float32" : "quantisation");
	api_json_value(j, o, "volume", u->volume_defined, u->volume);
	api_json_value(j, o, "mass", u->mass_defined, u->mass);
	api_json_value(j, o, "centroid", u->centroid_defined, u->centroid);
}

enum { AREA, NORMAL, CENTROID, HEIGHT, VOLUME, COLUMNS };

static void put_facet(struct api_text column[COLUMNS], const struct mp_facet *f)
{
	static const double none = NAN;

	api_text_number(&column[AREA], f->area);
	api_text_vector(&column[NORMAL], f->degenerate ? &none : f->normal, f->degenerate ? 1 : 3);
	api_text_vector(&column[CENTROID], f->centroid, 3);
	api_text_number(&column[HEIGHT], f->degenerate ? none : f->height);
	api_text_number(&column[VOLUME], f->volume);
}

void api_facets_add(struct api_json *j, cJSON *root, const struct mp_report *r, bool asked)
{
	static const char *const names[COLUMNS] = {"area", "normal", "centroid", "height",
						   "signed_volume"};
	struct api_text column[COLUMNS] = {{0}};
	cJSON *o;

	if (!asked) {
		api_json_null(j, root, "facets");
		return;
	}
	for (uint32_t t = 0; t < r->triangles; t++) {
		struct mp_facet facet;

		mp_report_facet(r, t, &facet);
		for (int c = 0; c < COLUMNS; c++)
			api_text_put(&column[c], t == 0 ? "[" : ",", 1);
		put_facet(column, &facet);
	}
	o = api_json_object(j, root, "facets");
	for (int c = 0; c < COLUMNS; c++) {
		api_text_put(&column[c], "]", 1);
		api_json_text(j, o, names[c], &column[c]);
	}
}

static void count(struct api_json *j, cJSON *checks, const char *name, const struct mp_crossings *c)
{
	if (c->decided)
		api_json_count(j, checks, name, c->count);
	else
		api_json_null(j, checks, name);
}

void api_crossings_count(struct api_json *j, cJSON *checks, const struct mp_report *r)
{
	count(j, checks, "overlapping_bodies", &r->overlaps);
	count(j, checks, "self_intersections", &r->self);
}

static void put_places(const struct mp_crossings *c, struct api_text *out)
{
	api_text_say(out, "[");
	for (size_t i = 0; i < c->listed; i++) {
		const struct mp_crossing *x = &c->list[i];

		api_text_say(out, i > 0 ? ",{\"triangles\":[" : "{\"triangles\":[");
		api_text_count(out, x->triangle[0]);
		api_text_say(out, ",");
		api_text_count(out, x->triangle[1]);
		api_text_say(out, "],\"vertices\":[");
		for (uint32_t k = 0; k < x->points; k++) {
			if (k > 0)
				api_text_say(out, ",");
			api_text_vector(out, x->point[k], 3);
		}
		api_text_say(out, "]}");
	}
	api_text_say(out, "]");
}

/* At most 100,000 of each, of a few hundred bytes: they need no limit of their own. */
void api_crossings_list(struct api_json *j, cJSON *defects, const struct mp_report *r)
{
	put_places(&r->overlaps, api_json_raw(j, defects, "overlapping_bodies"));
	put_places(&r->self, api_json_raw(j, defects, "self_intersections"));
}
