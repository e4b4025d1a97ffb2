#ifndef API_OPTION_VALUE_H
#define API_OPTION_VALUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "api/problem.h"

/*
 * The value of one option and where to complain.  All readers return 0, or -1 with a bad_option
 * that names the option and says what it takes.
 */
struct api_value {
	const char *name; /* of the option, for problems */
	size_t name_len;
	const char *text;
	size_t len;
	struct api_problem *problem;
};

int api_value_bad(const struct api_value *, const char *what); /* "must be ${what}"; always -1 */

bool api_value_is(const struct api_value *, const char *word);

/* One of ${count} words; ${*which} is its place. */
int api_value_choice(const struct api_value *, const char *const *words, size_t count,
		     unsigned *which);
int api_value_bool(const struct api_value *, bool *);

/* Digits only, at most ${most}. */
int api_value_count(const struct api_value *, uint32_t most, uint32_t *);

/* Finite decimal numbers; ${count} of them, comma-separated. */
int api_value_numbers(const struct api_value *, double *, size_t count);
int api_value_positive(const struct api_value *, double *);

#endif
