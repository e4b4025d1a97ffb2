#include "api/options.h"

#include <math.h>
#include <string.h>

#include "api/named.h"
#include "api/option_table.h"
#include "api/units.h"
#include "api/utf8.h"

enum { DEFAULT_LISTED = 100 };

static bool is_family(const char *name, size_t len)
{
	const size_t head = sizeof API_OPTION_FAMILY - 1;

	return len > head && memcmp(name, API_OPTION_FAMILY, head) == 0;
}

static bool row_fits(const struct api_option_row *row, const char *name, size_t len)
{
	if (is_family(row->name, strlen(row->name)))
		return is_family(name, len) && len > sizeof API_OPTION_FAMILY &&
		       name[len - 1] == ']';
	return strlen(row->name) == len && memcmp(row->name, name, len) == 0;
}

static int set_row(struct api_options *o, size_t i, const struct api_value *v)
{
	const uint64_t bit = UINT64_C(1) << i;

	if (is_family(v->name, v->name_len) ? api_named_has(&o->named, v) : (o->given & bit) != 0)
		return api_problem_option(v->problem, API_BAD_OPTION, v->name, v->name_len,
					  "The option is given more than once.");
	o->given |= bit;
	if (!api_utf8_clean(v->text, v->len))
		return api_problem_option(
		    v->problem, API_BAD_OPTION, v->name, v->name_len,
		    "The option's value holds control characters or is not UTF-8.");
	return api_option_rows[i].set(o, v);
}

int api_options_set(struct api_options *o, const char *name, size_t name_len, const char *value,
		    size_t value_len, struct api_problem *p)
{
	const struct api_value v = {name, name_len, value, value_len, p};

	if (name_len == 0)
		return api_problem_set(p, API_BAD_REQUEST, "There is an option without a name.");
	if (!api_utf8_clean(name, name_len))
		return api_problem_option(
		    p, API_BAD_REQUEST, name, name_len,
		    "An option's name holds control characters or is not UTF-8.");
	for (size_t i = 0; i < api_option_count; i++)
		if (row_fits(&api_option_rows[i], name, name_len))
			return set_row(o, i, &v);
	return api_problem_option(p, API_UNKNOWN_OPTION, name, name_len,
				  "There is no such option; names are case-sensitive.");
}

void api_options_init(struct api_options *o)
{
	memset(o, 0, sizeof *o);
	o->axis[2] = 1;
	o->bodies = o->defects = DEFAULT_LISTED;
}

void api_options_free(struct api_options *o)
{
	api_named_free(&o->named);
}

/* What was given, a density or a material, in ${to}. */
static struct api_ratio density_in(const struct api_options *o, enum api_density_unit to)
{
	if (o->has_material)
		return api_units_convert(api_materials[o->material].kg_m3, API_KG_M3, to, o->unit,
					 o->mass_unit);
	return api_units_convert(o->density, o->density_unit, to, o->unit, o->mass_unit);
}

static int exclusive(struct api_problem *p, const char *one, const char *other)
{
	return api_problem_option(p, API_BAD_OPTION, other, strlen(other),
				  "%s and %s exclude each other: give one of them.", one, other);
}

static int not_with_closed(struct api_problem *p, const char *option, const char *what)
{
	return api_problem_option(p, API_BAD_OPTION, option, strlen(option),
				  "checks=closed keeps no triangle, so there is no room for %s: "
				  "leave one of the two options out.",
				  what);
}

/* What checks=closed, which keeps no triangle, leaves no room for. */
static int check_closed(const struct api_options *o, struct api_problem *p)
{
	if (o->checks != MP_CHECKS_CLOSED)
		return 0;
	if (o->format == MP_WISH_OBJ || o->format == MP_WISH_DRACO)
		return api_problem_option(p, API_BAD_OPTION, "checks", strlen("checks"),
					  "checks=closed is for STL files: it cannot go with "
					  "another format.");
	if (o->precision == MP_WISH_EXACT)
		return not_with_closed(p, "precision", "exact numbers");
	if (o->has_transform)
		return not_with_closed(p, "transform", "an affine map");
	if (o->weld > 0)
		return not_with_closed(p, "weld", "welding");
	if (o->orient)
		return not_with_closed(p, "orient", "orienting");
	if ((o->include & API_INCLUDE_FACETS) != 0)
		return not_with_closed(p, "include", "a list of facets");
	if ((o->include & API_INCLUDE_SELF_INTERSECTIONS) != 0)
		return not_with_closed(p, "include", "self_intersections");
	return 0;
}

int api_options_check(const struct api_options *o, struct api_problem *p)
{
	const char *name = o->has_material ? "material" : "density";
	struct api_ratio density;

	if (api_named_check(o, p) || check_closed(o, p))
		return -1;
	if (o->has_density && o->has_material)
		return exclusive(p, "density", "material");
	if (o->has_density && o->has_mass)
		return exclusive(p, "density", "mass");
	if (o->has_material && o->has_mass)
		return exclusive(p, "material", "mass");
	if (!o->has_density && !o->has_material)
		return 0;
	density = density_in(o, API_DENSITY_FILE);
	if (!isnormal(density.num / density.den))
		return api_problem_option(p, API_BAD_OPTION, name, strlen(name),
					  "The density is out of range in these units.");
	return 0;
}

void api_options_request(const struct api_options *o, struct mp_request *out)
{
	struct api_ratio density;

	out->format = o->format;
	out->flip = o->flip;
	out->orient = o->orient;
	out->weld = o->weld;
	out->precision = o->precision;
	out->checks = o->checks;
	out->self_intersections = (o->include & API_INCLUDE_SELF_INTERSECTIONS) != 0;
	out->density_kind = MP_DENSITY_NONE;
	out->density = 0;
	out->density_divisor = 1;
	out->density_error = 0;
	if (o->has_mass) {
		out->density_kind = MP_DENSITY_FROM_MASS;
		out->density = o->mass;
	} else if (o->has_density || o->has_material) {
		out->density_kind = MP_DENSITY_GIVEN;
		density = density_in(o, API_DENSITY_FILE);
		out->density = density.num;
		out->density_divisor = density.den;
		out->density_error = density.error;
	}
	api_named_request(o, out);
	out->has_transform = o->has_transform;
	memcpy(out->transform, o->transform, sizeof out->transform);
	out->has_about = o->has_about;
	out->has_axis = o->has_axis || o->has_axis_origin;
	memcpy(out->about, o->about, sizeof out->about);
	memcpy(out->axis_direction, o->axis, sizeof out->axis_direction);
	memcpy(out->axis_origin, o->axis_origin, sizeof out->axis_origin);
	out->bodies = o->bodies;
	out->defects = o->defects;
}

double api_options_density(const struct api_options *o, double volume)
{
	struct api_ratio r;

	if (o->has_density)
		return o->density;
	if (o->has_material)
		r = density_in(o, o->density_unit);
	else
		r = api_units_convert(o->mass, API_DENSITY_FILE, o->density_unit, o->unit,
				      o->mass_unit);
	return o->has_material ? r.num / r.den : r.num / (volume * r.den);
}

double api_options_mean_density(const struct api_options *o, double mass, double volume)
{
	struct api_ratio r =
	    api_units_convert(mass, API_DENSITY_FILE, o->density_unit, o->unit, o->mass_unit);

	return r.num / (volume * r.den);
}

const char *api_option_name(size_t i)
{
	return i < api_option_count ? api_option_rows[i].name : NULL;
}

bool api_option_supported(size_t i)
{
	return i < api_option_count && !api_option_rows[i].later;
}
