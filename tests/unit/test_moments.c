#include "core/moments/moments.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/decoder.h"
#include "tests/unit/report_of.h"

/* A copy of exactly the block, so that a sanitizer sees what a kernel reads behind it. */
static void add(struct mp_moments *m, const struct mesh *mesh)
{
	for (size_t at = 0; at < mesh->count; at += MP_BLOCK) {
		size_t count = mesh->count - at < MP_BLOCK ? mesh->count - at : MP_BLOCK;
		double(*block)[9] = malloc(count * sizeof *block);

		assert_non_null(block);
		memcpy(block, mesh->tri + at, count * sizeof *block);
		mp_moments_add(m, (const double(*)[9])block, count);
		free(block);
	}
}

static void sum(struct mp_moments *m, const struct mesh *mesh)
{
	mp_moments_begin(m);
	add(m, mesh);
}

static struct mp_solid solve(const struct mesh *mesh)
{
	struct mp_moments m;
	struct mp_solid solid;

	sum(&m, mesh);
	mp_moments_solve(&m, &solid);
	return solid;
}

static void assert_box(const struct mp_solid *s, const double min[3], const double max[3],
		       double tolerance)
{
	double side[3], volume;

	for (int k = 0; k < 3; k++)
		side[k] = max[k] - min[k];
	volume = side[0] * side[1] * side[2];
	assert_true(s->in_range && s->area_in_range && s->has_centroid && s->has_surface_centroid);
	assert_relative((double)s->volume, volume, tolerance);
	assert_relative((double)s->area,
			2 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]), tolerance);
	for (int k = 0; k < 3; k++) {
		assert_near((double)s->centroid[k], (min[k] + max[k]) / 2, tolerance * side[k]);
		assert_near((double)s->surface_centroid[k], (min[k] + max[k]) / 2,
			    tolerance * side[k]);
		assert_relative((double)s->cov[k], side[k] * side[k] / 12, tolerance);
		assert_near((double)s->cov[3 + k], 0, tolerance * side[k] * side[(k + 1) % 3]);
		assert_near((double)s->vector_area[k], 0, 0);
	}
}

static void test_box_of_integers_is_exact(void **state)
{
	const double min[3] = {0, 0, 0}, max[3] = {40, 30, 20};
	struct mesh m = {0};
	struct mp_solid s;

	(void)state;
	mesh_box(&m, min, max);
	s = solve(&m);
	assert_box(&s, min, max, 1e-19);
	assert_false(s.again);
	mesh_free(&m);
}

static void test_empty_sum_is_nothing(void **state)
{
	struct mesh m = {0};
	struct mp_solid s = solve(&m);

	(void)state;
	assert_true(s.volume == 0 && s.area == 0 && !s.has_centroid && !s.again);
}

static void test_box_of_vertices(void **state)
{
	static const double TRI[2][9] = {{1, -2, 3, -0.0, 5, -6, 7, 8, -9},
					 {0, 0, 0, 0, 9, 0, 0, 0, 3.5}};
	struct mp_moments m;

	(void)state;
	mp_moments_begin(&m);
	mp_moments_add(&m, TRI, 1);
	mp_moments_add(&m, TRI + 1, 1);
	assert_true(m.min[0] == 0 && !signbit(m.min[0]) && m.min[1] == -2 && m.min[2] == -9);
	assert_true(m.max[0] == 7 && m.max[1] == 9 && m.max[2] == 3.5);
	assert_true(m.reference[0] == 1 && m.reference[1] == -2 && m.reference[2] == 3);
	assert_int_equal(m.triangles, 2);
}

/* A lane takes triangles j, j + 8, ..., 64 a round; lanes are folded 8 to 4 to 2 to 1. */
static void test_order_of_summation_is_fixed(void **state)
{
	struct mesh m = {0};
	double lane[8] = {0}, round[8] = {0}, total, area;
	struct mp_moments sums;

	(void)state;
	mesh_sphere(&m, 1.7, 23, 4); /* 138 triangles: a block that is no multiple of 8 */
	mesh_move(&m, 0, 0.1, 0.2, 0.3);
	sum(&sums, &m);
	for (size_t i = 0; i < m.count; i++) {
		const double *q = m.tri[i];
		double e[3], f[3], n[3];

		for (int k = 0; k < 3; k++) {
			e[k] = q[3 + k] - q[k];
			f[k] = q[6 + k] - q[k];
		}
		for (int k = 0; k < 3; k++)
			n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
		area = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
		round[i % 8] += area;
		for (int j = 0; j < 8 && (i % 64 == 63 || i + 1 == m.count); j++) {
			lane[j] += round[j];
			round[j] = 0;
		}
	}
	total = ((lane[0] + lane[4]) + (lane[2] + lane[6])) +
		((lane[1] + lane[5]) + (lane[3] + lane[7]));
	assert_true(sums.area2.hi == total && sums.area2.lo == 0);
	mesh_free(&m);
}

/* Moved by a number that shifts no digit out, every result but the centroid is the same. */
static void test_far_from_the_origin_nothing_is_lost(void **state)
{
	struct mesh m = {0};
	struct mp_solid near, far;

	(void)state;
	mesh_torus(&m, 3, 1, 40, 20);
	for (size_t i = 0; i < 9 * m.count; i++) /* a grid of 2^-26 */
		m.tri[i / 9][i % 9] = nearbyint(ldexp(m.tri[i / 9][i % 9], 26)) * 0x1p-26;
	near = solve(&m);
	mesh_move(&m, 0, 1e6, 2e6, -3e6);
	far = solve(&m);
	assert_true(near.volume == far.volume && near.area == far.area);
	for (int k = 0; k < 6; k++)
		assert_true(near.cov[k] == far.cov[k]);
	for (int k = 0; k < 3; k++)
		assert_near((double)(far.centroid[k] - (long double)(k == 0   ? 1e6
								     : k == 1 ? 2e6
									      : -3e6)),
			    (double)near.centroid[k], 1e-12);
	mesh_free(&m);
}

/*
 * A globe of planar quadrilaterals: between two rings a frustum of regular polygons.  The same
 * long double formula for any number of them, so a million triangles test the summation.
 */
static void test_sphere_of_a_million_triangles(void **state)
{
	enum { AROUND = 1000, UP = 500 };
	struct mesh m = {0};
	struct mp_solid s;
	long double volume = 0, area = 0, chord = 2 * sinl(acosl(-1) / AROUND);
	long double polygon = AROUND / 2.0L * sinl(2 * acosl(-1) / AROUND);

	(void)state;
	mesh_sphere(&m, 1, AROUND, UP);
	for (int j = 0; j < UP; j++) {
		long double a = acosl(-1) * j / UP, b = acosl(-1) * (j + 1) / UP;
		long double h = cosl(a) - cosl(b), r = sinl(a), t = sinl(b);
		long double flat = cosl(acosl(-1) / AROUND) * (r - t);

		volume += polygon * h / 3 * (r * r + r * t + t * t);
		area += AROUND * chord * (r + t) / 2 * sqrtl(h * h + flat * flat);
	}
	s = solve(&m);
	assert_int_equal(m.count, 998000);
	assert_relative((double)s.volume, (double)volume, 1e-15);
	assert_relative((double)s.area, (double)area, 1e-15);
	for (int k = 0; k < 3; k++)
		assert_near((double)s.centroid[k], 0, 1e-16);
	assert_true(s.volume_bound < 1e-13L * s.volume);
	assert_true(fabsl(s.volume - volume) < s.volume_bound);
	mesh_free(&m);
}

/*
 * A ring of regular polygons: between two meridian planes at angle alpha every ring of radius x
 * is a chord, so integrals over the section carry over: V = n sin(alpha) R A, and so on.
 */
static void test_torus_has_its_closed_form(void **state)
{
	const long double big = 3, r = 1, turn = 2 * acosl(-1);
	const int around = 48, section = 20;
	long double alpha = turn / around, s = sinl(alpha / 2), c = cosl(alpha / 2), side;
	long double area, square, spread, x2, z2;
	struct mesh m = {0};
	struct mp_solid solid;

	(void)state;
	mesh_torus(&m, 3, 1, around, section);
	side = 2 * r * sinl(turn / 2 / section);
	area = section / 2.0L * r * r * sinl(turn / section);
	square = area * (6 * r * r - side * side) / 24; /* of the polygon about its centre line */
	/* integral of x^3: third moments of the polygon about its centre are 0 */
	spread = around * sinl(alpha) * (big * big * big * area + 3 * big * square);
	x2 = spread * (c * c + s * s / 3) / 2; /* half of x^2 + y^2 */
	z2 = around * sinl(alpha) * big * square;
	solid = solve(&m);
	assert_relative((double)solid.volume, (double)(around * sinl(alpha) * big * area), 2e-15);
	assert_relative((double)(solid.cov[0] * solid.volume), (double)x2, 4e-15);
	assert_relative((double)(solid.cov[1] * solid.volume), (double)x2, 4e-15);
	assert_relative((double)(solid.cov[2] * solid.volume), (double)z2, 4e-15);
	for (int k = 0; k < 3; k++) {
		assert_near((double)solid.centroid[k], 0, 4e-15);
		assert_near((double)solid.cov[3 + k], 0, 4e-15);
		assert_true(solid.vector_area[k] == 0); /* not the noise of the sum */
	}
	mesh_free(&m);
}

/*
 * The volume integrals as surface integrals of polynomials (divergence theorem) by a four-point
 * rule of degree 3, exact for them: weight 25/96 of twice the area at the permutations of
 * (9,3,3)/15, -27/96 at the middle.  Another road to the same ten numbers.
 */
static void gauss(const struct mesh *m, long double out[10])
{
	static const double POINT[4][3] = {{9, 3, 3}, {3, 9, 3}, {3, 3, 9}, {5, 5, 5}};
	static const int NEXT[3] = {1, 2, 0};

	memset(out, 0, 10 * sizeof *out);
	for (size_t i = 0; i < m->count; i++) {
		const double *t = m->tri[i];
		long double n[3];

		for (int k = 0; k < 3; k++) {
			int a = NEXT[k], b = NEXT[a];

			n[k] = ((long double)t[3 + a] - t[a]) * ((long double)t[6 + b] - t[b]) -
			       ((long double)t[3 + b] - t[b]) * ((long double)t[6 + a] - t[a]);
		}
		for (int g = 0; g < 4; g++) {
			long double w = (g < 3 ? 25.0L : -27.0L) / 96, x[3];

			for (int k = 0; k < 3; k++)
				x[k] = (POINT[g][0] * t[k] + POINT[g][1] * t[3 + k] +
					POINT[g][2] * t[6 + k]) /
				       15;
			for (int k = 0; k < 3; k++) {
				out[0] += w * n[k] * x[k] / 3;
				out[1 + k] += w * n[k] * x[k] * x[k] / 2;
				out[4 + k] += w * n[k] * x[k] * x[k] * x[k] / 3;
				out[7 + k] += w * n[k] * x[k] * x[k] * x[NEXT[k]] / 2;
			}
		}
	}
}

static void test_agrees_with_gauss_quadrature(void **state)
{
	struct mesh m = {0};
	struct mp_solid s;
	long double want[10];

	(void)state;
	mesh_torus(&m, 3, 1, 17, 9);
	for (size_t i = 0; i < m.count; i++) { /* bend it out of every symmetry */
		for (int k = 0; k < 9; k += 3) {
			double *v = m.tri[i] + k, x = v[0], y = v[1], z = v[2];

			v[0] = x + 0.2 * y * z;
			v[1] = y * (1 + 0.1 * x) + 0.3 * z;
			v[2] = z + 0.05 * x * x - 0.1 * y;
		}
	}
	gauss(&m, want);
	s = solve(&m);
	assert_relative((double)s.volume, (double)want[0], 1e-15);
	for (int k = 0; k < 3; k++) {
		long double c = want[1 + k] / want[0];
		int next = (k + 1) % 3;

		assert_near((double)s.centroid[k], (double)c, 2e-15);
		assert_near((double)s.cov[k], (double)(want[4 + k] / want[0] - c * c), 4e-15);
		assert_near((double)s.cov[3 + k],
			    (double)(want[7 + k] / want[0] - c * want[1 + next] / want[0]), 4e-15);
	}
	mesh_free(&m);
}

static void assert_same_sums(const struct mp_sum *a, const struct mp_sum *b, int count)
{
	for (int i = 0; i < count; i++)
		assert_true(a[i].hi == b[i].hi && a[i].lo == b[i].lo);
}

/* Swapping two corners negates every signed sum to the bit, which is what flip does. */
static void test_flip_negates_to_the_bit(void **state)
{
	struct mesh m = {0};
	struct mp_moments sums, flipped;

	(void)state;
	mesh_torus(&m, 3, 1, 17, 9);
	mesh_move(&m, 0, 0.1, 0.7, 0.3);
	sum(&sums, &m);
	mesh_flip(&m, 0);
	sum(&flipped, &m);
	mp_moments_flip(&flipped);
	assert_same_sums(&sums.a0, &flipped.a0, 1);
	assert_same_sums(sums.a1, flipped.a1, 3);
	assert_same_sums(sums.a2, flipped.a2, 6);
	assert_same_sums(&sums.doubt, &flipped.doubt, 1);
	assert_same_sums(sums.doubt2, flipped.doubt2, 3);
	assert_same_sums(sums.vector_area, flipped.vector_area, 3);
	assert_same_sums(&sums.area2, &flipped.area2, 1);
	assert_same_sums(sums.area_s, flipped.area_s, 3);
	assert_same_sums(&sums.area_doubt, &flipped.area_doubt, 1);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_box_of_integers_is_exact),
	    cmocka_unit_test(test_empty_sum_is_nothing),
	    cmocka_unit_test(test_box_of_vertices),
	    cmocka_unit_test(test_order_of_summation_is_fixed),
	    cmocka_unit_test(test_far_from_the_origin_nothing_is_lost),
	    cmocka_unit_test(test_sphere_of_a_million_triangles),
	    cmocka_unit_test(test_torus_has_its_closed_form),
	    cmocka_unit_test(test_agrees_with_gauss_quadrature),
	    cmocka_unit_test(test_flip_negates_to_the_bit),
	};

	return cmocka_run_group_tests_name("moments", tests, NULL, NULL);
}
