#include "core/moments/moments_kernel.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/moments/moments.h"
#include "tests/unit/mesh_random.h"

/* Of ${mesh}, in blocks of ${block}, from copies of exactly their size. */
static struct mp_moments sums(const struct mesh *mesh, const struct mp_kernel *kernel, size_t block,
			      const struct mp_moments *first)
{
	struct mp_moments m;

	if (first == NULL)
		mp_moments_begin(&m);
	else
		mp_moments_begin_again(&m, first);
	for (size_t at = 0; at < mesh->count; at += block) {
		size_t count = mesh->count - at < block ? mesh->count - at : block;
		double(*copy)[9] = malloc(count * sizeof *copy);

		assert_non_null(copy);
		memcpy(copy, mesh->tri + at, count * sizeof *copy);
		mp_moments_add_with(&m, (const double(*)[9])copy, count, kernel);
		free(copy);
	}
	return m;
}

/* The same of floats. */
static struct mp_moments float_sums(const struct mesh *mesh, const struct mp_kernel *kernel,
				    size_t block, const struct mp_moments *first)
{
	struct mp_moments m;

	if (first == NULL)
		mp_moments_begin(&m);
	else
		mp_moments_begin_again(&m, first);
	for (size_t at = 0; at < mesh->count; at += block) {
		size_t count = mesh->count - at < block ? mesh->count - at : block;
		float(*xyz)[MP_BLOCK] = malloc(9 * sizeof *xyz);

		assert_non_null(xyz);
		for (size_t i = 0; i < count; i++)
			for (size_t k = 0; k < 9; k++)
				xyz[k][i] = (float)mesh->tri[at + i][k];
		if (kernel != NULL)
			mp_moments_add_floats_with(&m, (const float(*)[MP_BLOCK])xyz, count,
						   kernel);
		else
			mp_moments_add_floats(&m, (const float(*)[MP_BLOCK])xyz, count);
		free(xyz);
	}
	return m;
}

static void assert_same(const struct mp_moments *a, const struct mp_moments *b, const char *kernel)
{
	const size_t first = offsetof(struct mp_moments, a0);

	if (memcmp(a->reference, b->reference, sizeof a->reference) != 0 ||
	    memcmp((const char *)a + first, (const char *)b + first, sizeof *a - first) != 0)
		fail_msg("kernel %s gives other bits", kernel);
}

/* In every size of block, with and without scaling. */
static void test_all_kernels_give_the_same_bits(void **unused)
{
	static const size_t BLOCK[] = {1, 7, 8, 9, 63, 64, 65, 255, 256};
	uint64_t state = 5;
	unsigned narrow = 0;

	(void)unused;
	print_message("# kernels:");
	for (size_t k = 0; k < mp_kernel_count(); k++)
		print_message(" %s", mp_kernel_get(k)->name);
	print_message("\n");
	for (int i = 0; i < 300; i++) {
		size_t block = BLOCK[(size_t)i % (sizeof BLOCK / sizeof *BLOCK)];
		struct random_mesh r;
		struct mp_moments plain, again;

		mesh_random(&r, &state);
		plain = sums(&r.mesh, mp_kernel_get(0), block, NULL);
		again = sums(&r.mesh, mp_kernel_get(0), block, &plain);
		for (size_t k = 1; k < mp_kernel_count(); k++) {
			const struct mp_kernel *kernel = mp_kernel_get(k);
			struct mp_moments m = sums(&r.mesh, kernel, block, NULL);

			assert_same(&m, &plain, kernel->name);
			m = sums(&r.mesh, kernel, block, &plain);
			assert_same(&m, &again, kernel->name);
		}
		for (size_t k = 0; r.narrow && k < mp_kernel_count(); k++) {
			const struct mp_kernel *kernel = mp_kernel_get(k);
			struct mp_moments m = float_sums(&r.mesh, kernel, block, NULL);

			assert_same(&m, &plain, kernel->name);
			m = float_sums(&r.mesh, kernel, block, &plain);
			assert_same(&m, &again, kernel->name);
			narrow++;
		}
		mesh_free(&r.mesh);
	}
	assert_true(narrow > 30);
}

/* What mp_moments_add() takes is one of them. */
static void test_the_best_kernel_is_used(void **unused)
{
	uint64_t state = 6;
	struct random_mesh r;
	struct mp_moments m, best, floats;
	size_t count;

	(void)unused;
	mesh_random(&r, &state);
	count = r.mesh.count < 200 ? r.mesh.count : 200;
	mp_moments_begin(&m);
	mp_moments_add(&m, (const double(*)[9])r.mesh.tri, count);
	r.mesh.count = count;
	best = sums(&r.mesh, mp_kernel_get(mp_kernel_count() - 1), 256, NULL);
	assert_same(&m, &best, "best");
	while (!r.narrow) {
		mesh_free(&r.mesh);
		mesh_random(&r, &state);
	}
	best = sums(&r.mesh, mp_kernel_get(0), 256, NULL);
	floats = float_sums(&r.mesh, NULL, 256, NULL);
	assert_same(&floats, &best, "best of floats");
	assert_int_equal(m.blocks, 1);
	assert_int_equal(m.triangles, count);
	mesh_free(&r.mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_all_kernels_give_the_same_bits),
	    cmocka_unit_test(test_the_best_kernel_is_used),
	};

	return cmocka_run_group_tests_name("moments_kernel", tests, NULL, NULL);
}
