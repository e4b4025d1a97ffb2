#include "core/moments/facet.h"

#include <float.h>
#include <gmp.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/predicates.h"
#include "tests/unit/exact_meshes.h"
#include "tests/unit/mesh_random.h"

/* Digits enough for every product of three doubles, and for square roots of their sums. */
enum { BITS = 7000, EACH = 3000 };

struct plane {
	mpf_t p[3][3], n[3], length, dot, a, b;
};

static void plane_init(struct plane *o)
{
	mpf_set_default_prec(BITS);
	for (int i = 0; i < 9; i++)
		mpf_init(o->p[i / 3][i % 3]);
	for (int k = 0; k < 3; k++)
		mpf_init(o->n[k]);
	mpf_inits(o->length, o->dot, o->a, o->b, NULL);
}

static void plane_clear(struct plane *o)
{
	for (int i = 0; i < 9; i++)
		mpf_clear(o->p[i / 3][i % 3]);
	for (int k = 0; k < 3; k++)
		mpf_clear(o->n[k]);
	mpf_clears(o->length, o->dot, o->a, o->b, NULL);
}

/* n = (b - a) x (c - a), its length, a.n */
static void plane_find(struct plane *o, const double corner[3][3])
{
	mpf_t e[3], f[3];

	mpf_set_ui(o->length, 0);
	mpf_set_ui(o->dot, 0);
	for (int k = 0; k < 3; k++) {
		mpf_inits(e[k], f[k], NULL);
		for (int c = 0; c < 3; c++)
			mpf_set_d(o->p[c][k], corner[c][k]);
		mpf_sub(e[k], o->p[1][k], o->p[0][k]);
		mpf_sub(f[k], o->p[2][k], o->p[0][k]);
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		mpf_mul(o->a, e[i], f[j]);
		mpf_mul(o->b, e[j], f[i]);
		mpf_sub(o->n[k], o->a, o->b);
		mpf_mul(o->a, o->n[k], o->n[k]);
		mpf_add(o->length, o->length, o->a);
		mpf_mul(o->a, o->n[k], o->p[0][k]);
		mpf_add(o->dot, o->dot, o->a);
	}
	mpf_sqrt(o->length, o->length);
	for (int k = 0; k < 3; k++)
		mpf_clears(e[k], f[k], NULL);
}

/* |x - exact| <= relative*|exact| + absolute; beyond the range of a double x is infinite. */
static bool is_near(struct plane *o, double x, mpf_t exact, double relative, double absolute)
{
	if (isinf(x)) {
		mpf_set_d(o->b, DBL_MAX);
		mpf_abs(o->a, exact);
		mpf_div_ui(o->b, o->b, 2);
		return mpf_cmp(o->a, o->b) > 0 && mpf_sgn(exact) == (x > 0 ? 1 : -1);
	}
	mpf_set_d(o->a, x);
	mpf_sub(o->a, o->a, exact);
	mpf_abs(o->a, o->a);
	mpf_abs(o->b, exact);
	mpf_set_d(o->length, relative); /* used up by now */
	mpf_mul(o->b, o->b, o->length);
	mpf_set_d(o->length, absolute);
	mpf_add(o->b, o->b, o->length);
	return mpf_cmp(o->a, o->b) <= 0;
}

static bool is_right(struct plane *o, const double corner[3][3], const struct mp_facet *f)
{
	double far = INFINITY, reach = 0, relative = 8 * DBL_EPSILON, tiny = 8 * DBL_TRUE_MIN;
	bool right = true;
	mpf_t want, length;

	mpf_inits(want, length, NULL);
	plane_find(o, corner);
	mpf_set(length, o->length);
	for (int k = 0; k < 3; k++) {
		far = fmin(far,
			   fmax(fabs(corner[k][0]), fmax(fabs(corner[k][1]), fabs(corner[k][2]))));
		mpf_add(want, o->p[0][k], o->p[1][k]);
		mpf_add(want, want, o->p[2][k]);
		mpf_div_ui(want, want, 3);
		for (int c = 0; c < 3; c++)
			reach = fmax(reach, fabs(corner[c][k]));
		right = right && is_near(o, f->centroid[k], want, 2 * DBL_EPSILON,
					 fmax(tiny, ldexp(reach, -60)));
		mpf_div(want, o->n[k], length);
		right = right && is_near(o, f->normal[k], want, relative, relative);
	}
	mpf_div_ui(want, length, 2);
	right = right && is_near(o, f->area, want, relative, tiny);
	mpf_div(want, o->dot, length);
	right = right && is_near(o, f->height, want, relative, fmax(tiny, ldexp(far, -48)));
	mpf_clears(want, length, NULL);
	return right;
}

/* The width of the triangle over its length, about. */
static double slimness(struct plane *o, const double corner[3][3])
{
	double longest = 0, width;
	long exponent;

	for (int i = 0; i < 9; i++) {
		const double *p = corner[i / 3], *q = corner[(i / 3 + 1) % 3];

		longest = fmax(longest, fabs(p[i % 3] / 2 - q[i % 3] / 2) * 2);
	}
	plane_find(o, corner);
	width = mpf_get_d_2exp(&exponent, o->length);
	if (!(longest > 0) || isinf(longest))
		return 0;
	exponent -= 2 * (long)ilogb(longest);
	return exponent < -1000 ? 0 : ldexp(width, (int)exponent);
}

static void draw(double corner[3][3], enum exact_style style, uint64_t *state)
{
	bool sliver = random_chance(state, 0.3);
	double along = random_between(state, -1, 2);

	for (int i = 0; i < 9; i++)
		corner[i / 3][i % 3] = exact_coordinate(style, i % 3, state);
	for (int k = 0; k < 3 && sliver; k++) {
		double c = corner[0][k] + along * (corner[1][k] - corner[0][k]);

		corner[2][k] = isfinite(c) ? c : corner[2][k];
	}
}

static void every_kind_of_coordinate(void **unused)
{
	struct plane o;
	uint64_t state = 41;
	long seen = 0, slivers = 0, flat = 0;

	(void)unused;
	plane_init(&o);
	for (int style = 0; style < STYLES; style++)
		for (int i = 0; i < EACH / 10; i++) {
			double corner[3][3], slim;
			struct mp_facet f;
			bool line;

			draw(corner, (enum exact_style)style, &state);
			mp_facet_find((const double(*)[3])corner, &f);
			slim = slimness(&o, (const double(*)[3])corner);
			line = mp_collinear(corner[0], corner[1], corner[2]) != 0;
			if (f.degenerate != line && (line || slim > 0x1p-90))
				fail_msg("style %d, triangle %d, width/length %g: degenerate",
					 style, i, slim);
			flat += f.degenerate;
			if (slim < 0x1p-50)
				continue;
			slivers += slim < 0x1p-20;
			seen++;
			if (!is_right(&o, (const double(*)[3])corner, &f))
				fail_msg("style %d, triangle %d, width/length %g", style, i, slim);
		}
	print_message("# %ld triangles, %ld of them slivers; %ld degenerate\n", seen, slivers,
		      flat);
	assert_true(seen > STYLES * EACH / 10 / 2 && slivers > 20 && flat > 20);
	plane_clear(&o);
}

static void a_triangle_by_hand(void **unused)
{
	static const double corner[3][3] = {{1, 2, 5}, {4, 2, 5}, {1, 6, 5}};
	static const double other[3][3] = {{1, 2, 5}, {1, 6, 5}, {4, 2, 5}};
	struct mp_facet f;

	(void)unused;
	mp_facet_find(corner, &f);
	assert_false(f.degenerate);
	assert_true(f.area == 6 && f.height == 5 && f.volume == 10);
	assert_true(f.normal[0] == 0 && f.normal[1] == 0 && f.normal[2] == 1);
	assert_true(f.centroid[0] == 2 && f.centroid[2] == 5);
	assert_true(fabs(f.centroid[1] - 10.0 / 3) < 1e-15);
	mp_facet_find(other, &f);
	assert_true(f.area == 6 && f.height == -5 && f.volume == -10 && f.normal[2] == -1);
}

/* Raw products would leave an area of anything between 0 and 1e3. */
static void far_away_nothing_is_lost(void **unused)
{
	static const double corner[3][3] = {
	    {1e9, -2e9, 3e9}, {1e9 + 0x1p-20, -2e9, 3e9}, {1e9, -2e9 + 0x1p-20, 3e9}};
	struct mp_facet f;

	(void)unused;
	mp_facet_find(corner, &f);
	assert_true(f.area == 0x1p-41 && f.height == 3e9 && f.normal[2] == 1);
	assert_true(f.volume == 1e9 * 0x1p-41);
}

static void degenerate_triangles_have_no_plane(void **unused)
{
	static const double line[3][3] = {{0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0.4, 0.8, 1.2}},
			    point[3][3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
	struct mp_facet f;

	(void)unused;
	mp_facet_find(line, &f);
	assert_true(f.degenerate && f.area == 0 && f.volume == 0 && f.height == 0);
	assert_true(f.normal[0] == 0 && f.normal[1] == 0 && f.normal[2] == 0);
	assert_true(f.centroid[0] > 0);
	mp_facet_find(point, &f);
	assert_true(f.degenerate && f.area == 0 && f.centroid[1] == 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_triangle_by_hand),
	    cmocka_unit_test(far_away_nothing_is_lost),
	    cmocka_unit_test(degenerate_triangles_have_no_plane),
	    cmocka_unit_test(every_kind_of_coordinate),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
