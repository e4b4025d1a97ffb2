#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "alloc_fail.h"
#include "api/report_json.h"
#include "api/report_lists.h"
#include "api/report_table.h"
#include "api/utf8.h"
#include "api/warnings.h"
#include "cjson_hooks.h"

static const struct api_timing timing = {0.1, 0, 0.12345678, 1e-9};

/* The box of the contract, filled in by hand. */
static const struct mp_mass box_mass = {
    .volume = 24000,
    .area = 5200,
    .mass = 0.0648,
    .centroid = {20, 15, 10},
    .inertia = {{7.02, -0.0, 0}, {-0.0, 10.8, 0}, {0, 0, 13.5}},
    .volume_defined = true,
    .area_defined = true,
    .mass_defined = true,
    .centroid_defined = true,
    .inertia_defined = true,
};

static struct mp_body box_body; /* filled by box() */

static struct mp_report box(void)
{
	struct mp_report r = {
	    .notes = {.format = MP_FORMAT_STL_BINARY, .bytes = 684, .triangles = 12},
	    .triangles = 12,
	    .topology = {.vertices = 8,
			 .edges = 18,
			 .faces = 12,
			 .euler = 2,
			 .closed = true,
			 .watertight = true,
			 .winding_consistent = true,
			 .bodies = 1},
	    .box = {{0, 0, 0}, {40, 30, 20}},
	    .orientation = MP_ORIENTATION_OUTWARD,
	    .solid = MP_YES,
	    .overlapping = MP_NO,
	    .overlaps = {.asked = true, .decided = true},
	    .total = box_mass,
	    .surface_centroid = {20, 15, 10},
	    .surface_centroid_defined = true,
	    .has_density = true,
	    .density = 2.7e-6,
	    .density_defined = true,
	    .inertia_origin = {{28.08, -19.44, -12.96}, {-19.44, 43.2, -9.72}, {-12.96, -9.72, 54}},
	    .inertia_origin_defined = true,
	    .principal = {.moments = {7.02, 10.8, 13.5},
			  .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
			  .quaternion = {1, 0, 0, 0}},
	    .radii_of_gyration = {10.4083, 12.9099, 14.4338},
	    .radii_defined = true,
	    .precision = MP_PRECISION_EXACT,
	    .bounds = {.area = 1e-12,
		       .mass = 1e-17,
		       .centroid = 1e-15,
		       .inertia = 1e-14,
		       .inertia_origin = 1e-14,
		       .moments = 1e-14,
		       .axes = 1e-15,
		       .radii = 1e-15},
	    .body = &box_body,
	    .bodies_listed = 1,
	};

	box_body = (struct mp_body){.triangles = 12,
				    .mass = box_mass,
				    .box = r.box,
				    .watertight = true,
				    .orientable = true,
				    .orientation = MP_ORIENTATION_OUTWARD,
				    .nest = {true, 0, MP_NO_BODY}};
	return r;
}

static struct api_options query(const char *text)
{
	struct api_options o;
	struct api_problem p;

	api_options_init(&o);
	assert_int_equal(api_options_query(&o, text, strlen(text), &p), 0);
	assert_int_equal(api_options_check(&o, &p), 0);
	return o;
}

static char *print(const struct mp_report *r, const char *options, const char *filename)
{
	struct api_options o = query(options);
	size_t len = 0;
	char *text = api_report_json(r, &o, filename, &timing, &len);

	assert_non_null(text);
	assert_int_equal(strlen(text), len);
	return text;
}

static cJSON *parse(const struct mp_report *r, const char *options, const char *filename)
{
	char *text = print(r, options, filename);
	cJSON *json = cJSON_Parse(text);

	assert_non_null(json);
	free(text);
	return json;
}

/* The member at a path such as "mesh.bounding_box"; it must be there. */
static const cJSON *at(const cJSON *item, const char *path)
{
	char copy[128], *name = copy;

	assert_true(strlen(path) < sizeof copy);
	strcpy(copy, path);
	for (name = strtok(copy, "."); name != NULL; name = strtok(NULL, ".")) {
		item = cJSON_IsArray(item) ? cJSON_GetArrayItem(item, atoi(name))
					   : cJSON_GetObjectItemCaseSensitive(item, name);
		if (item == NULL)
			fail_msg("no %s", path);
	}
	return item;
}

static void is_null(const cJSON *json, const char *path)
{
	if (!cJSON_IsNull(at(json, path)))
		fail_msg("%s is not null", path);
}

static void says(const cJSON *json, const char *path, const char *word)
{
	const char *text = cJSON_GetStringValue(at(json, path));

	assert_non_null(text);
	assert_string_equal(text, word);
}

static void equals(const cJSON *json, const char *path, double x)
{
	assert_true(cJSON_IsNumber(at(json, path)));
	if (at(json, path)->valuedouble != x)
		fail_msg("%s is %.17g", path, at(json, path)->valuedouble);
}

static bool warns(const cJSON *json, const char *code)
{
	const cJSON *w = at(json, "warnings")->child;

	for (; w != NULL; w = w->next)
		if (strcmp(cJSON_GetStringValue(at(w, "code")), code) == 0)
			return true;
	return false;
}

static const char contract_box[] =
    "{\"schema\":\"masspropd/1\",\"precision\":\"exact\","
    "\"input\":{\"filename\":\"box.stl\",\"format\":\"stl-binary\",\"bytes\":684,"
    "\"unit\":\"mm\",\"transform\":null,\"sha256\":null},"
    "\"units\":{\"length\":\"mm\",\"area\":\"mm2\",\"volume\":\"mm3\",\"mass\":\"kg\","
    "\"density\":\"kg/m3\",\"inertia\":\"kg.mm2\"},"
    "\"mesh\":{\"triangles\":12,\"polygons\":0,\"surfaces\":0,\"vertices\":8,\"edges\":18,"
    "\"bodies\":1,\"euler_characteristic\":2,"
    "\"bounding_box\":{\"min\":[0,0,0],\"max\":[40,30,20],\"size\":[40,30,20]}},"
    "\"checks\":{\"closed\":true,\"watertight\":true,\"winding_consistent\":true,"
    "\"orientation\":\"outward\",\"solid\":true,\"boundary_edges\":0,\"boundary_loops\":0,"
    "\"non_manifold_edges\":0,\"non_manifold_vertices\":0,\"misoriented_edges\":0,"
    "\"degenerate_triangles\":0,\"duplicate_triangles\":0,\"duplicates_same\":0,"
    "\"duplicates_opposite\":0,\"double_walls\":0,\"single_walls\":0,"
    "\"normals_disagreeing\":0,"
    "\"overlapping_bodies\":0,\"self_intersections\":null,\"closure_defect\":[0,0,0],"
    "\"closes_at_tolerance\":null,\"by_index\":null},"
    "\"properties\":{\"volume\":24000,\"signed_volume\":24000,\"surface_area\":5200,"
    "\"surface_centroid\":[20,15,10],\"density\":2700,\"mass\":0.0648,\"centroid\":[20,15,10],"
    "\"inertia\":{\"convention\":\"tensor: [0][1] = -integral of density*x*y\","
    "\"about_origin\":[[28.08,-19.44,-12.96],[-19.44,43.2,-9.72],[-12.96,-9.72,54]],"
    "\"about_centroid\":[[7.02,0,0],[0,10.8,0],[0,0,13.5]],"
    "\"about_point\":null,\"point\":null,\"about_axis\":null},"
    "\"principal\":{\"moments\":[7.02,10.8,13.5],\"axes\":[[1,0,0],[0,1,0],[0,0,1]],"
    "\"quaternion_wxyz\":[1,0,0,0],\"radii_of_gyration\":[10.4083,12.9099,14.4338],"
    "\"symmetry\":\"none\"},\"volume_if_capped\":null,\"cap_area\":null,"
    "\"volume_if_oriented\":null},"
    "\"error_bounds\":{\"volume\":0,\"surface_area\":1e-12,\"mass\":1e-17,"
    "\"centroid\":1e-15,\"inertia\":1e-14,\"inertia_about_origin\":1e-14,"
    "\"principal_moments\":1e-14,\"principal_axes_rad\":1e-15,\"radii_of_gyration\":1e-15,"
    "\"quadrature_estimate\":null},\"input_uncertainty\":null,"
    "\"bodies\":[{\"triangles\":12,\"volume\":24000,\"signed_volume\":24000,"
    "\"surface_area\":5200,\"mass\":0.0648,\"centroid\":[20,15,10],"
    "\"inertia_about_centroid\":[[7.02,0,0],[0,10.8,0],[0,0,13.5]],"
    "\"bounding_box\":{\"min\":[0,0,0],\"max\":[40,30,20]},\"watertight\":true,"
    "\"orientable\":true,\"genus\":0,"
    "\"orientation\":\"outward\",\"depth\":0,\"parent\":null,\"cavity\":false,\"name\":null}],"
    "\"defects\":{\"boundary_edges\":[],\"boundary_loops\":[],\"non_manifold_edges\":[],"
    "\"non_manifold_vertices\":[],\"misoriented_edges\":[],\"degenerate_triangles\":[],"
    "\"duplicate_triangles\":[],\"overlapping_bodies\":[],\"self_intersections\":[],"
    "\"truncated\":false},\"facets\":null,"
    "\"repairs\":{\"flipped_triangles\":0,\"welded_vertices\":0},\"warnings\":[],"
    "\"timing_ms\":{\"receive\":0.1,\"queue\":0,\"decode\":0.123,\"analyse\":0}}";

static void the_box_prints_as_in_the_contract(void **state)
{
	struct mp_report r = box();
	char *text = print(&r, "density=2700&unit=mm", "box.stl");

	(void)state;
	assert_string_equal(text, contract_box);
	free(text);
}

static void without_density_the_numbers_are_geometry(void **state)
{
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	r.has_density = r.density_defined = false;
	json = parse(&r, "unit=in", NULL);
	is_null(json, "input.filename");
	is_null(json, "units.mass");
	is_null(json, "units.density");
	says(json, "units.inertia", "in5");
	says(json, "units.volume", "in3");
	is_null(json, "properties.mass");
	is_null(json, "properties.density");
	is_null(json, "bodies.0.mass");
	equals(json, "properties.inertia.about_centroid.0.0", 7.02);
	equals(json, "bodies.0.volume", 24000);
	cJSON_Delete(json);
}

static void units_are_those_asked_for(void **state)
{
	struct mp_report r = box();
	cJSON *json = parse(&r, "unit=ft&density=1&density_unit=lb/in3&mass_unit=lb", NULL);

	(void)state;
	says(json, "input.unit", "ft");
	says(json, "units.length", "ft");
	says(json, "units.area", "ft2");
	says(json, "units.mass", "lb");
	says(json, "units.density", "lb/in3");
	says(json, "units.inertia", "lb.ft2");
	equals(json, "properties.density", 1);
	cJSON_Delete(json);
	json = parse(&r, "density=0.25&density_unit=file", NULL);
	says(json, "units.mass", "file");
	says(json, "units.density", "file");
	says(json, "units.inertia", "file.mm2");
	equals(json, "properties.density", 0.25);
	cJSON_Delete(json);
}

static void a_weighed_mass_has_its_density(void **state)
{
	struct mp_report r = box();
	cJSON *json = parse(&r, "mass=64.8&mass_unit=g&density_unit=g/cm3", NULL);

	(void)state;
	equals(json, "properties.density", 2.7);
	cJSON_Delete(json);
	r.density_defined = r.total.mass_defined = false;
	json = parse(&r, "mass=64.8&mass_unit=g&density_unit=g/cm3", NULL);
	is_null(json, "properties.density");
	is_null(json, "properties.mass");
	says(json, "units.mass", "g");
	cJSON_Delete(json);
}

static void an_open_mesh_has_only_what_is_defined(void **state)
{
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	r.total = (struct mp_mass){.area = 5200, .area_defined = true};
	r.inertia_origin_defined = r.radii_defined = false;
	r.solid = MP_NO;
	r.orientation = MP_ORIENTATION_NONE;
	r.topology.closed = r.topology.watertight = false;
	r.topology.boundary_edges = 4;
	r.topology.boundary_loops = 1;
	r.topology.euler = -7;
	r.closure_defect[2] = 600;
	r.warnings = 1u << MP_WARN_OPEN;
	json = parse(&r, "density=2700", NULL);
	is_null(json, "properties.volume");
	is_null(json, "properties.signed_volume");
	is_null(json, "properties.mass");
	is_null(json, "properties.centroid");
	is_null(json, "properties.inertia");
	is_null(json, "properties.principal");
	equals(json, "properties.surface_area", 5200);
	equals(json, "properties.surface_centroid.0", 20);
	equals(json, "properties.density", 2700);
	equals(json, "checks.closure_defect.2", 600);
	equals(json, "checks.boundary_edges", 4);
	equals(json, "mesh.euler_characteristic", -7);
	says(json, "checks.orientation", "none");
	assert_true(cJSON_IsFalse(at(json, "checks.solid")));
	assert_true(warns(json, "open_mesh"));
	assert_true(warns(json, "unit_assumed"));
	assert_int_equal(cJSON_GetArraySize(at(json, "warnings")), 2);
	cJSON_Delete(json);
}

static void inside_out_is_answered_as_the_solid_it_means(void **state)
{
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	r.total.volume = -24000;
	r.orientation = MP_ORIENTATION_INWARD;
	box_body.mass.volume = -24000;
	json = parse(&r, "mass=0.0648", NULL);
	equals(json, "properties.volume", 24000);
	equals(json, "properties.signed_volume", -24000);
	equals(json, "properties.density", 2700);
	equals(json, "bodies.0.volume", 24000);
	equals(json, "bodies.0.signed_volume", -24000);
	says(json, "checks.orientation", "inward");
	cJSON_Delete(json);
}

static void what_is_not_decided_is_null(void **state)
{
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	r.solid = r.overlapping = MP_UNDECIDED;
	r.overlaps.decided = false;
	box_body.nest.decided = false;
	json = parse(&r, "", NULL);
	is_null(json, "checks.solid");
	is_null(json, "checks.overlapping_bodies");
	is_null(json, "bodies.0.depth");
	is_null(json, "bodies.0.parent");
	cJSON_Delete(json);
	box_body.nest = (struct mp_nest){true, 2, 17};
	json = parse(&r, "", NULL);
	equals(json, "bodies.0.depth", 2);
	equals(json, "bodies.0.parent", 17);
	cJSON_Delete(json);
}

static void point_and_axis_appear_when_asked_for(void **state)
{
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	r.inertia_about[1][2] = -3.5;
	r.inertia_about_defined = r.axis_defined = true;
	r.axis = (struct mp_axis_moment){{1, 2, 3}, {0, 0, 1}, 13.5, 14.4338, true};
	json = parse(&r, "about=1,2,3&axis_origin=1,2,3", NULL);
	equals(json, "properties.inertia.about_point.1.2", -3.5);
	equals(json, "properties.inertia.about_axis.origin.2", 3);
	equals(json, "properties.inertia.about_axis.direction.2", 1);
	equals(json, "properties.inertia.about_axis.moment", 13.5);
	equals(json, "properties.inertia.about_axis.radius_of_gyration", 14.4338);
	cJSON_Delete(json);
	r.axis.radius_defined = r.radii_defined = false;
	json = parse(&r, "axis=0,0,1", NULL);
	is_null(json, "properties.inertia.about_axis.radius_of_gyration");
	is_null(json, "properties.principal.radii_of_gyration");
	cJSON_Delete(json);
}

static void nothing_that_is_not_finite_is_printed(void **state)
{
	struct mp_report r = box();
	char *text;
	cJSON *json;

	(void)state;
	r.total.volume = INFINITY;
	r.total.mass = NAN;
	r.total.centroid[1] = -INFINITY;
	r.total.inertia[2][2] = NAN;
	r.box.max[0] = 1.7e308;
	r.box.min[0] = -1.7e308;
	box_body.mass.area = INFINITY;
	box_body.mass.inertia[0][0] = NAN;
	text = print(&r, "density=1", NULL);
	assert_null(strstr(text, "inf"));
	assert_null(strstr(text, "nan"));
	json = cJSON_Parse(text);
	is_null(json, "properties.volume");
	is_null(json, "properties.centroid");
	is_null(json, "properties.inertia.about_centroid");
	is_null(json, "mesh.bounding_box.size");
	is_null(json, "bodies.0.inertia_about_centroid");
	cJSON_Delete(json);
	free(text);
}

static void names_are_clean_whatever_the_file_says(void **state)
{
	static const char name[] = "caf\xc3\xa9 \"q\" \\ \x01\xff\0 \xe2\x80";
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	box_body.name = name;
	box_body.name_len = sizeof name - 1;
	json = parse(&r, "", "..\\\"<\x7f>\xc0\x80.stl");
	says(json, "bodies.0.name",
	     "caf\xc3\xa9 \"q\" \\ \xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd \xef\xbf\xbd");
	says(json, "input.filename", "..\\\"<\xef\xbf\xbd>\xef\xbf\xbd\xef\xbf\xbd.stl");
	cJSON_Delete(json);
}

/* ${count} boundary edges of one triangle, with float32 vertices at 0.1*i. */
struct edges {
	struct mp_vertices *vertices;
	struct mp_defect_list *list;
};

static struct edges add_edges(struct mp_report *r, uint32_t count)
{
	static const uint8_t key[16] = {1};
	struct mp_error err;
	struct edges e = {mp_vertices_new(key, &err), &r->topology.defect[MP_DEFECT_BOUNDARY_EDGE]};

	assert_non_null(e.vertices);
	r->vertices = e.vertices;
	e.list->count = count;
	e.list->triangle_at = malloc((count + 1) * sizeof(size_t));
	e.list->vertex_at = malloc((count + 1) * sizeof(size_t));
	e.list->triangles = malloc(count * sizeof(uint32_t));
	e.list->vertices = malloc(2 * count * sizeof(uint32_t));
	for (uint32_t i = 0; i <= count; i++) {
		const double tri[1][9] = {{0.1f * (float)i, 0, 0, 0.1f * (float)i, 1, 0, 0, 0, 1}};
		uint32_t out[1][3];

		e.list->triangle_at[i] = i;
		e.list->vertex_at[i] = 2 * (size_t)i;
		if (i == count)
			break;
		assert_int_equal(mp_vertices_add(e.vertices, tri, 1, out, &err), 0);
		e.list->triangles[i] = i;
		e.list->vertices[2 * i] = out[0][0];
		e.list->vertices[2 * i + 1] = out[0][1];
	}
	return e;
}

static void free_edges(struct edges *e)
{
	mp_vertices_free(e->vertices);
	free(e->list->triangle_at);
	free(e->list->vertex_at);
	free(e->list->triangles);
	free(e->list->vertices);
}

static void defects_have_their_places(void **state)
{
	struct mp_report r = box();
	struct edges e = add_edges(&r, 3);
	cJSON *json;

	(void)state;
	r.topology.truncated = true;
	json = parse(&r, "", NULL);
	assert_int_equal(cJSON_GetArraySize(at(json, "defects.boundary_edges")), 3);
	equals(json, "defects.boundary_edges.2.triangles.0", 2);
	assert_int_equal(cJSON_GetArraySize(at(json, "defects.boundary_edges.2.vertices")), 2);
	equals(json, "defects.boundary_edges.2.vertices.0.0", 0.2f);
	equals(json, "defects.boundary_edges.2.vertices.1.1", 1);
	assert_int_equal(cJSON_GetArraySize(at(json, "defects.boundary_loops")), 0);
	assert_true(cJSON_IsTrue(at(json, "defects.truncated")));
	cJSON_Delete(json);
	free_edges(&e);
}

static void as_many_defects_as_may_be_asked_for_are_printed(void **state)
{
	struct mp_report r = box();
	struct edges e = add_edges(&r, 100000);
	cJSON *json = parse(&r, "", NULL);

	(void)state;
	assert_int_equal(cJSON_GetArraySize(at(json, "defects.boundary_edges")), 100000);
	assert_true(cJSON_IsFalse(at(json, "defects.truncated")));
	cJSON_Delete(json);
	free_edges(&e);
}

static void a_list_that_grows_too_long_is_cut_between_defects(void **state)
{
	struct mp_report r = box();
	struct edges e = add_edges(&r, 50);
	struct api_text t = {0};
	cJSON *json;

	(void)state;
	assert_false(api_defects_text(&r, MP_DEFECT_BOUNDARY_EDGE, 500, &t));
	assert_in_range(t.len, 500, 700);
	json = cJSON_Parse(t.text);
	assert_true(cJSON_IsArray(json));
	assert_in_range(cJSON_GetArraySize(json), 2, 20);
	cJSON_Delete(json);
	free(t.text);
	free_edges(&e);
}

static void every_warning_has_a_code_and_a_sentence(void **state)
{
	const struct api_warning *w;
	struct mp_report r = box();
	cJSON *json;
	size_t n = 0;

	(void)state;
	for (; (w = api_warning_row(n)) != NULL; n++) {
		assert_non_null(w->code);
		assert_true(strspn(w->code, "abcdefghijklmnopqrstuvwxyz_") == strlen(w->code));
		assert_true(strlen(w->message) > 40);
		assert_true(w->message[strlen(w->message) - 1] == '.');
		for (size_t k = 0; k < n; k++)
			assert_string_not_equal(api_warning_row(k)->code, w->code);
	}
	assert_int_equal(n, MP_WARNINGS + 2); /* and what only api knows of */
	r.warnings = (UINT64_C(1) << MP_WARNINGS) - 1;
	json = parse(&r, "", NULL);
	assert_int_equal(cJSON_GetArraySize(at(json, "warnings")), n - 1);
	assert_false(warns(json, "attachment_ignored"));
	cJSON_Delete(json);
	json = parse(&r, "unit=mm", NULL);
	assert_false(warns(json, "unit_assumed"));
	assert_true(warns(json, "zero_volume"));
	cJSON_Delete(json);
}

static void any_failed_allocation_gives_null(void **state)
{
	struct mp_report r = box();
	struct edges e = add_edges(&r, 20);
	struct api_options o = query("density=1");
	char *text = NULL;
	size_t len;
	long n;

	(void)state;
	for (n = 1; text == NULL; n++) {
		alloc_fail_at(n);
		text = api_report_json(&r, &o, "a.stl", &timing, &len);
		assert_in_range(n, 1, 2000);
	}
	alloc_fail_at(0);
	assert_true(n > 15); /* it did go through them */
	free(text);
	free_edges(&e);
}

/* The table of `masspropd calc`. */

static void has_line(const char *table, const char *label, const char *rest)
{
	const char *line = strstr(table, label);
	size_t len;

	if (line == NULL)
		fail_msg("no line '%s' in\n%s", label, table);
	line += strlen(label);
	line += strspn(line, " ");
	len = strcspn(line, "\n");
	if (len != strlen(rest) || strncmp(line, rest, len) != 0)
		fail_msg("%s: '%.*s', not '%s'", label, (int)len, line, rest);
}

static void the_table_shows_the_box(void **state)
{
	char *table = api_report_table(contract_box, sizeof contract_box - 1);

	(void)state;
	assert_non_null(table);
	has_line(table, "box.stl", ": stl-binary, 684 bytes, 12 triangles");
	has_line(table, "\n  solid", "yes: closed, watertight, orientation outward");
	has_line(table, "\n  size", "40 x 30 x 20 mm");
	has_line(table, "\n  volume", "24000 mm3");
	has_line(table, "\n  surface area", "5200 mm2");
	has_line(table, "\n  density", "2700 kg/m3");
	has_line(table, "\n  mass", "0.0648 kg");
	has_line(table, "\n  centroid", "20, 15, 10 mm");
	has_line(table, "\n  principal moments", "7.02, 10.8, 13.5 kg.mm2");
	has_line(table, "\n  bodies", "1");
	assert_null(strstr(table, "warning"));
	assert_null(strstr(table, "boundary"));
	free(table);
}

static void the_table_of_an_open_mesh_says_so(void **state)
{
	struct mp_report r = box();
	char *text, *table;

	(void)state;
	r.total = (struct mp_mass){.area = 5200, .area_defined = true};
	r.inertia_origin_defined = false;
	r.solid = MP_NO;
	r.has_density = false;
	r.topology.closed = r.topology.watertight = r.topology.winding_consistent = false;
	r.topology.boundary_edges = 4;
	r.topology.bodies = 2;
	r.orientation = MP_ORIENTATION_NONE;
	r.warnings = 1u << MP_WARN_OPEN;
	text = print(&r, "unit=mm", NULL);
	table = api_report_table(text, strlen(text));
	assert_non_null(table);
	has_line(table, "\n  solid", "NO: not closed, winding not consistent, orientation none");
	has_line(table, "\n  boundary edges", "4");
	has_line(table, "\n  volume", "-");
	has_line(table, "\n  bodies", "2");
	has_line(table, "body 0", "24000 mm3, 12 triangles, outward");
	assert_non_null(strstr(table, "\n  warning "));
	assert_null(strstr(table, "\n  mass"));
	free(table);
	free(text);
}

static void what_is_no_report_has_no_table(void **state)
{
	static const char *const texts[] = {
	    "", "{", "[]", "null", "{\"schema\":1}", "{\"schema\":\"masspropd/2\"}"};

	(void)state;
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
		assert_null(api_report_table(texts[i], strlen(texts[i])));
}

static void a_report_with_gaps_still_has_a_table(void **state)
{
	static const char *const texts[] = {
	    "{\"schema\":\"masspropd/1\"}",
	    "{\"schema\":\"masspropd/1\",\"bodies\":[1,null,[]],\"mesh\":{\"bodies\":3},"
	    "\"warnings\":[0,{}],\"properties\":{\"inertia\":{\"about_origin\":[[],1,\"\\u001b\"]},"
	    "\"principal\":7},\"input\":{\"filename\":\"\\u001b[2J\"}}"};

	(void)state;
	for (size_t i = 0; i < 2; i++) {
		char *table = api_report_table(texts[i], strlen(texts[i]));

		assert_non_null(table);
		assert_null(strchr(table, '\x1b'));
		free(table);
	}
}

static void every_bound_stands_beside_its_result(void **state)
{
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	r.precision = MP_PRECISION_CERTIFIED;
	r.bounds = (struct mp_bounds){.volume = 1,
				      .area = 2,
				      .mass = 3,
				      .centroid = 4,
				      .inertia = 5,
				      .inertia_origin = 6,
				      .moments = 7,
				      .radii = 9,
				      .axes = 0.25};
	json = parse(&r, "density=2700", "box.stl");
	says(json, "precision", "certified");
	equals(json, "error_bounds.volume", 1);
	equals(json, "error_bounds.surface_area", 2);
	equals(json, "error_bounds.mass", 3);
	equals(json, "error_bounds.centroid", 4);
	equals(json, "error_bounds.inertia", 5);
	equals(json, "error_bounds.inertia_about_origin", 6);
	equals(json, "error_bounds.principal_moments", 7);
	equals(json, "error_bounds.principal_axes_rad", 0.25);
	equals(json, "error_bounds.radii_of_gyration", 9);
	is_null(json, "error_bounds.quadrature_estimate");
	cJSON_Delete(json);
}

static void a_bound_is_null_where_the_result_is(void **state)
{
	struct mp_report r = box();
	cJSON *json;

	(void)state;
	r.radii_defined = false;
	json = parse(&r, "density=2700", "box.stl");
	is_null(json, "error_bounds.radii_of_gyration");
	equals(json, "error_bounds.principal_moments", 1e-14);
	cJSON_Delete(json);
	r.has_density = false;
	r.total.inertia_defined = r.inertia_origin_defined = false;
	json = parse(&r, "", "box.stl");
	is_null(json, "error_bounds.mass");
	is_null(json, "error_bounds.inertia");
	is_null(json, "error_bounds.inertia_about_origin");
	is_null(json, "error_bounds.principal_moments");
	is_null(json, "error_bounds.principal_axes_rad");
	equals(json, "error_bounds.centroid", 1e-15);
	cJSON_Delete(json);
	r.total.volume_defined = r.total.area_defined = r.total.centroid_defined = false;
	json = parse(&r, "", "box.stl");
	is_null(json, "error_bounds.volume");
	is_null(json, "error_bounds.surface_area");
	is_null(json, "error_bounds.centroid");
	cJSON_Delete(json);
}

int main(void)
{
	const struct CMUnitTest report_json[] = {
	    cmocka_unit_test(the_box_prints_as_in_the_contract),
	    cmocka_unit_test(every_bound_stands_beside_its_result),
	    cmocka_unit_test(a_bound_is_null_where_the_result_is),
	    cmocka_unit_test(without_density_the_numbers_are_geometry),
	    cmocka_unit_test(units_are_those_asked_for),
	    cmocka_unit_test(a_weighed_mass_has_its_density),
	    cmocka_unit_test(an_open_mesh_has_only_what_is_defined),
	    cmocka_unit_test(inside_out_is_answered_as_the_solid_it_means),
	    cmocka_unit_test(what_is_not_decided_is_null),
	    cmocka_unit_test(point_and_axis_appear_when_asked_for),
	    cmocka_unit_test(nothing_that_is_not_finite_is_printed),
	    cmocka_unit_test(names_are_clean_whatever_the_file_says),
	    cmocka_unit_test(defects_have_their_places),
	    cmocka_unit_test(as_many_defects_as_may_be_asked_for_are_printed),
	    cmocka_unit_test(a_list_that_grows_too_long_is_cut_between_defects),
	    cmocka_unit_test(every_warning_has_a_code_and_a_sentence),
	    cmocka_unit_test_setup_teardown(any_failed_allocation_gives_null, hook, unhook),
	    cmocka_unit_test(the_table_shows_the_box),
	    cmocka_unit_test(the_table_of_an_open_mesh_says_so),
	    cmocka_unit_test(what_is_no_report_has_no_table),
	    cmocka_unit_test(a_report_with_gaps_still_has_a_table),
	};

	return cmocka_run_group_tests(report_json, NULL, NULL);
}
