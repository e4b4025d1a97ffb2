#ifndef API_WARNINGS_H
#define API_WARNINGS_H

#include <stdbool.h>
#include <stddef.h>

#include "api/options.h"
#include "core/report/report.h"

/* What the report warns of: a stable code and a sentence that says what it means for the numbers.
 */
struct api_warning {
	const char *code, *message;
};

/* All there are, for the docs' check; row i < MP_WARNINGS is enum mp_warning i. */
const struct api_warning *api_warning_row(size_t i); /* NULL behind the last */

/*
 * The warnings of a report, row by row: true where row ${i} applies.  ${lists_cut}: the JSON lists
 * fewer defects than ${report} holds.
 */
bool api_warning_applies(size_t i, const struct mp_report *report,
			 const struct api_options *options, bool lists_cut);

#endif
