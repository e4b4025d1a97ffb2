#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "alloc_fail.h"
#include "core/topology/vertices.h"
#include "soup.h"

static const uint8_t some_key[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

/* Two triangles on the corners 0 1 2 and 2 1 3. */
static void numbers_are_in_order_of_first_appearance(void **unused)
{
	const double tri[2][9] = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 0, 1, 0, 0, 1, 1, 0}};
	const uint32_t want[2][3] = {{0, 1, 2}, {2, 1, 3}};
	struct mp_vertices *v = mp_vertices_new(some_key, NULL);
	uint32_t out[2][3];
	double p[3];

	(void)unused;
	assert_non_null(v);
	assert_int_equal(mp_vertices_count(v), 0);
	assert_int_equal(mp_vertices_add(v, tri, 2, out, NULL), 0);
	assert_memory_equal(out, want, sizeof want);
	assert_int_equal(mp_vertices_count(v), 4);
	mp_vertices_seal(v);
	mp_vertices_get(v, 3, p);
	assert_true(p[0] == 1 && p[1] == 1 && p[2] == 0);
	mp_vertices_free(v);
	mp_vertices_free(NULL);
}

static void minus_zero_is_zero(void **unused)
{
	const double tri[1][9] = {{0.0, -0.0, 1, -0.0, 0.0, 1, -0.0, -0.0, 1}};
	struct mp_vertices *v = mp_vertices_new(some_key, NULL);
	uint32_t out[1][3];
	double p[3];

	(void)unused;
	assert_int_equal(mp_vertices_add(v, tri, 1, out, NULL), 0);
	assert_int_equal(mp_vertices_count(v), 1);
	mp_vertices_get(v, 0, p);
	assert_false(signbit(p[0]) || signbit(p[1]));
	mp_vertices_free(v);
}

/* The neighbours of a double are different vertices, and so is its float. */
static void one_ulp_makes_another_vertex(void **unused)
{
	const double x = 0.1, y = nextafter(x, 1), z = (double)0.1f;
	const double tri[1][9] = {{x, 0, 0, y, 0, 0, z, 0, 0}};
	struct mp_vertices *v = mp_vertices_new(some_key, NULL);
	uint32_t out[1][3];

	(void)unused;
	assert_int_equal(mp_vertices_add(v, tri, 1, out, NULL), 0);
	assert_int_equal(mp_vertices_count(v), 3);
	mp_vertices_free(v);
}

/* Values at the borders of what a float holds come back unchanged. */
static void every_double_comes_back(void **unused)
{
	const double value[] = {
	    0,        1,         FLT_MAX,         0x1p128,         FLT_MIN,
	    0x1p-149, 0x1p-150,  0x1.8p-149,      0x1.000002p-126, 0x1.000001p-126,
	    0.1,      DBL_MAX,   0x1p-1074,       0x1.fffffep-127, 0x1.8p-148,
	    -FLT_MAX, -0x1p-149, -0x1.fffffffp127};
	size_t n = sizeof value / sizeof value[0];

	(void)unused;
	for (size_t i = 0; i < n; i++) {
		const double tri[1][9] = {{1, 2, 3, value[i], 5, 6, 7, 8, value[i]}};
		struct mp_vertices *v = mp_vertices_new(some_key, NULL);
		uint32_t out[1][3];
		double p[3];

		assert_int_equal(mp_vertices_add(v, tri, 1, out, NULL), 0);
		for (unsigned k = 0; k < 3; k++) {
			mp_vertices_get(v, out[0][k], p);
			assert_memory_equal(p, tri[0] + 3 * k, sizeof p);
		}
		mp_vertices_free(v);
	}
}

/* Floats first, doubles from the middle on; the same again finds every vertex. */
static void widening_keeps_numbers_and_coordinates(void **unused)
{
	enum { N = 3000 };
	double(*tri)[9] = malloc(N * sizeof *tri);
	uint32_t(*first)[3] = malloc(N * sizeof *first), (*second)[3] = malloc(N * sizeof *second);
	struct mp_vertices *v = mp_vertices_new(some_key, NULL);
	uint64_t state = 5;
	uint32_t count;

	(void)unused;
	for (size_t i = 0; i < N; i++)
		for (size_t k = 0; k < 9; k++)
			tri[i][k] = (double)(soup_random(&state) % 64) / (i < N / 2 ? 64 : 63);
	assert_int_equal(mp_vertices_add(v, (const double(*)[9])tri, N, first, NULL), 0);
	count = mp_vertices_count(v);
	assert_int_equal(mp_vertices_add(v, (const double(*)[9])tri, N, second, NULL), 0);
	assert_int_equal(mp_vertices_count(v), count);
	assert_memory_equal(first, second, N * sizeof *first);
	for (size_t i = 0; i < 3 * N; i++) {
		double p[3];

		mp_vertices_get(v, first[i / 3][i % 3], p);
		assert_memory_equal(p, tri[i / 3] + 3 * (i % 3), sizeof p);
	}
	mp_vertices_free(v);
	free(tri);
	free(first);
	free(second);
}

/* A grid of n * n squares has (n + 1)^2 vertices, whatever the key and the size of the calls. */
static void numbers_depend_on_neither_key_nor_blocks(void **unused)
{
	enum { N = 60 };
	struct soup s = {0};
	struct built want;

	(void)unused;
	for (int i = 0; i < N * N; i++) {
		int column = i % N, row = i / N;
		double x = column, y = row;
		double p[4][3] = {{x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}};

		soup_add(&s, p[0], p[1], p[2]);
		soup_add(&s, p[0], p[2], p[3]);
	}
	assert_int_equal(soup_build(&s, 1, &want, NULL), 0);
	assert_int_equal(mp_vertices_count(want.vertices), (N + 1) * (N + 1));
	for (uint64_t key = 2; key < 12; key++) {
		struct mp_vertices *v;
		uint32_t(*out)[3] = malloc(s.count * sizeof *out);
		uint8_t bytes[16] = {(uint8_t)key};

		v = mp_vertices_new(bytes, NULL);
		for (size_t i = 0, n; i < s.count; i += n) {
			n = s.count - i < 7 * key ? s.count - i : 7 * key;
			assert_int_equal(
			    mp_vertices_add(v, (const double(*)[9])s.tri + i, n, out + i, NULL), 0);
		}
		assert_memory_equal(out, want.tri, s.count * sizeof *out);
		mp_vertices_free(v);
		free(out);
	}
	built_free(&want);
	soup_free(&s);
}

/* So many that some share their 32 bits of hash: about N^2 / 2^33 pairs. */
static void equal_hashes_are_told_apart(void **unused)
{
	enum { N = 600000 };
	struct mp_vertices *v = mp_vertices_new(some_key, NULL);
	uint32_t out[1][3];

	(void)unused;
	for (uint32_t i = 0; i < N; i += 3) {
		double tri[1][9] = {{i, 0, 0, i + 1, 0, 0, i + 2, 0, 0}};

		assert_int_equal(mp_vertices_add(v, (const double(*)[9])tri, 1, out, NULL), 0);
		assert_int_equal(out[0][2], i + 2);
	}
	assert_int_equal(mp_vertices_count(v), N);
	mp_vertices_free(v);
}

static void a_failed_allocation_is_reported(void **unused)
{
	struct soup s = {0};
	uint64_t state = 77;
	long n = 0;

	(void)unused;
	for (int i = 0; i < 1500; i++) {
		double t[9];

		for (int k = 0; k < 9; k++)
			t[k] = (double)(soup_random(&state) % 1000) / (i < 1000 ? 1 : 3);
		soup_add(&s, t, t + 3, t + 6);
	}
	for (bool good = false; !good;) {
		struct mp_error err = {.code = MP_OK};
		struct built b;

		alloc_fail_at(++n);
		good = soup_build(&s, 3, &b, &err) == 0;
		alloc_fail_at(0);
		if (good)
			built_free(&b);
		else if (n > 1) /* the first is soup_build's own */
			assert_int_equal(err.code, MP_NOMEM);
		assert_true(n < 100);
	}
	assert_true(n > 8);
	soup_free(&s);
}

/*
 * A large grid of which single triangles come by turns in rows, in no order, and in rows again:
 * the number of a vertex is what counting first appearances by its place in the grid says.
 */
static void large_meshes_are_numbered_in_any_order(void **unused)
{
	enum { N = 250, SIDE = N + 1, T = 2 * N * N };
	uint32_t *number = malloc(SIDE * SIDE * sizeof *number), count = 0;
	double(*tri)[9] = malloc(T * sizeof *tri);
	uint32_t(*want)[3] = malloc(T * sizeof *want), (*out)[3] = malloc(T * sizeof *out);
	uint64_t state = 23;

	(void)unused;
	for (int wide = 0; wide < 2; wide++, count = 0) {
		struct mp_vertices *v = mp_vertices_new(some_key, NULL);

		memset(number, 0xff, SIDE * SIDE * sizeof *number);
		for (unsigned i = 0; i < T; i++) {
			bool ordered = i % 50000 < 30000;
			unsigned at = ordered ? i : (unsigned)(soup_random(&state) % T);
			unsigned square = at / 2, corner = square / N * SIDE + square % N;
			const unsigned c[3] = {corner, corner + 1 + at % 2 * N,
					       corner + 1 + SIDE - at % 2};

			for (unsigned k = 0; k < 3; k++) {
				double x = c[k] % SIDE, y = c[k] / SIDE;

				tri[i][3 * k] = wide ? x / 3 : x;
				tri[i][3 * k + 1] = y;
				tri[i][3 * k + 2] = soup_random(&state) % 2 ? 0.0 : -0.0;
				if (number[c[k]] == UINT32_MAX)
					number[c[k]] = count++;
				want[i][k] = number[c[k]];
			}
		}
		for (size_t i = 0, n; i < T; i += n) {
			n = T - i < 256 ? T - i : 256;
			assert_int_equal(
			    mp_vertices_add(v, (const double(*)[9])tri + i, n, out + i, NULL), 0);
		}
		assert_int_equal(mp_vertices_count(v), count);
		assert_memory_equal(out, want, T * sizeof *out);
		mp_vertices_seal(v);
		for (size_t i = 0; i < T; i += 7) {
			double p[3];

			mp_vertices_get(v, out[i][0], p);
			assert_true(p[0] == tri[i][0] && p[1] == tri[i][1] && p[2] == 0);
		}
		mp_vertices_free(v);
	}
	free(number);
	free(tri);
	free(want);
	free(out);
}

/* What was appended is found, whether more comes as floats or as doubles. */
static void appended_vertices_are_found_later(void **unused)
{
	enum { N = 3000 };
	float(*point)[3] = malloc(N * sizeof *point);
	double(*again)[3] = malloc(N * sizeof *again);
	uint32_t *out = malloc(N * sizeof *out);

	(void)unused;
	for (int form = 0; form < 3; form++) { /* floats, doubles that are floats, others */
		struct mp_vertices *v = mp_vertices_new(some_key, NULL);
		const double third[1][3] = {{1.0 / 3, 0, 0}};
		double p[3];

		for (int i = 0; i < N; i++) {
			point[i][0] = (float)i;
			point[i][1] = i % 2 ? -0.0F : 0.0F;
			point[i][2] = (float)-i;
		}
		mp_vertices_expect(v, form == 0 ? N : 10, form == 1);
		assert_int_equal(mp_vertices_append(v, (const float(*)[3])point, N / 2, NULL), 0);
		assert_int_equal(mp_vertices_append(v, (const float(*)[3])point, 0, NULL), 0);
		if (form == 2)
			assert_int_equal(mp_vertices_add_points(v, third, 1, out, NULL), 0);
		assert_int_equal(
		    mp_vertices_append(v, (const float(*)[3])point + N / 2, N - N / 2, NULL), 0);
		assert_int_equal(mp_vertices_count(v), form == 2 ? N + 1 : N);
		for (int i = 0; i < N; i++)
			for (int k = 0; k < 3; k++)
				again[i][k] = (double)point[i][k];
		assert_int_equal(
		    form == 0
			? mp_vertices_add_float_points(v, (const float(*)[3])point, N, out, NULL)
			: mp_vertices_add_points(v, (const double(*)[3])again, N, out, NULL),
		    0);
		assert_int_equal(mp_vertices_count(v), form == 2 ? N + 1 : N);
		for (uint32_t i = 0; i < N; i++) {
			assert_int_equal(out[i], i + (form == 2 && i >= N / 2));
			mp_vertices_get(v, out[i], p);
			assert_true(p[0] == i && !signbit(p[1]) && p[2] == -(double)i);
		}
		mp_vertices_free(v);
	}
	free(point);
	free(again);
	free(out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(numbers_are_in_order_of_first_appearance),
	    cmocka_unit_test(minus_zero_is_zero),
	    cmocka_unit_test(one_ulp_makes_another_vertex),
	    cmocka_unit_test(every_double_comes_back),
	    cmocka_unit_test(widening_keeps_numbers_and_coordinates),
	    cmocka_unit_test(numbers_depend_on_neither_key_nor_blocks),
	    cmocka_unit_test(equal_hashes_are_told_apart),
	    cmocka_unit_test(a_failed_allocation_is_reported),
	    cmocka_unit_test(large_meshes_are_numbered_in_any_order),
	    cmocka_unit_test(appended_vertices_are_found_later),
	};

	return cmocka_run_group_tests_name("vertices", tests, NULL, NULL);
}
