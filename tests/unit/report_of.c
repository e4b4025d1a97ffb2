#include "tests/unit/report_of.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"

struct mp_request request_plain(void)
{
	return (struct mp_request){
	    .format = MP_WISH_AUTO,
	    .key = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3},
	    .limits = {.max_triangles = 20000000},
	    .bodies = 100,
	    .defects = 100,
	};
}

static int push_all(struct mp_analysis *a, const uint8_t *file, size_t size, size_t step,
		    struct mp_error *err)
{
	for (size_t at = 0; at < size; at += step) {
		size_t len = size - at < step ? size - at : step;
		uint8_t *chunk = malloc(len);
		int ret;

		if (chunk == NULL)
			return mp_fail_nomem(err);
		memcpy(chunk, file + at, len);
		ret = mp_analysis_push(a, chunk, len, err);
		free(chunk);
		if (ret)
			return -1;
	}
	return 0;
}

int report_of_file(const uint8_t *file, size_t size, size_t step, const struct mp_request *request,
		   struct mp_report *out, struct mp_error *err)
{
	struct mp_analysis *a = mp_analysis_new(request, err);
	int ret;

	memset(out, 0, sizeof *out);
	if (a == NULL)
		return -1;
	ret = push_all(a, file, size, step == 0 ? size : step, err);
	if (ret == 0)
		ret = mp_analysis_end(a, err);
	if (ret == 0)
		ret = mp_analysis_report(a, request, out, err);
	mp_analysis_free(a);
	return ret;
}

static void report_of_made(uint8_t *file, size_t size, const struct mp_request *request,
			   struct mp_report *out)
{
	const struct mp_request plain = request_plain();
	struct mp_error err = {0};
	int ret = report_of_file(file, size, 0, request != NULL ? request : &plain, out, &err);

	free(file);
	if (ret)
		fail_msg("no report: %s", err.text);
}

void report_of_binary(const struct mesh *m, const struct mp_request *request, struct mp_report *out)
{
	size_t size;
	uint8_t *file = mesh_stl_binary(m, NULL, &size);

	report_of_made(file, size, request, out);
}

void report_of_ascii(const struct mesh *m, const struct mp_request *request, struct mp_report *out)
{
	size_t size;
	uint8_t *file = mesh_stl_ascii(m, "made", &size);

	report_of_made(file, size, request, out);
}

void report_without_memory(const struct mesh *m, const struct mp_request *request, long most)
{
	size_t size;
	uint8_t *file = mesh_stl_binary(m, NULL, &size);
	bool done = false;
	long n;

	for (n = 1; !done; n++) {
		struct mp_error err = {0};
		struct mp_report r;

		assert_true(n < most);
		alloc_fail_at(n);
		done = report_of_file(file, size, 0, request, &r, &err) == 0;
		alloc_fail_at(0);
		if (done)
			mp_report_free(&r);
		else
			assert_int_equal(err.code, MP_NOMEM);
	}
	assert_true(n > 2); /* some allocation did fail */
	free(file);
}

void assert_near(double value, double want, double tolerance)
{
	if (!(fabs(value - want) <= tolerance))
		fail_msg("%.17g is not within %g of %.17g", value, tolerance, want);
}

void assert_relative(double value, double want, double tolerance)
{
	if (!(fabs(value - want) <= tolerance * fabs(want)))
		fail_msg("%.17g is not within a part of %g of %.17g (off by %g)", value, tolerance,
			 want, value / want - 1);
}
