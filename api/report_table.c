#include "api/report_table.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/json_build.h"
#include "api/json_number.h"
#include "api/utf8.h"

enum { LABEL = 20, DIGITS = 10, WIDTH = 88, CELL = 20 };

struct table {
	const cJSON *root;
	struct api_text out;
};

/* The value at a path such as "mesh.bounding_box.size", NULL where there is none. */
static const cJSON *at(const cJSON *item, const char *path)
{
	while (item != NULL && *path != '\0') {
		char name[64];
		size_t len = strcspn(path, ".");

		if (len >= sizeof name)
			return NULL;
		memcpy(name, path, len);
		name[len] = '\0';
		item = cJSON_GetObjectItemCaseSensitive(item, name);
		path += len + (path[len] == '.');
	}
	return cJSON_IsNull(item) ? NULL : item;
}

static double number(const cJSON *item, const char *path)
{
	item = at(item, path);
	return cJSON_IsNumber(item) ? item->valuedouble : 0;
}

static void put_spaces(struct table *t, size_t count)
{
	while (count-- > 0)
		api_text_put(&t->out, " ", 1);
}

static void put_label(struct table *t, const char *label)
{
	size_t len = strlen(label);

	put_spaces(t, 2);
	api_text_say(&t->out, label);
	put_spaces(t, len < LABEL ? LABEL - len : 1);
}

static void put_number(struct table *t, double x)
{
	char buf[API_NUMBER_SIZE];
	size_t len = api_json_number_rounded(buf, x, DIGITS);

	api_text_put(&t->out, buf, len);
}

/* Strings of the report are clean; a report from elsewhere need not be, and this goes to a
 * terminal. */
static void put_string(struct table *t, const cJSON *item)
{
	const char *text = cJSON_IsString(item) ? item->valuestring : "-";
	char *clean = api_utf8_dup(text, strlen(text));

	if (clean != NULL)
		api_text_say(&t->out, clean);
	else
		t->out.failed = true;
	free(clean);
}

/* Numbers with ${between} them and the unit of ${unit} (a path) behind. */
static void put_value(struct table *t, const cJSON *value, const char *between, const char *unit)
{
	if (cJSON_IsNumber(value))
		put_number(t, value->valuedouble);
	else if (cJSON_IsArray(value))
		for (const cJSON *c = value->child; c != NULL; c = c->next) {
			if (c != value->child)
				api_text_say(&t->out, between);
			put_value(t, c, between, "");
		}
	else
		api_text_say(&t->out, "-");
	if (value != NULL && at(t->root, unit) != NULL && *unit != '\0') {
		api_text_say(&t->out, " ");
		put_string(t, at(t->root, unit));
	}
}

static void row(struct table *t, const char *label, const char *path, const char *between,
		const char *unit)
{
	put_label(t, label);
	put_value(t, at(t->root, path), between, unit);
	api_text_say(&t->out, "\n");
}

static void matrix(struct table *t, const char *label, const char *path, const char *unit)
{
	const cJSON *m = at(t->root, path);

	if (!cJSON_IsArray(m))
		return;
	put_label(t, label);
	for (const cJSON *r = m->child; r != NULL; r = r->next) {
		if (r != m->child)
			put_spaces(t, LABEL + 2);
		for (const cJSON *c = r->child; c != NULL; c = c->next) {
			size_t before = t->out.len;

			put_number(t, cJSON_IsNumber(c) ? c->valuedouble : 0);
			if (c->next != NULL && t->out.len - before < CELL)
				put_spaces(t, CELL - (t->out.len - before));
		}
		if (r == m->child && *unit != '\0') {
			put_spaces(t, 3);
			put_string(t, at(t->root, unit));
		}
		api_text_say(&t->out, "\n");
	}
}

static void put_heading(struct table *t)
{
	const cJSON *names = at(t->root, "input.filenames");

	if (cJSON_IsArray(names)) { /* several files, one solid */
		for (const cJSON *n = names->child; n != NULL; n = n->next) {
			put_string(t, n);
			api_text_say(&t->out, n->next != NULL ? " + " : ": ");
		}
	} else if (at(t->root, "input.filename") != NULL) {
		put_string(t, at(t->root, "input.filename"));
		api_text_say(&t->out, ": ");
	}
	put_string(t, at(t->root, "input.format"));
	api_text_say(&t->out, ", ");
	put_number(t, number(t->root, "input.bytes"));
	api_text_say(&t->out, " bytes, ");
	put_number(t, number(t->root, "mesh.triangles"));
	api_text_say(&t->out, " triangles\n");
}

static void put_verdict(struct table *t)
{
	const cJSON *checks = at(t->root, "checks"), *solid = at(checks, "solid");

	put_label(t, "solid");
	api_text_say(&t->out, solid == NULL ? "not decided" : cJSON_IsTrue(solid) ? "yes" : "NO");
	api_text_say(&t->out, cJSON_IsTrue(at(checks, "closed")) ? ": closed" : ": not closed");
	if (cJSON_IsTrue(at(checks, "watertight")))
		api_text_say(&t->out, ", watertight");
	if (cJSON_IsFalse(at(checks, "winding_consistent")))
		api_text_say(&t->out, ", winding not consistent");
	api_text_say(&t->out, ", orientation ");
	put_string(t, at(checks, "orientation"));
	api_text_say(&t->out, "\n");
}

/* Only what is wrong: counts that are not zero. */
static void put_defects(struct table *t)
{
	static const char *const names[][2] = {
	    {"boundary edges", "checks.boundary_edges"},
	    {"holes", "checks.boundary_loops"},
	    {"non-manifold edges", "checks.non_manifold_edges"},
	    {"non-manifold points", "checks.non_manifold_vertices"},
	    {"misoriented edges", "checks.misoriented_edges"},
	    {"degenerate", "checks.degenerate_triangles"},
	    {"duplicate", "checks.duplicate_triangles"},
	    {"double walls", "checks.double_walls"},
	    {"single walls", "checks.single_walls"},
	    {"overlapping bodies", "checks.overlapping_bodies"},
	    {"self-intersections", "checks.self_intersections"},
	    {"normals disagreeing", "checks.normals_disagreeing"},
	};

	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (number(t->root, names[i][1]) > 0)
			row(t, names[i][0], names[i][1], "", "");
}

static void put_axis(struct table *t)
{
	row(t, "axis along", "properties.inertia.about_axis.direction", ", ", "");
	row(t, "axis through", "properties.inertia.about_axis.origin", ", ", "units.length");
	row(t, "moment about axis", "properties.inertia.about_axis.moment", "", "units.inertia");
	row(t, "radius of gyration", "properties.inertia.about_axis.radius_of_gyration", "",
	    "units.length");
}

static void put_properties(struct table *t)
{
	matrix(t, "transform", "input.transform", "");
	row(t, "size", "mesh.bounding_box.size", " x ", "units.length");
	row(t, "volume", "properties.volume", "", "units.volume");
	row(t, "surface area", "properties.surface_area", "", "units.area");
	if (at(t->root, "units.mass") != NULL) {
		row(t, "density", "properties.density", "", "units.density");
		row(t, "mass", "properties.mass", "", "units.mass");
	}
	row(t, "centroid", "properties.centroid", ", ", "units.length");
	matrix(t, "inertia at centroid", "properties.inertia.about_centroid", "units.inertia");
	matrix(t, "inertia at origin", "properties.inertia.about_origin", "units.inertia");
	if (at(t->root, "properties.inertia.about_point") != NULL) {
		row(t, "point", "properties.inertia.point", ", ", "units.length");
		matrix(t, "inertia at point", "properties.inertia.about_point", "units.inertia");
	}
	if (at(t->root, "properties.inertia.about_axis") != NULL)
		put_axis(t);
	if (at(t->root, "properties.principal") != NULL) {
		row(t, "principal moments", "properties.principal.moments", ", ", "units.inertia");
		matrix(t, "principal axes", "properties.principal.axes", "");
		row(t, "radii of gyration", "properties.principal.radii_of_gyration", ", ",
		    "units.length");
	}
}

static void put_body(struct table *t, const cJSON *body, int i)
{
	char label[LABEL];

	snprintf(label, sizeof label, "  body %d", i);
	put_label(t, label);
	put_value(t, at(body, "volume"), "", "units.volume");
	if (at(body, "mass") != NULL) {
		api_text_say(&t->out, ", ");
		put_value(t, at(body, "mass"), "", "units.mass");
	}
	api_text_say(&t->out, ", ");
	put_number(t, number(body, "triangles"));
	api_text_say(&t->out, " triangles, ");
	put_string(t, at(body, "orientation"));
	if (cJSON_IsTrue(at(body, "cavity")))
		api_text_say(&t->out, ", cavity");
	if (at(body, "name") != NULL) {
		api_text_say(&t->out, ", ");
		put_string(t, at(body, "name"));
	}
	api_text_say(&t->out, "\n");
}

static void put_bodies(struct table *t)
{
	const cJSON *bodies = at(t->root, "bodies");
	int i = 0;

	row(t, "bodies", "mesh.bodies", "", "");
	if (number(t->root, "mesh.bodies") > 1 && cJSON_IsArray(bodies))
		for (const cJSON *b = bodies->child; b != NULL; b = b->next)
			put_body(t, b, i++);
}

/* Words of ${text}, wrapped at WIDTH behind LABEL. */
static void put_wrapped(struct table *t, const char *text)
{
	size_t column = 0;

	while (*text != '\0') {
		size_t len = strcspn(text, " ");

		if (column > 0 && LABEL + 2 + column + 1 + len > WIDTH) {
			api_text_say(&t->out, "\n");
			put_spaces(t, LABEL + 2);
			column = 0;
		} else if (column > 0) {
			api_text_say(&t->out, " ");
			column++;
		}
		api_text_put(&t->out, text, len);
		column += len;
		text += len + strspn(text + len, " ");
	}
	api_text_say(&t->out, "\n");
}

static void put_warnings(struct table *t)
{
	const cJSON *warnings = at(t->root, "warnings");

	if (!cJSON_IsArray(warnings))
		return;
	for (const cJSON *w = warnings->child; w != NULL; w = w->next) {
		const cJSON *message = at(w, "message");
		const char *text = cJSON_IsString(message) ? message->valuestring : "";
		char *clean = api_utf8_dup(text, strlen(text));

		put_label(t, "warning");
		if (clean != NULL)
			put_wrapped(t, clean);
		else
			t->out.failed = true;
		free(clean);
	}
}

char *api_report_table(const char *json, size_t len)
{
	cJSON *root = cJSON_ParseWithLength(json, len);
	const cJSON *schema = at(root, "schema");
	struct table t = {.root = root};

	if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "masspropd/1") != 0) {
		cJSON_Delete(root);
		return NULL;
	}
	put_heading(&t);
	put_verdict(&t);
	put_defects(&t);
	put_properties(&t);
	put_bodies(&t);
	put_warnings(&t);
	cJSON_Delete(root);
	if (t.out.failed) {
		free(t.out.text);
		return NULL;
	}
	return t.out.text;
}
