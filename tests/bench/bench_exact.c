/*
 * Nanoseconds a triangle of the exact sums, for each width and for GMP, on a torus of 10^6
 * triangles; not run by any test.  From the root of the tree, after `make`:
 *
 *	cc -O2 -D_GNU_SOURCE -I. -o /tmp/bench_exact tests/bench/bench_exact.c tests/unit/soup.c \
 *	    build/libmasspropd.a -lgmp -lm && /tmp/bench_exact
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "core/exact/exact.h"
#include "tests/unit/soup.h"

static double now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* ${step} > 0: coordinates as multiples of it; 0: as float32; < 0: as they are. */
static void torus(struct soup *s, unsigned n, double step)
{
	soup_torus(s, n, n, 100, 40);
	for (size_t i = 0; i < s->count; i++)
		for (int k = 0; k < 9; k++) {
			double *x = &s->tri[i][k];

			if (step > 0)
				*x = step * rint(*x / step);
			else if (step == 0)
				*x = (double)(float)*x;
		}
}

enum way { AS_FOUND, BY_DIGITS, BY_GMP };

static void measure(const char *name, unsigned n, double step, enum way way)
{
	struct soup soup = {0};
	struct built built;
	struct mp_exact_grid grid;
	struct mp_exact e;
	struct mp_exact_value v;
	unsigned bits = 0;
	int lossless = 0;
	double best = INFINITY, grid_s = INFINITY;

	torus(&soup, n, step);
	if (soup_build(&soup, 1, &built, NULL))
		abort();
	for (int i = 0; i < 9; i++) {
		double start = now();

		if (mp_exact_grid_find(&built.mesh, &grid, NULL))
			abort();
		grid_s = fmin(grid_s, now() - start);
		if (way == BY_GMP)
			grid.bits = 0;
		for (uint32_t v = 0; way == BY_DIGITS && v < mp_vertices_count(built.vertices); v++)
			grid.q[v][0] = MP_EXACT_OFF;
		start = now();
		if (mp_exact_find(&built.mesh, &grid, NULL, built.mesh.triangles, &e, NULL))
			abort();
		best = fmin(best, now() - start);
		mp_exact_volume(&e, &v);
		mp_exact_free(&e);
		lossless = grid.lossless;
		bits = grid.bits;
		mp_exact_grid_free(&grid);
	}
	printf("%-28s %2u bits %-9s %8.1f ns, grid %.1f ns a triangle; volume %.17g\n", name, bits,
	       lossless ? "lossless" : "", best * 1e9 / (double)soup.count,
	       grid_s * 1e9 / (double)soup.count, v.value);
	built_free(&built);
	soup_free(&soup);
}

int main(void)
{
	measure("multiples of 2^-20", 708, 0x1p-20, AS_FOUND);
	measure("multiples of 2^-40", 708, 0x1p-40, AS_FOUND);
	measure("multiples of 2^-50", 708, 0x1p-50, AS_FOUND);
	measure("float32 (sin noise near 0)", 708, 0, AS_FOUND);
	measure("double (sin noise near 0)", 708, -1, AS_FOUND);
	measure("float32, all by digits", 224, 0, BY_DIGITS);
	measure("float32, all through GMP", 224, 0, BY_GMP);
	measure("double, all through GMP", 224, -1, BY_GMP);
	return 0;
}
