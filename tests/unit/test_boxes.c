#include "core/bodies/boxes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/unit/alloc_fail.h"

static void assert_apart(const struct mp_box *box, uint32_t count, enum mp_truth want)
{
	struct mp_error err;
	enum mp_truth apart;

	assert_int_equal(mp_boxes_apart(box, count, &apart, &err), 0);
	assert_int_equal(apart, want);
}

static void test_none_and_one_are_apart(void **state)
{
	const struct mp_box box = {{0, 0, 0}, {1, 1, 1}};

	(void)state;
	assert_apart(NULL, 0, MP_YES);
	assert_apart(&box, 1, MP_YES);
}

static void test_boxes_that_touch_are_apart(void **state)
{
	struct mp_box box[3] = {
	    {{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{0, 1, 1}, {1, 2, 2}}};

	(void)state;
	assert_apart(box, 3, MP_YES);
	box[2].min[1] = box[2].min[2] = 0.999;
	assert_apart(box, 3, MP_UNDECIDED);
}

static void test_box_in_a_box_is_not_apart(void **state)
{
	const struct mp_box box[2] = {{{1, 1, 1}, {2, 2, 2}}, {{0, 0, 0}, {3, 3, 3}}};

	(void)state;
	assert_apart(box, 2, MP_UNDECIDED);
}

/* ${side}^3 unit cubes on a grid in a scrambled order, then one that meets a neighbour. */
static void test_grid_of_boxes(void **state)
{
	enum { SIDE = 44, COUNT = SIDE * SIDE * SIDE };
	struct mp_box *box = calloc(COUNT, sizeof *box);

	(void)state;
	assert_non_null(box);
	for (uint32_t i = 0; i < COUNT; i++) {
		uint32_t at = i * 7919 % COUNT;

		for (int k = 0; k < 3; k++, at /= SIDE) {
			box[i].min[k] = 1.25 * (at % SIDE);
			box[i].max[k] = box[i].min[k] + 1;
		}
	}
	assert_apart(box, COUNT, MP_YES);
	for (int k = 0; k < 3; k++)
		box[COUNT / 2].max[k] += 0.5;
	assert_apart(box, COUNT, MP_UNDECIDED);
	free(box);
}

/*
 * ${side}^2 long bars along each axis, woven so that none meet and no plane parts them: along x
 * where y and z are even, along y where z is odd and x even, along z where x and y are odd.
 */
static struct mp_box *weave(uint32_t side)
{
	static const int ODD[3][3] = {{0, 0, 0}, {0, 0, 1}, {1, 1, 0}};
	struct mp_box *box = calloc(3 * (size_t)side * side, sizeof *box);

	assert_non_null(box);
	for (uint32_t i = 0; i < 3 * side * side; i++) {
		uint32_t along = i % 3, row = i / 3 % side, column = i / 3 / side;

		for (uint32_t k = 0; k < 3; k++) {
			double at = 2.0 * (k == (along + 1) % 3 ? row : column) + ODD[along][k];

			box[i].min[k] = k == along ? 0 : at;
			box[i].max[k] = k == along ? 2 * side : at + 1;
		}
	}
	return box;
}

static void test_boxes_that_no_plane_parts(void **state)
{
	struct mp_box *box = weave(20);

	(void)state;
	assert_apart(box, 1200, MP_YES);
	box[77].max[77 % 3 == 0 ? 1 : 0] += 0.5;
	box[77].max[77 % 3 == 2 ? 1 : 2] += 0.5;
	assert_apart(box, 1200, MP_UNDECIDED);
	free(box);
}

static void test_work_is_bounded(void **state)
{
	struct mp_box *box = weave(180);

	(void)state;
	assert_apart(box, 97200, MP_UNDECIDED); /* apart, but 10^9 pairs */
	free(box);
}

/* Every box a step beyond the last: groups within groups within groups. */
static void test_staircase(void **state)
{
	enum { COUNT = 5000 };
	struct mp_box *box = calloc(COUNT, sizeof *box);

	(void)state;
	assert_non_null(box);
	for (uint32_t i = 0; i < COUNT; i++) { /* each fills what is left, but for one side */
		uint32_t turn = i / 3, side = i % 3;

		for (uint32_t k = 0; k < 3; k++) {
			box[i].min[k] = turn + (k < side ? 1 : 0);
			box[i].max[k] = k == side ? box[i].min[k] + 1 : COUNT;
		}
	}
	assert_apart(box, COUNT, MP_YES);
	free(box);
}

static void test_out_of_memory(void **state)
{
	const struct mp_box box[2] = {{{0, 0, 0}, {1, 1, 1}}, {{2, 2, 2}, {3, 3, 3}}};
	struct mp_error err = {0};
	enum mp_truth apart;

	(void)state;
	alloc_fail_at(1);
	assert_int_equal(mp_boxes_apart(box, 2, &apart, &err), -1);
	assert_int_equal(err.code, MP_NOMEM);
	alloc_fail_at(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_none_and_one_are_apart),
	    cmocka_unit_test(test_boxes_that_touch_are_apart),
	    cmocka_unit_test(test_box_in_a_box_is_not_apart),
	    cmocka_unit_test(test_grid_of_boxes),
	    cmocka_unit_test(test_boxes_that_no_plane_parts),
	    cmocka_unit_test(test_work_is_bounded),
	    cmocka_unit_test(test_staircase),
	    cmocka_unit_test(test_out_of_memory),
	};

	return cmocka_run_group_tests_name("boxes", tests, NULL, NULL);
}
