#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/options.h"
#include "api/units.h"
#include "api/utf8.h"

/* Options, query and combinations at once, from a heap copy of the exact size. */
static int read_query(const char *query, size_t len, struct api_options *o, struct api_problem *p)
{
	char *copy = malloc(len + (len == 0));
	int rc;

	assert_non_null(copy);
	memcpy(copy, query, len);
	api_options_init(o);
	memset(p, 0, sizeof *p);
	rc = api_options_query(o, copy, len, p);
	if (rc == 0)
		rc = api_options_check(o, p);
	free(copy);
	assert_int_equal(rc == 0, p->code == API_OK);
	return rc;
}

static struct api_options accepts(const char *query)
{
	struct api_options o;
	struct api_problem p;

	if (read_query(query, strlen(query), &o, &p))
		fail_msg("%s: %s (%s)", query, p.detail, p.option);
	return o;
}

static struct api_problem refuses_bytes(const char *query, size_t len, enum api_code code,
					const char *option)
{
	struct api_options o;
	struct api_problem p;

	if (read_query(query, len, &o, &p) == 0)
		fail_msg("%s is accepted", query);
	api_options_free(&o);
	if (p.code != code || strcmp(p.option, option) != 0)
		fail_msg("%s: %s, %s, %s", query, api_problem_name(p.code), p.option, p.detail);
	assert_true(api_utf8_clean(p.detail, strlen(p.detail)));
	assert_true(api_utf8_clean(p.option, strlen(p.option)));
	assert_true(strlen(p.detail) > 10 && strlen(p.detail) + 1 < sizeof p.detail);
	return p;
}

static struct api_problem refuses(const char *query, enum api_code code, const char *option)
{
	return refuses_bytes(query, strlen(query), code, option);
}

static void bad(const char *query, const char *option)
{
	(void)refuses(query, API_BAD_OPTION, option);
}

static void later(const char *query, const char *option)
{
	(void)refuses(query, API_OPTION_NOT_SUPPORTED, option);
}

static void no_options_are_the_defaults(void **state)
{
	struct api_options o = accepts("");
	struct api_problem p;
	struct mp_request r = {.key = {1}, .limits = {7}};

	(void)state;
	assert_int_equal(o.given, 0);
	assert_int_equal(o.unit, API_MM);
	assert_int_equal(o.bodies, 100);
	assert_int_equal(o.defects, 100);
	assert_false(o.flip || o.strict || o.has_density || o.has_about || o.unit_given);
	assert_int_equal(o.precision, MP_WISH_PRECISION_AUTO);
	assert_int_equal(accepts("precision=certified").precision, MP_WISH_CERTIFIED);
	assert_int_equal(accepts("precision=exact").precision, MP_WISH_EXACT);
	assert_int_equal(api_options_query(&o, NULL, 0, &p), 0);
	api_options_request(&o, &r);
	assert_int_equal(r.density_kind, MP_DENSITY_NONE);
	assert_false(r.has_axis || r.has_about || r.flip);
	assert_int_equal(r.key[0], 1); /* not the options' business */
	assert_int_equal(r.limits.max_triangles, 7);
}

static void every_option_arrives(void **state)
{
	struct api_options o = accepts("format=stl&unit=in&density=7.85&density_unit=g%2Fcm3&"
				       "mass_unit=lb&about=1,-2.5,3e2&axis=0,1e-200,0&"
				       "axis_origin=-1,.5,7.&flip=true&bodies=10000&defects=0&"
				       "strict=true");
	struct mp_request r = {.limits = {0}};

	(void)state;
	assert_int_equal(o.format, MP_WISH_STL);
	assert_int_equal(o.unit, API_IN);
	assert_true(o.unit_given && o.has_density && o.flip && o.strict);
	assert_true(o.density == 7.85);
	assert_int_equal(o.density_unit, API_G_CM3);
	assert_int_equal(o.mass_unit, API_LB);
	assert_int_equal(o.bodies, 10000);
	assert_int_equal(o.defects, 0);
	api_options_request(&o, &r);
	assert_true(r.about[0] == 1 && r.about[1] == -2.5 && r.about[2] == 300);
	assert_true(r.axis_direction[1] == 1e-200 && r.axis_origin[2] == 7);
	assert_true(r.has_about && r.has_axis && r.flip);
	assert_int_equal(r.bodies, 10000);
	assert_int_equal(r.density_kind, MP_DENSITY_GIVEN);
}

static void the_other_words_arrive(void **state)
{
	(void)state;
	assert_int_equal(accepts("format=auto").format, MP_WISH_AUTO);
	assert_int_equal(accepts("format=obj").format, MP_WISH_OBJ);
	assert_int_equal(accepts("format=drc").format, MP_WISH_DRACO);
	assert_int_equal(accepts("unit=ft").unit, API_FT);
	assert_int_equal(accepts("density_unit=file").density_unit, API_DENSITY_FILE);
	assert_int_equal(accepts("mass_unit=g").mass_unit, API_G);
	assert_false(accepts("flip=false&strict=false").flip);
	assert_true(accepts("orient=fix").orient && !accepts("orient=keep").orient);
	assert_true(accepts("weld=0.00e5").weld == 0 && accepts("weld=2.5e-3").weld == 0.0025);
}

static void an_origin_alone_has_the_axis_z(void **state)
{
	struct api_options o = accepts("axis_origin=1,2,3");
	struct mp_request r;

	(void)state;
	api_options_request(&o, &r);
	assert_true(r.has_axis);
	assert_true(r.axis_direction[0] == 0 && r.axis_direction[1] == 0 &&
		    r.axis_direction[2] == 1);
	assert_true(r.axis_origin[1] == 2);
	o = accepts("axis=1,0,0");
	api_options_request(&o, &r);
	assert_true(r.has_axis && r.axis_origin[0] == 0 && r.axis_direction[2] == 0);
}

static void malformed_values_are_refused_by_name(void **state)
{
	static const char *const numbers[] = {
	    "",     "+",   "x",   "1x",  " 1",     "1%20", "nan", "inf", "-inf",        "1e999",
	    "0x10", "1d3", "1,2", "--1", "1.#INF", "1e",   "%2B", "1_0", "\xef\xbc\x91"};
	char query[64];

	(void)state;
	for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
		snprintf(query, sizeof query, "density=%s", numbers[i]);
		bad(query, "density");
		snprintf(query, sizeof query, "mass=%s", numbers[i]);
		bad(query, "mass");
		snprintf(query, sizeof query, "about=1,%s,3", numbers[i]);
		bad(query, "about");
		snprintf(query, sizeof query, "weld=%s", numbers[i]);
		bad(query, "weld");
		snprintf(query, sizeof query, "bodies=%s", numbers[i]);
		bad(query, "bodies");
	}
	bad("density", "density");
	bad("density=0", "density");
	bad("density=-1", "density");
	bad("density=1e-999", "density");
	bad("mass=0", "mass");
	bad("flip=1", "flip");
	bad("flip=TRUE", "flip");
	bad("strict=", "strict");
	bad("unit=MM", "unit");
	bad("unit=mm ", "unit");
	bad("format=ply", "format");
	bad("mass_unit=kilogram", "mass_unit");
	bad("density_unit=kg%2Fm", "density_unit");
	bad("material=unobtainium", "material");
}

static void vectors_have_three_numbers(void **state)
{
	(void)state;
	bad("about=1,2", "about");
	bad("about=1,2,3,4", "about");
	bad("about=1,2,3,", "about");
	bad("about=,1,2", "about");
	bad("about=,,", "about");
	bad("about=", "about");
	bad("about=1;2;3", "about");
	bad("axis=1,2", "axis");
	bad("axis=0,0,0", "axis");
	bad("axis=0,-0,0.0e7", "axis");
	bad("axis=1e-999,0,0", "axis");
	bad("axis_origin=1", "axis_origin");
}

static void counts_end_where_the_contract_says(void **state)
{
	(void)state;
	assert_int_equal(accepts("bodies=0").bodies, 0);
	assert_int_equal(accepts("defects=100000").defects, 100000);
	bad("bodies=10001", "bodies");
	bad("defects=100001", "defects");
	bad("bodies=-1", "bodies");
	bad("bodies=1.0", "bodies");
	bad("bodies=1e2", "bodies");
	bad("bodies=18446744073709551617", "bodies");
}

static void repeated_options_are_refused(void **state)
{
	(void)state;
	bad("unit=mm&unit=mm", "unit");
	bad("flip=false&strict=true&flip=true", "flip");
	bad("weld=0&weld=0", "weld");
}

static void unknown_options_are_refused_by_name(void **state)
{
	(void)state;
	(void)refuses("units=mm", API_UNKNOWN_OPTION, "units");
	(void)refuses("Unit=mm", API_UNKNOWN_OPTION, "Unit");
	(void)refuses("unit%20=mm", API_UNKNOWN_OPTION, "unit ");
	(void)refuses("density[]=1", API_UNKNOWN_OPTION, "density[]");
	(void)refuses("density[a=1", API_UNKNOWN_OPTION, "density[a");
	(void)refuses("density[NAME]x=1", API_UNKNOWN_OPTION, "density[NAME]x");
	(void)refuses("na%C3%AFve", API_UNKNOWN_OPTION, "na\xc3\xafve");
	(void)refuses("=1", API_BAD_REQUEST, "");
}

static void exclusive_options_are_refused(void **state)
{
	(void)state;
	bad("density=1&material=water", "material");
	bad("mass=1&density=1", "mass");
	bad("material=water&mass=1", "mass");
}

static void closed_checks_exclude_what_needs_a_table(void **state)
{
	struct mp_request r;
	struct api_options o = accepts("checks=closed&format=stl&precision=certified&bodies=3");

	(void)state;
	api_options_request(&o, &r);
	assert_int_equal(r.checks, MP_CHECKS_CLOSED);
	(void)accepts("checks=closed&precision=auto&format=auto");
	bad("checks=closed&precision=exact", "precision");
	bad("density[a]=1&checks=closed", "density[a]");
	bad("checks=closed&weld=1e-3", "weld");
	bad("orient=fix&checks=closed", "orient");
	bad("checks=closed&transform=1,0,0,0,0,1,0,0,0,0,1,0", "transform");
	(void)accepts("checks=closed&weld=0");
	bad("checks=closed&include=digest,facets", "include");
	(void)accepts("checks=closed&include=digest");
	bad("checks=closed&format=obj", "checks");
	bad("format=drc&checks=closed", "checks");
	bad("checks=open", "checks");
	o = accepts("checks=full&precision=exact&density[a]=1&format=stl");
	api_options_free(&o);
}

static void extras_are_a_list(void **state)
{
	struct api_options o;

	(void)state;
	o = accepts("include=facets");
	assert_int_equal(o.include, API_INCLUDE_FACETS);
	o = accepts("include=digest,facets");
	assert_int_equal(o.include, API_INCLUDE_FACETS | API_INCLUDE_DIGEST);
	o = accepts("include=digest,digest");
	assert_int_equal(o.include, API_INCLUDE_DIGEST);
	o = accepts("include=self_intersections,facets");
	assert_int_equal(o.include, API_INCLUDE_FACETS | API_INCLUDE_SELF_INTERSECTIONS);
	o = accepts("unit=mm");
	assert_int_equal(o.include, 0);
}

static void options_of_a_later_stage_take_their_default_alone(void **state)
{
	(void)state;
	(void)accepts("precision=auto&resolution=1e-9");
	later("resolution=1e-6", "resolution");
}

static void options_of_a_later_stage_are_checked_all_the_same(void **state)
{
	(void)state;
	bad("orient=repair", "orient");
	bad("weld=-1", "weld");
	bad("checks=", "checks");
	bad("include=", "include");
	bad("include=facets,", "include");
	bad("include=,facets", "include");
	bad("include=Facets", "include");
	bad("include=facets digest", "include");
	bad("include=facets,,digest", "include");
	bad("checks=closed&include=self_intersections", "include");
	bad("resolution=0", "resolution");
	bad("density[a]=heavy", "density[a]");
}

static void a_transform_is_three_rows_or_four(void **state)
{
	struct api_options o = accepts("transform=1,2,3,4,5,6,7,8,9,10,12,-1.5e3");
	struct mp_request request = {.has_transform = false};

	(void)state;
	api_options_request(&o, &request);
	assert_true(request.has_transform);
	assert_true(request.transform[0][3] == 4 && request.transform[1][0] == 5);
	assert_true(request.transform[2][2] == 12 && request.transform[2][3] == -1500);
	o = accepts("transform=1,2,3,4,5,6,7,8,9,10,12,-1.5e3,0,-0,0,1");
	assert_memory_equal(o.transform, request.transform, sizeof o.transform);
	assert_false(accepts("").has_transform);
	bad("transform=1,2,3", "transform");
	bad("transform=", "transform");
	bad("transform=1,0,0,0,0,1,0,0,0,0,1", "transform");
	bad("transform=1,0,0,0,0,1,0,0,0,0,1,0,0", "transform");
	bad("transform=1,0,0,0,0,1,0,0,0,0,1,", "transform");
	bad("transform=1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2", "transform");
	bad("transform=1,0,0,0,0,1,0,0,0,0,1,0,0,1e-300,0,1", "transform");
	bad("transform=1,0,0,0,0,1,0,0,0,0,1,nan", "transform");
	bad("transform=1,0,0,0,0,1e999,0,0,0,0,1,0", "transform");
}

/* 0.1*0.1 and 0.01 are not one: rounding decides nothing here. */
static void a_transform_is_singular_exactly_or_not(void **state)
{
	(void)state;
	bad("transform=1,0,0,0,0,1,0,0,0,0,0,0", "transform");
	bad("transform=1,2,3,0,2,4,6,0,0,0,1,0", "transform");
	bad("transform=0,0,0,1,0,0,0,1,0,0,0,1", "transform");
	bad("transform=1e-200,0,0,0,0,1e-200,1e-200,0,0,1e-200,1e-200,0", "transform");
	(void)accepts("transform=1e-200,0,0,0,0,1e-200,0,0,0,0,1e-200,0");
	(void)accepts("transform=1e300,0,0,0,0,1e300,0,0,0,0,1e300,0");
	(void)accepts("transform=0.1,0.01,0,0,1,0.1,0,0,0,0,1,0");
	(void)accepts("transform=1,1,0,0,1,1.0000000000000002,0,0,0,0,1,0");
}

static void a_density_out_of_range_is_refused(void **state)
{
	(void)state;
	(void)accepts("density=1e300");
	bad("density=1e306&density_unit=g/cm3&unit=m", "density");
	bad("density=1e-300&unit=um", "density");
}

static void segments_are_split_as_forms_are(void **state)
{
	(void)state;
	assert_true(accepts("&&flip=true&").flip);
	assert_int_equal(accepts("d%65nsity_unit=%6b%67/m3").density_unit, API_KG_M3);
	bad("unit=mm=", "unit");
	bad("unit=mm%26flip=true", "unit");
	bad("density=1e+3", "density"); /* '+' is a space */
	assert_true(accepts("density=1e%2B3").density == 1000);
	assert_non_null(strstr(refuses("density=1e+3", API_BAD_OPTION, "density").detail, "%2B"));
}

static void broken_escapes_and_bytes_are_refused(void **state)
{
	(void)state;
	bad("unit=%", "unit");
	bad("unit=%6", "unit");
	bad("unit=%zz", "unit");
	bad("unit=%6g", "unit");
	bad("unit=mm%00", "unit");
	bad("unit=%ff", "unit");
	bad("unit=%c3%28", "unit");
	bad("unit=mm%0a", "unit");
	(void)refuses("un%it=mm", API_BAD_REQUEST, "");
	(void)refuses("unit%00=mm", API_BAD_REQUEST, "unit\xef\xbf\xbd");
	(void)refuses("%ff=1", API_BAD_REQUEST, "\xef\xbf\xbd");
	(void)refuses_bytes("unit=m\0m", 8, API_BAD_OPTION, "unit");
	(void)refuses_bytes("\0", 1, API_BAD_REQUEST, "\xef\xbf\xbd");
}

static void very_long_texts_are_refused(void **state)
{
	char query[6000];

	(void)state;
	memset(query, '1', sizeof query);
	memcpy(query, "about=", 6);
	(void)refuses_bytes(query, sizeof query, API_BAD_OPTION, "about");
	memset(query, 'n', sizeof query);
	(void)refuses_bytes(query, sizeof query, API_BAD_REQUEST, "");
	memset(query, '&', sizeof query);
	assert_int_equal(accepts("&").given, 0);
	memset(query, '0', 4000); /* long, but a number all the same */
	memcpy(query, "density=", 8);
	memcpy(query + 4000, "7850", 5);
	assert_true(accepts(query).density == 7850);
}

static void details_list_what_is_allowed(void **state)
{
	struct api_problem p = refuses("unit=yard", API_BAD_OPTION, "unit");
	size_t i;

	(void)state;
	assert_non_null(strstr(p.detail, "mm, um, cm, m, in, ft."));
	p = refuses("material=x", API_BAD_OPTION, "material");
	for (i = 0; i < api_material_count; i++)
		assert_non_null(strstr(p.detail, api_materials[i].name));
}

static void form_fields_may_hold_anything(void **state)
{
	struct api_options o;
	struct api_problem p;

	(void)state;
	api_options_init(&o);
	assert_int_equal(api_options_set(&o, "unit", 4, "in", 2, &p), 0);
	assert_int_equal(api_options_set(&o, "unit", 4, "in", 2, &p), -1);
	assert_int_equal(api_options_set(&o, "mass", 4, NULL, 0, &p), -1);
	assert_int_equal(api_options_set(&o, NULL, 0, NULL, 0, &p), -1);
	assert_int_equal(p.code, API_BAD_REQUEST);
}

/* Density in kg per mm3 and so on, as a quotient of integers. */
static void request_density(const char *query, double density, double divisor)
{
	struct api_options o = accepts(query);
	struct mp_request r;

	api_options_request(&o, &r);
	assert_int_equal(r.density_kind, MP_DENSITY_GIVEN);
	if (r.density != density || r.density_divisor != divisor)
		fail_msg("%s: %.17g / %.17g", query, r.density, r.density_divisor);
}

static void densities_are_quotients_of_integers(void **state)
{
	(void)state;
	request_density("density=2700", 2700, 1e9);
	request_density("density=2700&unit=um", 2700, 1e18);
	request_density("density=2700&unit=cm", 2700, 1e6);
	request_density("density=2700&unit=m", 2700, 1);
	request_density("density=2700&unit=m&mass_unit=g", 2700e3, 1);
	request_density("density=2.7&density_unit=g/cm3", 27, 1e7);
	request_density("density=2.7&density_unit=g/cm3&mass_unit=g", 27, 1e4);
	request_density("density=2.7&density_unit=g/cm3&mass_unit=g&unit=cm", 27, 10);
	request_density("density=2700&unit=in", 2700.0 * 16387064, 1e12);
	request_density("density=2700&unit=ft", 2700.0 * 28316846592, 1e12);
	request_density("density=0.1&density_unit=lb/in3&unit=in&mass_unit=lb", 1, 10);
	request_density("density=0.1&density_unit=lb/in3&unit=ft&mass_unit=lb", 1728, 10);
	request_density("density=0.1&density_unit=lb/in3&unit=in", 45359237, 1e9);
	request_density("density=1&mass_unit=lb&unit=m", 1e8, 45359237);
	request_density("density=5&density_unit=file&unit=in&mass_unit=lb", 5, 1);
	request_density("density=2.7e-6&density_unit=file", 27, 1e7);
	request_density("material=steel", 7850, 1e9);
	request_density("material=steel&density_unit=lb/in3", 7850, 1e9);
	request_density("material=water", 9982, 1e10);
}

static void a_density_that_is_no_short_decimal_is_taken_as_it_is(void **state)
{
	(void)state;
	request_density("density=0.33333333333333331&density_unit=file", 0.33333333333333331, 1);
	request_density("density=0.333333333333333&density_unit=file", 333333333333333, 1e15);
	request_density("density=12345678901234567890&density_unit=file", 12345678901234567890.0,
			1);
	request_density("density=1e-200&density_unit=file", 1e-200, 1);
	request_density("density=1e300&density_unit=file", 1e300, 1);
}

static void a_weighed_mass_stays_as_it_is(void **state)
{
	struct api_options o = accepts("mass=64.8&mass_unit=g");
	struct mp_request r;

	(void)state;
	api_options_request(&o, &r);
	assert_int_equal(r.density_kind, MP_DENSITY_FROM_MASS);
	assert_true(r.density == 64.8);
}

static void the_report_gets_the_density_in_its_unit(void **state)
{
	struct api_options o = accepts("density=0.1&density_unit=lb/in3");

	(void)state;
	assert_true(api_options_density(&o, 3) == 0.1);
	o = accepts("material=aluminium_6061&density_unit=g/cm3");
	assert_true(api_options_density(&o, 3) == 2.7);
	o = accepts("mass=0.0648");
	assert_true(api_options_density(&o, 24000) == 2700);
	o = accepts("mass=64.8&mass_unit=g&density_unit=g/cm3");
	assert_true(api_options_density(&o, 24000) == 2.7);
	o = accepts("mass=6&density_unit=file&unit=in");
	assert_true(api_options_density(&o, 24) == 0.25);
	o = accepts("material=water&density_unit=file");
	assert_true(api_options_density(&o, 1) == 9.982e-7);
	o = accepts("mass=1&mass_unit=lb&unit=in&density_unit=lb/in3");
	assert_true(api_options_density(&o, 8) == 0.125);
}

static void materials_are_dense_and_named(void **state)
{
	(void)state;
	for (size_t i = 0; i < api_material_count; i++) {
		assert_true(api_materials[i].kg_m3 > 500 && api_materials[i].kg_m3 < 23000);
		for (size_t k = 0; k < i; k++)
			assert_string_not_equal(api_materials[i].name, api_materials[k].name);
	}
}

static void the_list_of_options_ends(void **state)
{
	size_t n = 0, now = 0;

	(void)state;
	for (; api_option_name(n) != NULL; n++)
		now += api_option_supported(n);
	assert_int_equal(n, 22);
	assert_int_equal(now, 21);
	assert_null(api_option_name(n + 1000));
	assert_false(api_option_supported(n));
}

int main(void)
{
	const struct CMUnitTest options[] = {
	    cmocka_unit_test(no_options_are_the_defaults),
	    cmocka_unit_test(every_option_arrives),
	    cmocka_unit_test(the_other_words_arrive),
	    cmocka_unit_test(an_origin_alone_has_the_axis_z),
	    cmocka_unit_test(malformed_values_are_refused_by_name),
	    cmocka_unit_test(vectors_have_three_numbers),
	    cmocka_unit_test(counts_end_where_the_contract_says),
	    cmocka_unit_test(repeated_options_are_refused),
	    cmocka_unit_test(unknown_options_are_refused_by_name),
	    cmocka_unit_test(exclusive_options_are_refused),
	    cmocka_unit_test(closed_checks_exclude_what_needs_a_table),
	    cmocka_unit_test(extras_are_a_list),
	    cmocka_unit_test(options_of_a_later_stage_take_their_default_alone),
	    cmocka_unit_test(options_of_a_later_stage_are_checked_all_the_same),
	    cmocka_unit_test(a_transform_is_three_rows_or_four),
	    cmocka_unit_test(a_transform_is_singular_exactly_or_not),
	    cmocka_unit_test(a_density_out_of_range_is_refused),
	    cmocka_unit_test(segments_are_split_as_forms_are),
	    cmocka_unit_test(broken_escapes_and_bytes_are_refused),
	    cmocka_unit_test(very_long_texts_are_refused),
	    cmocka_unit_test(details_list_what_is_allowed),
	    cmocka_unit_test(form_fields_may_hold_anything),
	    cmocka_unit_test(densities_are_quotients_of_integers),
	    cmocka_unit_test(a_density_that_is_no_short_decimal_is_taken_as_it_is),
	    cmocka_unit_test(a_weighed_mass_stays_as_it_is),
	    cmocka_unit_test(the_report_gets_the_density_in_its_unit),
	    cmocka_unit_test(materials_are_dense_and_named),
	    cmocka_unit_test(the_list_of_options_ends),
	};

	return cmocka_run_group_tests(options, NULL, NULL);
}
