#include "api/option_table.h"

#include <string.h>

#include "api/named.h"
#include "api/units.h"
#include "core/affine/affine.h"

enum { MOST_BODIES = 10000, MOST_DEFECTS = 100000, MOST_MATERIALS = 64 };

static int set_format(struct api_options *o, const struct api_value *v)
{
	static const char *const words[] = {"auto", "stl", "obj", "drc"}; /* enum mp_format_wish */
	unsigned which = 0;

	if (api_value_choice(v, words, 4, &which))
		return -1;
	o->format = (enum mp_format_wish)which;
	return 0;
}

static int set_unit(struct api_options *o, const struct api_value *v)
{
	unsigned which = 0;

	if (api_value_choice(v, api_unit_names, API_UNITS, &which))
		return -1;
	o->unit = (enum api_unit)which;
	o->unit_given = true;
	return 0;
}

static int set_density(struct api_options *o, const struct api_value *v)
{
	o->has_density = true;
	return api_value_positive(v, &o->density);
}

static int set_density_of(struct api_options *o, const struct api_value *v)
{
	double density;

	return api_value_positive(v, &density) ? -1 : api_named_add(&o->named, v, density);
}

static int set_density_unit(struct api_options *o, const struct api_value *v)
{
	unsigned which = 0;

	if (api_value_choice(v, api_density_unit_names, API_DENSITY_UNITS, &which))
		return -1;
	o->density_unit = (enum api_density_unit)which;
	return 0;
}

static int set_material(struct api_options *o, const struct api_value *v)
{
	const char *names[MOST_MATERIALS];
	size_t count = api_material_count < MOST_MATERIALS ? api_material_count : MOST_MATERIALS;
	unsigned which = 0;

	for (size_t i = 0; i < count; i++)
		names[i] = api_materials[i].name;
	if (api_value_choice(v, names, count, &which))
		return -1;
	o->material = (int)which;
	o->has_material = true;
	return 0;
}

static int set_mass(struct api_options *o, const struct api_value *v)
{
	o->has_mass = true;
	return api_value_positive(v, &o->mass);
}

static int set_mass_unit(struct api_options *o, const struct api_value *v)
{
	unsigned which = 0;

	if (api_value_choice(v, api_mass_unit_names, API_MASS_UNITS, &which))
		return -1;
	o->mass_unit = (enum api_mass_unit)which;
	return 0;
}

static int set_about(struct api_options *o, const struct api_value *v)
{
	o->has_about = true;
	return api_value_numbers(v, o->about, 3);
}

static int set_axis(struct api_options *o, const struct api_value *v)
{
	o->has_axis = true;
	if (api_value_numbers(v, o->axis, 3))
		return -1;
	if (o->axis[0] == 0 && o->axis[1] == 0 && o->axis[2] == 0)
		return api_value_bad(v, "a direction; its length is 0");
	return 0;
}

static int set_axis_origin(struct api_options *o, const struct api_value *v)
{
	o->has_axis_origin = true;
	return api_value_numbers(v, o->axis_origin, 3);
}

static int set_transform(struct api_options *o, const struct api_value *v)
{
	double m[16];
	size_t commas = 0;
	struct mp_affine map;

	for (size_t i = 0; i < v->len; i++)
		commas += v->text[i] == ',';
	if (commas != 11 && commas != 15)
		return api_value_bad(v, "12 or 16 finite numbers with commas between them");
	if (api_value_numbers(v, m, commas + 1))
		return -1;
	if (commas == 15 && (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1))
		return api_value_bad(v, "an affine map, whose last row is 0,0,0,1");
	memcpy(o->transform, m, sizeof o->transform);
	if (!mp_affine_set(&map, (const double(*)[4])o->transform))
		return api_value_bad(v, "an affine map that can be undone; its determinant is 0");
	o->has_transform = true;
	return 0;
}

static int set_flip(struct api_options *o, const struct api_value *v)
{
	return api_value_bool(v, &o->flip);
}

static int set_bodies(struct api_options *o, const struct api_value *v)
{
	return api_value_count(v, MOST_BODIES, &o->bodies);
}

static int set_defects(struct api_options *o, const struct api_value *v)
{
	return api_value_count(v, MOST_DEFECTS, &o->defects);
}

static int set_strict(struct api_options *o, const struct api_value *v)
{
	return api_value_bool(v, &o->strict);
}

/* Options of a later stage: a malformed value is still malformed, the default changes nothing. */

static int not_yet(const struct api_value *v)
{
	return api_problem_option(v->problem, API_OPTION_NOT_SUPPORTED, v->name, v->name_len,
				  "This version does not have this option yet.");
}

static int set_orient(struct api_options *o, const struct api_value *v)
{
	static const char *const words[] = {"keep", "fix"};
	unsigned which = 0;

	if (api_value_choice(v, words, 2, &which))
		return -1;
	o->orient = which == 1;
	return 0;
}

static int set_weld(struct api_options *o, const struct api_value *v)
{
	if (api_value_numbers(v, &o->weld, 1))
		return -1;
	return o->weld < 0 ? api_value_bad(v, "a number that is not negative") : 0;
}

static int set_checks(struct api_options *o, const struct api_value *v)
{
	static const char *const words[] = {"full", "closed"}; /* enum mp_checks_wish */
	unsigned which = 0;

	if (api_value_choice(v, words, 2, &which))
		return -1;
	o->checks = (enum mp_checks_wish)which;
	return 0;
}

static int set_precision(struct api_options *o, const struct api_value *v)
{
	static const char *const words[] = {"auto", "certified", "exact"}; /* mp_precision_wish */
	unsigned which = 0;

	if (api_value_choice(v, words, 3, &which))
		return -1;
	o->precision = (enum mp_precision_wish)which;
	return 0;
}

static int set_resolution(struct api_options *o, const struct api_value *v)
{
	double x;

	(void)o;
	if (api_value_positive(v, &x))
		return -1;
	return x == 1e-9 ? 0 : not_yet(v);
}

static const struct {
	const char *word;
	unsigned bit;
} extras[] = {{"facets", API_INCLUDE_FACETS},
	      {"digest", API_INCLUDE_DIGEST},
	      {"self_intersections", API_INCLUDE_SELF_INTERSECTIONS}};

static int include_one(struct api_options *o, const struct api_value *all, const char *word,
		       size_t len)
{
	const struct api_value v = {all->name, all->name_len, word, len, all->problem};

	for (size_t i = 0; i < sizeof extras / sizeof extras[0]; i++) {
		if (!api_value_is(&v, extras[i].word))
			continue;
		o->include |= extras[i].bit;
		return 0;
	}
	return api_value_bad(&v, "a list of facets, digest, self_intersections");
}

static int set_include(struct api_options *o, const struct api_value *v)
{
	size_t from = 0;

	for (size_t i = 0; i <= v->len; i++) {
		if (i < v->len && v->text[i] != ',')
			continue;
		if (include_one(o, v, v->text + from, i - from))
			return -1;
		from = i + 1;
	}
	return 0;
}

const struct api_option_row api_option_rows[] = {
    {"format", set_format, false},
    {"unit", set_unit, false},
    {"density", set_density, false},
    {"density_unit", set_density_unit, false},
    {"material", set_material, false},
    {"mass", set_mass, false},
    {API_OPTION_FAMILY "NAME]", set_density_of, false},
    {"mass_unit", set_mass_unit, false},
    {"about", set_about, false},
    {"axis", set_axis, false},
    {"axis_origin", set_axis_origin, false},
    {"transform", set_transform, false},
    {"flip", set_flip, false},
    {"orient", set_orient, false},
    {"weld", set_weld, false},
    {"bodies", set_bodies, false},
    {"defects", set_defects, false},
    {"checks", set_checks, false},
    {"precision", set_precision, false},
    {"resolution", set_resolution, true},
    {"include", set_include, false},
    {"strict", set_strict, false},
};

const size_t api_option_count = sizeof api_option_rows / sizeof api_option_rows[0];
_Static_assert(sizeof api_option_rows / sizeof api_option_rows[0] <= 64,
	       "api_options.given has a bit for every row");
