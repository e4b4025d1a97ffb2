#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "draco_seen.h"
#include "draco_stub.h"

/* The checks on what libdraco delivers, with a libdraco that delivers anything. */

static const uint64_t roomy = 1000000;
static const uint32_t face[2][3] = {{0, 1, 2}, {2, 1, 3}};
static const uint32_t swapped[4] = {1, 0, 3, 2};
static struct draco_seen seen, floats = {.as_floats = true};
static uint8_t *values; /* 4 positions, exactly as long as it says */

/* A good mesh of two triangles; every test spoils one thing. */
static void set_up(void)
{
	const float xyz[4][3] = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}};

	free(values);
	values = malloc(sizeof xyz);
	assert_non_null(values);
	memcpy(values, xyz, sizeof xyz);
	memset(&draco_stub, 0, sizeof draco_stub);
	draco_stub.verdict = MP_DRACO_DECODED;
	draco_stub.shape = (struct mp_draco_shape){.faces = 2,
						   .points = 4,
						   .used = UINT64_MAX,
						   .has_positions = true,
						   .type = MP_DRACO_FLOAT32,
						   .components = 3,
						   .values = 4,
						   .mapped = 4,
						   .data = values,
						   .size = sizeof xyz,
						   .stride = 12};
	draco_stub.face = face;
	draco_stub.face_count = 2;
}

static void decode(uint64_t most)
{
	static struct draco_file file;

	draco_head(&file, 0x202, 1, 1, 0);
	draco_put(&file, "\0\4\2\0\2\0", 6); /* edgebreaker of 2 faces */
	draco_put(&file, "anything", 8);
	draco_decode(&seen, file.bytes, file.len, SIZE_MAX, SIZE_MAX, most);
	draco_decode(&floats, file.bytes, file.len, SIZE_MAX, SIZE_MAX, most);
	assert_true(draco_same(&seen, &floats));
	assert_false(draco_stub.wrong);
	assert_false(seen.wrong);
	assert_int_equal(draco_stub.alive, 0);
	assert_true(seen.notes.foreign_code);
}

static void check_refused(enum mp_code code, const char *word)
{
	decode(roomy);
	if (seen.ret == 0 || seen.err.code != code || strstr(seen.err.text, word) == NULL)
		fail_msg("%d, code %d: %s", seen.ret, seen.err.code, seen.err.text);
	assert_int_equal(seen.count, 0);
}

static void a_good_mesh_is_passed_on(void **state)
{
	(void)state;
	set_up();
	decode(roomy);
	assert_int_equal(seen.ret, 0);
	assert_int_equal(seen.count, 2);
	assert_true(seen.tri[1][0] == 6 && seen.tri[1][4] == 4 && seen.tri[1][8] == 11);
	draco_stub.value = swapped;
	decode(roomy);
	assert_int_equal(seen.ret, 0);
	assert_true(seen.tri[1][0] == 9 && seen.tri[1][4] == 1 && seen.tri[1][8] == 8);
	assert_int_equal(seen.index[1][0], 3);
}

static void positions_may_lie_apart(void **state)
{
	(void)state;
	set_up();
	draco_stub.shape.offset = 4; /* one float in, and 8 bytes apart: 4 + 3 * 8 + 12 < 48 */
	draco_stub.shape.stride = 12;
	draco_stub.shape.values = 3;
	draco_stub.face_count = 1;
	decode(roomy);
	assert_int_equal(seen.ret, 0);
	assert_true(seen.tri[0][0] == 1 && seen.tri[0][8] == 9);
	draco_stub.shape.values = 4; /* the last would end 4 bytes behind the data */
	check_refused(MP_SYNTAX, "fewer");
}

/* As many as are worked on together and more; the last position has nothing behind it. */
static void every_corner_gets_its_position(void **state)
{
	uint32_t corner[600][3];

	(void)state;
	for (uint64_t faces = 1; faces <= 600; faces += faces < 20 ? 1 : 29)
		for (uint32_t last = 0; last < 2; last++) {
			for (size_t i = 0; i < 3 * faces; i++)
				corner[i / 3][i % 3] = (uint32_t)(i * i % 7 % (3 + last));
			set_up();
			draco_stub.shape.faces = draco_stub.face_count = faces;
			draco_stub.face = (const uint32_t(*)[3])corner;
			decode(roomy);
			assert_int_equal(seen.ret, 0);
			assert_int_equal(floats.count, faces);
			assert_int_equal(floats.expected, faces);
			for (size_t i = 0; i < 9 * faces; i++)
				assert_true(floats.tri[i / 9][i % 9] ==
					    3 * corner[i / 9][i / 3 % 3] + i % 3);
		}
}

static void positions_that_nobody_names_may_be_anything(void **state)
{
	const float bad = NAN;

	(void)state;
	set_up();
	memcpy(values + 36, &bad, sizeof bad);
	draco_stub.face_count = 1;
	decode(roomy);
	assert_int_equal(seen.ret, 0);
	assert_int_equal(floats.expected, 0);
	draco_stub.face_count = 2;
	check_refused(MP_NON_FINITE, "face 1 (from 0): x of position 3 is not finite");
}

static void what_claims_too_much_is_refused(void **state)
{
	static const struct {
		uint64_t size, offset, stride, values;
	} bad[] = {{47, 0, 12, 4},          {48, 0, 13, 4},  {48, 0, 11, 4},
		   {48, 0, 0, 4},           {48, 37, 12, 1}, {48, 49, 12, 1},
		   {48, UINT64_MAX, 12, 1}, {11, 0, 12, 1},  {0, 0, 12, 1},
		   {48, 0, 12, 5},          {48, 0, 12, 0},  {48, 0, UINT64_MAX, 2},
		   {48, 0, 12, UINT64_MAX}};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		set_up();
		draco_stub.shape.size = bad[i].size;
		draco_stub.shape.offset = bad[i].offset;
		draco_stub.shape.stride = bad[i].stride;
		draco_stub.shape.values = bad[i].values;
		check_refused(MP_SYNTAX, "fewer");
	}
}

static void indices_are_checked_at_every_step(void **state)
{
	static const uint32_t beyond[4] = {0, 1, 4, 3}, none[4] = {0, UINT32_MAX, 2, 3};

	(void)state;
	set_up();
	draco_stub.shape.points = 3;
	check_refused(MP_BAD_INDEX, "face 1 (from 0) names point 3 of 3");
	set_up();
	draco_stub.shape.mapped = 3; /* the map is shorter than it should be */
	check_refused(MP_BAD_INDEX, "face 1 (from 0) names point 3 of 4");
	set_up();
	draco_stub.shape.values = 3;
	check_refused(MP_BAD_INDEX, "face 1 (from 0) names position 3 of 3");
	set_up();
	draco_stub.value = beyond;
	check_refused(MP_BAD_INDEX, "face 0 (from 0) names position 4 of 4");
	draco_stub.value = none;
	check_refused(MP_BAD_INDEX, "face 0 (from 0) names position 4294967295 of 4");
	set_up();
	draco_stub.shape.points = draco_stub.shape.mapped = draco_stub.shape.values = 0;
	check_refused(MP_SYNTAX, "fewer");
}

static void the_limit_counts_what_was_decoded(void **state)
{
	(void)state;
	set_up();
	decode(2);
	assert_int_equal(seen.ret, 0);
	draco_stub.shape.faces = 3; /* the header said 2 */
	decode(2);
	assert_int_equal(seen.ret, -1);
	assert_int_equal(seen.err.code, MP_LIMIT);
	assert_int_equal(seen.err.limit, 2);
	assert_int_equal(seen.err.actual, 3);
	draco_stub.shape.faces = 0;
	check_refused(MP_NO_FACES, "0 faces");
}

static void a_step_is_passed_on_if_it_is_one(void **state)
{
	(void)state;
	set_up();
	draco_stub.shape.step = 0.25;
	decode(roomy);
	assert_true(seen.notes.quantisation_step == 0.25);
	assert_int_equal(seen.notes.rounding, MP_ROUNDING_QUANTISED);
	draco_stub.shape.step = -0.25;
	decode(roomy);
	assert_true(seen.notes.quantisation_step == 0);
	draco_stub.shape.step = (double)INFINITY;
	decode(roomy);
	assert_true(seen.notes.quantisation_step == 0);
	assert_int_equal(seen.notes.rounding, MP_ROUNDING_UNKNOWN);
}

static void libdracos_troubles_become_errors(void **state)
{
	(void)state;
	set_up();
	draco_stub.verdict = MP_DRACO_NO_MEMORY;
	check_refused(MP_NOMEM, "memory");
	draco_stub.verdict = MP_DRACO_REFUSED;
	check_refused(MP_SYNTAX, "damaged or incomplete");
	assert_null(strchr(seen.err.text, '('));
	draco_stub.why = "no idea";
	check_refused(MP_SYNTAX, "damaged or incomplete (libdraco: no idea)");
}

static int clean_up(void **state)
{
	(void)state;
	free(values);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_good_mesh_is_passed_on),
	    cmocka_unit_test(positions_may_lie_apart),
	    cmocka_unit_test(every_corner_gets_its_position),
	    cmocka_unit_test(positions_that_nobody_names_may_be_anything),
	    cmocka_unit_test(what_claims_too_much_is_refused),
	    cmocka_unit_test(indices_are_checked_at_every_step),
	    cmocka_unit_test(the_limit_counts_what_was_decoded),
	    cmocka_unit_test(a_step_is_passed_on_if_it_is_one),
	    cmocka_unit_test(libdracos_troubles_become_errors),
	};

	return cmocka_run_group_tests_name("draco_shape", tests, NULL, clean_up);
}
