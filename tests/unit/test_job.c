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
#include "api/capabilities.h"
#include "api/job.h"
#include "api/options.h"
#include "api/report_table.h"
#include "api/utf8.h"
#include "cjson_hooks.h"

static double clock_s; /* goes on by a quarter of a second whenever it is read */

static double tick(void)
{
	return clock_s += 0.25;
}

static const char garbage[] =
    "{\"this\": \"is no mesh, but so long that it cannot be the beginning of one either\", "
    "\"because\": \"a binary STL has a header of 80 bytes and a count in front of its facets\"}";

struct file {
	uint8_t bytes[84 + 50 * 36];
	size_t len;
};

/* The 12 triangles of a box, outward; appended to a binary STL. */
static void add_box(struct file *f, const float min[3], const float max[3], bool inward)
{
	static const uint8_t corner[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
					      {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
					      {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
	uint32_t count;

	if (f->len == 0) {
		memset(f, 0, sizeof *f);
		f->len = 84;
	}
	for (int i = 0; i < 12; i++, f->len += 50) {
		for (int v = 0; v < 3; v++) {
			uint8_t c = corner[i][inward ? 2 - v : v];
			float p[3];

			for (int k = 0; k < 3; k++)
				p[k] = (c >> k & 1) != 0 ? max[k] : min[k];
			memcpy(f->bytes + f->len + 12 + 12 * v, p, sizeof p);
		}
	}
	count = (uint32_t)((f->len - 84) / 50);
	memcpy(f->bytes + 80, &count, sizeof count);
}

static struct file contract_box(void)
{
	struct file f = {.len = 0};

	add_box(&f, (const float[]){0, 0, 0}, (const float[]){40, 30, 20}, false);
	return f;
}

/* Without its last ${count} triangles. */
static struct file opened(uint32_t count)
{
	struct file f = contract_box();

	f.len -= 50 * (size_t)count;
	count = 12 - count;
	memcpy(f.bytes + 80, &count, sizeof count);
	return f;
}

static struct api_job_head head_of(const char *query)
{
	return (struct api_job_head){.query = query,
				     .query_len = query != NULL ? strlen(query) : 0,
				     .instance = "/v1/mass-properties",
				     .request_id = "test-1",
				     .key = {7},
				     .limits = {1 << 20, 1000},
				     .now = tick};
}

/* The answer to ${len} bytes that come in pieces of ${step}. */
static struct api_answer ask(const struct api_job_head *head, const void *bytes, size_t len,
			     size_t step)
{
	struct api_job *job = api_job_new(head);
	struct api_answer a;

	assert_non_null(job);
	for (size_t at = 0; at < len; at += step) {
		size_t n = len - at < step ? len - at : step;
		uint8_t *copy = malloc(n);

		assert_non_null(copy);
		memcpy(copy, (const uint8_t *)bytes + at, n);
		(void)api_job_push(job, copy, n);
		free(copy);
	}
	api_job_answer(job, 1.5, 2.5, &a);
	api_job_free(job);
	assert_non_null(a.body);
	assert_int_equal(strlen(a.body), a.len);
	assert_true(api_utf8_clean(a.body, a.len));
	assert_int_equal(a.status, api_problem_status(a.code));
	assert_non_null(a.format);
	return a;
}

/* The body parsed; the answer is given back. */
static cJSON *parse(struct api_answer *a)
{
	cJSON *json = cJSON_Parse(a->body);

	assert_non_null(json);
	if (a->code == API_OK) {
		assert_string_equal(a->content_type, "application/json");
	} else {
		const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(json, "code"));

		assert_string_equal(a->content_type, "application/problem+json");
		assert_string_equal(name, api_problem_name(a->code));
		assert_true(a->detail[0] != '\0');
	}
	api_answer_free(a);
	return json;
}

static cJSON *report(const struct file *f, const char *query)
{
	struct api_job_head head = head_of(query);
	struct api_answer a = ask(&head, f->bytes, f->len, 1000);

	if (a.code != API_OK)
		fail_msg("%s", a.body);
	return parse(&a);
}

static cJSON *problem(const struct api_job_head *head, const void *bytes, size_t len,
		      enum api_code code)
{
	struct api_answer a = ask(head, bytes, len, 100);

	if (a.code != code)
		fail_msg("%s instead of %s", a.body, api_problem_name(code));
	return parse(&a);
}

static const cJSON *at(const cJSON *item, const char *path)
{
	char copy[128], *name;

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

/* The text of a member, as printed. */
static void prints(const cJSON *json, const char *path, const char *expected)
{
	char *text = cJSON_PrintUnformatted(at(json, path));

	assert_non_null(text);
	assert_string_equal(text, expected);
	free(text);
}

/* In the text itself: cJSON would round on the way. */
static void has(const struct api_answer *a, const char *words)
{
	if (strstr(a->body, words) == NULL)
		fail_msg("no %s in %s", words, a->body);
}

static void the_box_of_the_contract_prints_as_there(void **state)
{
	struct file f = contract_box();
	struct api_job_head head = head_of("density=2700");
	struct api_answer a;

	(void)state;
	head.filename = "box.stl";
	a = ask(&head, f.bytes, f.len, 17);
	assert_int_equal(a.status, 200);
	has(&a, "\"input\":{\"filename\":\"box.stl\",\"format\":\"stl-binary\",\"bytes\":684,"
		"\"unit\":\"mm\",\"transform\":null,\"sha256\":null}");
	has(&a, "\"mesh\":{\"triangles\":12,\"polygons\":0,\"surfaces\":0,\"vertices\":8,"
		"\"edges\":18,\"bodies\":1,\"euler_characteristic\":2,\"bounding_box\":"
		"{\"min\":[0,0,0],\"max\":[40,30,20],\"size\":[40,30,20]}}");
	has(&a, "\"checks\":{\"closed\":true,\"watertight\":true,\"winding_consistent\":true,"
		"\"orientation\":\"outward\",\"solid\":true,\"boundary_edges\":0,");
	has(&a, "\"overlapping_bodies\":0,\"self_intersections\":null,\"closure_defect\":[0,0,0],"
		"\"closes_at_tolerance\":null,\"by_index\":null}");
	has(&a, "\"volume\":24000,\"signed_volume\":24000,\"surface_area\":5200,"
		"\"surface_centroid\":[20,15,10],\"density\":2700,\"mass\":0.0648,"
		"\"centroid\":[20,15,10],");
	has(&a, "\"about_origin\":[[28.08,-19.44,-12.96],[-19.44,43.2,-9.72],[-12.96,-9.72,54]],"
		"\"about_centroid\":[[7.02,0,0],[0,10.8,0],[0,0,13.5]],\"about_point\":null,"
		"\"point\":null,\"about_axis\":null}");
	has(&a, "\"moments\":[7.02,10.8,13.5],\"axes\":[[1,0,0],[0,1,0],[0,0,1]],"
		"\"quaternion_wxyz\":[1,0,0,0],\"radii_of_gyration\":[10.408");
	has(&a, "\"bodies\":[{\"triangles\":12,\"volume\":24000,");
	has(&a, "\"inertia_about_centroid\":[[7.02,0,0],[0,10.8,0],[0,0,13.5]],\"bounding_box\":"
		"{\"min\":[0,0,0],\"max\":[40,30,20]},\"watertight\":true,\"orientable\":true,"
		"\"genus\":0,"
		"\"orientation\":\"outward\",\"depth\":0,\"parent\":null,\"cavity\":false,"
		"\"name\":null}]");
	has(&a, "\"warnings\":[{\"code\":\"unit_assumed\",");
	assert_string_equal(a.format, "stl-binary");
	assert_int_equal(a.triangles, 12);
	assert_int_equal(a.bytes, 684);
	api_answer_free(&a);
}

static void other_ways_to_say_the_same_mass_print_the_same(void **state)
{
	static const char *const queries[] = {
	    "density=2.7&density_unit=g/cm3", "material=aluminium_6061",
	    "density=0.0000027&density_unit=file", "density=2700&mass_unit=kg&unit=mm"};
	struct file f = contract_box();

	(void)state;
	for (size_t i = 0; i < sizeof queries / sizeof queries[0]; i++) {
		struct api_job_head head = head_of(queries[i]);
		struct api_answer a = ask(&head, f.bytes, f.len, 1000);

		has(&a, "\"mass\":0.0648,\"centroid\"");
		has(&a, "\"about_centroid\":[[7.02,0,0],[0,10.8,0],[0,0,13.5]]");
		api_answer_free(&a);
	}
}

static void inches_and_pounds_are_exact(void **state)
{
	struct file f = contract_box();
	cJSON *json = report(&f, "unit=in&density=0.25&density_unit=lb/in3&mass_unit=lb");

	(void)state;
	prints(json, "properties.mass", "6000");
	prints(json, "units.inertia", "\"lb.in2\"");
	cJSON_Delete(json);
	json = report(&f, "unit=in&mass=6000&mass_unit=lb&density_unit=lb/in3");
	prints(json, "properties.density", "0.25");
	prints(json, "properties.mass", "6000");
	cJSON_Delete(json);
}

static void point_and_axis_are_answered(void **state)
{
	struct file f = contract_box();
	cJSON *json = report(&f, "density=2700&about=20,15,10&axis_origin=20,15,10");

	(void)state;
	prints(json, "properties.inertia.about_axis.direction", "[0,0,1]");
	prints(json, "properties.inertia.about_axis.moment", "13.5");
	prints(json, "properties.inertia.about_axis.origin", "[20,15,10]");
	prints(json, "properties.inertia.about_point", "[[7.02,0,0],[0,10.8,0],[0,0,13.5]]");
	cJSON_Delete(json);
}

static void where_a_chunk_ends_never_shows(void **state)
{
	struct file f = contract_box();
	struct api_job_head head = head_of("density=2700");
	struct api_answer whole = ask(&head, f.bytes, f.len, f.len);
	char *end = strstr(whole.body, "\"timing_ms\"");

	(void)state;
	for (size_t step = 1; step < 100; step += 7) {
		struct api_answer a = ask(&head, f.bytes, f.len, step);

		assert_memory_equal(a.body, whole.body, (size_t)(end - whole.body));
		api_answer_free(&a);
	}
	api_answer_free(&whole);
}

static void times_are_in_milliseconds(void **state)
{
	struct file f = contract_box();
	struct api_job_head head = head_of("");
	struct api_answer a = ask(&head, f.bytes, f.len, 342);
	cJSON *json;

	(void)state;
	assert_true(a.timing.receive == 1.5 && a.timing.queue == 2.5);
	assert_true(a.timing.decode == 750);  /* two pieces and the end, a tick each */
	assert_true(a.timing.analyse == 500); /* the report, and printing it */
	json = parse(&a);
	prints(json, "timing_ms", "{\"receive\":1.5,\"queue\":2.5,\"decode\":750,\"analyse\":250}");
	cJSON_Delete(json);
}

static void strict_refuses_what_is_no_solid(void **state)
{
	struct file whole = contract_box(), open = opened(1), inside_out = {.len = 0};
	struct api_job_head head = head_of("strict=true");
	cJSON *json;

	(void)state;
	cJSON_Delete(report(&whole, "strict=true"));
	cJSON_Delete(report(&open, "strict=false"));
	json = problem(&head, open.bytes, open.len, API_NOT_A_SOLID);
	prints(json, "status", "422");
	assert_non_null(
	    strstr(cJSON_GetStringValue(at(json, "detail")), "3 boundary edges in 1 places"));
	cJSON_Delete(json);
	add_box(&inside_out, (const float[]){0, 0, 0}, (const float[]){1, 1, 1}, true);
	json = problem(&head, inside_out.bytes, inside_out.len, API_NOT_A_SOLID);
	assert_non_null(strstr(cJSON_GetStringValue(at(json, "detail")), "inside out"));
	cJSON_Delete(json);
	cJSON_Delete(report(&inside_out, "strict=true&flip=true"));
}

static void strict_refuses_bodies_that_overlap(void **state)
{
	struct file f = {.len = 0};
	struct api_job_head head = head_of("strict=true");
	cJSON *json;

	(void)state;
	add_box(&f, (const float[]){0, 0, 0}, (const float[]){2, 2, 2}, false);
	add_box(&f, (const float[]){1, 1, 1}, (const float[]){3, 3, 3}, false);
	json = problem(&head, f.bytes, f.len, API_NOT_A_SOLID);
	assert_non_null(
	    strstr(cJSON_GetStringValue(cJSON_GetObjectItem(json, "detail")), "bodies overlap"));
	cJSON_Delete(json);
	json = report(&f, "");
	prints(json, "checks.solid", "false");
	prints(json, "checks.overlapping_bodies", "1");
	cJSON_Delete(json);
}

static void strict_lets_pass_what_was_not_decided(void **state)
{
	struct file f = {.len = 0};
	cJSON *json;

	(void)state;
	add_box(&f, (const float[]){0, 0, 0}, (const float[]){1, 1, 1}, false);
	add_box(&f, (const float[]){1, 1, 0}, (const float[]){2, 2, 1}, false); /* the same body */
	add_box(&f, (const float[]){1, .25F, .25F}, (const float[]){1.5F, .75F, .75F}, false);
	json = report(&f, "strict=true"); /* a face on one whose edges join four triangles */
	prints(json, "checks.solid", "null");
	prints(json, "checks.overlapping_bodies", "null");
	prints(json, "mesh.bodies", "2");
	cJSON_Delete(json);
}

static void a_cavity_is_one(void **state)
{
	struct file f = {.len = 0};
	cJSON *json;

	(void)state;
	add_box(&f, (const float[]){0, 0, 0}, (const float[]){4, 4, 4}, false);
	add_box(&f, (const float[]){1, 1, 1}, (const float[]){3, 3, 3}, true);
	json = report(&f, "");
	prints(json, "properties.volume", "56");
	prints(json, "bodies.1.volume", "8");
	prints(json, "bodies.1.signed_volume", "-8");
	prints(json, "bodies.1.cavity", "true");
	prints(json, "bodies.1.depth", "1");
	prints(json, "bodies.1.parent", "0");
	prints(json, "bodies.0.parent", "null");
	cJSON_Delete(json);
	json = report(&f, "bodies=1");
	assert_int_equal(cJSON_GetArraySize(at(json, "bodies")), 1);
	prints(json, "mesh.bodies", "2");
	cJSON_Delete(json);
}

static void an_open_mesh_says_where(void **state)
{
	struct file f = opened(1);
	cJSON *json = report(&f, "density=2700");

	(void)state;
	prints(json, "properties.volume", "null");
	prints(json, "properties.mass", "null");
	prints(json, "properties.inertia", "null");
	prints(json, "properties.density", "2700");
	prints(json, "checks.boundary_edges", "3");
	assert_int_equal(cJSON_GetArraySize(at(json, "defects.boundary_edges")), 3);
	prints(json, "defects.truncated", "false");
	cJSON_Delete(json);
	json = report(&f, "defects=1");
	assert_int_equal(cJSON_GetArraySize(at(json, "defects.boundary_edges")), 1);
	prints(json, "defects.truncated", "true");
	cJSON_Delete(json);
}

static void a_bad_file_is_the_files_fault(void **state)
{
	struct file f = contract_box();
	struct api_job_head head = head_of("");
	const float nan = NAN;
	cJSON *json;

	(void)state;
	cJSON_Delete(problem(&head, "", 0, API_EMPTY));
	cJSON_Delete(problem(&head, garbage, sizeof garbage - 1, API_UNREADABLE));
	json = problem(&head, f.bytes, f.len - 1, API_TRUNCATED);
	prints(json, "instance", "\"/v1/mass-properties\"");
	prints(json, "request_id", "\"test-1\"");
	prints(json, "retryable", "false");
	cJSON_Delete(json);
	memcpy(f.bytes + 84 + 12, &nan, sizeof nan);
	json = problem(&head, f.bytes, f.len, API_NON_FINITE);
	assert_true(cJSON_IsNumber(at(json, "byte")));
	cJSON_Delete(json);
	json = problem(&head, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2 x\n", 51,
		       API_UNREADABLE);
	prints(json, "line", "4");
	cJSON_Delete(json);
}

static void other_formats_have_their_own_decoders(void **state)
{
	static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n";
	static const char draco[] = "DRACO\x02\x02\x01\x01\0\0";
	struct api_job_head head = head_of("");

	(void)state;
	cJSON_Delete(problem(&head, obj, sizeof obj - 1, API_BAD_INDEX));
	cJSON_Delete(problem(&head, draco, sizeof draco - 1, API_TRUNCATED));
	head = head_of("format=obj");
	cJSON_Delete(problem(&head, obj, sizeof obj - 1, API_BAD_INDEX));
	head = head_of("format=drc");
	cJSON_Delete(problem(&head, draco, sizeof draco - 1, API_TRUNCATED));
	head = head_of("format=stl");
	cJSON_Delete(problem(&head, draco, sizeof draco - 1, API_TYPE_MISMATCH));
	cJSON_Delete(problem(&head, obj, sizeof obj - 1, API_TYPE_MISMATCH));
	cJSON_Delete(problem(&head, garbage, sizeof garbage - 1, API_UNREADABLE));
}

static void a_forced_format_is_taken_at_its_word(void **state)
{
	struct file f = contract_box();
	cJSON *json;

	(void)state;
	memcpy(f.bytes, "DRACO\x02\x02\x01\x01", 9);
	json = report(&f, "format=stl");
	prints(json, "properties.volume", "24000");
	cJSON_Delete(json);
}

static void limits_are_named_with_both_figures(void **state)
{
	struct file f = contract_box();
	struct api_job_head head = head_of("");
	struct api_job *job;
	struct api_answer a;
	cJSON *json;

	(void)state;
	head.limits.max_triangles = 11;
	json = problem(&head, f.bytes, f.len, API_TOO_MANY_TRIANGLES);
	prints(json, "status", "413");
	prints(json, "limit", "11");
	prints(json, "actual", "12");
	cJSON_Delete(json);
	head.limits.max_triangles = 12;
	head.limits.max_decoded = 684;
	a = ask(&head, f.bytes, f.len, 100);
	assert_int_equal(a.status, 200);
	api_answer_free(&a);
	head.limits.max_decoded = 683;
	json = problem(&head, f.bytes, f.len, API_DECODED_TOO_LARGE);
	prints(json, "limit", "683");
	prints(json, "actual", "684");
	cJSON_Delete(json);
	job = api_job_new(&head); /* known as soon as it is passed, and for good */
	assert_int_equal(api_job_push(job, f.bytes, 683), 0);
	assert_int_equal(api_job_push(job, f.bytes, 0), 0);
	assert_int_equal(api_job_push(job, f.bytes, 1), 1);
	assert_int_equal(api_job_push(job, f.bytes, 1), 1);
	api_job_free(job);
}

static int verdict(const char *query, const char *type, const char *encoding)
{
	struct api_job_head head = head_of(query);
	struct api_problem p = {.code = API_OK};
	struct api_answer a;
	struct file f = contract_box();
	int rc;

	head.content_type = type;
	head.content_encoding = encoding;
	rc = api_job_precheck(&head, &p);
	a = ask(&head, f.bytes, f.len, 300);
	assert_int_equal(rc == 0, a.code == API_OK);
	assert_int_equal(p.code, a.code); /* the job comes to the same verdict */
	api_answer_free(&a);
	return (int)p.code;
}

static void options_are_judged_from_the_head(void **state)
{
	struct api_job_head head = head_of("unit=parsec");
	struct api_job *job = api_job_new(&head);
	cJSON *json;

	(void)state;
	assert_int_equal(api_job_push(job, (const uint8_t *)"x", 1), 1);
	api_job_free(job);
	json = problem(&head, "x", 1, API_BAD_OPTION);
	prints(json, "option", "\"unit\"");
	prints(json, "status", "400");
	cJSON_Delete(json);
	assert_int_equal(verdict("mass=1&density=2", NULL, NULL), API_BAD_OPTION);
	assert_int_equal(verdict("nope=1", NULL, NULL), API_UNKNOWN_OPTION);
	assert_int_equal(verdict("resolution=1", NULL, NULL), API_OPTION_NOT_SUPPORTED);
	assert_int_equal(verdict("unit=mm", NULL, NULL), API_OK);
	assert_int_equal(verdict(NULL, NULL, NULL), API_OK);
}

static bool streams(const char *query)
{
	struct api_job_head head = head_of(query);

	return api_job_streams(&head);
}

static void the_query_says_whether_a_body_streams(void **state)
{
	(void)state;
	assert_true(streams("unit=mm&checks=closed&density=3"));
	assert_true(streams("check%73=close%64"));
	assert_false(streams("checks=full"));
	assert_false(streams("checks=closed&nope=1")); /* refused anyway */
	assert_false(streams(""));
	assert_false(streams(NULL));
}

static void media_types_are_those_of_the_contract(void **state)
{
	static const char *const good[] = {"model/stl",
					   "Model/STL; charset=binary",
					   " application/octet-stream ;x",
					   "text/plain;charset=utf-8",
					   "",
					   "application/x-www-form-urlencoded",
					   "application/sla",
					   "application/vnd.ms-pki.stl",
					   "model/x.stl-binary",
					   "model/x.stl-ascii",
					   "application/x-tgif",
					   "model/obj",
					   "model/x-draco"};
	static const char *const wrong[] = {"application/json",
					    "model/stlx",
					    "model",
					    "*/*",
					    "model/stl, text/plain",
					    "image/png",
					    "multipart/mixed; boundary=x"};

	(void)state;
	for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
		assert_int_equal(verdict("", good[i], NULL), API_OK);
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
		assert_int_equal(verdict("", wrong[i], NULL), API_UNSUPPORTED_MEDIA_TYPE);
}

static void codings_are_those_of_the_contract(void **state)
{
	(void)state;
	assert_int_equal(verdict("", NULL, "identity"), API_OK);
	assert_int_equal(verdict("", NULL, " Identity , identity"), API_OK);
	assert_int_equal(verdict("", NULL, ""), API_OK);
	assert_int_equal(verdict("", NULL, "br"), API_UNSUPPORTED_ENCODING);
	assert_int_equal(verdict("", NULL, "identity, deflate"), API_UNSUPPORTED_ENCODING);
	assert_int_equal(verdict("", NULL, "gzip, zstd"), API_UNSUPPORTED_ENCODING);
	assert_int_equal(verdict("", "multipart/form-data", NULL), API_BAD_MULTIPART);
	assert_string_equal(api_accept_encoding, "gzip, zstd, identity");
	assert_non_null(strstr(api_accept_post, "model/stl"));
	assert_non_null(strstr(api_accept_post, "multipart/form-data"));
}

static void a_job_may_be_left_at_any_time(void **state)
{
	struct file f = contract_box();
	struct api_job_head head = head_of("");
	struct api_job *job;

	(void)state;
	api_job_free(NULL);
	api_job_free(api_job_new(&head));
	job = api_job_new(&head);
	assert_int_equal(api_job_push(job, f.bytes, 500), 0);
	api_job_free(job);
	head.now = NULL;
	cJSON_Delete(problem(&head, NULL, 0, API_EMPTY));
}

/* Length of an answer's body up to the times, which may differ. */
static size_t without_times(const struct api_answer *a)
{
	const char *times = strstr(a->body, "\"timing_ms\"");

	return times != NULL ? (size_t)(times - a->body) : a->len;
}

/* One run in which the ${n}-th allocation fails; the code of the answer, which is sound. */
static enum api_code run_failing(const struct api_job_head *head, const struct file *f, long n,
				 const struct api_answer *good)
{
	struct api_job *job;
	struct api_answer a;
	enum api_code code = API_TOO_EXPENSIVE;
	cJSON *json;

	alloc_fail_at(n);
	job = api_job_new(head);
	if (job == NULL)
		goto out;
	(void)api_job_push(job, f->bytes, f->len);
	api_job_answer(job, 0, 0, &a);
	api_job_free(job);
	alloc_fail_at(0);
	code = a.code;
	assert_non_null(a.body);
	assert_int_equal(strlen(a.body), a.len);
	assert_int_equal(a.status, api_problem_status(a.code));
	if (code == good->code)
		assert_memory_equal(a.body, good->body, without_times(&a));
	json = cJSON_Parse(a.body);
	assert_non_null(json);
	cJSON_Delete(json);
	api_answer_free(&a);
out:
	alloc_fail_at(0);
	return code;
}

/* Whatever allocation fails, the answer says that memory is out, or it is whole. */
static void sweep(const char *query, const struct file *f, enum api_code expected)
{
	struct api_job_head head = head_of(query);
	struct api_answer good;
	long total = alloc_count(), out_of_memory = 0;

	head.filename = "a.stl";
	good = ask(&head, f->bytes, f->len, f->len);
	assert_int_equal(good.code, expected);
	total = alloc_count() - total;
	for (long n = 1; n <= total; n++) {
		enum api_code code = run_failing(&head, f, n, &good);

		out_of_memory += code == API_TOO_EXPENSIVE;
		if (code != expected)
			assert_int_equal(code, API_TOO_EXPENSIVE);
	}
	assert_true(out_of_memory > 10 && out_of_memory <= total);
	api_answer_free(&good);
}

static void any_failed_allocation_gives_an_answer(void **state)
{
	struct file f = contract_box(), open = opened(2);

	(void)state;
	sweep("density=2700&about=1,2,3&axis=1,1,1", &f, API_OK);
	sweep("", &open, API_OK);
	sweep("strict=true", &open, API_NOT_A_SOLID);
	sweep("unit=x", &f, API_BAD_OPTION);
}

static void capabilities_say_what_is_in_force(void **state)
{
	const struct api_limits_in_force limits = {1 << 30, UINT64_C(1) << 32, 20000000, 30, 4};
	size_t len = 0;
	char *text = api_capabilities_json(&limits, &len);
	cJSON *json = cJSON_Parse(text);
	int options = 0;

	(void)state;
	assert_int_equal(strlen(text), len);
	prints(json, "version", "\"0.1.0\"");
	assert_string_equal(api_version, "0.1.0");
	prints(json, "formats", "[\"stl-binary\",\"stl-ascii\",\"obj\",\"draco\"]");
	prints(json, "content_codings", "[\"identity\",\"gzip\",\"zstd\"]");
	prints(json, "units", "[\"mm\",\"um\",\"cm\",\"m\",\"in\",\"ft\"]");
	prints(json, "density_units", "[\"kg/m3\",\"g/cm3\",\"lb/in3\",\"file\"]");
	prints(json, "mass_units", "[\"kg\",\"g\",\"lb\"]");
	prints(json, "media_types.0", "\"model/stl\"");
	prints(json, "materials.0",
	       "{\"name\":\"aluminium_6061\",\"density\":2700,\"density_unit\":\"kg/m3\"}");
	prints(json, "limits.max_decoded", "4294967296");
	prints(json, "limits.max_triangles", "20000000");
	prints(json, "limits.deadline_s", "30");
	prints(json, "limits.workers", "4");
	for (size_t i = 0; api_option_name(i) != NULL; i++)
		options += api_option_supported(i);
	assert_int_equal(cJSON_GetArraySize(at(json, "options")), options);
	cJSON_Delete(json);
	free(text);
}

static void any_failed_allocation_gives_no_capabilities(void **state)
{
	const struct api_limits_in_force limits = {1, 2, 3, 4, 5};
	char *text = NULL;
	size_t len;
	long n;

	(void)state;
	for (n = 1; text == NULL && n < 2000; n++) {
		alloc_fail_at(n);
		text = api_capabilities_json(&limits, &len);
	}
	alloc_fail_at(0);
	assert_non_null(text);
	assert_true(n > 15);
	free(text);
}

static void a_report_makes_a_table(void **state)
{
	struct file f = contract_box();
	struct api_job_head head = head_of("material=steel");
	struct api_answer a = ask(&head, f.bytes, f.len, 1000);
	char *table = api_report_table(a.body, a.len);

	(void)state;
	assert_non_null(table);
	assert_non_null(strstr(table, "0.1884 kg"));
	free(table);
	api_answer_free(&a);
}

int main(void)
{
	const struct CMUnitTest job[] = {
	    cmocka_unit_test(the_box_of_the_contract_prints_as_there),
	    cmocka_unit_test(other_ways_to_say_the_same_mass_print_the_same),
	    cmocka_unit_test(inches_and_pounds_are_exact),
	    cmocka_unit_test(point_and_axis_are_answered),
	    cmocka_unit_test(where_a_chunk_ends_never_shows),
	    cmocka_unit_test(times_are_in_milliseconds),
	    cmocka_unit_test(strict_refuses_what_is_no_solid),
	    cmocka_unit_test(strict_refuses_bodies_that_overlap),
	    cmocka_unit_test(strict_lets_pass_what_was_not_decided),
	    cmocka_unit_test(a_cavity_is_one),
	    cmocka_unit_test(an_open_mesh_says_where),
	    cmocka_unit_test(a_bad_file_is_the_files_fault),
	    cmocka_unit_test(other_formats_have_their_own_decoders),
	    cmocka_unit_test(a_forced_format_is_taken_at_its_word),
	    cmocka_unit_test(limits_are_named_with_both_figures),
	    cmocka_unit_test(options_are_judged_from_the_head),
	    cmocka_unit_test(the_query_says_whether_a_body_streams),
	    cmocka_unit_test(media_types_are_those_of_the_contract),
	    cmocka_unit_test(codings_are_those_of_the_contract),
	    cmocka_unit_test(a_job_may_be_left_at_any_time),
	    cmocka_unit_test_setup_teardown(any_failed_allocation_gives_an_answer, hook, unhook),
	    cmocka_unit_test(capabilities_say_what_is_in_force),
	    cmocka_unit_test_setup_teardown(any_failed_allocation_gives_no_capabilities, hook,
					    unhook),
	    cmocka_unit_test(a_report_makes_a_table),
	};

	return cmocka_run_group_tests(job, NULL, NULL);
}
