#include "api/openapi.h"

const char api_openapi[] = {
#include "openapi_json.h"
};
const size_t api_openapi_len = sizeof api_openapi;
