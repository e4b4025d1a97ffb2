#include "api/report_extras.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void prints(const struct mp_report *r, const char *want)
{
	struct api_json j;
	cJSON *root = api_json_begin(&j);
	size_t len;
	char *text;

	api_uncertainty_add(&j, root, r);
	text = api_json_finish(&j, &len);
	assert_non_null(text);
	assert_string_equal(text, want);
	free(text);
}

static void uncertainty_names_its_source(void **state)
{
	struct mp_report r;

	(void)state;
	memset(&r, 0, sizeof r);
	r.uncertainty = (struct mp_uncertainty){.source = MP_ROUNDING_FLOAT32,
						.volume = 0.5,
						.mass = 0.25,
						.centroid = 0.125,
						.volume_defined = true,
						.mass_defined = true,
						.centroid_defined = true};
	prints(&r, "{\"input_uncertainty\":{\"source\":\"float32\",\"volume\":0.5,\"mass\":0.25,"
		   "\"centroid\":0.125}}");
	r.uncertainty.source = MP_ROUNDING_QUANTISED;
	r.uncertainty.volume_defined = false;
	prints(&r, "{\"input_uncertainty\":{\"source\":\"quantisation\",\"volume\":null,"
		   "\"mass\":0.25,\"centroid\":0.125}}");
	r.uncertainty.mass_defined = r.uncertainty.centroid_defined = false;
	prints(&r, "{\"input_uncertainty\":{\"source\":\"quantisation\",\"volume\":null,"
		   "\"mass\":null,\"centroid\":null}}");
	r.uncertainty.source = MP_ROUNDING_UNKNOWN;
	prints(&r, "{\"input_uncertainty\":null}");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(uncertainty_names_its_source),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
