#include "api/report_extras.h"

void api_uncertainty_add(struct api_json *j, cJSON *root, const struct mp_report *r)
{
	const struct mp_uncertainty *u = &r->uncertainty;
	cJSON *o;

	if (u->source == MP_ROUNDING_UNKNOWN) {
		api_json_null(j, root, "input_uncertainty");
		return;
	}
	o = api_json_object(j, root, "input_uncertainty");
	api_json_string(j, o, "source",
			u->source == MP_ROUNDING_FLOAT32 ? "float32" : "quantisation");
	api_json_value(j, o, "volume", u->volume_defined, u->volume);
	api_json_value(j, o, "mass", u->mass_defined, u->mass);
	api_json_value(j, o, "centroid", u->centroid_defined, u->centroid);
}
