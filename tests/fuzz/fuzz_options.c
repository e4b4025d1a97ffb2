/* Any query: refused with a problem that is clean JSON, or turned into a request that is sound. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "api/json_number.h"
#include "api/options.h"
#include "api/utf8.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void must(int truth)
{
	if (!truth)
		abort();
}

static void judge_problem(const struct api_problem *p, const char *path, size_t path_len)
{
	char *instance = malloc(path_len + 1), *text;
	size_t len = 0;
	cJSON *json;

	must(instance != NULL);
	memcpy(instance, path, path_len);
	instance[path_len] = '\0';
	must(p->code > API_OK && p->code < API_CODES && api_problem_status(p->code) == 400);
	must(memchr(p->detail, '\0', sizeof p->detail) != NULL && p->detail[0] != '\0');
	must(memchr(p->option, '\0', sizeof p->option) != NULL);
	text = api_problem_json(p, instance, instance, &len);
	must(text != NULL && strlen(text) == len && api_utf8_clean(text, len));
	json = cJSON_Parse(text);
	must(json != NULL);
	cJSON_Delete(json);
	free(text);
	free(instance);
}

static void judge_number(double x)
{
	char text[API_NUMBER_SIZE];

	must(isfinite(x));
	must(api_json_number(text, x) < sizeof text && strtod(text, NULL) == x);
}

static void judge_request(const struct api_options *o)
{
	struct mp_request r;

	memset(&r, 0, sizeof r);
	api_options_request(o, &r);
	must(r.bodies <= 10000 && r.defects <= 100000);
	must(isfinite(r.density) && r.density >= 0 && r.density_divisor >= 1);
	must((r.density_kind == MP_DENSITY_NONE) == (r.density == 0));
	must(r.named_count <= MP_MOST_NAMED);
	for (uint32_t i = 0; i < r.named_count; i++) {
		must(r.named[i].len > 0 && r.named[i].len <= MP_NAME_MAX);
		must(isnormal(r.named[i].density / r.named[i].divisor));
	}
	for (int k = 0; k < 3; k++) {
		judge_number(r.about[k]);
		judge_number(r.axis_origin[k]);
		judge_number(r.axis_direction[k]);
	}
	must(r.axis_direction[0] != 0 || r.axis_direction[1] != 0 || r.axis_direction[2] != 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const char *query = (const char *)data;
	struct api_options o;
	struct api_problem p;

	api_options_init(&o);
	if (api_options_query(&o, query, size, &p) != 0 || api_options_check(&o, &p) != 0)
		judge_problem(&p, query, size);
	else
		judge_request(&o);
	api_options_free(&o);
	return 0;
}
