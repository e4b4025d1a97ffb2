#include "core/fingerprint/fingerprint.h"

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/decoder.h"
#include "core/fingerprint/fingerprint_kernel.h"
#include "tests/unit/mesh_random.h"

static const uint8_t KEY[16] = {7, 1, 2, 9};

/* Bytes in the order of the standard. */
static void block_of(const char *hex, uint64_t out[2])
{
	out[0] = out[1] = 0;
	for (unsigned i = 0; i < 16; i++) {
		char byte[3] = {hex[2 * i], hex[2 * i + 1], '\0'};

		out[i / 8] |= (uint64_t)strtoul(byte, NULL, 16) << 8 * (i % 8);
	}
}

/* FIPS 197, appendix B and C.1; SP 800-38A, F.1.1. */
static void test_aes_is_the_standard(void **unused)
{
	static const char *const VECTORS[][3] = {
	    {"2b7e151628aed2a6abf7158809cf4f3c", "3243f6a8885a308d313198a2e0370734",
	     "3925841d02dc09fbdc118597196a0b32"},
	    {"000102030405060708090a0b0c0d0e0f", "00112233445566778899aabbccddeeff",
	     "69c4e0d86a7b0430d8cdb78070b4c55a"},
	    {"2b7e151628aed2a6abf7158809cf4f3c", "6bc1bee22e409f96e93d7e117393172a",
	     "3ad77bb40d7a3660a89ecaf32466ef97"},
	    {"2b7e151628aed2a6abf7158809cf4f3c", "f69f2445df4f9b17ad2b417be66c3710",
	     "7b0c785e27e8ad3f8223207104725dd4"},
	};

	(void)unused;
	for (size_t i = 0; i < sizeof VECTORS / sizeof *VECTORS; i++) {
		uint64_t key[2], in[1][2], want[2], out[1][2];
		struct mp_aes aes;

		block_of(VECTORS[i][0], key);
		block_of(VECTORS[i][1], in[0]);
		block_of(VECTORS[i][2], want);
		mp_aes_expand(&aes, key);
		mp_aes_encrypt(&aes, (const uint64_t(*)[2])in, out, 1);
		assert_memory_equal(out[0], want, sizeof want);
	}
}

/* However many are side by side, and in place. */
static void test_every_block_is_encrypted_alone(void **unused)
{
	static const size_t COUNT[] = {1, 2, 63, 64, 65, 200, 255, 256};
	uint64_t state = 1, in[MP_AES_BLOCKS][2], out[MP_AES_BLOCKS][2], one[2];
	struct mp_aes aes;

	(void)unused;
	mp_aes_expand(&aes, (const uint64_t[2]){random_bits(&state), random_bits(&state)});
	for (size_t i = 0; i < MP_AES_BLOCKS; i++)
		in[i][0] = random_bits(&state), in[i][1] = random_bits(&state);
	for (size_t k = 0; k < sizeof COUNT / sizeof *COUNT; k++) {
		memcpy(out, in, sizeof out);
		mp_aes_encrypt(&aes, (const uint64_t(*)[2])out, out, COUNT[k]);
		for (size_t i = 0; i < COUNT[k]; i++) {
			mp_aes_encrypt(&aes, (const uint64_t(*)[2])(in + i), &one, 1);
			assert_memory_equal(out[i], one, sizeof one);
		}
		if (COUNT[k] < MP_AES_BLOCKS)
			assert_memory_equal(out[COUNT[k]], in[COUNT[k]], sizeof one);
	}
}

/* A coordinate of every kind that there is. */
static double coordinate(uint64_t *state, unsigned kind)
{
	static const double ODD[] = {
	    0.0,          -0.0,        FLT_MAX, -FLT_MAX, FLT_MIN,   0x1p-149, 0x1p-150,
	    0x1p-140,     0x1.8p-127,  DBL_MAX, DBL_MIN,  0x1p-1074, 0x1p128,  -0x1.fffffep-127,
	    0x1.000002p0, 0x1.000001p0};
	double x = random_between(state, -1000, 1000);
	float f = (float)x;
	uint32_t bits;

	if (kind == 2 && random_chance(state, 0.2))
		return ODD[random_bits(state) % (sizeof ODD / sizeof *ODD)];
	if (kind == 1 && random_chance(state, 0.1))
		return x;
	if (kind == 0 && random_chance(state, 0.1))
		f = random_chance(state, 0.5) ? -0.0f : 0x1p-149f;
	memcpy(&bits, &f, sizeof bits); /* no shortcut from double to double */
	memcpy(&f, &bits, sizeof f);
	return (double)f;
}

static double (*block(uint64_t *state, unsigned kind, size_t count))[9]
{
	double(*tri)[9] = malloc(count * sizeof *tri);

	assert_non_null(tri);
	for (size_t i = 0; i < 9 * count; i++)
		tri[i / 9][i % 9] = coordinate(state, kind);
	return tri;
}

/* Triangles of floats have the same sums in both forms. */
static void check_floats(const struct mp_fingerprint *f, const double (*tri)[9], size_t count)
{
	float(*xyz)[MP_BLOCK] = malloc(9 * sizeof *xyz);
	struct mp_fingerprint best = *f;
	uint64_t want[2] = {7, 8};

	assert_non_null(xyz);
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 9; k++) {
			xyz[k][i] = (float)tri[i][k];
			assert_true((double)xyz[k][i] == tri[i][k]);
		}
	mp_fingerprint_kernel(0)->add(f->key, tri, count, want);
	for (size_t k = 0; k < mp_fingerprint_kernels(); k++) {
		uint64_t sum[2] = {7, 8};

		mp_fingerprint_kernel(k)->add_floats(f->key, (const float(*)[MP_BLOCK])xyz, count,
						     sum);
		assert_memory_equal(sum, want, sizeof sum);
	}
	best.sum[0] = 7;
	best.sum[1] = 8;
	mp_fingerprint_add_floats(&best, (const float(*)[MP_BLOCK])xyz, count);
	assert_memory_equal(best.sum, want, sizeof want);
	free(xyz);
}

static void test_all_kernels_compute_the_same(void **unused)
{
	uint64_t state = 2;
	struct mp_fingerprint f;

	(void)unused;
	mp_fingerprint_begin(&f, KEY);
	print_message("# kernels:");
	for (size_t k = 0; k < mp_fingerprint_kernels(); k++)
		print_message(" %s", mp_fingerprint_kernel(k)->name);
	print_message("\n");
	for (unsigned i = 0; i < 600; i++) {
		size_t count = i < 20 ? i + 1 : i % 30 == 0 ? 256 : 1 + random_bits(&state) % 256;
		double(*tri)[9] = block(&state, i % 3, count);
		uint64_t want[2] = {5, 6}, best[2] = {5, 6};

		mp_fingerprint_kernel(0)->add(f.key, (const double(*)[9])tri, count, want);
		for (size_t k = 1; k < mp_fingerprint_kernels(); k++) {
			uint64_t sum[2] = {5, 6};

			mp_fingerprint_kernel(k)->add(f.key, (const double(*)[9])tri, count, sum);
			assert_memory_equal(sum, want, sizeof sum);
		}
		if (i % 3 == 0)
			check_floats(&f, (const double(*)[9])tri, count);
		memcpy(f.sum, best, sizeof best);
		mp_fingerprint_add(&f, (const double(*)[9])tri, count);
		assert_memory_equal(f.sum, want, sizeof want);
		assert_true(want[0] != want[1]);
		free(tri);
	}
}

/* The sums over the triangles ${m} with a key that ends in ${key}. */
static struct mp_fingerprint sums(const struct mesh *m, uint8_t key)
{
	uint8_t secret[16] = {[15] = key};
	struct mp_fingerprint f;

	mp_fingerprint_begin(&f, secret);
	for (size_t at = 0; at < m->count; at += MP_BLOCK) {
		size_t n = m->count - at < MP_BLOCK ? m->count - at : MP_BLOCK;

		mp_fingerprint_add(&f, (const double(*)[9])(m->tri + at), n);
	}
	return f;
}

static bool closed(const struct mesh *m)
{
	struct mp_fingerprint f = sums(m, 1), g = sums(m, 2);

	assert_int_equal(mp_fingerprint_closed(&f), mp_fingerprint_closed(&g));
	return mp_fingerprint_closed(&f);
}

static const double LOW[3] = {0, 0, 0}, HIGH[3] = {1, 2, 3};

static void test_the_key_decides_the_sums(void **unused)
{
	struct mesh m = {0};
	struct mp_fingerprint f, g, h;

	(void)unused;
	mesh_box(&m, LOW, HIGH);
	m.count--;
	f = sums(&m, 1);
	g = sums(&m, 2);
	h = sums(&m, 1);
	assert_memory_equal(f.sum, h.sum, sizeof f.sum);
	assert_true(f.sum[0] != g.sum[0] && f.sum[1] != g.sum[1]);
	assert_true(f.sum[0] != f.sum[1] && f.sum[0] != 0 && f.sum[1] != 0);
	assert_memory_not_equal(f.key[0].round, f.key[1].round, sizeof f.key[0].round);
	mesh_free(&m);
}

static void test_a_closed_mesh_is_closed(void **unused)
{
	struct mesh m = {0};

	(void)unused;
	assert_true(closed(&m));
	mesh_box(&m, LOW, HIGH);
	mesh_sphere(&m, 1.1, 30, 20);
	mesh_torus(&m, 3.3, 1, 40, 30);
	assert_true(closed(&m));
	mesh_flip(&m, 12);
	assert_true(closed(&m));
	for (size_t i = 0; i < m.count; i++) { /* other corners first, then the last triangle */
		double t[9];

		memcpy(t, m.tri[i], sizeof t);
		memcpy(m.tri[i], t + 3 * (i % 3), (9 - 3 * (i % 3)) * sizeof *t);
		memcpy(m.tri[i] + (9 - 3 * (i % 3)), t, 3 * (i % 3) * sizeof *t);
	}
	assert_true(closed(&m));
	mesh_free(&m);
}

/* An edge that is used one time too few, too many, or the wrong way round. */
static void test_any_triangle_can_open_it(void **unused)
{
	struct mesh m = {0};

	(void)unused;
	mesh_sphere(&m, 1.1, 9, 7);
	for (size_t i = 0; i < m.count; i++) {
		double last[9], t[9];

		memcpy(t, m.tri[i], sizeof t);
		memcpy(last, m.tri[m.count - 1], sizeof last);
		memcpy(m.tri[i], last, sizeof last);
		m.count--;
		assert_false(closed(&m));
		m.count++;
		memcpy(m.tri[m.count - 1], last, sizeof last);
		memcpy(m.tri[i], t + 3, 3 * sizeof *t);
		memcpy(m.tri[i] + 3, t, 3 * sizeof *t);
		memcpy(m.tri[i] + 6, t + 6, 3 * sizeof *t);
		assert_false(closed(&m));
		memcpy(m.tri[i], t, sizeof t);
		m.tri[i][4] += 0x1p-52;
		assert_int_equal(closed(&m), m.tri[i][4] == t[4]);
		m.tri[i][4] = t[4];
		assert_true(closed(&m));
	}
	mesh_free(&m);
}

/* Single triangles used 2^k times more one way: 2^k divides all counts and so the sums. */
static void test_even_counts_do_not_hide(void **unused)
{
	struct mesh m = {0};

	(void)unused;
	mesh_triangle(&m, LOW, HIGH, (const double[3]){5, 6, 9});
	while (m.count < 4096) {
		size_t count = m.count;

		assert_false(closed(&m));
		for (size_t i = 0; i < count; i++) {
			double t[9]; /* the list may move */

			memcpy(t, m.tri[i], sizeof t);
			mesh_triangle(&m, t, t + 3, t + 6);
		}
	}
	assert_false(closed(&m));
	mesh_free(&m);
}

static void test_a_corner_twice_adds_nothing(void **unused)
{
	const double *const P[] = {LOW, HIGH};

	(void)unused;
	for (unsigned i = 0; i < 8; i++) {
		struct mesh m = {0};

		mesh_triangle(&m, P[i & 1], P[i >> 1 & 1], P[i >> 2]);
		m.tri[0][0] += 0.1; /* no float */
		m.tri[0][3] += 0.1;
		m.tri[0][6] += 0.1;
		assert_true(closed(&m));
		mesh_free(&m);
	}
}

static void test_the_sign_of_zero_does_not_count(void **unused)
{
	struct mesh m = {0};

	(void)unused;
	for (int wide = 0; wide < 2; wide++) {
		mesh_box(&m, LOW, (const double[3]){wide ? 0.1 : 1, 2, 3});
		assert_true(closed(&m));
		for (size_t i = 0; i < m.count; i += 2)
			for (int k = 0; k < 9; k++)
				if (m.tri[i][k] == 0)
					m.tri[i][k] = -0.0;
		assert_true(closed(&m));
		mesh_free(&m);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_aes_is_the_standard),
	    cmocka_unit_test(test_every_block_is_encrypted_alone),
	    cmocka_unit_test(test_all_kernels_compute_the_same),
	    cmocka_unit_test(test_the_key_decides_the_sums),
	    cmocka_unit_test(test_a_closed_mesh_is_closed),
	    cmocka_unit_test(test_any_triangle_can_open_it),
	    cmocka_unit_test(test_even_counts_do_not_hide),
	    cmocka_unit_test(test_a_corner_twice_adds_nothing),
	    cmocka_unit_test(test_the_sign_of_zero_does_not_count),
	};

	return cmocka_run_group_tests_name("fingerprint", tests, NULL, NULL);
}
