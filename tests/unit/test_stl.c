#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "alloc_fail.h"
#include "core/stl/stl_kernel.h"
#include "core/stl/stl_private.h"
#include "mesh_random.h"
#include "stl_binary_file.h"

/* Binary STL.  Telling it from text: test_stl_sniff.c; text: test_stl_ascii.c. */

static void reads_what_was_written(void **state)
{
	static const double want[9] = {-1.5, 0, 2.125, 3.25, 0, 2.125, 0.1f, 2, 2.125};

	(void)state;
	check_accepted(make(3, "a box"), 3);
	assert_memory_equal(whole.tri[2], want, sizeof want);
	assert_int_equal(whole.notes.parts, 1);
	assert_int_equal(whole.notes.normals_disagreeing, 0);
	assert_int_equal(whole.notes.trailing_bytes, 0);
	assert_string_equal(whole.parts, "");
}

static void floats_are_little_endian_and_exact(void **state)
{
	static const uint8_t bits[9][4] = {
	    {0, 0, 0x80, 0x3f},       {0, 0, 0, 0x80},          {1, 0, 0, 0},
	    {0xff, 0xff, 0x7f, 0x7f}, {0xff, 0xff, 0x7f, 0xff}, {0xcd, 0xcc, 0xcc, 0x3d},
	    {0, 0, 0x80, 0},          {0xff, 0xff, 0x7f, 0x80}, {0x78, 0x56, 0x34, 0x12}};
	static const double want[9] = {
	    1.0,           -0.0,     0x1p-149,         0x1.fffffep127, -0x1.fffffep127,
	    0x1.99999ap-4, 0x1p-126, -0x1.fffffcp-127, 0x1.68acfp-91};
	size_t len = make(1, "");

	(void)state;
	for (size_t i = 0; i < 9; i++)
		memcpy(file + 84 + 12 + 4 * i, bits[i], 4);
	check_accepted(len, 1);
	assert_memory_equal(whole.tri[0], want, sizeof want);
}

static void blocks_are_full_but_for_the_last(void **state)
{
	static const size_t counts[] = {1, 255, 256, 257, 512, 700};

	(void)state;
	for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
		check_accepted(make(counts[i], "h"), counts[i]); /* seen_block() looks */
}

static void where_a_chunk_ends_never_matters(void **state)
{
	size_t len = make(100, "solid with a facet in its header"); /* longer than the window */

	(void)state;
	decode(len);
	assert_int_equal(whole.count, 100);
	for (size_t at = 0; at <= len; at++) {
		seen_decode(&other, file, len, at, all, roomy);
		assert_true(seen_same(&whole, &other));
	}
	len = make(600, "h");
	decode(len);
	for (size_t step = 1; step < 200; step++) {
		seen_decode(&other, file, len, step, step, roomy);
		assert_true(seen_same(&whole, &other));
	}
}

static void every_proper_prefix_is_refused_with_its_offset(void **state)
{
	static const char *const headers[] = {
	    "",
	    "solid",
	    "solid facet normal endsolid",
	    "an ASCII header without NULs up to the count ...........................",
	    "solid a\nfacet",
	    "\xff\xfe non-UTF-8 \x80"};

	(void)state;
	for (size_t h = 0; h < sizeof headers / sizeof headers[0]; h++) {
		size_t len = make(90, headers[h]);

		if (h == 5)
			file[0] = 'x'; /* FF FE alone would say UTF-16 */
		for (size_t n = 1; n < len; n += h == 0 || n < 200 ? 1 : 37) {
			decode(n);
			if (whole.ret != -1 || whole.err.code != MP_TRUNCATED ||
			    whole.err.byte != n)
				fail_msg("header %zu, %zu bytes: code %d: %s", h, n, whole.err.code,
					 whole.err.text);
		}
		decode(0);
		assert_int_equal(whole.err.code, MP_EMPTY);
		assert_int_equal(whole.err.byte, MP_NO_BYTE);
	}
}

static void a_count_that_the_bytes_do_not_bear_out_is_truncation(void **state)
{
	static const uint32_t counts[] = {5,          0x7fffffff, 0x80000000,
					  0xffffffff, 85899346,   0x20202020};

	(void)state;
	for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
		size_t len = make(4, "xxxxxxxxxx");

		put32(file + 80,
		      counts[i]); /* 85899346 * 50 + 84 wraps to 284 - 200 + 4 in 32 bits */
		check_refused(len, MP_TRUNCATED, len, "missing");
		check_refused(84, MP_TRUNCATED, 84, "missing");
	}
	make(4, "");
	put32(file + 80, 6);
	check_refused(84 + 225, MP_TRUNCATED, 84 + 225, "6 facets: 4 are there, 2 are missing");
}

static void bytes_behind_the_facets_are_passed_over(void **state)
{
	(void)state;
	make(3, "h");
	for (size_t extra = 1; extra < 300; extra += 7) {
		check_accepted(84 + 150 + extra, 3);
		assert_int_equal(whole.notes.trailing_bytes, extra);
	}
	make(100, "h");
	check_accepted(5084 + 3000, 100);
	assert_int_equal(whole.notes.trailing_bytes, 3000);
}

static void count_zero_is_never_guessed_at(void **state)
{
	(void)state;
	make(0, "empty");
	check_refused(84, MP_NO_FACES, 80, "0 facets");
	make(0, "solid a\nfacet"); /* 84 bytes: not the beginning of a text */
	check_refused(84, MP_NO_FACES, 80, "0 facets");
	make(3, "facets behind a count of 0");
	put32(file + 80, 0);
	check_refused(84 + 150, MP_SYNTAX, 80, "count was not written");
	check_refused(85, MP_SYNTAX, 80, "count was not written");
	check_refused(9000, MP_SYNTAX, 80, "count was not written");
}

static void the_limit_judges_what_has_come(void **state)
{
	size_t len = make(300, "h");

	(void)state;
	seen_decode(&whole, file, len, all, all, 300);
	assert_int_equal(whole.ret, 0);
	for (uint64_t most = 0; most < 300; most += most < 250 ? 50 : 7) {
		seen_decode(&whole, file, len, all, all, most);
		assert_int_equal(whole.ret, -1);
		assert_int_equal(whole.err.code, MP_LIMIT);
		assert_int_equal(whole.err.limit, most);
		assert_int_equal(whole.err.actual, most + 1);
		assert_int_equal(whole.err.byte, 84 + 50 * most);
		seen_decode(&other, file, len, 11, 17, most);
		assert_true(seen_same(&whole, &other));
	}
	put32(file + 80, 0xffffffff); /* what it claims is no matter */
	seen_decode(&whole, file, len, all, all, 300);
	assert_int_equal(whole.err.code, MP_TRUNCATED);
}

static void coordinates_that_are_not_finite_are_refused_with_their_place(void **state)
{
	(void)state;
	for (size_t number = 3; number < 12; number++) {
		size_t len = make(270, "h");

		put_float(260, number, number % 2 ? NAN : -INFINITY);
		put_float(261, 3, NAN);
		check_refused(len, MP_NON_FINITE, 84 + 50 * 260 + 4 * number,
			      "facet 260 (from 0): ");
		assert_int_equal(whole.count, 256); /* the full block before it had gone out */
	}
	make(270, "h");
	put_float(1, 10, NAN);
	check_refused(84 + 50 * 2, MP_NON_FINITE, 84 + 50 + 40, "y of vertex 3 ");
}

static void stored_normals_are_only_counted(void **state)
{
	size_t len = make(10, "h");

	(void)state;
	put_float(1, 2, -1.0f);   /* against the winding */
	put_float(2, 2, -1e-30f); /* too, however short */
	put_float(3, 2, 0.0f);    /* none given */
	put_float(4, 2, NAN);
	put_float(5, 0, INFINITY);
	put_float(6, 2, -INFINITY);
	put_float(7, 0, 5.0f); /* tilted, but up */
	check_accepted(len, 10);
	assert_int_equal(whole.notes.normals_disagreeing, 2);
	assert_int_equal(whole.notes.normals_not_finite, 3);
	assert_true(whole.tri[1][0] == -1.5);
}

static void attribute_bytes_are_ignored(void **state)
{
	uint64_t hash;
	size_t len = make(5, "COLOR=abcd");

	(void)state;
	check_accepted(len, 5);
	hash = whole.hash;
	for (size_t i = 0; i < 5; i++)
		put32(file + 84 + 50 * i + 46,
		      0xffff0000 | file[84 + 50 * i + 46] | (uint32_t)file[84 + 50 * i + 47] << 8);
	for (size_t i = 0; i < 5; i++) { /* restore the two bytes of the float */
		float z = (float)i + 0.125f;

		put_float(i, 11, z);
	}
	check_accepted(len, 5);
	assert_true(whole.hash == hash);
}

static void a_sink_that_fails_stops_the_decoder(void **state)
{
	size_t len = make(700, "h");

	(void)state;
	for (uint64_t at = 1; at <= 700; at += 233) {
		whole.fail_at = at;
		decode(len);
		assert_int_equal(whole.ret, -1);
		assert_int_equal(whole.err.code, MP_BUG);
		assert_int_equal(whole.err.byte, 7);
	}
	whole.fail_at = 0;
}

static void a_failed_allocation_is_an_error(void **state)
{
	size_t len = make(20, "h");
	long before = alloc_count();
	const struct mp_limits limits = {1};
	const struct mp_sink sink = {.block = seen_block, .part = seen_part, .self = &whole};
	struct mp_error err = {0};
	void *st;

	(void)state;
	memset(&whole, 0, sizeof whole);
	alloc_fail_at(1);
	assert_int_equal(mp_stl_decoder.begin(&st, &sink, &limits, &whole.notes, &err), -1);
	assert_int_equal(err.code, MP_NOMEM);
	mp_stl_decoder.end(st);
	mp_stl_decoder.end(NULL);
	before = alloc_count();
	decode(len);
	assert_int_equal(alloc_count() - before, 2); /* the state, and the test's own copy */
	assert_int_equal(whole.ret, 0);
}

/* Facets of random bits, in every number and from every column on: no byte more is read. */
static void all_kernels_read_the_same_columns(void **unused)
{
	uint64_t state = 8;

	(void)unused;
	for (size_t i = 0; i < 2000; i++) {
		size_t at = random_bits(&state) % MP_BLOCK;
		size_t count = 1 + random_bits(&state) % (MP_BLOCK - at);
		uint8_t *p = malloc(count * STL_FACET);
		struct stl_columns want = {{{0}}};
		struct stl_columns_seen seen;

		assert_non_null(p);
		for (size_t k = 0; k < count * STL_FACET; k++)
			p[k] = (uint8_t)random_bits(&state);
		for (size_t k = 0; i % 4 != 0 && k < count * 12; k++) /* 0x40: a small number */
			p[k / 12 * STL_FACET + 4 * (k % 12) + 3] =
			    random_bits(&state) % 2 ? 0x40 : 0xc0;
		stl_columns_read(0, &want, at, p, count, &seen);
		for (size_t k = 1; k < stl_columns_kernels(); k++) {
			struct stl_columns got = {{{0}}};
			struct stl_columns_seen other_seen;

			stl_columns_read(k, &got, at, p, count, &other_seen);
			assert_memory_equal(&got, &want, sizeof want);
			assert_int_equal(other_seen.not_finite, seen.not_finite);
			assert_int_equal(other_seen.normals_disagreeing, seen.normals_disagreeing);
			assert_int_equal(other_seen.normals_not_finite, seen.normals_not_finite);
		}
		free(p);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(all_kernels_read_the_same_columns),
	    cmocka_unit_test(reads_what_was_written),
	    cmocka_unit_test(floats_are_little_endian_and_exact),
	    cmocka_unit_test(blocks_are_full_but_for_the_last),
	    cmocka_unit_test(where_a_chunk_ends_never_matters),
	    cmocka_unit_test(every_proper_prefix_is_refused_with_its_offset),
	    cmocka_unit_test(a_count_that_the_bytes_do_not_bear_out_is_truncation),
	    cmocka_unit_test(bytes_behind_the_facets_are_passed_over),
	    cmocka_unit_test(count_zero_is_never_guessed_at),
	    cmocka_unit_test(the_limit_judges_what_has_come),
	    cmocka_unit_test(coordinates_that_are_not_finite_are_refused_with_their_place),
	    cmocka_unit_test(stored_normals_are_only_counted),
	    cmocka_unit_test(attribute_bytes_are_ignored),
	    cmocka_unit_test(a_sink_that_fails_stops_the_decoder),
	    cmocka_unit_test(a_failed_allocation_is_an_error),
	};

	return cmocka_run_group_tests_name("stl", tests, NULL, NULL);
}
