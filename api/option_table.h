#ifndef API_OPTION_TABLE_H
#define API_OPTION_TABLE_H

#include "api/option_value.h"
#include "api/options.h"

/* One row for each option of the contract, in its order; rows <= 64. */
struct api_option_row {
	const char *name;
	int (*set)(struct api_options *, const struct api_value *);
	bool later; /* of a later stage: only the default is accepted */
};

extern const struct api_option_row api_option_rows[];
extern const size_t api_option_count;

/* The one row that stands for many names: density[NAME], any NAME but an empty one. */
#define API_OPTION_FAMILY "density["

#endif
