/* Several files, one mesh: mp_analysis_next(). */
#include "core/analysis.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"
#include "tests/unit/report_of.h"

struct file {
	uint8_t *bytes;
	size_t len;
};

static const double LOW[3] = {0, 0, 0}, HIGH[3] = {1, 2, 3};

/* ${name} NULL: binary. */
static struct file file_of(const struct mesh *m, const char *name)
{
	struct file f;

	f.bytes = name != NULL ? mesh_stl_ascii(m, name, &f.len) : mesh_stl_binary(m, NULL, &f.len);
	return f;
}

/* A box of its own at ${x}. */
static struct file box_at(double x, const char *name)
{
	struct mesh m = {0};
	struct file f;

	mesh_box(&m, LOW, HIGH);
	mesh_move(&m, 0, x, 0, 0);
	f = file_of(&m, name);
	mesh_free(&m);
	return f;
}

static int push_file(struct mp_analysis *a, const struct file *f, size_t step, struct mp_error *err)
{
	for (size_t at = 0; at < f->len; at += step) {
		size_t len = f->len - at < step ? f->len - at : step;
		uint8_t *chunk = malloc(len);
		int ret;

		if (chunk == NULL)
			return mp_fail_nomem(err);
		memcpy(chunk, f->bytes + at, len);
		ret = mp_analysis_push(a, chunk, len, err);
		free(chunk);
		if (ret)
			return -1;
	}
	return 0;
}

static int look(const struct file *f, size_t count, size_t step, const struct mp_request *request,
		struct mp_report *out, struct mp_error *err)
{
	struct mp_analysis *a = mp_analysis_new(request, err);
	int ret = a != NULL ? 0 : -1;

	memset(out, 0, sizeof *out);
	for (size_t i = 0; i < count && ret == 0; i++) {
		if (i > 0)
			ret = mp_analysis_next(a, err);
		if (ret == 0)
			ret = push_file(a, &f[i], step, err);
	}
	if (ret == 0)
		ret = mp_analysis_end(a, err);
	if (ret == 0)
		ret = mp_analysis_report(a, request, out, err);
	mp_analysis_free(a);
	return ret;
}

static void report(const struct file *f, size_t count, struct mp_report *out)
{
	struct mp_request request = request_plain();
	struct mp_error err = {0};

	if (look(f, count, SIZE_MAX / 2, &request, out, &err))
		fail_msg("no report: %s", err.text);
}

static void forget(struct file *f, size_t count)
{
	for (size_t i = 0; i < count; i++)
		free(f[i].bytes);
}

static void test_files_are_one_mesh(void **state)
{
	struct file f[3] = {box_at(0, NULL), box_at(5, "second"), box_at(10, NULL)};
	struct mp_report r;

	(void)state;
	report(f, 3, &r);
	assert_int_equal(r.triangles, 36);
	assert_int_equal(r.topology.bodies, 3);
	assert_true(r.topology.watertight && r.total.volume == 18);
	assert_true(r.box.min[0] == 0 && r.box.max[0] == 11);
	assert_int_equal(r.body[1].first, 12);
	assert_int_equal(r.body[2].first, 24);
	mp_report_free(&r);
	forget(f, 3);
}

/* Half of a closed surface in each file: the edges between them are found. */
static void test_a_body_may_reach_over_files(void **state)
{
	struct mesh m = {0};
	struct file f[2];
	struct mp_report r;

	(void)state;
	mesh_torus(&m, 3, 1, 30, 20);
	m.count /= 2;
	f[0] = file_of(&m, NULL);
	memmove(m.tri, m.tri + m.count, m.count * sizeof *m.tri);
	f[1] = file_of(&m, NULL); /* binary too, so that both are rounded alike */
	report(f, 1, &r);
	assert_false(r.topology.closed);
	mp_report_free(&r);
	report(f, 2, &r);
	assert_true(r.topology.watertight);
	assert_int_equal(r.topology.bodies, 1);
	mp_report_free(&r);
	forget(f, 2);
	mesh_free(&m);
}

static void test_triangles_are_numbered_on(void **state)
{
	struct mesh m = {0};
	struct file f[2];
	struct mp_report r;
	const struct mp_defect_list *d;

	(void)state;
	f[0] = box_at(0, NULL);
	mesh_triangle(&m, LOW, LOW, HIGH);
	mesh_box(&m, LOW, HIGH);
	mesh_move(&m, 0, 0, 0, 7);
	f[1] = file_of(&m, NULL);
	report(f, 2, &r);
	d = &r.topology.defect[MP_DEFECT_DEGENERATE_TRIANGLE];
	assert_int_equal(d->count, 1);
	assert_int_equal(d->triangles[0], 12);
	mp_report_free(&r);
	forget(f, 2);
	mesh_free(&m);
}

static void test_where_a_chunk_ends_never_matters(void **state)
{
	static const size_t STEP[] = {1, 2, 49, 50, 83, 84, 85, 683, 684, 685};
	struct file f[4] = {box_at(0, NULL), box_at(1, "a b"), box_at(0.5, NULL), box_at(7, "")};
	struct mp_request request = request_plain();
	struct mp_report whole, split;
	struct mp_error err;

	(void)state;
	report(f, 4, &whole);
	for (size_t i = 0; i < sizeof STEP / sizeof *STEP; i++) {
		assert_int_equal(look(f, 4, STEP[i], &request, &split, &err), 0);
		assert_memory_equal(&split.notes, &whole.notes, sizeof whole.notes);
		assert_memory_equal(split.tri, whole.tri, whole.triangles * sizeof *whole.tri);
		assert_memory_equal(&split.total, &whole.total, sizeof whole.total);
		assert_true(split.warnings == whole.warnings);
		mp_report_free(&split);
	}
	mp_report_free(&whole);
	forget(f, 4);
}

static void test_notes_are_those_of_all_files(void **state)
{
	struct file f[3] = {box_at(0, NULL), box_at(5, NULL), box_at(10, "third")};
	struct mp_report r;

	(void)state;
	f[1].bytes = realloc(f[1].bytes, f[1].len + 3);
	memset(f[1].bytes + f[1].len, 'x', 3);
	f[1].len += 3;
	report(f, 2, &r);
	assert_int_equal(r.notes.format, MP_FORMAT_STL_BINARY);
	assert_int_equal(r.notes.bytes, 684 + 687);
	assert_int_equal(r.notes.triangles, 24);
	assert_int_equal(r.notes.trailing_bytes, 3);
	assert_true(MP_WARNED(&r, MP_WARN_TRAILING_BYTES));
	mp_report_free(&r);
	report(f, 3, &r);
	assert_int_equal(r.notes.format, MP_FORMAT_MIXED);
	assert_int_equal(r.notes.bytes, 684 + 687 + f[2].len);
	assert_int_equal(r.notes.trailing_bytes, 3);
	assert_int_equal(r.notes.parts, 1);
	assert_false(MP_WARNED(&r, MP_WARN_SEVERAL_SOLIDS)); /* each file holds one */
	mp_report_free(&r);
	forget(f, 3);
}

static void assert_name(const struct mp_body *b, const char *name)
{
	assert_int_equal(b->name_len, strlen(name));
	if (b->name_len > 0)
		assert_memory_equal(b->name, name, b->name_len);
	else
		assert_null(b->name);
}

/* A name ends with its file, also where the next one has none. */
static void test_names_stay_with_their_files(void **state)
{
	struct file f[4] = {box_at(0, "left"), box_at(5, NULL), box_at(10, "right"),
			    box_at(15, "far right")};
	struct mp_report r;

	(void)state;
	report(f, 4, &r);
	assert_int_equal(r.bodies_listed, 4);
	assert_name(&r.body[0], "left");
	assert_name(&r.body[1], "");
	assert_name(&r.body[2], "right");
	assert_name(&r.body[3], "far right");
	mp_report_free(&r);
	forget(f, 4);
}

/* Whichever of three files is bad, the error is that of the file alone. */
static void test_every_file_has_to_be_good(void **state)
{
	static char text[] = "this is no mesh\n", none[] = "solid a\nendsolid a\n";
	struct file good[3] = {box_at(0, NULL), box_at(5, "b"), box_at(10, NULL)};
	const struct file bad[4] = {{(uint8_t *)text, 0},
				    {(uint8_t *)text, sizeof text - 1},
				    {(uint8_t *)none, sizeof none - 1},
				    {good[0].bytes, 683}};
	static const enum mp_code code[4] = {MP_EMPTY, MP_TRUNCATED, MP_NO_FACES, MP_TRUNCATED};
	struct mp_request request = request_plain();
	struct mp_error alone, err;
	struct mp_report r;

	(void)state;
	for (size_t b = 0; b < 4; b++) {
		assert_int_equal(look(&bad[b], 1, 100, &request, &r, &alone), -1);
		assert_int_equal(alone.code, code[b]);
		for (size_t i = 0; i < 3; i++) {
			struct file f[3] = {good[0], good[1], good[2]};

			f[i] = bad[b];
			assert_int_equal(look(f, 3, 100, &request, &r, &err), -1);
			assert_int_equal(err.code, alone.code);
			assert_true(err.byte == alone.byte && err.line == alone.line);
			assert_string_equal(err.text, alone.text);
		}
	}
	forget(good, 3);
}

static void test_a_forced_format_is_that_of_all_files(void **state)
{
	struct file f[2] = {box_at(0, NULL), box_at(5, NULL)};
	struct mp_request request = request_plain();
	struct mp_report r;
	struct mp_error err;

	(void)state;
	request.format = MP_WISH_STL;
	memcpy(f[1].bytes, "DRACO\x02\x02\x01\x01", 9);
	assert_int_equal(look(f, 2, 100, &request, &r, &err), 0);
	assert_true(r.total.volume == 12);
	mp_report_free(&r);
	request.format = MP_WISH_AUTO;
	assert_int_equal(look(f, 2, 100, &request, &r, &err), -1);
	forget(f, 2);
}

static void test_the_limit_is_that_of_all_files(void **state)
{
	struct file f[2] = {box_at(0, NULL), box_at(5, "b")};
	struct mp_request request = request_plain();
	struct mp_report r;
	struct mp_error err;

	(void)state;
	request.limits.max_triangles = 24;
	assert_int_equal(look(f, 2, 100, &request, &r, &err), 0);
	mp_report_free(&r);
	request.limits.max_triangles = 23;
	assert_int_equal(look(f, 2, 100, &request, &r, &err), -1);
	assert_int_equal(err.code, MP_LIMIT);
	assert_int_equal(err.limit, 23);
	assert_int_equal(err.actual, 24);
	forget(f, 2);
}

static void test_every_allocation_may_fail(void **state)
{
	struct file f[3] = {box_at(0, NULL), box_at(5, "b"), box_at(10, NULL)};
	struct mp_request request = request_plain();
	struct mp_report r;
	struct mp_error err;
	long asked = 0;

	(void)state;
	for (long n = 1; asked >= n - 1; n++) {
		long before = alloc_count();
		int ret;

		alloc_fail_at(n);
		ret = look(f, 3, SIZE_MAX / 2, &request, &r, &err);
		asked = alloc_count() - before;
		alloc_fail_at(0);
		if (ret == 0)
			assert_true(r.total.volume == 18);
		else
			assert_int_equal(err.code, MP_NOMEM);
		mp_report_free(&r);
	}
	assert_true(asked > 20);
	forget(f, 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_files_are_one_mesh),
	    cmocka_unit_test(test_a_body_may_reach_over_files),
	    cmocka_unit_test(test_triangles_are_numbered_on),
	    cmocka_unit_test(test_where_a_chunk_ends_never_matters),
	    cmocka_unit_test(test_notes_are_those_of_all_files),
	    cmocka_unit_test(test_names_stay_with_their_files),
	    cmocka_unit_test(test_every_file_has_to_be_good),
	    cmocka_unit_test(test_a_forced_format_is_that_of_all_files),
	    cmocka_unit_test(test_the_limit_is_that_of_all_files),
	    cmocka_unit_test(test_every_allocation_may_fail),
	};

	return cmocka_run_group_tests_name("analysis_files", tests, NULL, NULL);
}
