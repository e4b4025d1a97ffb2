#ifndef API_UNITS_H
#define API_UNITS_H

#include <stddef.h>

#include "api/options.h"

/* Words of the units, in the order of their enums. */
extern const char *const api_unit_names[API_UNITS];
extern const char *const api_density_unit_names[API_DENSITY_UNITS];
extern const char *const api_mass_unit_names[API_MASS_UNITS];

/*
 * A converted quantity as a quotient of two doubles, both integers wherever the quantity is a
 * decimal of up to 15 digits, so that dividing once costs one rounding in all (a long one costs
 * two more).  1 in = 25.4 mm, 1 ft = 12 in, 1 lb = 0.45359237 kg, exactly.
 */
struct api_ratio {
	double num, den;
	double error; /* num/den is at most this off, relative; nearly always 0 */
};

/*
 * ${x} ${from} in ${to}; "file" stands for ${mass} units per cubic ${unit}.  An ${x} of a few
 * decimals is taken as that decimal, not as the double next to it: 2.7 is 27/10.
 */
struct api_ratio api_units_convert(double x, enum api_density_unit from, enum api_density_unit to,
				   enum api_unit unit, enum api_mass_unit mass);

/* Nominal densities at room temperature, for estimates; a data sheet or a weighing knows better. */
struct api_material {
	const char *name;
	double kg_m3;
};

extern const struct api_material api_materials[];
extern const size_t api_material_count;

#endif
