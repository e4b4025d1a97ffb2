#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/config.h"
#include "server/config_value.h"

extern char **environ;

enum { MOST_ARGS = 64 };

/* Not on the stack: what the config points to lives as long as the program. */
static struct srv_config config;
static char why[300];

/* Load with the arguments up to NULL. */
static int load(const char *first, ...)
{
	static char args[MOST_ARGS][200];
	char *argv[MOST_ARGS + 1] = {args[0]};
	int argc = 1;
	va_list ap;

	(void)snprintf(args[0], sizeof args[0], "masspropd");
	va_start(ap, first);
	for (const char *a = first; a != NULL && argc < MOST_ARGS; a = va_arg(ap, const char *)) {
		(void)snprintf(args[argc], sizeof args[argc], "%s", a);
		argv[argc] = args[argc];
		argc++;
	}
	va_end(ap);
	argv[argc] = NULL;
	why[0] = '\0';
	srv_config_free(&config);
	return srv_config_load(&config, argc, argv, why, sizeof why);
}

static void loads(const char *flag, const char *value)
{
	if (load(flag, value, NULL) != 0)
		fail_msg("%s %s: %s", flag, value, why);
}

static void refuses(const char *flag, const char *value)
{
	if (load(flag, value, NULL) == 0)
		fail_msg("%s takes \"%s\"", flag, value);
	if (strstr(why, flag) == NULL || strchr(why, '\n') != NULL)
		fail_msg("%s %s: says \"%s\"", flag, value, why);
}

/* No variable of ours from outside, and none from one test to the next. */
static int clean(void **state)
{
	(void)state;
	for (size_t i = 0; environ[i] != NULL;) {
		char name[100];
		size_t len = strcspn(environ[i], "=");

		if (strncmp(environ[i], "MASSPROPD_", 10) != 0 || len >= sizeof name) {
			i++;
			continue;
		}
		memcpy(name, environ[i], len);
		name[len] = '\0';
		unsetenv(name);
	}
	return 0;
}

static void sizes_have_units_of_ten_and_of_two(void **state)
{
	static const struct {
		const char *text;
		uint64_t bytes;
	} good[] = {
	    {"0", 0},
	    {"17", 17},
	    {"17B", 17},
	    {"2kB", 2000},
	    {"3MB", 3000000},
	    {"4GB", UINT64_C(4000000000)},
	    {"2KiB", 2048},
	    {"3MiB", 3 << 20},
	    {"4GiB", UINT64_C(4) << 30},
	    {"1.5GiB", UINT64_C(3) << 29},
	    {"0.5KiB", 512},
	    {"007", 7},
	    {"9000000000000000000", UINT64_C(9000000000000000000)},
	};
	static const char *const bad[] = {"",     "B",    "-1",   "+1",   "1 ",
					  " 1",   "1 kB", "1KB",  "1kb",  "1k",
					  "1G",   "1TB",  "0.3B", "1.5",  "1e3",
					  "0x10", "inf",  "nan",  "1.",   ".5",
					  "1..5", "1kB5", "1,5",  "1kBB", "10000000000000000000"};
	uint64_t v;

	(void)state;
	for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
		if (srv_value_size(good[i].text, &v) != 0 || v != good[i].bytes)
			fail_msg("%s", good[i].text);
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		if (srv_value_size(bad[i], &v) == 0)
			fail_msg("\"%s\" is taken", bad[i]);
}

static void durations_are_seconds(void **state)
{
	static const struct {
		const char *text;
		double seconds;
	} good[] = {{"0", 0},        {"2", 2},       {"2s", 2},      {"0.5", 0.5},
		    {"250ms", 0.25}, {"1.5min", 90}, {"2h", 7200.0}, {"0.5ms", 0.0005}};
	static const char *const bad[] = {"",    "s",   "-1s", "1m",  "1S",
					  "1 s", "1e3", "inf", "nan", "1sec"};
	double v;

	(void)state;
	for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
		if (srv_value_duration(good[i].text, &v) != 0 || v != good[i].seconds)
			fail_msg("%s", good[i].text);
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		if (srv_value_duration(bad[i], &v) == 0)
			fail_msg("\"%s\" is taken", bad[i]);
}

static void counts_are_whole(void **state)
{
	static const char *const bad[] = {"",   "k",   "-1",  "1.5", "1K",
					  "1m", "1kk", "1e3", "1 k", "0x1"};
	uint64_t v;

	(void)state;
	assert_int_equal(srv_value_count("20M", &v), 0);
	assert_true(v == 20000000);
	assert_int_equal(srv_value_count("1.5k", &v), 0);
	assert_true(v == 1500);
	assert_int_equal(srv_value_count("0", &v), 0);
	assert_true(v == 0);
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		if (srv_value_count(bad[i], &v) == 0)
			fail_msg("\"%s\" is taken", bad[i]);
}

/* As API and architecture promise them. */
static void defaults(void **state)
{
	(void)state;
	assert_int_equal(load(NULL, NULL), 0);
	assert_int_equal(config.listens, 1);
	assert_string_equal(config.listen[0], "127.0.0.1:8080");
	assert_int_equal(config.origins, 0);
	assert_true(config.workers >= 1);
	assert_true(config.queue == 0 && config.memory == 0);
	assert_true(config.max_body == UINT64_C(1) << 30);
	assert_true(config.max_decoded == UINT64_C(4) << 30);
	assert_true(config.max_triangles == 20000000);
	assert_true(config.header_timeout == 10 && config.body_timeout == 60);
	assert_true(config.deadline == 30 && config.write_timeout == 60);
	assert_true(config.drain_delay == 0 && config.drain_timeout == 25);
	assert_int_equal(config.log_level, SRV_INFO);
	assert_false(config.log_json || config.help || config.version || config.health);
}

static void every_number_has_its_flag(void **state)
{
	(void)state;
	assert_int_equal(load("--workers", "3", "--queue", "9", "--max-body", "1MB",
			      "--max-decoded=2MB", "--max-triangles", "5k", "--memory=100MB", NULL),
			 0);
	assert_true(config.workers == 3 && config.queue == 9 && config.max_body == 1000000);
	assert_true(config.max_decoded == 2000000 && config.max_triangles == 5000);
	assert_true(config.memory == 100000000);
	assert_int_equal(load("--header-timeout", "1s", "--body-timeout=2s", "--deadline", "3s",
			      "--write-timeout", "4s", "--drain-delay", "5s", "--drain-timeout=6s",
			      NULL),
			 0);
	assert_true(config.header_timeout == 1 && config.body_timeout == 2);
	assert_true(config.deadline == 3 && config.write_timeout == 4);
	assert_true(config.drain_delay == 5 && config.drain_timeout == 6);
}

static void words_have_their_choices(void **state)
{
	static const char *const levels[] = {"error", "warn", "info", "debug"};

	(void)state;
	for (int i = 0; i < 4; i++) {
		loads("--log-level", levels[i]);
		assert_int_equal((int)config.log_level, i);
	}
	loads("--log-format", "json");
	assert_true(config.log_json);
	loads("--log-format", "text");
	assert_false(config.log_json);
	refuses("--log-level", "INFO");
	refuses("--log-level", "");
	refuses("--log-format", "xml");
}

static void plain_flags_take_no_value(void **state)
{
	(void)state;
	assert_int_equal(load("--help", NULL), 0);
	assert_true(config.help);
	assert_int_equal(load("--version", NULL), 0);
	assert_true(config.version);
	assert_int_equal(load("--health", "--listen", "127.0.0.1:1", NULL), 0);
	assert_true(config.health);
	assert_string_equal(config.listen[0], "127.0.0.1:1");
	assert_int_equal(load("--help=yes", NULL), -1);
}

static void lists_split_at_commas_and_repeated_flags_add(void **state)
{
	(void)state;
	loads("--listen", "127.0.0.1:1,[::1]:2");
	assert_int_equal(config.listens, 2);
	assert_string_equal(config.listen[1], "[::1]:2");
	assert_int_equal(load("--listen", "a:1", "--listen", "b:2,c:3", "--cors-origin",
			      "https://a.test", "--cors-origin", "*.b.test", NULL),
			 0);
	assert_int_equal(config.listens, 3);
	assert_string_equal(config.listen[0], "a:1");
	assert_string_equal(config.listen[2], "c:3");
	assert_int_equal(config.origins, 2);
	assert_string_equal(config.origin[0], "https://a.test");
	assert_string_equal(config.origin[1], "*.b.test");
	refuses("--listen", "");
	refuses("--listen", ",,");
	refuses("--listen", "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17");
}

static void ranges_hold(void **state)
{
	static const char *const durations[] = {"--header-timeout", "--body-timeout", "--deadline",
						"--write-timeout"};

	(void)state;
	refuses("--workers", "0");
	refuses("--workers", "257");
	loads("--workers", "256");
	refuses("--queue", "0");
	refuses("--max-body", "0");
	refuses("--max-triangles", "0");
	refuses("--max-triangles", "2000M");
	refuses("--memory", "1MB");
	refuses("--max-decoded", "-1");
	for (size_t i = 0; i < 4; i++) {
		refuses(durations[i], "0");
		refuses(durations[i], "25h");
		loads(durations[i], "10ms");
	}
	loads("--drain-delay", "0");
	loads("--drain-timeout", "0s");
}

static void unknown_arguments_are_refused(void **state)
{
	static const char *const bad[] = {"--bogus", "--bogus=1", "-h",          "--", "calc", "",
					  "--work",  "--Workers", "--max_body=1"};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		assert_int_equal(load(bad[i], NULL), -1);
		if (strstr(why, bad[i]) == NULL)
			fail_msg("\"%s\" does not name \"%s\"", why, bad[i]);
	}
	assert_int_equal(load("--workers", NULL), -1);
	assert_non_null(strstr(why, "--workers needs a value"));
	refuses("--workers", "");
	assert_int_equal(load("--workers=", NULL), -1);
}

static void the_environment_sets_what_flags_may_override(void **state)
{
	(void)state;
	setenv("MASSPROPD_WORKERS", "5", 1);
	setenv("MASSPROPD_MAX_BODY", "7MB", 1);
	setenv("MASSPROPD_LISTEN", "10.0.0.1:1,10.0.0.2:2", 1);
	setenv("MASSPROPD_LOG_FORMAT", "json", 1);
	assert_int_equal(load(NULL, NULL), 0);
	assert_true(config.workers == 5 && config.max_body == 7000000 && config.log_json);
	assert_int_equal(config.listens, 2);
	assert_int_equal(load("--workers", "2", "--listen", "127.0.0.1:0", NULL), 0);
	assert_true(config.workers == 2 && config.max_body == 7000000);
	assert_int_equal(config.listens, 1); /* not beside those of the environment */
	assert_string_equal(config.listen[0], "127.0.0.1:0");
}

static void unknown_variables_of_ours_are_refused(void **state)
{
	static const char *const names[] = {"MASSPROPD_BOGUS", "MASSPROPD_", "MASSPROPD_workers",
					    "MASSPROPD_HELP"};

	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		setenv(names[i], "1", 1);
		assert_int_equal(load(NULL, NULL), -1);
		if (strstr(why, names[i]) == NULL)
			fail_msg("\"%s\" does not name %s", why, names[i]);
		unsetenv(names[i]);
	}
	setenv("MASSPROPD_WORKERS", "many", 1);
	assert_int_equal(load(NULL, NULL), -1);
	assert_non_null(strstr(why, "MASSPROPD_WORKERS"));
	unsetenv("MASSPROPD_WORKERS");
	setenv("MASSPROP_X", "1", 1); /* somebody else's */
	setenv("XMASSPROPD_X", "1", 1);
	assert_int_equal(load(NULL, NULL), 0);
	unsetenv("MASSPROP_X");
	unsetenv("XMASSPROPD_X");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, clean, clean)
	const struct CMUnitTest settings[] = {
	    TEST(sizes_have_units_of_ten_and_of_two),
	    TEST(durations_are_seconds),
	    TEST(counts_are_whole),
	    TEST(defaults),
	    TEST(every_number_has_its_flag),
	    TEST(words_have_their_choices),
	    TEST(plain_flags_take_no_value),
	    TEST(lists_split_at_commas_and_repeated_flags_add),
	    TEST(ranges_hold),
	    TEST(unknown_arguments_are_refused),
	    TEST(the_environment_sets_what_flags_may_override),
	    TEST(unknown_variables_of_ours_are_refused),
	};

	return cmocka_run_group_tests_name("config", settings, NULL, NULL);
}
