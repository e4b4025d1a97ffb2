#ifndef API_REPORT_EXTRAS_H
#define API_REPORT_EXTRAS_H

#include "api/json_build.h"
#include "core/report/report.h"

/* input_uncertainty: an object, or null where it is not known how the file was rounded. */
void api_uncertainty_add(struct api_json *, cJSON *root, const struct mp_report *report);

#endif
