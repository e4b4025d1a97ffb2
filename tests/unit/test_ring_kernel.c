/* Every kernel finds the same rings of links, and those that there are. */
#include "core/topology/ring_kernel.h"

#include <setjmp.h>
#include <stdalign.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "soup.h"

enum { MOST = 5, LOW = 100 };

static bool says(const struct mp_ring_kernel *k, const struct mp_ring_line *line,
		 const uint8_t *links, uint32_t count, uint32_t *label)
{
	for (uint32_t i = 0; i < count; i++)
		label[i] = UINT32_MAX;
	return k->look(line, links, count, LOW, label);
}

static uint32_t leaves_for(uint64_t link)
{
	return (uint32_t)(link >> 32);
}

static void leave_for(uint64_t *link, uint32_t vertex)
{
	*link = (uint64_t)vertex << 32 | (uint32_t)*link;
}

static void come_from(uint64_t *link, uint32_t vertex)
{
	*link = *link >> 32 << 32 | vertex;
}

/* By definition: the walk from the first link is home after n steps and no sooner. */
static bool is_ring(const struct mp_ring_line *line, unsigned n)
{
	unsigned at = 0;

	for (unsigned step = 1; step <= n; step++) {
		unsigned next = 0;

		while (next < n && leaves_for(line->link[next]) != (uint32_t)line->link[at])
			next++;
		if (next == n || (next == 0) != (step == n))
			return false;
		at = next;
	}
	return n > 2;
}

/* Links of neighbours ${name}[0 .. n), one ring, with ${damage} of them changed. */
static void make_line(struct mp_ring_line *line, unsigned n, unsigned damage, uint64_t *state)
{
	uint32_t name[MP_RING_LINE];

	memset(line, soup_random(state) % 2 ? 0xff : 0, sizeof *line); /* behind them: anything */
	for (unsigned i = 0; i < MP_RING_LINE; i++)
		come_from(&line->link[i], (uint32_t)(soup_random(state) % 200));
	for (unsigned i = 0; i < n; i++)
		name[i] = 60 + 10 * i + (uint32_t)(soup_random(state) % 10);
	for (unsigned i = n; i > 1; i--) {
		unsigned j = (unsigned)(soup_random(state) % i);
		uint32_t keep = name[j];

		name[j] = name[i - 1];
		name[i - 1] = keep;
	}
	for (unsigned i = 0; i < n; i++) {
		unsigned at = (i * 3 + 1) % n; /* in no order, where n is no multiple of 3 */

		at = n % 3 == 0 ? i : at;
		leave_for(&line->link[at], name[i]);
		come_from(&line->link[at], name[(i + 1) % n]);
	}
	for (unsigned i = 0; i < damage && n > 0; i++) {
		unsigned at = (unsigned)(soup_random(state) % n);
		uint32_t other = leaves_for(line->link[soup_random(state) % n]);

		if (soup_random(state) % 2)
			come_from(&line->link[at], other);
		else
			leave_for(&line->link[at], other);
	}
}

static void kernels_find_rings(void **unused)
{
	alignas(64) struct mp_ring_line line[MOST];
	uint8_t links[MOST];
	uint64_t state = 3;
	int good = 0, bad = 0;

	(void)unused;
	for (int round = 0; round < 40000; round++) {
		unsigned n = (unsigned)(soup_random(&state) % (MP_RING_LINE + 1));
		bool want;

		make_line(line, n, (unsigned)(soup_random(&state) % 3), &state);
		links[0] = (uint8_t)n;
		want = n == 0 || is_ring(line, n);
		good += want;
		bad += !want;
		for (size_t k = 0; k < mp_ring_kernel_count(); k++) {
			uint32_t label[1], smallest = LOW;

			assert_int_equal(says(mp_ring_kernel_get(k), line, links, 1, label), want);
			for (unsigned i = 0; i < n; i++)
				if (leaves_for(line[0].link[i]) < smallest)
					smallest = leaves_for(line[0].link[i]);
			if (want)
				assert_int_equal(label[0], smallest);
		}
	}
	assert_true(good > 10000 && bad > 10000);
}

/* A permutation of two or more cycles has every link's successor, too. */
static void several_rings_are_none(void **unused)
{
	static const uint8_t next[][MP_RING_LINE] = {{1, 2, 0, 4, 5, 3},
						     {1, 0, 3, 4, 2},
						     {1, 2, 3, 0, 5, 6, 7, 4},
						     {0, 2, 3, 1},
						     {1, 2, 3, 4, 5, 6, 7, 1}};
	static const uint8_t count[] = {6, 5, 8, 4, 8};
	alignas(64) struct mp_ring_line line[1];
	uint32_t label[1];

	(void)unused;
	for (size_t c = 0; c < sizeof count; c++) {
		memset(line, 0, sizeof line);
		for (unsigned i = 0; i < count[c]; i++) {
			leave_for(&line[0].link[i], 7 + i);
			come_from(&line[0].link[i], 7u + next[c][i]);
		}
		for (size_t k = 0; k < mp_ring_kernel_count(); k++)
			assert_false(says(mp_ring_kernel_get(k), line, &count[c], 1, label));
	}
}

/* One bad vertex anywhere; too many links are not for the kernel to judge. */
static void every_vertex_is_looked_at(void **unused)
{
	alignas(64) struct mp_ring_line line[MOST];
	uint8_t links[MOST];
	uint32_t label[MOST];
	uint64_t state = 9;

	(void)unused;
	for (unsigned i = 0; i < MOST; i++) {
		links[i] = (uint8_t)(i + 4);
		make_line(&line[i], i + 4, 0, &state);
	}
	for (size_t k = 0; k < mp_ring_kernel_count(); k++) {
		const struct mp_ring_kernel *kernel = mp_ring_kernel_get(k);

		assert_true(says(kernel, line, links, MOST, label));
		for (unsigned i = 0; i < MOST; i++) {
			uint64_t keep = line[i].link[1];

			come_from(&line[i].link[1], 3);
			assert_false(says(kernel, line, links, MOST, label));
			links[i] = MP_RING_LINE + 1;
			assert_true(says(kernel, line, links, MOST, label));
			links[i] = (uint8_t)(i + 4);
			line[i].link[1] = keep;
		}
		assert_true(says(kernel, line, links, 0, label));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(kernels_find_rings),
	    cmocka_unit_test(several_rings_are_none),
	    cmocka_unit_test(every_vertex_is_looked_at),
	};

	return cmocka_run_group_tests_name("ring_kernel", tests, NULL, NULL);
}
