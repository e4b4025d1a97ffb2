/* Which points are the same place, against comparing them all with each other. */
#include "core/topology/places.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "alloc_fail.h"
#include "soup.h"

enum { MOST = 1500 };

static const uint8_t some_key[16] = {9, 8, 7, 6, 5, 4, 3, 2, 1};

/* ${count} points with coordinates below ${range}, some of them -0, in memory of their size. */
static unsigned char *make(size_t count, size_t stride, unsigned range, uint64_t *state)
{
	unsigned char *data = malloc(count > 0 ? (count - 1) * stride + 12 : 1);

	assert_non_null(data);
	for (size_t i = 0; i < 3 * count; i++) {
		float x = (float)(soup_random(state) % range);

		if (x == 0 && soup_random(state) % 2)
			x = -x;
		memcpy(data + i / 3 * stride + i % 3 * 4, &x, sizeof x);
	}
	return data;
}

static void take(const struct mp_points *p, size_t i, float xyz[3])
{
	memcpy(xyz, p->data + i * p->stride, 3 * sizeof *xyz);
}

static bool is_same(const struct mp_points *p, size_t i, size_t j)
{
	float a[3], b[3];

	take(p, i, a);
	take(p, j, b);
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Returns how many are the place of an earlier one. */
static size_t check_first(const struct mp_places *places, const struct mp_points *p)
{
	size_t same = 0;

	for (size_t i = 0; i < p->count; i++) {
		size_t j = 0;

		while (!is_same(p, i, j))
			j++;
		same += j < i;
		if (places->first != NULL)
			assert_int_equal(places->first[i], j);
	}
	assert_true((places->first != NULL) == (same > 0));
	return same;
}

/* Points come in no order, some never; vertices are numbered as their places come. */
static void check_numbers(struct mp_places *places, struct mp_vertices *v,
			  const struct mp_points *p, uint64_t *state)
{
	static bool came[MOST];
	static uint32_t want[MOST];
	uint32_t count = 0;

	memset(came, 0, sizeof came);
	memset(want, 0xff, sizeof want);
	for (int round = 0; round < 40; round++) {
		uint32_t number[200], expected[200], out[200];
		float point[200][3];
		size_t n = 0;

		for (int i = 0; i < 200; i++) {
			uint32_t at = (uint32_t)(soup_random(state) % p->count);
			size_t first = 0;

			if (came[at])
				continue;
			came[at] = true;
			while (!is_same(p, at, first))
				first++;
			if (want[first] == UINT32_MAX)
				want[first] = count++;
			take(p, at, point[n]);
			expected[n] = want[first];
			number[n++] = at;
		}
		assert_int_equal(mp_places_add(places, v, number, point, n, out, NULL), 0);
		assert_memory_equal(out, expected, n * sizeof *out);
	}
	assert_int_equal(mp_vertices_count(v), count);
	for (size_t i = 0; i < p->count; i++) {
		double at[3];
		float xyz[3];

		if (want[i] == UINT32_MAX)
			continue;
		take(p, i, xyz);
		mp_vertices_get(v, want[i], at);
		for (int k = 0; k < 3; k++)
			assert_true(at[k] == (double)xyz[k] && !signbit(at[k]));
	}
}

static void same_places_are_found(void **unused)
{
	static const unsigned ranges[] = {1, 2, 5, 20, 200, 1 << 22};
	static const size_t counts[] = {1, 2, 63, 64, 65, 1000, MOST};
	uint64_t state = 5;
	size_t same = 0;

	(void)unused;
	for (size_t r = 0; r < sizeof ranges / sizeof ranges[0]; r++)
		for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
			size_t stride = c % 2 ? 12 : 17;
			unsigned char *data = make(counts[c], stride, ranges[r], &state);
			const struct mp_points p = {data, stride, counts[c]};
			struct mp_vertices *v = mp_vertices_new(some_key, NULL);
			struct mp_places places;

			mp_places_find(&places, v, &p);
			assert_true(places.known);
			same += check_first(&places, &p);
			check_numbers(&places, v, &p, &state);
			mp_places_free(&places);
			mp_places_free(&places);
			mp_vertices_free(v);
			free(data);
		}
	assert_true(same > MOST);
}

/* The key says which of them are suspected; what is found is the same. */
static void no_key_matters(void **unused)
{
	uint64_t state = 6;
	unsigned char *data = make(MOST, 12, 30, &state);
	const struct mp_points p = {data, 12, MOST};

	(void)unused;
	for (uint8_t i = 0; i < 8; i++) {
		const uint8_t key[16] = {i, 1, i};
		struct mp_vertices *v = mp_vertices_new(key, NULL);
		struct mp_places places;

		mp_places_find(&places, v, &p);
		assert_true(places.known);
		check_first(&places, &p);
		mp_places_free(&places);
		mp_vertices_free(v);
	}
	free(data);
}

static void without_memory_they_stay_unknown(void **unused)
{
	uint64_t state = 7;
	unsigned char *data = make(MOST, 12, 10, &state);
	const struct mp_points p = {data, 12, MOST};
	struct mp_vertices *v = mp_vertices_new(some_key, NULL);
	struct mp_places places = {.known = false};
	long n = 0;

	(void)unused;
	while (!places.known) {
		alloc_fail_at(++n);
		mp_places_find(&places, v, &p);
		alloc_fail_at(0);
		assert_true(places.known || (places.first == NULL && places.vertex == NULL));
		assert_true(n < 100);
	}
	assert_true(n > 8);
	mp_places_free(&places);
	mp_vertices_free(v);
	free(data);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(same_places_are_found),
	    cmocka_unit_test(no_key_matters),
	    cmocka_unit_test(without_memory_they_stay_unknown),
	};

	return cmocka_run_group_tests_name("places", tests, NULL, NULL);
}
