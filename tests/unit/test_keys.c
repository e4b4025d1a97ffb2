#include "server/keys.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"

static char path[] = "/tmp/test_keys.XXXXXX";

/* The keys of a file with this text; the descriptor or -1. */
static int read_text(const char *text, size_t len, char *why, size_t size)
{
	FILE *f = fopen(path, "wb");

	assert_non_null(f);
	assert_int_equal(fwrite(text, 1, len, f), len);
	assert_int_equal(fclose(f), 0);
	return srv_keys_read(path, why, size);
}

static void load(struct srv_keys *keys, const char *text)
{
	char why[300];
	int fd = read_text(text, strlen(text), why, sizeof why);

	assert_true(fd >= 0);
	assert_int_equal(srv_keys_load(keys, fd), 0);
	close(fd);
}

static void assert_refused(const char *text, size_t len, const char *reason)
{
	char why[300] = "";

	assert_int_equal(read_text(text, len, why, sizeof why), -1);
	if (strstr(why, reason) == NULL)
		fail_msg("'%s' does not say '%s'", why, reason);
}

static void test_lines_blanks_and_comments(void **state)
{
	struct srv_keys keys = {.in_force = false};

	(void)state;
	load(&keys, "# keys\n\n  first-key \t\r\nsecond#key # of the shop\n#third\nlast");
	assert_true(keys.in_force);
	assert_int_equal(keys.count, 3);
	assert_string_equal(keys.key[0], "first-key");
	assert_string_equal(keys.key[1], "second#key");
	assert_string_equal(keys.key[2], "last");
	assert_true(srv_keys_fit(&keys, "Bearer second#key"));
	assert_false(srv_keys_fit(&keys, "Bearer third"));
	srv_keys_free(&keys);
	assert_false(keys.in_force);
}

static void test_only_a_whole_key_of_the_scheme_fits(void **state)
{
	static const char *const wrong[] = {"",
					    "Bearer",
					    "Bearer ",
					    "alpha",
					    "Basic alpha",
					    "Bearer ",
					    "Bearer alp",
					    "Bearer alphaa",
					    "Bearer Alpha",
					    "Bearer alpha beta",
					    "Beareralpha",
					    "Bearer alpha,beta",
					    "Bearer \talpha",
					    "Bearer alpha "};
	struct srv_keys keys = {.in_force = false};
	char longer[SRV_KEY_MAX + 20];

	(void)state;
	load(&keys, "alpha\nbeta\n");
	assert_true(srv_keys_fit(&keys, "Bearer alpha"));
	assert_true(srv_keys_fit(&keys, "bearer   beta"));
	assert_false(srv_keys_fit(&keys, NULL));
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
		assert_false(srv_keys_fit(&keys, wrong[i]));
	memset(longer, 'a', sizeof longer);
	memcpy(longer, "Bearer alpha", 12);
	longer[sizeof longer - 1] = '\0';
	assert_false(srv_keys_fit(&keys, longer));
	srv_keys_free(&keys);
}

static void test_longest_key_and_most_keys(void **state)
{
	static char text[(SRV_KEYS_MAX + 1) * 8], longest[SRV_KEY_MAX + 2], header[SRV_KEY_MAX + 9];
	struct srv_keys keys = {.in_force = false};
	size_t len = 0;

	(void)state;
	memset(longest, 'k', SRV_KEY_MAX);
	load(&keys, longest);
	(void)snprintf(header, sizeof header, "Bearer %s", longest);
	assert_true(srv_keys_fit(&keys, header));
	header[strlen(header) - 1] = '\0';
	assert_false(srv_keys_fit(&keys, header));
	longest[SRV_KEY_MAX] = 'k';
	assert_refused(longest, SRV_KEY_MAX + 1, "longer than 255");
	for (int i = 0; i < SRV_KEYS_MAX; i++)
		len += (size_t)sprintf(text + len, "k%d\n", i);
	load(&keys, text);
	assert_int_equal(keys.count, SRV_KEYS_MAX);
	assert_true(srv_keys_fit(&keys, "Bearer k999"));
	assert_refused(strcat(text, "one\n"), len + 4, ":1001: more than 1000");
	srv_keys_free(&keys);
}

static void test_what_is_no_key_file(void **state)
{
	char why[300];

	(void)state;
	assert_refused("", 0, "no key");
	assert_refused("# nothing\n\n", 11, "no key");
	assert_refused("good\ntwo words\n", 15, ":2: a key is of visible ASCII");
	assert_refused("nul\0l\n", 6, ":1: a key is of visible ASCII");
	assert_refused("\xc3\xa4\n", 3, ":1: a key is of visible ASCII");
	assert_int_equal(srv_keys_read("/nowhere/at-all", why, sizeof why), -1);
	assert_non_null(strstr(why, "No such file"));
	assert_int_equal(srv_keys_read("/tmp", why, sizeof why), -1);
	assert_non_null(strstr(why, "not a plain file"));
	assert_int_equal(srv_keys_read("/dev/zero", why, sizeof why), -1);
	assert_non_null(strstr(why, "not a plain file"));
}

static void test_secrets_are_not_in_complaints(void **state)
{
	char why[300];

	(void)state;
	assert_int_equal(read_text("hush hush\n", 10, why, sizeof why), -1);
	assert_null(strstr(why, "hush"));
}

static void test_old_keys_stay_where_memory_is_out(void **state)
{
	struct srv_keys keys = {.in_force = false};
	char why[300];
	int fd;

	(void)state;
	load(&keys, "old\n");
	fd = read_text("new\n", 4, why, sizeof why);
	for (long n = 1; n <= 2; n++) {
		alloc_fail_at(n);
		assert_int_equal(srv_keys_load(&keys, fd), -1);
		alloc_fail_at(0);
		assert_true(srv_keys_fit(&keys, "Bearer old"));
	}
	assert_int_equal(srv_keys_load(&keys, fd), 0);
	assert_true(srv_keys_fit(&keys, "Bearer new"));
	assert_false(srv_keys_fit(&keys, "Bearer old"));
	close(fd);
	alloc_fail_at(1);
	assert_int_equal(srv_keys_read(path, why, sizeof why), -1);
	alloc_fail_at(0);
	srv_keys_free(&keys);
}

static int make_file(void **state)
{
	int fd = mkstemp(path);

	(void)state;
	return fd < 0 ? -1 : close(fd);
}

static int remove_file(void **state)
{
	(void)state;
	return unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_lines_blanks_and_comments),
	    cmocka_unit_test(test_only_a_whole_key_of_the_scheme_fits),
	    cmocka_unit_test(test_longest_key_and_most_keys),
	    cmocka_unit_test(test_what_is_no_key_file),
	    cmocka_unit_test(test_secrets_are_not_in_complaints),
	    cmocka_unit_test(test_old_keys_stay_where_memory_is_out),
	};

	return cmocka_run_group_tests_name("keys", tests, make_file, remove_file);
}
