#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/sort.h"
#include "core/topology/smallest.h"
#include "soup.h"

static int order(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

	return (x > y) - (x < y);
}

static uint64_t key(int kind, size_t i, uint64_t *state)
{
	switch (kind) {
	case 0:
		return soup_random(state);
	case 1:
		return soup_random(state) % 3;
	case 2:
		return (soup_random(state) % 3) << 56 | soup_random(state) % 5;
	case 3:
		return UINT64_MAX - i;
	case 4:
		return i << 20;
	default:
		return 5;
	}
}

static void any_keys_are_sorted(void **unused)
{
	uint64_t state = 2;

	(void)unused;
	for (size_t n = 0; n < 3000; n += 1 + n / 7) {
		for (int kind = 0; kind < 6; kind++) {
			uint64_t *a = malloc((n + 1) * sizeof *a), *b = malloc((n + 1) * sizeof *b);

			for (size_t i = 0; i < n; i++)
				a[i] = b[i] = key(kind, i, &state);
			mp_sort_u64(a, n);
			qsort(b, n, sizeof *b, order);
			assert_memory_equal(a, b, n * sizeof *a);
			free(a);
			free(b);
		}
	}
}

static void the_smallest_are_kept(void **unused)
{
	uint64_t state = 3;

	(void)unused;
	for (size_t most = 0; most < 60; most = 2 * most + 1) {
		for (int kind = 0; kind < 6; kind++) {
			enum { N = 500 };
			struct mp_smallest s = {.most = most};
			uint64_t all[N];

			for (size_t i = 0; i < N; i++) {
				all[i] = key(kind, i, &state);
				mp_smallest_add(&s, all[i]);
			}
			qsort(all, N, sizeof *all, order);
			assert_int_equal(mp_smallest_finish(&s), 0);
			assert_int_equal(s.count, most);
			if (most > 0)
				assert_memory_equal(s.key, all, most * sizeof *all);
			mp_smallest_free(&s);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(any_keys_are_sorted),
	    cmocka_unit_test(the_smallest_are_kept),
	};

	return cmocka_run_group_tests_name("sort", tests, NULL, NULL);
}
