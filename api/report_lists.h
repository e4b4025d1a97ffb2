#ifndef API_REPORT_LISTS_H
#define API_REPORT_LISTS_H

#include "api/json_build.h"
#include "api/options.h"
#include "core/report/report.h"

/* The long lists of a report as JSON text, appended to ${out}. */

void api_bodies_text(const struct mp_report *, struct api_text *out);

/*
 * One kind of defects, listed while the list is shorter than ${most} bytes: a mesh of many long
 * boundary loops could make gigabytes of them.  Returns whether all were listed.
 */
bool api_defects_text(const struct mp_report *, enum mp_defect_kind kind, size_t most,
		      struct api_text *out);

/* Returns how many were listed. */
size_t api_warnings_text(const struct mp_report *, const struct api_options *, bool lists_cut,
			 struct api_text *out);

#endif
