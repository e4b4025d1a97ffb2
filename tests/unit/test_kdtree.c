#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/bodies/kdtree.h"
#include "soup.h"

enum { N = 2000 };

struct hits {
	unsigned char seen[N];
	int count, stop_at;
};

static int hit(void *self, uint32_t id)
{
	struct hits *h = self;

	assert_int_equal(h->seen[id]++, 0);
	return ++h->count == h->stop_at;
}

/* Many equal coordinates; few; sorted; ends high, middle low: what quickselect dislikes. */
static double coordinate(int kind, int i, uint64_t *state)
{
	switch (kind) {
	case 0:
		return (double)(soup_random(state) % 4);
	case 1:
		return (double)(soup_random(state) % 100000);
	case 2:
		return i;
	case 3:
		return -i;
	case 4:
		return i < N / 2 ? i : N - i;
	default:
		return 7;
	}
}

static void every_point_in_the_box_is_found_once(void **unused)
{
	uint64_t state = 12;

	(void)unused;
	for (int round = 0; round < 300; round++) {
		struct mp_kd_point *tree = malloc(N * sizeof *tree);
		int n = round < 20 ? round : N, want = 0;
		double lo[3], hi[3];
		struct hits h = {.count = 0};
		uint64_t steps = N;

		for (int i = 0; i < n; i++) {
			for (int k = 0; k < 3; k++)
				tree[i].p[k] = coordinate((round + k) % 6, i, &state);
			tree[i].id = (uint32_t)i;
		}
		for (int k = 0; k < 3; k++) {
			lo[k] = round % 7 ? coordinate((round + k) % 6, round, &state) : -INFINITY;
			hi[k] = lo[k] < 0 ? 50 : 2 * lo[k];
		}
		for (int i = 0; i < n; i++) {
			bool in = true;

			for (int k = 0; k < 3; k++)
				in &= lo[k] <= tree[i].p[k] && tree[i].p[k] <= hi[k];
			want += in;
		}
		mp_kd_build(tree, (size_t)n);
		assert_int_equal(mp_kd_search(tree, (size_t)n, lo, hi, &steps, hit, &h), 0);
		assert_int_equal(h.count, want);
		free(tree);
	}
}

static void a_search_ends_when_told_to_or_out_of_steps(void **unused)
{
	const double lo[3] = {-1, -1, -1}, hi[3] = {N, N, N};
	struct mp_kd_point *tree = calloc(N, sizeof *tree);
	struct hits h = {.stop_at = 10}, g = {.count = 0};
	uint64_t steps = 5 * N;

	(void)unused;
	for (uint32_t i = 0; i < N; i++)
		tree[i].id = i;
	mp_kd_build(tree, N);
	assert_int_equal(mp_kd_search(tree, N, lo, hi, &steps, hit, &h), -1);
	assert_int_equal(h.count, 10);
	assert_int_equal(steps, 5 * N - 10);
	steps = 100;
	assert_int_equal(mp_kd_search(tree, N, lo, hi, &steps, hit, &g), -1);
	assert_int_equal(g.count, 100);
	assert_int_equal(steps, 0);
	free(tree);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_point_in_the_box_is_found_once),
	    cmocka_unit_test(a_search_ends_when_told_to_or_out_of_steps),
	};

	return cmocka_run_group_tests_name("kdtree", tests, NULL, NULL);
}
