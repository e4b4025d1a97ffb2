#ifndef API_JSON_NUMBER_H
#define API_JSON_NUMBER_H

#include <stddef.h>

enum { API_NUMBER_SIZE = 32 };

/*
 * api_json_number(out, x):
 * Print ${x} as a JSON number of at most 17 significant digits, the fewest that read back to the
 * same double, laid out as ECMAScript does (24000, 0.0648, 1e-12), but with an exponent from 10^16
 * on: a number printed without point and exponent is that integer exactly.  -0 prints as 0; NaN
 * and the infinities, which JSON cannot say, print as null.  Returns the length; a NUL stands
 * behind it.
 * Locale-free, allocates nothing, cannot fail.
 */
size_t api_json_number(char out[API_NUMBER_SIZE], double x);

/* The same, rounded to ${digits} (1 to 17) significant digits: for people. */
size_t api_json_number_rounded(char out[API_NUMBER_SIZE], double x, int digits);

#endif
