/* Tables on huge pages: what they hold stays, and nothing beside them changes. */
#include <malloc.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/memory/huge.h"

#include "alloc_fail.h"

enum { LARGE = 40 << 20 };

/* Has the mapping around ${p} been asked for huge pages?  -1: the system does not say. */
static int is_advised(const void *p)
{
	FILE *f = fopen("/proc/self/smaps", "r");
	char line[512];
	int inside = 0, advised = -1;

	while (f != NULL && fgets(line, sizeof line, f) != NULL) {
		unsigned long from, to;

		if (sscanf(line, "%lx-%lx ", &from, &to) == 2)
			inside = (uintptr_t)p >= from && (uintptr_t)p < to;
		else if (inside && strncmp(line, "VmFlags:", 8) == 0)
			advised = strstr(line, " hg") != NULL;
	}
	if (f != NULL)
		fclose(f);
	return advised;
}

static void a_large_table_is_advised(void **state)
{
	unsigned char *table = mp_huge(calloc(1, LARGE), LARGE);
	FILE *f = fopen("/sys/kernel/mm/transparent_hugepage/enabled", "r");
	int advised = is_advised(table + LARGE / 2);

	(void)state;
	assert_non_null(table);
	assert_int_equal(is_advised(table), advised); /* in one piece: realloc() can move it */
	assert_int_equal(is_advised(table + LARGE - 1), advised);
	for (size_t i = 0; i < LARGE; i += 4096)
		assert_int_equal(table[i], 0);
	free(table);
	if (f == NULL || advised < 0)
		skip();
	fclose(f);
	assert_int_equal(advised, 1);
}

static void its_bytes_stay(void **state)
{
	unsigned char *table = malloc(LARGE);

	(void)state;
	assert_non_null(table);
	for (size_t i = 0; i < LARGE; i++)
		table[i] = (unsigned char)(i * 2654435761u >> 24);
	assert_ptr_equal(mp_huge(table, LARGE), table);
	for (size_t i = 0; i < LARGE; i++)
		if (table[i] != (unsigned char)(i * 2654435761u >> 24))
			fail_msg("byte %zu changed", i);
	free(table);
}

static void a_table_grows_on_huge_pages(void **state)
{
	FILE *f = fopen("/sys/kernel/mm/transparent_hugepage/enabled", "r");
	unsigned char *table = mp_huge_grow(NULL, 0, 1 << 20), *large;
	int advised;

	(void)state;
	assert_non_null(table);
	for (size_t i = 0; i < 1 << 20; i++)
		table[i] = (unsigned char)(i * 2654435761u >> 24);
	table = mp_huge_grow(table, 1 << 20, 2 << 20);
	assert_non_null(table);
	large = mp_huge_grow(table, 1 << 20, LARGE);
	assert_non_null(large);
	for (size_t i = 0; i < 1 << 20; i++)
		if (large[i] != (unsigned char)(i * 2654435761u >> 24))
			fail_msg("byte %zu changed", i);
	advised = is_advised(large + LARGE / 2);
	alloc_fail_at(1);
	assert_null(mp_huge_grow(large, LARGE, 2 * LARGE)); /* and it is there still */
	large[LARGE - 1] = large[0];
	free(large);
	if (f == NULL || advised < 0)
		skip();
	fclose(f);
	assert_int_equal(advised, 1);
}

static void a_small_table_and_none_are_left_alone(void **state)
{
	void *table = malloc(1 << 20);

	(void)state;
	assert_non_null(table);
	assert_ptr_equal(mp_huge(table, 1 << 20), table);
	assert_int_not_equal(is_advised((char *)table + (1 << 19)), 1);
	free(table);
	assert_null(mp_huge(NULL, 0));
	assert_null(mp_huge(NULL, LARGE));
}

/* As in a worker: from now on malloc() keeps what it was given. */
static void what_others_get_later_is_advised(void **state)
{
#ifdef MP_SANITIZED
	(void)state;
	skip(); /* they bring a malloc() of their own */
#else
	unsigned char *before, *after;
	FILE *f = fopen("/sys/kernel/mm/transparent_hugepage/enabled", "r");
	int was, is;

	(void)state;
	mallopt(M_MMAP_MAX, 0);
	mallopt(M_TRIM_THRESHOLD, -1);
	mp_huge_heap(SIZE_MAX / 2); /* more than there is: nothing happens */
	before = malloc(1 << 20);
	assert_non_null(before);
	was = is_advised(before + (1 << 19));
	mp_huge_heap(LARGE);
	after = malloc(1 << 20);
	assert_non_null(after);
	is = is_advised(after + (1 << 19));
	free(before);
	free(after);
	if (f == NULL || is < 0)
		skip();
	fclose(f);
	assert_int_equal(was, 0);
	assert_int_equal(is, 1);
#endif
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_large_table_is_advised),
	    cmocka_unit_test(its_bytes_stay),
	    cmocka_unit_test(a_table_grows_on_huge_pages),
	    cmocka_unit_test(a_small_table_and_none_are_left_alone),
	    cmocka_unit_test(what_others_get_later_is_advised),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
