#include "api/capabilities.h"

#include <string.h>

#include "api/json_build.h"
#include "api/media.h"
#include "api/options.h"
#include "api/report_words.h"
#include "api/units.h"

const char api_version[] = "0.1.0";

static void add_words(struct api_json *j, const char *name, const char *const *words, size_t count)
{
	struct api_text t = {0};

	api_text_say(&t, "[");
	for (size_t i = 0; i < count; i++) {
		if (i > 0)
			api_text_say(&t, ",");
		api_text_string(&t, words[i], strlen(words[i]));
	}
	api_text_say(&t, "]");
	api_json_text(j, j->root, name, &t);
}

static void add_media_types(struct api_json *j)
{
	size_t count = 0;

	while (api_media_types[count] != NULL)
		count++;
	add_words(j, "media_types", api_media_types, count);
}

static void add_materials(struct api_json *j)
{
	struct api_text t = {0};

	api_text_say(&t, "[");
	for (size_t i = 0; i < api_material_count; i++) {
		api_text_say(&t, i > 0 ? ",{\"name\":" : "{\"name\":");
		api_text_string(&t, api_materials[i].name, strlen(api_materials[i].name));
		api_text_say(&t, ",\"density\":");
		api_text_number(&t, api_materials[i].kg_m3);
		api_text_say(&t, ",\"density_unit\":\"kg/m3\"}");
	}
	api_text_say(&t, "]");
	api_json_text(j, j->root, "materials", &t);
}

static void add_options(struct api_json *j)
{
	const char *names[64]; /* as many as api_options.given has bits */
	size_t count = 0;

	for (size_t i = 0; api_option_name(i) != NULL && count < 64; i++)
		if (api_option_supported(i))
			names[count++] = api_option_name(i);
	add_words(j, "options", names, count);
}

static void add_limits(struct api_json *j, const struct api_limits_in_force *limits)
{
	cJSON *o = api_json_object(j, j->root, "limits");

	api_json_count(j, o, "max_body", limits->max_body);
	api_json_count(j, o, "max_decoded", limits->max_decoded);
	api_json_count(j, o, "max_triangles", limits->max_triangles);
	api_json_value(j, o, "deadline_s", true, limits->deadline_s);
	api_json_count(j, o, "workers", limits->workers);
}

char *api_capabilities_json(const struct api_limits_in_force *limits, size_t *len)
{
	const char *const formats[] = {
	    api_format_word(MP_FORMAT_STL_BINARY), api_format_word(MP_FORMAT_STL_ASCII),
	    api_format_word(MP_FORMAT_OBJ), api_format_word(MP_FORMAT_DRACO)};
	struct api_json j;
	cJSON *root = api_json_begin(&j);

	api_json_string(&j, root, "schema", "masspropd/1");
	api_json_string(&j, root, "service", "masspropd");
	api_json_string(&j, root, "version", api_version);
	add_words(&j, "formats", formats, sizeof formats / sizeof formats[0]);
	add_media_types(&j);
	add_words(&j, "content_codings", api_coding_names, API_CODINGS);
	add_words(&j, "units", api_unit_names, API_UNITS);
	add_words(&j, "density_units", api_density_unit_names, API_DENSITY_UNITS);
	add_words(&j, "mass_units", api_mass_unit_names, API_MASS_UNITS);
	add_materials(&j);
	add_options(&j);
	add_limits(&j, limits);
	return api_json_finish(&j, len);
}
