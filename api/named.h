#ifndef API_NAMED_H
#define API_NAMED_H

#include "api/option_value.h"
#include "api/options.h"

/* density[NAME]=number: densities of the faces under a name. */

enum { API_MOST_NAMED = MP_MOST_NAMED };

/* Is the name of the option, which is density[NAME], there already?  Not quick, but short. */
bool api_named_has(const struct api_named *, const struct api_value *v);

/* -1 with the problem: NAME is too long, there are too many, or memory is out. */
int api_named_add(struct api_named *, const struct api_value *v, double density);

/* When all options are there: exclusive ones, densities out of range. */
int api_named_check(const struct api_options *, struct api_problem *p);

/* named and named_count of ${out}. */
void api_named_request(const struct api_options *, struct mp_request *out);

/*
 * ${err} is an MP_BAD_NAME of the report of ${analysis}: as a bad_option, with the names there are.
 * Always -1.
 */
int api_named_refuse(const struct api_named *, const struct mp_analysis *analysis,
		     const struct mp_error *err, struct api_problem *p);

void api_named_free(struct api_named *);

#endif
