#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/topology/topology.h"
#include "soup.h"

/* Blocks of floats, a row a coordinate, say the same as doubles, a triangle after the other. */

struct blocks {
	double (*tri)[9];          /* of exactly ${count} triangles */
	float (*xyz)[9][MP_BLOCK]; /* the same, in blocks */
	size_t count;
};

static float some_float(uint64_t *state)
{
	static const float ODD[] = {0,       -0.0F,    1,         -1,        FLT_MIN,
				    FLT_MAX, -FLT_MAX, 0x1p-149F, 0x1p-100F, 0.1F};
	uint64_t what = soup_random(state) % 16;

	if (what < sizeof ODD / sizeof *ODD)
		return ODD[what];
	return (float)(soup_random(state) % 5) - 2;
}

/* Few different coordinates: vertices come again, and triangles are flat now and then. */
static struct blocks make(size_t count, bool odd, uint64_t *state)
{
	struct blocks b = {.count = count};

	b.tri = malloc(count * sizeof *b.tri);
	b.xyz = calloc(count / MP_BLOCK + 1, sizeof *b.xyz);
	assert_true(b.tri != NULL && b.xyz != NULL);
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 9; k++) {
			float x =
			    odd ? some_float(state) : (float)(soup_random(state) % 1000) * 0.37F;

			b.tri[i][k] = (double)x;
			b.xyz[i / MP_BLOCK][k][i % MP_BLOCK] = x;
		}
	return b;
}

static void drop(struct blocks *b)
{
	free(b->tri);
	free(b->xyz);
}

static size_t in_block(const struct blocks *b, size_t at)
{
	return b->count - at < MP_BLOCK ? b->count - at : MP_BLOCK;
}

static void check_vertices(const struct blocks *b, bool wide)
{
	static const double third[1][9] = {{1 / 3.0, 0, 0, 0, 1 / 3.0, 0, 0, 0, 1 / 3.0}};
	static const uint8_t key[16] = {5};
	struct mp_vertices *v = mp_vertices_new(key, NULL), *w = mp_vertices_new(key, NULL);
	uint32_t(*one)[3] = calloc(b->count, sizeof *one), (*other)[3];
	double p[3], q[3];

	other = calloc(b->count, sizeof *other);
	assert_true(v != NULL && w != NULL && one != NULL && other != NULL);
	if (wide) {
		uint32_t number[1][3];

		assert_int_equal(mp_vertices_add(v, third, 1, number, NULL), 0);
		assert_int_equal(mp_vertices_add(w, third, 1, number, NULL), 0);
	}
	for (size_t at = 0; at < b->count; at += MP_BLOCK) {
		size_t n = in_block(b, at);

		assert_int_equal(
		    mp_vertices_add(v, (const double(*)[9])b->tri + at, n, one + at, NULL), 0);
		assert_int_equal(
		    mp_vertices_add_floats(w, (const float(*)[MP_BLOCK])b->xyz[at / MP_BLOCK], n,
					   other + at, NULL),
		    0);
	}
	assert_memory_equal(one, other, b->count * sizeof *one);
	assert_int_equal(mp_vertices_count(v), mp_vertices_count(w));
	for (uint32_t i = 0; i < mp_vertices_count(v); i++) {
		mp_vertices_get(v, i, p);
		mp_vertices_get(w, i, q);
		assert_memory_equal(p, q, sizeof p); /* not even a sign of 0 */
	}
	mp_vertices_free(v);
	mp_vertices_free(w);
	free(one);
	free(other);
}

static void columns_have_the_same_vertices(void **unused)
{
	static const size_t COUNT[] = {1, 3, 4, 5, 63, 64, 65, 255, 256, 257, 700, 20000};
	uint64_t state = 4;

	(void)unused;
	for (size_t i = 0; i < 2 * sizeof COUNT / sizeof *COUNT; i++) {
		struct blocks b = make(COUNT[i / 2], i % 2 == 0, &state);

		check_vertices(&b, false);
		check_vertices(&b, true);
		drop(&b);
	}
}

/* Wherever a block begins, by every kernel. */
static void columns_have_the_same_marks(void **unused)
{
	uint64_t state = 6, seen = 0;

	(void)unused;
	for (size_t round = 0; round < 200; round++) {
		struct blocks b = make(1 + soup_random(&state) % MP_BLOCK, round % 2 == 0, &state);
		uint64_t first = soup_random(&state) % 5000, want[3] = {0};

		for (size_t i = 0; i < b.count; i++) /* but for some */
			if (soup_random(&state) % 100 != 0)
				for (size_t k = 0; k < 9 && round % 4 == 0; k++)
					b.xyz[0][k][i] =
					    (float)(b.tri[i][k] = (double)(k % 4 + k / 4));
		mp_flat_mark((const double(*)[9])b.tri, b.count, first, want);
		seen |= want[0] | want[1];
		for (size_t k = 0; k < mp_flat_kernels(); k++) {
			uint64_t flat[3] = {0};

			mp_flat_mark_with(k, (const float(*)[MP_BLOCK])b.xyz[0], b.count, first,
					  flat);
			assert_memory_equal(flat, want, sizeof want);
		}
		drop(&b);
	}
	assert_true(seen != 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(columns_have_the_same_vertices),
	    cmocka_unit_test(columns_have_the_same_marks),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
