/* Forms, content codings and several files, through a whole job. */
#include "api/form.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <cjson/cJSON.h>
#include <zlib.h>

#include "alloc_fail.h"
#include "api/job.h"
#include "api/utf8.h"
#include "cjson_hooks.h"
#include "tests/unit/mesh_make.h"

struct body { /* grows at the end */
	char bytes[1 << 16];
	size_t len;
};

static struct body form;

static void add(const void *bytes, size_t len)
{
	assert_true(len <= sizeof form.bytes - form.len);
	memcpy(form.bytes + form.len, bytes, len);
	form.len += len;
}

static void say(const char *text)
{
	add(text, strlen(text));
}

static void begin(void)
{
	form.len = 0;
}

static void begin_part(const char *params, const char *headers)
{
	say("--XX\r\nContent-Disposition: form-data; ");
	say(params);
	say(headers);
	say("\r\n\r\n");
}

static void option(const char *name, const char *value)
{
	char params[600];

	(void)snprintf(params, sizeof params, "name=\"%s\"", name);
	begin_part(params, "");
	say(value);
	say("\r\n");
}

/* A box of 1 x 2 x 3 at ${x}; ${ascii}: its name as a solid, NULL for binary. */
static void box(double x, const char *ascii)
{
	const double min[3] = {x, 0, 0}, max[3] = {x + 1, 2, 3};
	struct mesh m = {0};
	uint8_t *file;
	size_t len;

	mesh_box(&m, min, max);
	file = ascii != NULL ? mesh_stl_ascii(&m, ascii, &len) : mesh_stl_binary(&m, NULL, &len);
	add(file, len);
	free(file);
	mesh_free(&m);
}

static void box_part(double x, const char *params)
{
	begin_part(params, "\r\nContent-Type: application/octet-stream");
	box(x, NULL);
	say("\r\n");
}

static void end(void)
{
	say("--XX--\r\n");
}

static struct api_job_head head_of(const char *query)
{
	return (struct api_job_head){.query = query,
				     .query_len = query != NULL ? strlen(query) : 0,
				     .content_type = "multipart/form-data; boundary=XX",
				     .instance = "/v1/mass-properties",
				     .request_id = "test-1",
				     .key = {7},
				     .limits = {1 << 20, 1000}};
}

static struct api_answer ask(const struct api_job_head *head, size_t step)
{
	struct api_job *job = api_job_new(head);
	struct api_answer a;

	assert_non_null(job);
	for (size_t at = 0; at < form.len; at += step) {
		size_t n = form.len - at < step ? form.len - at : step;
		uint8_t *copy = malloc(n);

		assert_non_null(copy);
		memcpy(copy, form.bytes + at, n);
		(void)api_job_push(job, copy, n);
		free(copy);
	}
	api_job_answer(job, 0, 0, &a);
	api_job_free(job);
	assert_non_null(a.body);
	assert_true(api_utf8_clean(a.body, a.len));
	assert_int_equal(a.status, api_problem_status(a.code));
	return a;
}

/* Length of an answer's body up to the times, which may differ. */
static size_t without_times(const struct api_answer *a)
{
	const char *times = strstr(a->body, "\"timing_ms\"");

	return times != NULL ? (size_t)(times - a->body) : a->len;
}

/* The answer to ${form}, which is the same in any pieces. */
static cJSON *answer(const struct api_job_head *head, enum api_code code)
{
	struct api_answer whole = ask(head, form.len > 0 ? form.len : 1);
	cJSON *json;

	if (whole.code != code)
		fail_msg("%s instead of %s", whole.body, api_problem_name(code));
	for (size_t step = 1; step < 200; step += 1 + step / 3) {
		struct api_answer a = ask(head, step);

		assert_int_equal(without_times(&a), without_times(&whole));
		assert_memory_equal(a.body, whole.body, without_times(&whole));
		assert_true(a.bytes == whole.bytes || code != API_OK);
		api_answer_free(&a);
	}
	json = cJSON_Parse(whole.body);
	assert_non_null(json);
	api_answer_free(&whole);
	return json;
}

static cJSON *report(const char *query)
{
	struct api_job_head head = head_of(query);

	return answer(&head, API_OK);
}

static const cJSON *at(const cJSON *item, const char *path)
{
	char copy[128], *name;

	assert_true(strlen(path) < sizeof copy);
	strcpy(copy, path);
	for (name = strtok(copy, "."); name != NULL && item != NULL; name = strtok(NULL, "."))
		item = cJSON_IsArray(item) ? cJSON_GetArrayItem(item, atoi(name))
					   : cJSON_GetObjectItemCaseSensitive(item, name);
	return item;
}

static void prints(const cJSON *json, const char *path, const char *expected)
{
	char *text;

	if (at(json, path) == NULL)
		fail_msg("no %s", path);
	text = cJSON_PrintUnformatted(at(json, path));
	assert_non_null(text);
	assert_string_equal(text, expected);
	free(text);
}

/* The problem that ${form} is: ${option} NULL for none, ${words} are in its detail. */
static void refused(const char *query, enum api_code code, const char *option_name,
		    const char *words)
{
	struct api_job_head head = head_of(query);
	cJSON *json = answer(&head, code);
	const char *detail = cJSON_GetStringValue(at(json, "detail"));
	const char *name = cJSON_GetStringValue(at(json, "option"));

	if (strstr(detail, words) == NULL)
		fail_msg("no '%s' in '%s'", words, detail);
	if (option_name == NULL)
		assert_null(name);
	else
		assert_string_equal(name, option_name);
	cJSON_Delete(json);
}

static bool warns(const cJSON *json, const char *code)
{
	const cJSON *w;

	cJSON_ArrayForEach(w, at(json, "warnings")) if (strcmp(cJSON_GetStringValue(at(w, "code")),
							       code) == 0) return true;
	return false;
}

static void options_stand_before_and_behind_the_file(void **state)
{
	cJSON *json;

	(void)state;
	begin();
	option("density", "500");
	option("unit", "m");
	box_part(0, "name=\"file\"; filename=\"box.stl\"");
	option("about", "0,0,0");
	option("flip", "true");
	option("bodies", "0");
	end();
	json = report("defects=5");
	prints(json, "input",
	       "{\"filename\":\"box.stl\",\"format\":\"stl-binary\",\"bytes\":684,"
	       "\"unit\":\"m\",\"transform\":null,\"sha256\":null}");
	prints(json, "properties.mass", "3000");
	prints(json, "properties.signed_volume", "-6");
	assert_true(cJSON_IsArray(at(json, "properties.inertia.about_point")));
	prints(json, "bodies", "[]");
	assert_false(warns(json, "unit_assumed"));
	cJSON_Delete(json);
}

static void a_file_is_known_by_its_filename_or_its_name(void **state)
{
	static const char *const params[][2] = {
	    {"name=\"file\"", "null"},
	    {"name=\"file\"; filename=\"\"", "null"},
	    {"name=\"mesh\"; filename=\"a\"", "\"a\""},
	    {"name=\"unit\"; filename=\"b.stl\"", "\"b.stl\""},
	    {"name=\"x\"; filename=\"\xff\xc3\xa9\"", "\"\xef\xbf\xbd\xc3\xa9\""}};

	(void)state;
	for (size_t i = 0; i < sizeof params / sizeof params[0]; i++) {
		cJSON *json;

		begin();
		box_part(0, params[i][0]);
		end();
		json = report(NULL);
		prints(json, "input.filename", params[i][1]);
		assert_null(at(json, "input.filenames"));
		prints(json, "properties.volume", "6");
		cJSON_Delete(json);
	}
}

static void files_are_one_solid(void **state)
{
	cJSON *json;

	(void)state;
	begin();
	box_part(0, "name=\"file\"; filename=\"a.stl\"");
	option("unit", "in");
	box_part(5, "name=\"file\"");
	begin_part("name=\"other\"; filename=\"c.stl\"", "");
	box(10, "third");
	say("\r\n");
	end();
	json = report("density=2&density_unit=file");
	prints(json, "input.filename", "\"a.stl\"");
	prints(json, "input.filenames", "[\"a.stl\",null,\"c.stl\"]");
	prints(json, "input.format", "\"mixed\"");
	prints(json, "mesh.triangles", "36");
	prints(json, "mesh.bodies", "3");
	prints(json, "properties.volume", "18");
	prints(json, "properties.mass", "36");
	prints(json, "bodies.2.name", "\"third\"");
	cJSON_Delete(json);
}

/* Browsers sort part.mtl before part.obj, so that it may come first. */
static void materials_and_pictures_are_passed_over(void **state)
{
	cJSON *json;

	(void)state;
	begin();
	begin_part("name=\"file\"; filename=\"box.MTL\"", "");
	say("newmtl steel\r\n");
	begin_part("name=\"file\"; filename=\"skin\"", "\r\nContent-Type: Image/PNG");
	say("\x89PNG\r\n");
	box_part(0, "name=\"file\"; filename=\"box.stl\"");
	begin_part("name=\"more\"; filename=\"a.b.jpeg\"", "");
	say("\r\n");
	end();
	json = report(NULL);
	prints(json, "input.filename", "\"box.stl\"");
	assert_null(at(json, "input.filenames"));
	prints(json, "properties.volume", "6");
	assert_true(warns(json, "attachment_ignored"));
	cJSON_Delete(json);
	begin();
	begin_part("name=\"file\"; filename=\"box.stl\"", "\r\nContent-Type: image/x-cad");
	box(0, NULL);
	say("\r\n");
	end();
	json = report(NULL); /* what is called a mesh is one */
	assert_false(warns(json, "attachment_ignored"));
	cJSON_Delete(json);
}

static void a_form_needs_a_file(void **state)
{
	(void)state;
	begin();
	refused(NULL, API_BAD_MULTIPART, NULL, "the body is empty");
	end();
	refused(NULL, API_BAD_MULTIPART, NULL, "no file");
	begin();
	option("density", "1");
	end();
	refused(NULL, API_BAD_MULTIPART, NULL, "no file");
	begin();
	begin_part("name=\"file\"; filename=\"a.png\"", "");
	say("\r\n");
	end();
	refused(NULL, API_BAD_MULTIPART, NULL, "materials or pictures");
	begin();
	box_part(0, "name=\"file\"; filename=\"a.stl\"");
	refused(NULL, API_BAD_MULTIPART, NULL, "Part 1 of the form: ");
}

static void options_are_judged_as_in_the_query(void **state)
{
	static const struct {
		const char *query, *name, *value;
		enum api_code code;
	} cases[] = {{"density=1", "density", "1", API_BAD_OPTION},
		     {"", "unit", "parsec", API_BAD_OPTION},
		     {"", "unit", "mm\r\n", API_BAD_OPTION},
		     {"", "unit", "", API_BAD_OPTION},
		     {"", "density", "1e400", API_BAD_OPTION},
		     {"", "resolution", "1", API_OPTION_NOT_SUPPORTED},
		     {"", "nonsense", "1", API_UNKNOWN_OPTION},
		     {"mass=1", "density", "1", API_BAD_OPTION},
		     {"unit=m", "density", "1e-320", API_BAD_OPTION}};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		for (int behind = 0; behind < 2; behind++) {
			begin();
			if (behind)
				box_part(0, "name=\"file\"; filename=\"a.stl\"");
			option(cases[i].name, cases[i].value);
			if (!behind)
				box_part(0, "name=\"file\"; filename=\"a.stl\"");
			end();
			refused(cases[i].query, cases[i].code,
				strcmp(cases[i].query, "mass=1") == 0 ? "mass" : cases[i].name, "");
		}
	}
	begin();
	option("flip", "true");
	option("flip", "true");
	end();
	refused(NULL, API_BAD_OPTION, "flip", "more than once");
}

/* The unit may come later than what it gives a meaning to. */
static void options_are_checked_together_at_the_end(void **state)
{
	struct api_job_head head = head_of("density=1e-300");
	struct api_problem p;
	cJSON *json;

	(void)state;
	assert_int_equal(api_job_precheck(&head, &p), 0);
	begin();
	box_part(0, "name=\"file\"; filename=\"a.stl\"");
	option("unit", "m");
	end();
	json = report("density=1e-300");
	prints(json, "properties.density", "1e-300");
	cJSON_Delete(json);
	head.content_type = NULL;
	head.query = "density=1e-305";
	assert_int_equal(api_job_precheck(&head, &p), -1); /* in mm it is out of range */
}

static void a_value_has_a_limit(void **state)
{
	static char value[API_FORM_VALUE + 2];

	(void)state;
	memset(value, '1', API_FORM_VALUE + 1);
	begin();
	option("unit", value);
	refused(NULL, API_BAD_OPTION, "unit", "longer than 16384 bytes");
	value[API_FORM_VALUE] = '\0';
	begin();
	option("unit", value);
	end();
	refused(NULL, API_BAD_OPTION, "unit", "one of mm");
}

static void a_digest_is_asked_for_before_the_files(void **state)
{
	(void)state;
	for (int when = 0; when < 3; when++) { /* before, between, behind */
		begin();
		if (when == 0)
			option("include", "digest");
		box_part(0, "name=\"file\"; filename=\"a.stl\"");
		if (when == 1)
			option("include", "facets,digest");
		box_part(5, "name=\"file\"; filename=\"b.stl\"");
		if (when == 2)
			option("include", "digest");
		end();
		if (when == 0)
			cJSON_Delete(report(NULL));
		else
			refused(NULL, API_BAD_OPTION, "include", "before the files");
	}
	begin();
	box_part(0, "name=\"file\"; filename=\"a.stl\"");
	option("include", "facets"); /* of which nothing is gone */
	end();
	cJSON_Delete(report(NULL));
}

static void a_format_behind_the_file_must_be_what_was_found(void **state)
{
	static const char *const words[] = {"auto", "stl", "drc", "obj"};

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		begin();
		box_part(0, "name=\"file\"; filename=\"a.stl\"");
		option("format", words[i]);
		box_part(5, "name=\"file\"; filename=\"b.stl\"");
		end();
		if (i < 2)
			cJSON_Delete(report(NULL));
		else
			refused(NULL, API_BAD_OPTION, "format", "before the files");
	}
	begin();
	option("format", "stl");
	begin_part("name=\"file\"", "");
	box(0, NULL);
	memcpy(form.bytes + form.len - 684, "DRACO\x02\x02\x01\x01", 9);
	say("\r\n");
	end();
	cJSON_Delete(report(NULL));
}

static void a_problem_names_the_file(void **state)
{
	(void)state;
	begin();
	box_part(0, "name=\"file\"; filename=\"a.stl\"");
	begin_part("name=\"file\"; filename=\"b\xc3\xa9.stl\"", "");
	box(0, NULL);
	form.len--;
	say("\r\n");
	box_part(0, "name=\"file\"");
	end();
	refused(NULL, API_TRUNCATED, NULL, "File 2 (b\xc3\xa9.stl): ");
	begin();
	begin_part("name=\"file\"; filename=\"a.stl\"", "");
	say("\r\n");
	box_part(0, "name=\"file\"");
	end();
	refused(NULL, API_EMPTY, NULL, "File 1 (a.stl): ");
	begin();
	begin_part("name=\"file\"", "");
	say("PK\x03\x04 an archive, not a mesh, and long enough to be told from a short file, "
	    "since 84 bytes are wanted\r\n");
	end();
	refused(NULL, API_UNREADABLE, NULL, "File 1: ");
}

/* With ${wbits} 31 a gzip member, in the place of ${form}. */
static void pack(void)
{
	static uint8_t packed[sizeof form.bytes];
	z_stream z = {0};

	assert_int_equal(deflateInit2(&z, 6, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
	z.next_in = (Bytef *)form.bytes;
	z.avail_in = (uInt)form.len;
	z.next_out = packed;
	z.avail_out = sizeof packed;
	assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
	form.len = sizeof packed - z.avail_out;
	deflateEnd(&z);
	memcpy(form.bytes, packed, form.len);
}

static void a_form_may_be_compressed(void **state)
{
	struct api_job_head head = head_of(NULL);
	cJSON *json;
	size_t len;

	(void)state;
	head.content_encoding = "gzip";
	begin();
	option("unit", "m");
	box_part(0, "name=\"file\"; filename=\"a.stl\"");
	end();
	len = form.len;
	pack();
	json = answer(&head, API_OK);
	prints(json, "input.bytes", "684");
	cJSON_Delete(json);
	head.limits.max_decoded = len - 1;
	json = answer(&head, API_DECODED_TOO_LARGE);
	cJSON_Delete(json);
	head.limits.max_decoded = len;
	cJSON_Delete(answer(&head, API_OK));
	form.len -= 9;
	cJSON_Delete(answer(&head, API_BAD_ENCODING));
}

static void a_file_may_be_compressed(void **state)
{
	struct api_job_head head = head_of(NULL);
	cJSON *json;

	(void)state;
	head.content_type = "model/stl";
	head.content_encoding = "gzip";
	begin();
	box(0, NULL);
	pack();
	json = answer(&head, API_OK);
	prints(json, "input.bytes", "684");
	prints(json, "properties.volume", "6");
	cJSON_Delete(json);
	head.content_encoding = NULL; /* what nobody said is not undone */
	json = answer(&head, API_UNREADABLE);
	assert_non_null(strstr(cJSON_GetStringValue(at(json, "detail")), "a gzip file"));
	cJSON_Delete(json);
	head.content_encoding = "zstd";
	json = answer(&head, API_BAD_ENCODING);
	prints(json, "byte", "0");
	cJSON_Delete(json);
	begin();
	pack();
	head.content_encoding = "gzip";
	cJSON_Delete(answer(&head, API_EMPTY));
	begin();
	cJSON_Delete(answer(&head, API_BAD_ENCODING));
}

/* What is wrong with the file is said when nothing is wrong with the coding. */
static void a_compressed_body_is_judged_from_the_outside_in(void **state)
{
	struct api_job_head head = head_of(NULL);
	struct api_job *job;
	size_t len;

	(void)state;
	head.content_type = NULL;
	head.content_encoding = "gzip";
	begin();
	for (int i = 0; i < 1000; i++)
		say("this is no mesh but garbage ");
	len = form.len;
	pack();
	cJSON_Delete(answer(&head, API_UNREADABLE));
	head.limits.max_decoded = len;
	cJSON_Delete(answer(&head, API_UNREADABLE));
	head.limits.max_decoded = len - 1;
	cJSON_Delete(answer(&head, API_DECODED_TOO_LARGE));
	head.limits.max_decoded = len;
	job = api_job_new(&head);
	assert_int_equal(api_job_push(job, (uint8_t *)form.bytes, form.len), 0);
	api_job_free(job);
	form.bytes[form.len - 5] ^= 1;
	cJSON_Delete(answer(&head, API_BAD_ENCODING));
	form.bytes[form.len - 5] ^= 1;
	say("x");
	cJSON_Delete(answer(&head, API_BAD_ENCODING));
	begin(); /* the form is outside of its parts, but comes as they do */
	option("unit", "parsec");
	pack();
	head.content_type = "multipart/form-data; boundary=XX";
	cJSON_Delete(answer(&head, API_BAD_MULTIPART));
	begin();
	option("unit", "parsec");
	option("unit", "parsec");
	pack();
	cJSON_Delete(answer(&head, API_BAD_OPTION));
	form.len--;
	cJSON_Delete(answer(&head, API_BAD_ENCODING));
}

/* Files one behind the other, as the command line has them. */
static int next_files(const char *const *names, size_t count, struct api_answer *a)
{
	struct api_job_head head = head_of(NULL);
	struct api_job *job;
	int verdict = 0;

	head.content_type = NULL;
	head.filename = names[0];
	head.several = true;
	job = api_job_new(&head);
	assert_non_null(job);
	for (size_t i = 0; i < count && verdict == 0; i++) {
		begin();
		box((double)i * 5, NULL);
		if (i > 0)
			verdict = api_job_next_file(job, names[i]);
		if (verdict == 0)
			verdict = api_job_push(job, (uint8_t *)form.bytes,
					       strcmp(names[i], "cut") == 0 ? 600 : form.len);
	}
	if (verdict)
		assert_int_equal(api_job_next_file(job, "x"), 1);
	api_job_answer(job, 0, 0, a);
	api_job_free(job);
	return verdict;
}

static void files_may_follow_one_another(void **state)
{
	static const char *const good[] = {"a.stl", "b.stl", "c.stl"}, *const bad[] = {"cut", "b"};
	struct api_answer a;
	cJSON *json;

	(void)state;
	assert_int_equal(next_files(good, 3, &a), 0);
	json = cJSON_Parse(a.body);
	prints(json, "input.filenames", "[\"a.stl\",\"b.stl\",\"c.stl\"]");
	prints(json, "input.bytes", "2052");
	prints(json, "properties.volume", "18");
	cJSON_Delete(json);
	api_answer_free(&a);
	assert_int_equal(next_files(bad, 2, &a), 1);
	assert_int_equal(a.code, API_TRUNCATED);
	assert_non_null(strstr(a.detail, "File 1 (cut): "));
	api_answer_free(&a);
}

/* One run in which the ${n}-th allocation fails; whether memory was what it lacked. */
static bool runs_out(const struct api_job_head *head, long n, const struct api_answer *good)
{
	struct api_answer a;
	struct api_job *job;
	bool out;

	alloc_fail_at(n);
	job = api_job_new(head);
	if (job != NULL) {
		(void)api_job_push(job, (uint8_t *)form.bytes, form.len);
		api_job_answer(job, 0, 0, &a);
		api_job_free(job);
	}
	alloc_fail_at(0);
	if (job == NULL)
		return true;
	out = a.code != good->code;
	if (out)
		assert_int_equal(a.code, API_TOO_EXPENSIVE);
	else
		assert_memory_equal(a.body, good->body, without_times(good));
	api_answer_free(&a);
	return out;
}

static void any_failed_allocation_gives_an_answer(void **state)
{
	struct api_job_head head = head_of("density=1");
	struct api_answer good;
	long total = alloc_count(), out = 0;

	(void)state;
	head.content_encoding = "gzip";
	begin();
	option("unit", "m");
	box_part(0, "name=\"file\"; filename=\"a.stl\"");
	box_part(5, "name=\"file\"; filename=\"b.stl\"");
	begin_part("name=\"t\"; filename=\"t.png\"", "");
	say("\r\n");
	end();
	pack();
	good = ask(&head, form.len);
	assert_int_equal(good.code, API_OK);
	total = alloc_count() - total;
	for (long n = 1; n <= total; n++)
		out += runs_out(&head, n, &good);
	assert_true(out > 10 && out <= total);
	api_answer_free(&good);
}

int main(void)
{
	const struct CMUnitTest forms[] = {
	    cmocka_unit_test(options_stand_before_and_behind_the_file),
	    cmocka_unit_test(a_file_is_known_by_its_filename_or_its_name),
	    cmocka_unit_test(files_are_one_solid),
	    cmocka_unit_test(materials_and_pictures_are_passed_over),
	    cmocka_unit_test(a_form_needs_a_file),
	    cmocka_unit_test(options_are_judged_as_in_the_query),
	    cmocka_unit_test(options_are_checked_together_at_the_end),
	    cmocka_unit_test(a_value_has_a_limit),
	    cmocka_unit_test(a_digest_is_asked_for_before_the_files),
	    cmocka_unit_test(a_format_behind_the_file_must_be_what_was_found),
	    cmocka_unit_test(a_problem_names_the_file),
	    cmocka_unit_test(a_form_may_be_compressed),
	    cmocka_unit_test(a_file_may_be_compressed),
	    cmocka_unit_test(a_compressed_body_is_judged_from_the_outside_in),
	    cmocka_unit_test(files_may_follow_one_another),
	    cmocka_unit_test_setup_teardown(any_failed_allocation_gives_an_answer, hook, unhook),
	};

	return cmocka_run_group_tests(forms, NULL, NULL);
}
