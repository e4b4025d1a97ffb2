#ifndef API_REPORT_WORDS_H
#define API_REPORT_WORDS_H

#include "core/report/report.h"

const char *api_format_word(enum mp_format);           /* "stl-binary", ..., "unknown" */
const char *api_orientation_word(enum mp_orientation); /* "outward", ... */
const char *api_symmetry_word(enum mp_symmetry);       /* "none", "axial", "spherical" */
const char *api_precision_word(enum mp_precision);     /* "certified", "exact" */

#endif
