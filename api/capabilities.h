#ifndef API_CAPABILITIES_H
#define API_CAPABILITIES_H

#include <stddef.h>
#include <stdint.h>

#include "api/job.h"

struct api_limits_in_force { /* shown to clients */
	uint64_t max_body, max_decoded, max_triangles;
	double deadline_s;
	unsigned workers;
};

/* The JSON of GET /v1/capabilities; heap string of ${*len} bytes, NULL when memory is out. */
char *api_capabilities_json(const struct api_limits_in_force *limits, size_t *len);

/* Version of the program, "0.1.0". */
extern const char api_version[];

#endif
