#ifndef API_REPORT_EXTRAS_H
#define API_REPORT_EXTRAS_H

#include "api/json_build.h"
#include "core/report/report.h"

/* What stands beside the results. */

/* input_uncertainty: an object, or null where it is not known how the file was rounded. */
void api_uncertainty_add(struct api_json *, cJSON *root, const struct mp_report *report);

/*
 * facets: an object of columns, whose i-th elements are of the i-th triangle; five arrays are a
 * third shorter than an array of objects and much faster to take apart.  ${asked} false: null.
 */
void api_facets_add(struct api_json *, cJSON *root, const struct mp_report *report, bool asked);

enum { API_MOST_FACETS = 500000 }; /* in one document: at most 120 MB */

/* overlapping_bodies and self_intersections: how many, under checks; and where, under defects. */
void api_crossings_count(struct api_json *, cJSON *checks, const struct mp_report *report);
void api_crossings_list(struct api_json *, cJSON *defects, const struct mp_report *report);

#endif
