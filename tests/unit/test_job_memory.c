#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>
#include <zstd.h>

#include "alloc_fail.h"
#include "api/job.h"
#include "cjson_hooks.h"
#include "tests/unit/draco_seen.h"
#include "tests/unit/mesh_make.h"

/* Whole requests of every kind, in which each allocation in turn fails. */

struct body {
	uint8_t *bytes; /* heap, of exactly the size */
	size_t len;
};

static struct api_job_head head_of(const char *query)
{
	return (struct api_job_head){.query = query,
				     .query_len = strlen(query),
				     .instance = "/v1/mass-properties",
				     .request_id = "test-1",
				     .key = {7},
				     .limits = {1 << 20, 1000}};
}

/* NULL body where not even the job could be made. */
static struct api_answer ask(const struct api_job_head *head, const struct body *b)
{
	struct api_answer a = {.code = API_TOO_EXPENSIVE};
	struct api_job *job = api_job_new(head);

	if (job == NULL)
		return a;
	(void)api_job_push(job, b->bytes, b->len / 3);
	(void)api_job_push(job, b->bytes + b->len / 3, b->len - b->len / 3);
	api_job_answer(job, 0, 0, &a);
	api_job_free(job);
	return a;
}

/* Memory was out, said in clean JSON, or everything is as if nothing had happened. */
static bool is_sound(const struct api_answer *a, const struct api_answer *good)
{
	cJSON *json;

	if (a->body == NULL)
		return a->code == API_TOO_EXPENSIVE;
	if (a->code == good->code)
		return a->status == good->status && a->len == good->len &&
		       memcmp(a->body, good->body, a->len) == 0 &&
		       strcmp(a->origin, good->origin) == 0;
	json = cJSON_Parse(a->body);
	cJSON_Delete(json);
	return json != NULL && a->code == API_TOO_EXPENSIVE && a->status == 422 &&
	       strlen(a->body) == a->len;
}

static void sweep(const struct api_job_head *head, const struct body *b, enum api_code expected)
{
	const long before = alloc_count();
	struct api_answer good = ask(head, b);
	const long total = alloc_count() - before;
	long refused = 0;

	if (good.code != expected)
		fail_msg("%s: %s", head->query, good.body);
	for (long n = 1; n <= total; n++) {
		struct api_answer a;

		alloc_fail_at(n);
		a = ask(head, b);
		alloc_fail_at(0);
		refused += a.code == API_TOO_EXPENSIVE;
		if (!is_sound(&a, &good))
			fail_msg("%s, allocation %ld: %s", head->query, n, a.body);
		api_answer_free(&a);
	}
	assert_true(refused > 5);
	api_answer_free(&good);
}

static void sweep_query(const char *query, const struct body *b, enum api_code expected)
{
	struct api_job_head head = head_of(query);

	sweep(&head, b, expected);
}

/* Two boxes that overlap by a corner, one with a cavity; ${open}: without its last triangle. */
static struct body boxes(bool open)
{
	static const double box[3][2][3] = {
	    {{0, 0, 0}, {4, 4, 4}}, {{1, 1, 1}, {2, 2, 2}}, {{3, 3, 3}, {6, 6, 6}}};
	struct mesh m = {0};
	struct body b;

	mesh_box(&m, box[0][0], box[0][1]);
	mesh_box(&m, box[1][0], box[1][1]);
	mesh_flip(&m, 12);
	mesh_box(&m, box[2][0], box[2][1]);
	m.count -= open;
	b.bytes = mesh_stl_binary(&m, NULL, &b.len);
	mesh_free(&m);
	return b;
}

static struct body copy_of(const void *bytes, size_t len)
{
	struct body b = {malloc(len), len};

	assert_non_null(b.bytes);
	memcpy(b.bytes, bytes, len);
	return b;
}

static const char tetrahedra[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 5 0 0\nv 6 0 0\nv 5 1 0\n"
				 "v 5 0 1\nusemtl a\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
				 "usemtl b\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";

/* A tetrahedron, uncompressed. */
static struct body draco(void)
{
	static const uint8_t corner[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
	static const float at[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
	const struct draco_attribute position = {0, D_F32, 3, 0, 0};
	static struct draco_file f;

	draco_head(&f, 0x202, 1, 0, 0);
	draco_faces(&f, 4, 4, corner);
	draco_attributes(&f, &position, 1);
	for (size_t i = 0; i < 12; i++)
		draco_f32(&f, at[i]);
	return copy_of(f.bytes, f.len);
}

static void a_report_with_all_options_is_whole_or_refused(void **state)
{
	struct body whole = boxes(false), open = boxes(true);

	(void)state;
	sweep_query(
	    "material=steel&about=1,2,3&axis=1,1,1&include=facets,digest,self_intersections",
	    &whole, API_OK);
	sweep_query("precision=exact&weld=0.001&orient=fix", &whole, API_OK);
	sweep_query("transform=2,0,0,1,0,0,-3,2,0,1,0,3&flip=true&density=2", &whole, API_OK);
	sweep_query("checks=closed&density=2700", &whole, API_OK);
	sweep_query("orient=fix&weld=0.01&include=self_intersections", &open, API_OK);
	sweep_query("strict=true", &open, API_NOT_A_SOLID);
	free(whole.bytes);
	free(open.bytes);
}

static void other_formats_are_whole_or_refused(void **state)
{
	struct body obj = copy_of(tetrahedra, sizeof tetrahedra - 1), drc = draco();

	(void)state;
	sweep_query("density[a]=7850&density[b]=2700&include=digest", &obj, API_OK);
	sweep_query("density[a]=7850&density[c]=2700&density=1", &obj, API_BAD_OPTION);
	sweep_query("precision=exact&density=7850&include=facets", &drc, API_OK);
	free(obj.bytes);
	free(drc.bytes);
}

static void a_mesh_is_whole_or_refused(void **state)
{
	struct body b = boxes(false);
	struct api_job_head head = head_of("weld=0.001&orient=fix");

	(void)state;
	head.mesh = true;
	sweep(&head, &b, API_OK);
	head = head_of("transform=-1,0,0,1e6,0,1,0,0,0,0,1,0");
	head.mesh = true;
	sweep(&head, &b, API_OK);
	free(b.bytes);
}

static void packed_bodies_are_whole_or_refused(void **state)
{
	struct body plain = boxes(false), b;
	static uint8_t packed[1 << 16];
	struct api_job_head head = head_of("density=1");
	z_stream z = {.next_in = plain.bytes,
		      .avail_in = (uInt)plain.len,
		      .next_out = packed,
		      .avail_out = sizeof packed};

	(void)state;
	assert_int_equal(deflateInit2(&z, 6, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
	assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
	b = copy_of(packed, z.total_out);
	assert_int_equal(deflateEnd(&z), Z_OK);
	head.content_encoding = "gzip";
	sweep(&head, &b, API_OK);
	free(b.bytes);
	b = copy_of(packed, ZSTD_compress(packed, sizeof packed, plain.bytes, plain.len, 3));
	head.content_encoding = "zstd";
	sweep(&head, &b, API_OK);
	free(b.bytes);
	free(plain.bytes);
}

static void a_form_with_several_files_is_whole_or_refused(void **state)
{
	static char text[4096];
	struct api_job_head head = head_of("include=digest");
	struct body b;

	(void)state;
	strcpy(text, "--XX\r\nContent-Disposition: form-data; name=\"density[a]\"\r\n\r\n7\r\n");
	for (int i = 0; i < 2; i++) {
		strcat(text, "--XX\r\nContent-Disposition: form-data; name=\"file\"; "
			     "filename=\"a.obj\"\r\n\r\n");
		strcat(text, tetrahedra);
		strcat(text, "\r\n");
	}
	strcat(text, "--XX\r\nContent-Disposition: form-data; name=\"density\"\r\n\r\n3\r\n"
		     "--XX--\r\n");
	b = copy_of(text, strlen(text));
	head.content_type = "multipart/form-data; boundary=XX";
	sweep(&head, &b, API_OK);
	free(b.bytes);
}

int main(void)
{
	const struct CMUnitTest job_memory[] = {
	    cmocka_unit_test(a_report_with_all_options_is_whole_or_refused),
	    cmocka_unit_test(other_formats_are_whole_or_refused),
	    cmocka_unit_test(a_mesh_is_whole_or_refused),
	    cmocka_unit_test(packed_bodies_are_whole_or_refused),
	    cmocka_unit_test(a_form_with_several_files_is_whole_or_refused),
	};

	return cmocka_run_group_tests(job_memory, hook, unhook);
}
