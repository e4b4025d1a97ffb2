#ifndef API_OPENAPI_H
#define API_OPENAPI_H

#include <stddef.h>

/* The contract as served at /openapi.json: the bytes of api/openapi.json, not terminated. */
extern const char api_openapi[];
extern const size_t api_openapi_len;

#endif
