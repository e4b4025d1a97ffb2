#ifndef API_OPTIONS_H
#define API_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "api/problem.h"
#include "core/analysis.h"

enum api_unit { API_MM, API_UM, API_CM, API_M, API_IN, API_FT, API_UNITS };
enum api_density_unit { API_KG_M3, API_G_CM3, API_LB_IN3, API_DENSITY_FILE, API_DENSITY_UNITS };
enum api_mass_unit { API_KG, API_G, API_LB, API_MASS_UNITS };

/* What include asks for; bits. */
enum { API_INCLUDE_FACETS = 1, API_INCLUDE_DIGEST = 2, API_INCLUDE_SELF_INTERSECTIONS = 4 };

/* What came beside the options and is told in the report. */
struct api_sent {
	const char *sha256;    /* of the first file, hexadecimal; NULL: not asked for */
	const char *digests;   /* JSON array, where there were several files; else NULL */
	const char *filenames; /* JSON array, where there were several files; else NULL */
	bool attachment;       /* a form had a material or a picture, which was passed over */
};

/* What came as density[NAME]. */
struct api_name {
	char *text; /* heap, not terminated */
	size_t len;
	double density; /* in density_unit */
};

struct api_named {
	struct api_name *list;
	struct mp_named_density *request; /* of the same room: what api_options_request() made */
	uint32_t count, room;
};

/* The words of a request (query parameters, form fields, calc's flags), parsed but in user units.
 */
struct api_options {
	uint64_t given; /* bit per row of the option table: repeated ones are refused */
	enum mp_format_wish format;
	enum api_unit unit;
	bool unit_given;
	bool has_density, has_mass, has_material;
	double density, mass;
	struct api_named named;
	enum api_density_unit density_unit;
	enum api_mass_unit mass_unit;
	int material; /* row of the material table */
	bool has_transform;
	double transform[3][4];
	bool has_about, has_axis, has_axis_origin;
	double about[3], axis[3], axis_origin[3];
	bool flip, strict;
	bool orient; /* fix */
	unsigned include;
	double weld; /* in the file's unit */
	enum mp_checks_wish checks;
	enum mp_precision_wish precision;
	uint32_t bodies, defects;
	struct api_sent sent;
};

void api_options_init(struct api_options *); /* the defaults */
void api_options_free(struct api_options *); /* legal on a zeroed struct, and again */

/*
 * One option; ${name} and ${value} are decoded bytes, any content.  0, or -1 with ${p}: the fault
 * of the option, or too_expensive where memory is out.
 */
int api_options_set(struct api_options *, const char *name, size_t name_len, const char *value,
		    size_t value_len, struct api_problem *p);

/* The raw query of a URL (behind the '?', still percent-encoded; NULL or "" is none). */
int api_options_query(struct api_options *, const char *query, size_t len, struct api_problem *p);

/*
 * When all are there: exclusive combinations, a density out of range.  density_unit and mass_unit
 * are also the units of what the report says, so they are legal without a density.
 */
int api_options_check(const struct api_options *, struct api_problem *p);

/*
 * To the core's terms: density in mass unit per L^3 as density/density_divisor.  Sets everything
 * but key and limits, which are left alone.  out->named belongs to ${options} and is good until
 * they change.
 */
void api_options_request(const struct api_options *, struct mp_request *out);

/* Names of all options, for help and for the check that the docs spell them; NULL behind the last.
 */
const char *api_option_name(size_t i);

/* False for those of a later stage, which only take their default. */
bool api_option_supported(size_t i);

/*
 * The density to report, in density_unit: as given, of the material, or (weighed) mass over
 * ${volume} [L^3] > 0.
 */
double api_options_density(const struct api_options *, double volume);

/* The same where names have densities: the mean of ${mass} [mass_unit] over ${volume} > 0. */
double api_options_mean_density(const struct api_options *, double mass, double volume);

#endif
