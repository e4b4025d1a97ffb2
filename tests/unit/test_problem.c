#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "alloc_fail.h"
#include "api/problem.h"
#include "api/utf8.h"
#include "cjson_hooks.h"

/* The table of the contract. */
static const struct {
	int status;
	const char *name;
	bool retryable;
} contract[] = {
    {200, "ok", false},
    {400, "bad_request", false},
    {400, "bad_option", false},
    {400, "unknown_option", false},
    {400, "option_not_supported", false},
    {400, "bad_multipart", false},
    {400, "bad_encoding", false},
    {400, "type_mismatch", false},
    {401, "unauthorized", false},
    {404, "not_found", false},
    {405, "method_not_allowed", false},
    {406, "not_acceptable", false},
    {408, "too_slow", false},
    {413, "body_too_large", false},
    {413, "decoded_too_large", false},
    {413, "too_many_triangles", false},
    {415, "unsupported_media_type", false},
    {415, "unsupported_encoding", false},
    {422, "unreadable", false},
    {422, "truncated", false},
    {422, "empty", false},
    {422, "no_faces", false},
    {422, "point_cloud", false},
    {422, "bad_index", false},
    {422, "non_finite", false},
    {422, "unsupported_feature", false},
    {422, "trimmed_surface", false},
    {422, "not_a_solid", false},
    {422, "too_expensive", false},
    {422, "decoder_crashed", false},
    {429, "queue_full", true},
    {429, "memory_full", true},
    {503, "draining", true},
    {503, "worker_lost", true},
    {500, "internal", false},
};

static void every_code_is_as_the_contract_says(void **state)
{
	(void)state;
	assert_int_equal(sizeof contract / sizeof contract[0], API_CODES);
	for (int i = 0; i < API_CODES; i++) {
		enum api_code code = (enum api_code)i;

		assert_int_equal(api_problem_status(code), contract[i].status);
		assert_string_equal(api_problem_name(code), contract[i].name);
		assert_int_equal(api_problem_retryable(code), contract[i].retryable);
		assert_true(strlen(api_problem_title(code)) > 5);
	}
}

static void a_code_out_of_range_is_internal(void **state)
{
	(void)state;
	assert_string_equal(api_problem_name((enum api_code)API_CODES), "internal");
	assert_int_equal(api_problem_status((enum api_code) - 1), 500);
}

static cJSON *parse(const struct api_problem *p, const char *instance, const char *id)
{
	size_t len = 0;
	char *text = api_problem_json(p, instance, id, &len);
	cJSON *json;

	assert_non_null(text);
	assert_int_equal(strlen(text), len);
	assert_true(api_utf8_clean(text, len));
	json = cJSON_Parse(text);
	assert_non_null(json);
	free(text);
	return json;
}

static const char *word(const cJSON *json, const char *name)
{
	const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, name));

	assert_non_null(text);
	return text;
}

static double figure(const cJSON *json, const char *name)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, name);

	assert_true(cJSON_IsNumber(item));
	return item->valuedouble;
}

static void says_what_rfc_9457_asks(void **state)
{
	struct api_problem p;
	cJSON *json;

	(void)state;
	assert_int_equal(api_problem_set(&p, API_QUEUE_FULL, "There are %d ahead.", 8), -1);
	json = parse(&p, "/v1/mass-properties", "abc.1");
	assert_string_equal(word(json, "type"), "urn:masspropd:problem:queue_full");
	assert_string_equal(word(json, "title"), "The queue is full");
	assert_true(figure(json, "status") == 429);
	assert_string_equal(word(json, "detail"), "There are 8 ahead.");
	assert_string_equal(word(json, "instance"), "/v1/mass-properties");
	assert_string_equal(word(json, "code"), "queue_full");
	assert_true(cJSON_IsTrue(cJSON_GetObjectItem(json, "retryable")));
	assert_string_equal(word(json, "request_id"), "abc.1");
	assert_int_equal(cJSON_GetArraySize(json), 8);
	cJSON_Delete(json);
}

static void figures_appear_where_they_apply(void **state)
{
	struct api_problem p;
	cJSON *json;

	(void)state;
	(void)api_problem_option(&p, API_BAD_OPTION, "axis", 4, "no");
	p.limit = 0; /* a figure like any other */
	p.actual = UINT64_MAX - 1;
	p.byte = 17;
	p.line = 3;
	json = parse(&p, NULL, NULL);
	assert_string_equal(word(json, "option"), "axis");
	assert_true(figure(json, "limit") == 0);
	assert_true(figure(json, "actual") > 1.8e19);
	assert_true(figure(json, "byte") == 17);
	assert_true(figure(json, "line") == 3);
	assert_null(cJSON_GetObjectItem(json, "instance"));
	cJSON_Delete(json);
}

static void hostile_bytes_become_replacement_characters(void **state)
{
	static const char option[] = "a\0b\x80\xff\xc3(\xed\xa0\x80\xf4\x90\x80\x80\"\\\n\x7f";
	struct api_problem p;
	cJSON *json;

	(void)state;
	(void)api_problem_option(&p, API_UNKNOWN_OPTION, option, sizeof option - 1, "x");
	json = parse(&p, "/\x01\xe2\x82", "\xff");
	assert_string_equal(word(json, "instance"), "/\xef\xbf\xbd\xef\xbf\xbd");
	assert_string_equal(word(json, "request_id"), "\xef\xbf\xbd");
	assert_memory_equal(word(json, "option"),
			    "a\xef\xbf\xbd"
			    "b\xef\xbf\xbd",
			    8);
	cJSON_Delete(json);
}

static void only_utf8_without_controls_is_clean(void **state)
{
	static const char *const good[] = {"",
					   "az ~",
					   "\xc2\xa0",
					   "\xdf\xbf",
					   "\xe0\xa0\x80",
					   "\xed\x9f\xbf",
					   "\xee\x80\x80",
					   "\xf0\x90\x80\x80",
					   "\xf4\x8f\xbf\xbf"};
	static const struct {
		const char *bytes;
		size_t replaced; /* by so many characters */
	} bad[] = {{"\n", 1},
		   {"\x7f", 1},
		   {"\xc2\x9f", 1}, /* a control character of two bytes */
		   {"\x80", 1},
		   {"\xc0\xaf", 2},         /* overlong */
		   {"\xe0\x9f\xbf", 3},     /* overlong */
		   {"\xf0\x8f\xbf\xbf", 4}, /* overlong */
		   {"\xed\xa0\x80", 3},     /* a surrogate */
		   {"\xf4\x90\x80\x80", 4}, /* above U+10FFFF */
		   {"\xf5\x80", 2},
		   {"\xe2\x82", 1}, /* cut */
		   {"\xf0\x9f\x98", 1},
		   {"\xff\xfe", 2}};
	char out[64];

	(void)state;
	for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
		assert_true(api_utf8_clean(good[i], strlen(good[i])));
		(void)api_utf8_copy(out, sizeof out, good[i], strlen(good[i]));
		assert_string_equal(out, good[i]);
	}
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		size_t len = strlen(bad[i].bytes);

		assert_false(api_utf8_clean(bad[i].bytes, len));
		assert_int_equal(api_utf8_copy(out, sizeof out, bad[i].bytes, len),
				 3 * bad[i].replaced);
		assert_true(api_utf8_clean(out, strlen(out)));
	}
	assert_int_equal(api_utf8_copy(out, 1, "abc", 3), 0);
	assert_int_equal(api_utf8_copy(out, 4, "ab\xff", 3), 2);
}

static void a_long_option_is_cut_between_characters(void **state)
{
	char option[300];
	struct api_problem p;

	(void)state;
	for (size_t i = 0; i < sizeof option; i += 3)
		memcpy(option + i, "\xe2\x82\xac", 3);
	(void)api_problem_option(&p, API_UNKNOWN_OPTION, option, sizeof option, "x");
	assert_int_equal(strlen(p.option), 63);
	assert_true(api_utf8_clean(p.option, strlen(p.option)));
}

static void a_detail_that_is_too_long_is_cut(void **state)
{
	char text[2000];
	struct api_problem p;

	(void)state;
	memset(text, 'x', sizeof text - 1);
	text[sizeof text - 1] = '\0';
	(void)api_problem_set(&p, API_INTERNAL, "%s", text);
	assert_int_equal(strlen(p.detail), sizeof p.detail - 1);
}

static void any_failed_allocation_gives_null(void **state)
{
	struct api_problem p;
	char *text = NULL;
	size_t len;
	long n;

	(void)state;
	(void)api_problem_option(&p, API_BAD_OPTION, "unit", 4, "no");
	for (n = 1; text == NULL; n++) {
		alloc_fail_at(n);
		text = api_problem_json(&p, "/v1/mass-properties", "id", &len);
		assert_in_range(n, 1, 200);
	}
	alloc_fail_at(0);
	assert_true(n > 10);
	free(text);
}

int main(void)
{
	const struct CMUnitTest problem[] = {
	    cmocka_unit_test(every_code_is_as_the_contract_says),
	    cmocka_unit_test(a_code_out_of_range_is_internal),
	    cmocka_unit_test(says_what_rfc_9457_asks),
	    cmocka_unit_test(figures_appear_where_they_apply),
	    cmocka_unit_test(hostile_bytes_become_replacement_characters),
	    cmocka_unit_test(only_utf8_without_controls_is_clean),
	    cmocka_unit_test(a_long_option_is_cut_between_characters),
	    cmocka_unit_test(a_detail_that_is_too_long_is_cut),
	    cmocka_unit_test_setup_teardown(any_failed_allocation_gives_null, hook, unhook),
	};

	return cmocka_run_group_tests(problem, NULL, NULL);
}
