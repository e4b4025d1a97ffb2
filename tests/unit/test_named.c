/* density[NAME], from the words of a request to its answer. */
#include "api/named.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "api/job.h"
#include "api/utf8.h"
#include "tests/unit/alloc_fail.h"
#include "tests/unit/mesh_make.h"

static int read_query(const char *query, struct api_options *o, struct api_problem *p)
{
	size_t len = strlen(query);
	char *copy = malloc(len + (len == 0));
	int ret;

	assert_non_null(copy);
	memcpy(copy, query, len);
	api_options_init(o);
	memset(p, 0, sizeof *p);
	ret = api_options_query(o, copy, len, p);
	if (ret == 0)
		ret = api_options_check(o, p);
	free(copy);
	return ret;
}

static void accepts(const char *query, struct api_options *o)
{
	struct api_problem p;

	if (read_query(query, o, &p))
		fail_msg("%.80s: %s (%s)", query, p.detail, p.option);
}

static void refuses(const char *query, const char *option)
{
	struct api_options o;
	struct api_problem p;

	if (read_query(query, &o, &p) == 0)
		fail_msg("%.80s is accepted", query);
	assert_int_equal(p.code, API_BAD_OPTION);
	assert_string_equal(p.option, option);
	assert_true(strlen(p.detail) > 10);
	api_options_free(&o);
}

static void names_and_numbers_arrive(void **state)
{
	struct api_options o;
	struct mp_request r;

	(void)state;
	accepts("density%5Bst%C3%A9el%20%5Bx%5D%5D=7.85&density[a]=1e3&density_unit=g/cm3&"
		"unit=cm&mass_unit=g&density=3",
		&o);
	api_options_request(&o, &r);
	assert_int_equal(r.named_count, 2);
	assert_int_equal(r.named[0].len, 10);
	assert_memory_equal(r.named[0].name,
			    "st\xc3\xa9"
			    "el [x]",
			    10);
	assert_true(r.named[0].density / r.named[0].divisor == 7.85);
	assert_int_equal(r.named[1].len, 1);
	assert_true(r.named[1].density / r.named[1].divisor == 1000);
	assert_int_equal(r.density_kind, MP_DENSITY_GIVEN);
	assert_true(r.density / r.density_divisor == 3);
	api_options_free(&o);
	api_options_free(&o);
	accepts("unit=mm", &o);
	api_options_request(&o, &r);
	assert_int_equal(r.named_count, 0);
	api_options_free(&o);
	accepts("material=steel&density[x]=1", &o);
	api_options_free(&o);
}

static void names_that_cannot_be(void **state)
{
	(void)state;
	refuses("density[a]=1&density[b]=2&density[a]=1", "density[a]");
	refuses("density[a]=1&density%5B%61%5D=2", "density[a]");
	refuses("density[a]=0", "density[a]");
	refuses("density[a]=-1", "density[a]");
	refuses("density[a]=", "density[a]");
	refuses("density[a]", "density[a]");
	refuses("density[a]=heavy", "density[a]");
	refuses("density[a]=1,2", "density[a]");
	refuses("density[a]=1e999", "density[a]");
	refuses("mass=1&density[a]=1", "density[a]");
	refuses("density[a]=1&mass=1", "density[a]");
	refuses("density[a]=1&density[b]=1e306&density_unit=g/cm3&unit=m", "density[b]");
}

static void long_names(void **state)
{
	char query[600] = "density[", want[64] = "density[";
	struct api_options o;

	(void)state;
	memset(query + 8, 'n', 255);
	(void)snprintf(query + 8 + 255, 16, "]=2");
	accepts(query, &o);
	assert_int_equal(o.named.list[0].len, 255);
	api_options_free(&o);
	memset(query + 8, 'n', 256);
	(void)snprintf(query + 8 + 256, 16, "]=2");
	memset(want + 8, 'n', sizeof want - 9); /* what a problem has room for */
	refuses(query, want);
}

static void a_thousand_names(void **state)
{
	struct api_options o;
	struct api_problem p;
	struct mp_request r;

	(void)state;
	api_options_init(&o);
	for (int i = 0; i <= API_MOST_NAMED; i++) {
		char name[32];
		int len = snprintf(name, sizeof name, "density[%d]", i);
		int ret = api_options_set(&o, name, (size_t)len, "2", 1, &p);

		assert_int_equal(ret, i < API_MOST_NAMED ? 0 : -1);
	}
	assert_int_equal(p.code, API_BAD_OPTION);
	assert_string_equal(p.option, "density[1000]");
	assert_true(p.limit == 1000 && p.actual == 1001);
	api_options_request(&o, &r);
	assert_int_equal(r.named_count, API_MOST_NAMED);
	assert_memory_equal(r.named[999].name, "999", 3);
	api_options_free(&o);
}

static void memory_runs_out(void **state)
{
	const char *query = "density[a]=1&density[b]=2&density[c]=3&density[d]=4&density[e]=5&"
			    "density[f]=6&density[g]=7&density[h]=8&density[i]=9";
	struct api_options o;
	struct api_problem p;
	long last;

	(void)state;
	last = alloc_count();
	accepts(query, &o);
	api_options_free(&o);
	last = alloc_count() - last;
	assert_true(last > 10);
	for (long n = 2; n <= last; n++) { /* the first one is the test's */
		alloc_fail_at(n);
		assert_int_equal(read_query(query, &o, &p), -1);
		alloc_fail_at(0);
		assert_int_equal(p.code, API_TOO_EXPENSIVE);
		api_options_free(&o);
	}
}

static double no_clock(void)
{
	return 0;
}

/* ASCII STL of solids of two boxes each, one after the other. */
static char *solids(const char *const *names)
{
	size_t size = 0;
	char *all = malloc(1);

	assert_non_null(all);
	for (int i = 0; names[i] != NULL; i++) {
		const double min[3] = {10.0 * i, 0, 0}, max[3] = {10.0 * i + 1, 1, 1};
		struct mesh m = {0};
		uint8_t *one;
		size_t len;

		mesh_box(&m, min, max);
		one = mesh_stl_ascii(&m, names[i], &len);
		all = realloc(all, size + len + 1);
		assert_non_null(all);
		memcpy(all + size, one, len);
		size += len;
		free(one);
		mesh_free(&m);
	}
	all[size] = '\0';
	return all;
}

static struct api_answer answer(const char *file, const char *query)
{
	const struct api_job_head head = {
	    .query = query,
	    .query_len = strlen(query),
	    .instance = "/v1/mass-properties",
	    .limits = {1 << 20, 1 << 20},
	    .now = no_clock,
	};
	struct api_problem problem = {.code = API_OK};
	struct api_answer out;
	struct api_job *job = api_job_new(&head);

	(void)api_job_precheck(&head, &problem);
	assert_non_null(job);
	(void)api_job_push(job, (const uint8_t *)file, strlen(file));
	api_job_answer(job, 0, 0, &out);
	api_job_free(job);
	return out;
}

static void says(const char *file, const char *query, int status, const char *const *words)
{
	struct api_answer a = answer(file, query);

	if (a.status != status)
		fail_msg("%s: %d %s", query, a.status, a.body);
	assert_true(api_utf8_clean(a.body, a.len));
	for (; *words != NULL; words++)
		if (strstr(a.body, *words) == NULL)
			fail_msg("%s: not %s in %s", query, *words, a.body);
	api_answer_free(&a);
}

#define SAYS(query, status, ...) says(file, query, status, (const char *const[]){__VA_ARGS__, NULL})

static void answers_weigh_by_name(void **state)
{
	const char *const names[] = {"steel", "plastic part", NULL};
	char *file = solids(names);

	(void)state;
	SAYS("density[steel]=7.5&density[plastic%20part]=0.5&density_unit=file", 200, "\"mass\":8,",
	     "\"density\":4,", "\"mass\":\"file\"", "\"mass\":7.5,");
	SAYS("density[steel]=8000&density[plastic%20part]=1000&unit=cm&mass_unit=g", 200,
	     "\"mass\":9,", "\"density\":4500,", "\"mass\":\"g\"");
	SAYS("density[steel]=8000&density=1000&unit=cm&mass_unit=g", 200, "\"mass\":9,");
	SAYS("density[steel]=8000&material=water&unit=m", 200, "\"mass\":8998.2,");
	free(file);
}

static void problems_say_which_name(void **state)
{
	const char *const names[] = {"steel",
				     "b\xff"
				     "d \"quoted\"",
				     "steel 2",
				     "4",
				     "5",
				     "6 6 6 6",
				     "7",
				     NULL};
	char *file = solids(names);

	(void)state;
	SAYS("density[stel]=1&density=1", 400, "\"option\":\"density[stel]\"",
	     "\"code\":\"bad_option\"",
	     "No faces are under this name. The names are: steel, b\xef\xbf\xbd"
	     "d "
	     "\\\"quoted\\\", steel 2, 4, 5, 6 6 6 6, and others.");
	SAYS("density[steel]=1", 400,
	     "\"option\":\"density[b\xef\xbf\xbd"
	     "d \\\"quoted\\\"]\"",
	     "no density");
	free(file);
	file = solids((const char *const[]){"a", "", NULL});
	SAYS("density[a]=1", 400, "\"option\":\"density\"", "under no name");
	SAYS("density[b]=1&density=1", 400, "\"option\":\"density[b]\"",
	     "this name. The names are: a.\"");
	free(file);
	file = solids((const char *const[]){"", NULL});
	SAYS("density[b]=1&density=1", 400, "No faces have a name.\"");
	free(file);
}

/* The lid of a box is no solid. */
static void a_name_has_to_be_a_solid(void **state)
{
	const double min[3] = {0, 0, 0}, max[3] = {1, 2, 3};
	struct mesh m = {0}, lid;
	char *file, *rest;
	size_t n, k;

	(void)state;
	mesh_box(&m, min, max);
	lid = (struct mesh){.tri = m.tri + 10, .count = 2};
	m.count = 10;
	file = (char *)mesh_stl_ascii(&m, "walls", &n);
	rest = (char *)mesh_stl_ascii(&lid, "lid", &k);
	file = realloc(file, n + k + 1);
	assert_non_null(file);
	memcpy(file + n, rest, k);
	file[n + k] = '\0';
	SAYS("density[lid]=1&density[walls]=2", 400, "\"option\":\"density[lid]\"",
	     "\"code\":\"bad_option\"", "not a closed solid by themselves");
	SAYS("density[walls]=1&density=2", 400, "\"option\":\"density[walls]\"");
	SAYS("density=2&density_unit=file", 200, "\"mass\":12,");
	free(file);
	free(rest);
	m.count = 12;
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(names_and_numbers_arrive),
	    cmocka_unit_test(names_that_cannot_be),
	    cmocka_unit_test(long_names),
	    cmocka_unit_test(a_thousand_names),
	    cmocka_unit_test(memory_runs_out),
	    cmocka_unit_test(answers_weigh_by_name),
	    cmocka_unit_test(problems_say_which_name),
	    cmocka_unit_test(a_name_has_to_be_a_solid),
	};

	return cmocka_run_group_tests_name("named", tests, NULL, NULL);
}
