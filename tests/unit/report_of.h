#ifndef REPORT_OF_H
#define REPORT_OF_H

#include "core/analysis.h"
#include "tests/unit/mesh_make.h"

/* From a mesh or a file to its report, for tests of the whole of core. */

struct mp_request request_plain(void); /* auto format, no density, lists of 100 */

/* Pushes ${step} bytes at a time (0: all at once), each from a heap copy of exactly that size. */
int report_of_file(const uint8_t *file, size_t size, size_t step, const struct mp_request *request,
		   struct mp_report *out, struct mp_error *err);

/* These fail the test where there is no report; ${request} NULL: plain. */
void report_of_binary(const struct mesh *, const struct mp_request *request, struct mp_report *out);
void report_of_ascii(const struct mesh *, const struct mp_request *request, struct mp_report *out);

/*
 * The n-th allocation from decoding to report fails, for every n until none is left, which has to
 * be below ${most}: each time the error is MP_NOMEM, and nothing leaks (with the sanitizer).
 */
void report_without_memory(const struct mesh *, const struct mp_request *request, long most);

/* |value - want| <= tolerance, also for NaN; and relative to |want|. */
void assert_near(double value, double want, double tolerance);
void assert_relative(double value, double want, double tolerance);

#endif
