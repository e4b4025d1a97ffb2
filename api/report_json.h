#ifndef API_REPORT_JSON_H
#define API_REPORT_JSON_H

#include <stddef.h>

#include "api/job.h"
#include "api/options.h"
#include "core/report/report.h"

/*
 * The report of the contract as JSON text.  Units: lengths in the file's unit; mass in kg (or
 * mass_unit), density as asked, inertia in mass unit times length unit squared.
 * Heap string of ${*len} bytes, NULL when memory is out.
 */
char *api_report_json(const struct mp_report *report, const struct api_options *options,
		      const char *filename, const struct api_timing *timing, size_t *len);

#endif
