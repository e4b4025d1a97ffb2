#include "api/units.h"

#include <float.h>
#include <math.h>

/* 10^22 is the last power of ten that a double holds; 10^15 - 1 has 15 digits. */
enum { MOST_DECIMALS = 22 };
#define MOST_DECIMAL 1e15

const char *const api_unit_names[API_UNITS] = {"mm", "um", "cm", "m", "in", "ft"};
const char *const api_density_unit_names[API_DENSITY_UNITS] = {"kg/m3", "g/cm3", "lb/in3", "file"};
const char *const api_mass_unit_names[API_MASS_UNITS] = {"kg", "g", "lb"};

/* 10^ten * 16387064^inch * 1728^foot * 45359237^pound: cancelling is adding exponents. */
struct factor {
	int ten, inch, foot, pound;
};

/* cubic units in m3: 1 in3 = 16387064e-12 m3, 1 ft3 = 1728 in3 */
static const struct factor cubes[API_UNITS] = {
    [API_MM] = {-9, 0, 0, 0}, [API_UM] = {-18, 0, 0, 0}, [API_CM] = {-6, 0, 0, 0},
    [API_M] = {0, 0, 0, 0},   [API_IN] = {-12, 1, 0, 0}, [API_FT] = {-12, 1, 1, 0},
};

/* in kg: 1 lb = 45359237e-8 kg */
static const struct factor masses[API_MASS_UNITS] = {
    [API_KG] = {0, 0, 0, 0},
    [API_G] = {-3, 0, 0, 0},
    [API_LB] = {-8, 0, 0, 1},
};

/* in kg/m3: 1 lb/in3 = 45359237e-8 / 16387064e-12 */
static const struct factor densities[API_DENSITY_FILE] = {
    [API_KG_M3] = {0, 0, 0, 0},
    [API_G_CM3] = {3, 0, 0, 0},
    [API_LB_IN3] = {4, -1, 0, 1},
};

static struct factor times(struct factor a, struct factor b)
{
	return (struct factor){a.ten + b.ten, a.inch + b.inch, a.foot + b.foot, a.pound + b.pound};
}

static struct factor inverse(struct factor a)
{
	return (struct factor){-a.ten, -a.inch, -a.foot, -a.pound};
}

/* io *= by; a product that had to be rounded is one unit in the last place off at most. */
static void multiply(double *io, double by, double *error)
{
	double product = *io * by;

	if (fma(*io, by, -product) != 0)
		*error += DBL_EPSILON;
	*io = product;
}

static void raise(struct api_ratio *r, double base, int exponent)
{
	for (; exponent > 0; exponent--)
		multiply(&r->num, base, &r->error);
	for (; exponent < 0; exponent++)
		multiply(&r->den, base, &r->error);
}

static struct api_ratio ratio(struct factor f)
{
	struct api_ratio r = {1, 1, 0};

	raise(&r, 16387064, f.inch);
	raise(&r, 1728, f.foot);
	raise(&r, 45359237, f.pound);
	raise(&r, 10, f.ten);
	return r;
}

/* of one unit of density, in kg/m3 */
static struct factor density_factor(enum api_density_unit density, enum api_unit unit,
				    enum api_mass_unit mass)
{
	if (density == API_DENSITY_FILE)
		return times(masses[mass], inverse(cubes[unit]));
	return densities[density];
}

/*
 * The decimal that ${x} was written as: n/10^k with the smallest k for which both are exact and
 * their quotient rounds to ${x}.  Returns k and sets ${*n}; 0 and ${x} where there is none.
 */
static int decimal(double x, double *n)
{
	double ten = 1;

	for (int k = 0; k <= MOST_DECIMALS; k++) {
		*n = rint(x * ten);
		if (*n < MOST_DECIMAL && *n / ten == x)
			return k;
		ten *= 10;
	}
	*n = x;
	return 0;
}

struct api_ratio api_units_convert(double x, enum api_density_unit from, enum api_density_unit to,
				   enum api_unit unit, enum api_mass_unit mass)
{
	struct factor f =
	    times(density_factor(from, unit, mass), inverse(density_factor(to, unit, mass)));
	struct api_ratio r;
	double n;

	f.ten -= decimal(x, &n);
	r = ratio(f);
	multiply(&r.num, n, &r.error);
	return r;
}

/*
 * Nominal densities at room temperature, kg/m3, as data sheets print them; plastics: the middle of
 * the range of unfilled grades.  Water: 20 degrees C.  A quote that matters gives its own density.
 */
const struct api_material api_materials[] = {
    {"aluminium_6061", 2700},
    {"aluminium_7075", 2810},
    {"steel", 7850},
    {"stainless_304", 8000},
    {"stainless_316", 8000},
    {"cast_iron", 7200},
    {"titanium_ti6al4v", 4430},
    {"brass", 8500},
    {"bronze", 8800},
    {"copper", 8960},
    {"magnesium_az31", 1770},
    {"zinc_zamak3", 6600},
    {"lead", 11340},
    {"silver", 10490},
    {"gold", 19300},
    {"tungsten", 19250},
    {"abs", 1040},
    {"asa", 1070},
    {"pa12", 1010},
    {"pc", 1200},
    {"pe_hd", 955},
    {"peek", 1300},
    {"petg", 1270},
    {"pla", 1240},
    {"pmma", 1180},
    {"pom", 1410},
    {"pp", 905},
    {"ptfe", 2170},
    {"pvc", 1390},
    {"tpu", 1200},
    {"water", 998.2},
};

const size_t api_material_count = sizeof api_materials / sizeof api_materials[0];
