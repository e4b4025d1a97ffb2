/*
 * The worked examples and the formulas of the papers that the moments come from, misprints
 * corrected, as second opinions that share nothing with core/:
 *   Alexiou, Mass Properties of a Triangular Pyramid, 2019: sums of pyramids over the origin;
 *   Bhat, Centroid of a solid: closed surface integrals of squares over triangles;
 *   Andujar, BRep queries, 2014: four-point Gauss quadrature of the divergence theorem's integrals.
 */
#include "core/analysis.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/mesh_random.h"
#include "tests/unit/report_of.h"

typedef const long double (*corners)[3];

/* A sum, and that of what its terms would be if nothing in them had cancelled. */
struct sum {
	long double value, size;
};

static void add(struct sum *s, long double x, long double size)
{
	s->value += x;
	s->size += size;
}

static void minus(const double a[3], const double b[3], long double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = (long double)a[k] - b[k];
}

static void cross(const long double a[3], const long double b[3], long double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static long double norm(const long double a[3])
{
	return fabsl(a[0]) + fabsl(a[1]) + fabsl(a[2]);
}

static long double dot(const long double a[3], const long double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Volume, its first moments, the integrals of x_i*x_j (xx yy zz xy yz zx), about a point. */
struct integrals {
	struct sum volume, first[3], second[6];
};

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

/* (x)^T(x) of the parallel axis theorem: y^2 + z^2 on the diagonal, -x*y beside it. */
static long double parallel(const long double r[3], int i, int j)
{
	return (i == j ? dot(r, r) : 0) - r[i] * r[j];
}

/* ---- pyramids ---- */

static void test_pyramid(void **unused)
{
	static const double PER_MASS[3][3] = {
	    {68.9, -50, -16}, {-50, 166.4, -10}, {-16, -10, 222.5}};
	static const double PARALLEL[3][3] = {
	    {43.0625, -62.5, -20}, {-62.5, 104, -12.5}, {-20, -12.5, 139.0625}};
	static const double ABOUT_ORIGIN[3][3] = {
	    {0.91866666666666667, -2 / 3.0, -0.21333333333333333},
	    {-2 / 3.0, 2.21866666666666667, -0.13333333333333333},
	    {-0.21333333333333333, -0.13333333333333333, 2.96666666666666667}};
	static const double AT_CENTROID[3][3] = {
	    {0.3445, 1 / 6.0, 0.05333333333333333},
	    {1 / 6.0, 0.832, 0.03333333333333333},
	    {0.05333333333333333, 0.03333333333333333, 1.1125}};
	static const double PAIRS[3][3] = {{40, 25, 0}, {0, 25, 8}, {40, 0, 8}};
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)unused;
	mesh_wedge(&m, 40, 25, 8);
	request.density_kind = MP_DENSITY_GIVEN;
	request.density = 1e-5;
	for (int wish = MP_WISH_CERTIFIED; wish <= MP_WISH_EXACT; wish++) {
		request.precision = (enum mp_precision_wish)wish;
		report_of_binary(&m, &request, &r);
		assert_relative(r.total.volume, 8000 / 6.0, 2e-16);
		assert_relative(r.total.mass, 0.01333333333333333, 1e-15);
		assert_true(r.total.centroid[0] == 10 && r.total.centroid[1] == 6.25 &&
			    r.total.centroid[2] == 2);
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++) {
				const long double c[3] = {10, 6.25L, 2};
				double twentieth = 0;

				for (int p = 0; p < 3; p++) {
					const long double q[3] = {PAIRS[p][0], PAIRS[p][1],
								  PAIRS[p][2]};

					twentieth += (double)parallel(q, i, j) / 20;
				}
				assert_relative(twentieth, PER_MASS[i][j], 1e-15);
				assert_true((double)parallel(c, i, j) == PARALLEL[i][j]);
				assert_relative(r.inertia_origin[i][j], ABOUT_ORIGIN[i][j], 1e-15);
				assert_relative(r.inertia_origin[i][j] / r.total.mass,
						PER_MASS[i][j], 1e-15);
				assert_relative(r.total.inertia[i][j], AT_CENTROID[i][j], 1e-15);
				assert_relative(r.total.inertia[i][j] / r.total.mass,
						PER_MASS[i][j] - PARALLEL[i][j], 2e-15);
			}
		mp_report_free(&r);
	}
	mesh_free(&m);
}

/* The height of the pyramid over its base: 6 V/|n| = 3 V/A, about 7 2/3 of the 8 mm edge. */
static void test_height_of_the_pyramid(void **unused)
{
	struct mesh m = {0};
	struct mp_report r;

	(void)unused;
	mesh_wedge(&m, 40, 25, 8);
	report_of_binary(&m, NULL, &r);
	assert_relative(3 * r.total.volume / (r.total.area - 500 - 160 - 100),
			8000 / sqrt(200.0 * 200 + 320 * 320 + 1000 * 1000), 2e-15);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Section 4: each triangle and the point ${from} make a pyramid, whatever the sign. */
static void add_pyramid(struct integrals *out, corners p)
{
	long double n[3], volume, pair[3], size = norm(p[0]) * norm(p[1]) * norm(p[2]);
	long double reach = norm(p[0]) + norm(p[1]) + norm(p[2]);

	cross(p[1], p[2], n);
	volume = dot(p[0], n) / 6;
	add(&out->volume, volume, size);
	for (int k = 0; k < 3; k++)
		add(&out->first[k], volume * (p[0][k] + p[1][k] + p[2][k]) / 4, size * reach);
	for (int c = 0; c < 3; c++) {
		for (int k = 0; k < 3; k++)
			pair[k] = p[c][k] + p[(c + 1) % 3][k];
		for (int k = 0; k < 6; k++)
			add(&out->second[k], volume * pair[AXES[k][0]] * pair[AXES[k][1]] / 20,
			    size * reach * reach);
	}
}

/* ---- squares over triangles, and quadrature ---- */

/* (1/24) sum n_x (x0^2 + x1^2 + x2^2 + x0 x1 + x0 x2 + x1 x2) */
static void add_squares(struct integrals *out, corners p)
{
	long double e[3], f[3], n[3];

	for (int k = 0; k < 3; k++) {
		e[k] = p[1][k] - p[0][k];
		f[k] = p[2][k] - p[0][k];
	}
	cross(e, f, n);
	for (int k = 0; k < 3; k++) {
		long double x = p[0][k], y = p[1][k], z = p[2][k];

		add(&out->first[k], n[k] * (x * x + y * y + z * z + x * y + x * z + y * z) / 24,
		    norm(e) * norm(f) * (x * x + y * y + z * z));
	}
}

/*
 * Exact for polynomials of degree 3.  The points are (5,5,5)/15 and the three of ${outer} and twice
 * ${inner} fifteenths: 9 and 3.
 */
static void add_quadrature(struct integrals *out, corners p, int outer, int inner)
{
	long double reach = norm(p[0]) + norm(p[1]) + norm(p[2]), size;
	long double e[3], f[3], n[3];

	for (int k = 0; k < 3; k++) {
		e[k] = p[1][k] - p[0][k];
		f[k] = p[2][k] - p[0][k];
	}
	cross(e, f, n);
	size = norm(e) * norm(f);
	for (int l = 0; l < 4; l++) {
		long double w = (l == 0 ? -27 : 25) / 96.0L, x[3];

		for (int k = 0; k < 3; k++) {
			x[k] = 0;
			for (int c = 0; c < 3; c++)
				x[k] += (l == 0 ? 5 : c + 1 == l ? outer : inner) * p[c][k] / 15;
		}
		for (int k = 0; k < 3; k++) {
			add(&out->volume, w * x[k] * n[k] / 3, size * reach);
			add(&out->first[k], w * x[k] * x[k] * n[k] / 2, size * reach * reach);
			add(&out->second[k], w * x[k] * x[k] * x[k] * n[k] / 3,
			    size * reach * reach * reach);
		}
		for (int k = 3; k < 6; k++) {
			int i = AXES[k][0], j = AXES[k][1];

			add(&out->second[k], w * x[i] * x[i] * x[j] * n[i] / 2,
			    size * reach * reach * reach);
		}
	}
}

enum formula { PYRAMIDS, SQUARES, QUADRATURE, AS_PRINTED };

static void integrate(const struct mesh *m, const double from[3], enum formula formula,
		      struct integrals *out)
{
	memset(out, 0, sizeof *out);
	for (size_t i = 0; i < m->count; i++) {
		long double p[3][3];

		for (int c = 0; c < 3; c++)
			minus(&m->tri[i][3 * c], from, p[c]);
		if (formula == PYRAMIDS)
			add_pyramid(out, (corners)p);
		else if (formula == SQUARES)
			add_squares(out, (corners)p);
		else
			add_quadrature(out, (corners)p, formula == QUADRATURE ? 9 : 11,
				       formula == QUADRATURE ? 3 : 2);
	}
}

static void assert_sum(const struct sum *s, long double value, long double rounded)
{
	long double most = 16 * LDBL_EPSILON * s->size + rounded;

	if (!(fabsl(s->value - value) <= most))
		fail_msg("%.17Lg is not %.17Lg within %.3Lg", value, s->value, most);
}

static void check(const struct mesh *m, const struct mp_report *r, enum formula formula)
{
	long double volume = r->total.volume, sign = volume < 0 ? -1 : 1;
	struct integrals s;

	integrate(m, m->tri[0], formula, &s);
	if (formula != SQUARES)
		assert_sum(&s.volume, volume, 0x1p-52L * fabsl(volume));
	for (int k = 0; k < 3; k++) {
		long double at = r->total.centroid[k];

		assert_sum(&s.first[k], (at - m->tri[0][k]) * volume,
			   0x1p-51L * fabsl(volume) * fabsl(at));
	}
	for (int k = 0; k < 6 && formula != SQUARES; k++) {
		int i = AXES[k][0], j = AXES[k][1];
		long double entry = r->inertia_about[i][j], own, trace = 0;

		for (int a = 0; a < 3; a++)
			trace += r->inertia_about[a][a];
		own = i == j ? trace / 2 - entry : -entry;
		assert_sum(&s.second[k], sign * own, 0x1p-50L * fabsl(trace));
	}
}

static void test_formulas_agree_on_random_meshes(void **unused)
{
	uint64_t state = 4711;
	int seen = 0;

	(void)unused;
	for (int n = 0; n < 1500; n++) {
		struct mp_request request = request_plain();
		struct random_mesh random;
		struct mp_report r;

		mesh_random(&random, &state);
		request.precision = MP_WISH_EXACT;
		request.has_about = true;
		memcpy(request.about, random.mesh.tri[0], sizeof request.about);
		report_of_ascii(&random.mesh, &request, &r);
		if (r.inertia_about_defined && r.precision == MP_PRECISION_EXACT) {
			check(&random.mesh, &r, PYRAMIDS);
			check(&random.mesh, &r, SQUARES);
			check(&random.mesh, &r, QUADRATURE);
			seen++;
		}
		mp_report_free(&r);
		mesh_free(&random.mesh);
	}
	assert_true(seen > 1000);
}

/*
 * With the matrix as printed, 11 and 2 fifteenths, the volume survives, which hides that the
 * centroid and the moments do not.
 */
static void test_the_printed_points_spoil_all_but_the_volume(void **unused)
{
	const double origin[3] = {0, 0, 0};
	struct integrals good, bad;
	struct mesh m = {0};

	(void)unused;
	mesh_wedge(&m, 40, 25, 8);
	integrate(&m, origin, QUADRATURE, &good);
	integrate(&m, origin, AS_PRINTED, &bad);
	assert_near((double)(bad.volume.value / good.volume.value), 1, 1e-15);
	assert_near((double)(bad.first[0].value / good.first[0].value), 1.42, 0.005);
	assert_near((double)((bad.second[1].value + bad.second[2].value) /
			     (good.second[1].value + good.second[2].value)),
		    1.87, 0.005);
	mesh_free(&m);
}

/* A homogeneous solid's linear functions have their mean at the centroid. */
static void test_linear_functions_have_their_mean_at_the_centroid(void **unused)
{
	const double origin[3] = {0, 0, 0}, f[3] = {2, -3, 5};
	struct integrals s;
	struct mesh m = {0};
	struct mp_report r;
	double mean = 7, at = 7;

	(void)unused;
	mesh_torus(&m, 3, 1, 17, 9);
	mesh_move(&m, 0, 1, 2, -4);
	report_of_ascii(&m, NULL, &r);
	integrate(&m, origin, SQUARES, &s);
	for (int k = 0; k < 3; k++) {
		mean += f[k] * (double)(s.first[k].value / r.total.volume);
		at += f[k] * r.total.centroid[k];
	}
	assert_near(mean, at, 1e-13);
	mp_report_free(&r);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_pyramid),
	    cmocka_unit_test(test_height_of_the_pyramid),
	    cmocka_unit_test(test_formulas_agree_on_random_meshes),
	    cmocka_unit_test(test_the_printed_points_spoil_all_but_the_volume),
	    cmocka_unit_test(test_linear_functions_have_their_mean_at_the_centroid),
	};

	return cmocka_run_group_tests_name("papers", tests, NULL, NULL);
}
