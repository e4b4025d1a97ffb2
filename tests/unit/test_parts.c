#include "core/bodies/parts.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"

static void add(struct mp_parts *p, uint64_t first, const char *name)
{
	struct mp_error err;

	assert_int_equal(mp_parts_add(p, first, name, strlen(name), &err), 0);
}

static void assert_name(const struct mp_parts *p, uint64_t first, uint64_t last, const char *want)
{
	uint32_t tri[100] = {0};
	size_t len, count = 0;
	const char *name;

	for (uint64_t i = first; i <= last; i++)
		tri[count++] = (uint32_t)i;
	name = mp_parts_name(p, tri, count, &len);
	if (first == 0)
		assert_ptr_equal(mp_parts_name(p, NULL, count, &len), name);
	if (want == NULL) {
		assert_null(name);
		assert_int_equal(len, 0);
		return;
	}
	assert_non_null(name);
	assert_int_equal(len, strlen(want));
	assert_memory_equal(name, want, len);
}

static void test_ranges_have_names(void **state)
{
	struct mp_parts p = {0};

	(void)state;
	assert_name(&p, 0, 0, NULL);
	add(&p, 2, "a");
	add(&p, 5, "");
	add(&p, 8, "long name");
	assert_name(&p, 0, 1, NULL);
	assert_name(&p, 1, 3, NULL);
	assert_name(&p, 2, 4, "a");
	assert_name(&p, 4, 5, NULL);
	assert_name(&p, 5, 7, NULL);
	assert_name(&p, 8, 8, "long name");
	assert_name(&p, UINT32_MAX - 1, UINT32_MAX, "long name");
	mp_parts_free(&p);
	mp_parts_free(&p);
}

static void test_same_first_replaces(void **state)
{
	struct mp_parts p = {0};

	(void)state;
	add(&p, 0, "first");
	add(&p, 0, "second, longer");
	add(&p, 0, "3");
	add(&p, 4, "x");
	assert_int_equal(p.count, 2);
	assert_int_equal(p.used, 2);
	assert_name(&p, 0, 3, "3");
	assert_name(&p, 4, 4, "x");
	mp_parts_free(&p);
}

static void test_many_parts(void **state)
{
	struct mp_parts p = {0};
	char name[32];

	(void)state;
	for (uint64_t i = 0; i < 5000; i++) {
		(void)snprintf(name, sizeof name, "part %d", (int)i);
		add(&p, 3 * i, name);
	}
	for (uint64_t i = 0; i < 5000; i++) {
		(void)snprintf(name, sizeof name, "part %d", (int)i);
		assert_name(&p, 3 * i, 3 * i + 2, name);
		assert_name(&p, 3 * i, 3 * i + 3, i < 4999 ? NULL : name);
	}
	mp_parts_free(&p);
}

static void test_the_same_name_goes_on(void **state)
{
	struct mp_parts p = {0};

	(void)state;
	add(&p, 0, "a");
	add(&p, 4, "a");
	add(&p, 8, "");
	add(&p, 9, "");
	add(&p, 12, "aa");
	assert_int_equal(p.count, 3);
	assert_name(&p, 0, 7, "a");
	assert_name(&p, 0, 8, NULL);
	assert_name(&p, 12, 100, "aa");
	mp_parts_free(&p);
}

static void test_a_name_of_several_parts(void **state)
{
	static const uint32_t TRI[] = {0, 1, 6, 7};
	struct mp_parts p = {0};
	size_t len;

	(void)state;
	add(&p, 0, "a");
	add(&p, 2, "b");
	add(&p, 6, "a");
	assert_memory_equal(mp_parts_name(&p, TRI, 4, &len), "a", 1);
	assert_int_equal(len, 1);
	assert_name(&p, 1, 6, NULL);
	mp_parts_free(&p);
}

/* ${name} NULL: in no part; "": in a part without a name. */
static void assert_at(const struct mp_parts *p, uint64_t t, const char *name, uint64_t want_end)
{
	uint64_t end;
	const struct mp_part *part = mp_parts_at(p, t, &end);

	assert_true(end == want_end);
	assert_int_equal(part == NULL, name == NULL);
	if (part == NULL || name == NULL)
		return;
	assert_int_equal(part->len, strlen(name));
	assert_memory_equal(p->pool + part->name, name, part->len);
}

static void test_a_gap_is_no_part(void **state)
{
	struct mp_parts p = {0};
	struct mp_error err;

	(void)state;
	assert_int_equal(mp_parts_end(&p, 3, &err), 0); /* nothing ends */
	assert_int_equal(p.count, 0);
	assert_at(&p, 5, NULL, UINT64_MAX);
	add(&p, 5, "");
	add(&p, 7, "x");
	assert_int_equal(mp_parts_end(&p, 9, &err), 0);
	assert_int_equal(mp_parts_end(&p, 10, &err), 0); /* it goes on */
	assert_at(&p, 4, NULL, 5);
	assert_at(&p, 5, "", 7);
	assert_at(&p, 8, "x", 9);
	assert_at(&p, 9, NULL, UINT64_MAX);
	assert_name(&p, 9, 9, NULL);
	add(&p, 12, "");
	add(&p, 15, "y");
	assert_int_equal(mp_parts_end(&p, 15, &err), 0); /* y had no triangles */
	add(&p, 16, "z");
	assert_at(&p, 9, NULL, 12);
	assert_at(&p, 13, "", 15);
	assert_at(&p, 15, NULL, 16);
	assert_at(&p, 16, "z", UINT64_MAX);
	mp_parts_free(&p);
}

static void test_out_of_memory_keeps_what_was_there(void **state)
{
	struct mp_parts p = {0};
	struct mp_error err = {0};

	(void)state;
	for (uint64_t i = 0; i < 16; i++)
		add(&p, i, i % 2 == 0 ? "name 0" : "name 1");
	for (long n = 1; n < 3; n++) {
		alloc_fail_at(n);
		assert_int_equal(
		    mp_parts_add(&p, 16, "a name that needs more room, by far", 35, &err), -1);
		alloc_fail_at(0);
		assert_int_equal(err.code, MP_NOMEM);
		assert_int_equal(p.count, 16);
		assert_name(&p, 15, 15, "name 1");
		p.pool_room = p.used; /* so that the second round asks for both again */
	}
	add(&p, 16, "a name that needs more room, by far");
	assert_name(&p, 16, 16, "a name that needs more room, by far");
	mp_parts_free(&p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_ranges_have_names),
	    cmocka_unit_test(test_same_first_replaces),
	    cmocka_unit_test(test_many_parts),
	    cmocka_unit_test(test_the_same_name_goes_on),
	    cmocka_unit_test(test_a_name_of_several_parts),
	    cmocka_unit_test(test_a_gap_is_no_part),
	    cmocka_unit_test(test_out_of_memory_keeps_what_was_there),
	};

	return cmocka_run_group_tests_name("parts", tests, NULL, NULL);
}
