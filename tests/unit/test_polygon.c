#include "core/obj/polygon.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/predicates.h"
#include "core/obj/polygon_private.h"
#include "tests/unit/alloc_fail.h"

#define PI 3.14159265358979323846

struct shape { /* a polygon in a plane */
	double (*p)[2];
	uint32_t n, room;
};

static void add(struct shape *s, double x, double y)
{
	if (s->n == s->room) {
		s->room = s->room < 16 ? 16 : 2 * s->room;
		s->p = realloc(s->p, s->room * sizeof *s->p);
		assert_non_null(s->p);
	}
	s->p[s->n][0] = x;
	s->p[s->n++][1] = y;
}

static uint64_t random_state;

static double uniform(void) /* in [0, 1) */
{
	random_state = random_state * 6364136223846793005u + 1442695040888963407u;
	return (double)(random_state >> 11) * 0x1p-53;
}

static double shoelace(const struct shape *s)
{
	double sum = 0;

	for (uint32_t i = 0; i < s->n; i++) {
		const double *a = s->p[i], *b = s->p[(i + 1) % s->n];

		sum += (a[0] - s->p[0][0]) * (b[1] - s->p[0][1]) -
		       (a[1] - s->p[0][1]) * (b[0] - s->p[0][0]);
	}
	return sum / 2;
}

/* Into space: u and v span the plane. */
struct frame {
	double o[3], u[3], v[3];
};

static const struct frame FLAT = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
static const struct frame FLAT_CHECKED = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}; /* both ways */

static struct frame random_frame(void)
{
	struct frame f;
	double q[4], length = 0, w, x, y, z;

	for (int k = 0; k < 4; k++) {
		q[k] = uniform() - 0.5;
		length += q[k] * q[k];
	}
	length = sqrt(length);
	w = q[0] / length;
	x = q[1] / length;
	y = q[2] / length;
	z = q[3] / length;
	f.u[0] = 1 - 2 * (y * y + z * z);
	f.u[1] = 2 * (x * y + w * z);
	f.u[2] = 2 * (x * z - w * y);
	f.v[0] = 2 * (x * y - w * z);
	f.v[1] = 1 - 2 * (x * x + z * z);
	f.v[2] = 2 * (y * z + w * x);
	for (int k = 0; k < 3; k++)
		f.o[k] = 10 * uniform() - 5;
	return f;
}

static double area_of(const double *a, const double *b, const double *c)
{
	double n = 0;

	for (int k = 0; k < 3; k++) {
		int l = (k + 1) % 3, m = (k + 2) % 3;
		double x = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);

		n += x * x;
	}
	return sqrt(n) / 2;
}

struct edge {
	const double *a, *b; /* a before b */
	int way;             /* 1: from a to b */
};

static int before(const double *a, const double *b)
{
	for (int k = 0; k < 3; k++)
		if (a[k] != b[k])
			return a[k] < b[k] ? -1 : 1;
	return 0;
}

static int by_ends(const void *a, const void *b)
{
	const struct edge *e = a, *f = b;
	int order = before(e->a, f->a);

	return order != 0 ? order : before(e->b, f->b);
}

static void set_edge(struct edge *e, const double *a, const double *b, int way)
{
	bool turn = before(a, b) > 0;

	e->a = turn ? b : a;
	e->b = turn ? a : b;
	e->way = before(a, b) == 0 ? 0 : turn ? -way : way;
}

/* The triangles bound what the polygon bounds: all edges taken together, nothing is left. */
static void check_edges(const double (*xyz)[3], const uint32_t *corner, const uint32_t (*tri)[3],
			uint32_t n)
{
	size_t count = 3 * ((size_t)n - 2) + n;
	struct edge *edge = malloc(count * sizeof *edge);
	long sum = 0;

	assert_non_null(edge);
	for (uint32_t i = 0; i < n; i++)
		set_edge(&edge[i], xyz[corner[i]], xyz[corner[(i + 1) % n]], -1);
	for (size_t i = 0; i < count - n; i++) {
		uint32_t a = tri[i / 3][i % 3], b = tri[i / 3][(i + 1) % 3];

		assert_true(a < n && b < n);
		set_edge(&edge[n + i], xyz[corner[a]], xyz[corner[b]], 1);
	}
	qsort(edge, count, sizeof *edge, by_ends);
	for (size_t i = 0; i < count; i++) {
		if (i > 0 && by_ends(&edge[i - 1], &edge[i]) != 0) {
			assert_int_equal(sum, 0);
			sum = 0;
		}
		sum += edge[i].way;
	}
	assert_int_equal(sum, 0);
	free(edge);
}

static int orient_of(const double (*xyz)[3], const uint32_t *corner, const uint32_t tri[3])
{
	return mp_orient2d(xyz[corner[tri[0]]], xyz[corner[tri[1]]], xyz[corner[tri[2]]]);
}

/* What one of the two ways to split polygons makes of it, where the other would do as well. */
static void check_alone(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner,
			uint32_t n)
{
	static const int axis[2] = {0, 1};
	struct mp_error err;
	bool done = false;

	memset(p->tri, 0, (n - 2) * sizeof *p->tri);
	assert_int_equal(polygon_sweep(p, xyz, corner, n, axis, &done, &err), 0);
	assert_true(done);
	check_edges(xyz, corner, (const uint32_t(*)[3])p->tri, n);
	for (uint32_t i = 0; i < n - 2; i++)
		assert_true(orient_of(xyz, corner, p->tri[i]) >= 0);
	if (n > 300)
		return;
	memset(p->tri, 0, (n - 2) * sizeof *p->tri);
	assert_int_equal(polygon_clip(p, xyz, corner, n, axis, &err), 0);
	assert_false(p->tangled);
	check_edges(xyz, corner, (const uint32_t(*)[3])p->tri, n);
	for (uint32_t i = 0; i < n - 2; i++)
		assert_true(orient_of(xyz, corner, p->tri[i]) >= 0);
}

struct result {
	double area;
	uint32_t flat; /* triangles without area */
	bool nonplanar, tangled;
};

static struct result split(const struct shape *s, const struct frame *f)
{
	struct result r = {0, 0, false, false};
	struct mp_polygon p = {0};
	struct mp_error err;
	double(*xyz)[3] = malloc(s->n * sizeof *xyz);
	uint32_t *corner = malloc(s->n * sizeof *corner);

	assert_non_null(xyz);
	assert_non_null(corner);
	for (uint32_t i = 0; i < s->n; i++) {
		corner[i] = s->n - 1 - i; /* backwards in memory */
		for (int k = 0; k < 3; k++)
			xyz[corner[i]][k] = f->o[k] + s->p[i][0] * f->u[k] + s->p[i][1] * f->v[k];
	}
	assert_int_equal(mp_polygon_split(&p, (const double(*)[3])xyz, corner, s->n, &err), 0);
	check_edges((const double(*)[3])xyz, corner, (const uint32_t(*)[3])p.tri, s->n);
	for (uint32_t i = 0; i + 2 < s->n; i++) {
		double area = area_of(xyz[corner[p.tri[i][0]]], xyz[corner[p.tri[i][1]]],
				      xyz[corner[p.tri[i][2]]]);

		r.area += area;
		r.flat += area == 0;
	}
	r.nonplanar = p.nonplanar;
	r.tangled = p.tangled;
	if (f == &FLAT_CHECKED && s->n > 3)
		check_alone(&p, (const double(*)[3])xyz, corner, s->n);
	free(xyz);
	free(corner);
	mp_polygon_free(&p);
	return r;
}

/* The area is right in the plane, backwards, from another corner and in any plane. */
static void check_area(const struct shape *s)
{
	struct shape turned = {0};
	double area = shoelace(s);

	random_state = s->n;
	for (int i = 0; i < 4; i++) {
		struct frame f = random_frame();
		uint32_t begin = i == 0 ? 0 : (uint32_t)(uniform() * s->n);
		struct result r;

		turned.n = 0;
		for (uint32_t k = 0; k < s->n; k++) {
			uint32_t from = (begin + (i == 2 ? s->n - k : k)) % s->n;

			add(&turned, s->p[from][0], s->p[from][1]);
		}
		r = split(&turned, i == 0 ? &FLAT_CHECKED : &f);
		assert_false(r.tangled);
		assert_false(r.nonplanar);
		assert_true(fabs(r.area - area) <= 1e-11 * area * (1 + sqrt(s->n)));
	}
	free(turned.p);
}

static void test_convex_polygons_are_fans(void **state)
{
	struct mp_polygon p = {0};
	struct mp_error err;
	double xyz[100][3];
	uint32_t corner[100];

	(void)state;
	for (uint32_t i = 0; i < 100; i++) {
		corner[i] = i;
		xyz[i][0] = cos(2 * PI * i / 100);
		xyz[i][1] = 7;
		xyz[i][2] = sin(2 * PI * i / 100);
	}
	for (uint32_t n = 3; n <= 100; n++) {
		assert_int_equal(mp_polygon_split(&p, (const double(*)[3])xyz, corner, n, &err), 0);
		assert_false(p.tangled || p.nonplanar);
		for (uint32_t i = 0; i + 2 < n; i++) {
			assert_int_equal(p.tri[i][0], 0);
			assert_int_equal(p.tri[i][1], i + 1);
			assert_int_equal(p.tri[i][2], i + 2);
		}
	}
	mp_polygon_free(&p);
}

static void test_concave_quads(void **state)
{
	static const double DART[4][2] = {{0, 0}, {2, 1}, {0, 4}, {-2, 1}};
	struct shape s = {0};

	(void)state;
	for (int first = 0; first < 4; first++) {
		for (int dent = 0; dent < 4; dent++) {
			s.n = 0;
			for (int i = 0; i < 4; i++) {
				int k = (first + i) % 4;

				add(&s, DART[k][0] / (k == dent ? 8 : 1),
				    k == dent ? 1.5 : DART[k][1]);
			}
			check_area(&s);
		}
	}
	free(s.p);
}

static void star(struct shape *s, uint32_t n, double low)
{
	s->n = 0;
	for (uint32_t i = 0; i < n; i++) {
		double r = low + (1 - low) * uniform();

		add(s, r * cos(2 * PI * i / n), r * sin(2 * PI * i / n));
	}
}

static void test_random_stars(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t n = 5; n < 400; n += 1 + n / 8) {
		for (uint32_t seed = 0; seed < 8; seed++) {
			random_state = n * 100 + seed;
			star(&s, n, seed * 0.1);
			check_area(&s);
		}
	}
	random_state = 5;
	star(&s, 30000, 0.1);
	check_area(&s);
	free(s.p);
}

static void spiral(struct shape *s, uint32_t half, double turns)
{
	s->n = 0;
	for (uint32_t i = 0; i < half; i++) {
		double t = (double)i / (half - 1), a = 2 * PI * turns * t;

		add(s, (1 + turns * t) * cos(a), (1 + turns * t) * sin(a));
	}
	for (uint32_t i = half; i-- > 0;) {
		double t = (double)i / (half - 1), a = 2 * PI * turns * t;

		add(s, (0.6 + turns * t) * cos(a), (0.6 + turns * t) * sin(a));
	}
}

static void test_spirals(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t half = 20; half < 30000; half *= 4) {
		spiral(&s, half, half < 1000 ? 2 : 40);
		check_area(&s);
	}
	free(s.p);
}

/* Teeth on a flat back: half of the corners lie on one line once the teeth are off. */
static void comb(struct shape *s, uint32_t teeth)
{
	s->n = 0;
	add(s, 0, -1);
	add(s, teeth, -1);
	for (uint32_t i = teeth; i-- > 0;) {
		add(s, i + 1, 0);
		add(s, i + 0.5, 3);
	}
	add(s, 0, 0);
}

static void test_combs(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t teeth = 1; teeth < 3000; teeth = 3 * teeth + 1) {
		comb(&s, teeth);
		check_area(&s);
	}
	comb(&s, 50000);
	check_area(&s);
	free(s.p);
}

/* Square teeth of various length, all at right angles. */
static void test_battlements(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t teeth = 1; teeth < 30000; teeth = 5 * teeth + 2) {
		s.n = 0;
		random_state = teeth;
		add(&s, 0, -1);
		add(&s, 2 * teeth, -1);
		for (uint32_t i = teeth; i-- > 0;) {
			double y = 1 + floor(8 * uniform());

			add(&s, 2 * i + 2, 0);
			add(&s, 2 * i + 1, 0);
			add(&s, 2 * i + 1, y);
			add(&s, 2 * i, y);
		}
		check_area(&s);
	}
	free(s.p);
}

/* A plate with holes: each hole is a detour from the corner before it and back. */
static void add_hole(struct shape *s, double x, double y, double r, uint32_t n)
{
	double back_x = s->p[s->n - 1][0], back_y = s->p[s->n - 1][1];

	for (uint32_t i = 0; i <= n; i++) /* clockwise */
		add(s, x - r * cos(2 * PI * (i % n) / n), y + r * sin(2 * PI * (i % n) / n));
	add(s, back_x, back_y);
}

static void test_holes_on_bridges(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t holes = 1; holes < 400; holes = 2 * holes + 1) {
		for (uint32_t n = 3; n < 40; n = 2 * n - 1) {
			s.n = 0; /* bridges from the left edge, one a row */
			add(&s, 0, 0);
			add(&s, 3, 0);
			add(&s, 3, holes);
			add(&s, 0, holes);
			for (uint32_t i = holes; i-- > 0;) {
				add(&s, 0, i + 0.5);
				add_hole(&s, 1, i + 0.5, 0.3, n);
			}
			check_area(&s);
		}
	}
	free(s.p);
}

/* All bridges begin in one corner; or each hole hangs on the one before it. */
static void test_bridges_that_share_a_corner(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t holes = 1; holes < 300; holes = 3 * holes + 1) {
		s.n = 0;
		add(&s, 20, 0);
		add(&s, 20, 20);
		add(&s, 0, 20);
		add(&s, 0, 0);
		for (uint32_t i = holes; i-- > 0;) { /* to the left, as seen from the corner */
			double a = PI / 2 * (i + 0.5) / holes;

			add_hole(&s, 10 * cos(a), 10 * sin(a), 3.0 / holes, 6);
		}
		check_area(&s);
		s.n = 0;
		add(&s, 0, -1);
		add(&s, holes + 1.0, -1);
		add(&s, holes + 1.0, 1);
		add(&s, 0, 1);
		add(&s, 0, 0);
		for (uint32_t i = 0; i < holes; i++) { /* there below, back above */
			add(&s, i + 0.75, 0);
			add(&s, i + 1, -0.25);
			add(&s, i + 1.25, 0);
		}
		for (uint32_t i = holes; i-- > 0;) {
			add(&s, i + 1.25, 0);
			add(&s, i + 1, 0.25);
			add(&s, i + 0.75, 0);
		}
		add(&s, 0, 0);
		/* clockwise around the holes: so the way there is above */
		for (uint32_t i = 5; i < s.n; i++)
			s.p[i][1] = -s.p[i][1];
		check_area(&s);
	}
	free(s.p);
}

/* A square whose sides are cut into pieces: no triangle need be flat. */
static void test_corners_along_a_line(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t m = 1; m < 100; m += 1 + m / 4) {
		for (uint32_t turn = 0; turn < 4 * m; turn += m / 2 + 1) {
			s.n = 0;
			for (uint32_t i = 0; i < 4 * m; i++) {
				uint32_t k = (i + turn) % (4 * m), at = k % m;
				const double x[4] = {at, m, m - at, 0}, y[4] = {0, at, m, m - at};

				add(&s, x[k / m], y[k / m]);
			}
			check_area(&s);
			assert_int_equal(split(&s, &FLAT).flat, 0);
		}
	}
	free(s.p);
}

/* Is every corner one of a triangle, as a point? */
static void check_all_used(const struct shape *s)
{
	double xyz[16][3] = {{0}};
	uint32_t corner[16];
	struct mp_polygon p = {0};
	struct mp_error err;

	for (uint32_t i = 0; i < s->n; i++) {
		corner[i] = i;
		memcpy(xyz[i], s->p[i], sizeof s->p[i]);
	}
	assert_int_equal(mp_polygon_split(&p, (const double(*)[3])xyz, corner, s->n, &err), 0);
	for (uint32_t i = 0; i < s->n; i++) {
		bool used = false;

		for (uint32_t k = 0; k < 3 * (s->n - 2); k++)
			used = used || before(xyz[p.tri[k / 3][k % 3]], xyz[i]) == 0;
		assert_true(used);
	}
	mp_polygon_free(&p);
}

static void test_repeated_corners_and_spikes(void **state)
{
	static const double SQUARE[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
	struct shape s = {0};

	(void)state;
	for (uint32_t repeat = 1; repeat < 6; repeat++) {
		s.n = 0;
		for (int i = 0; i < 4; i++)
			for (uint32_t k = 0; k < repeat; k++)
				add(&s, SQUARE[i][0], SQUARE[i][1]);
		check_area(&s);
		assert_int_equal(split(&s, &FLAT).flat, 4 * (repeat - 1));
	}
	for (int inward = -1; inward <= 1; inward += 2) { /* from the middle of a side and back */
		s.n = 0;
		for (int i = 0; i < 4; i++) {
			const double *a = SQUARE[i], *b = SQUARE[(i + 1) % 4];
			double x = (a[0] + b[0]) / 2, y = (a[1] + b[1]) / 2;

			add(&s, a[0], a[1]);
			add(&s, x, y);
			add(&s, x + inward * 0.25 * (0.5 - x), y + inward * 0.25 * (0.5 - y));
			add(&s, x, y);
		}
		check_area(&s);
		check_all_used(&s);
	}
	free(s.p);
}

/* Holes that touch the rim or each other in a corner, or with a corner on a side. */
static void test_boundaries_that_touch(void **state)
{
	static const double P[][2] = {
	    {0, 0}, {6, 0}, {6, 6}, {3, 6}, {4, 5}, {3, 4}, {4, 3}, {3, 2}, {2, 3},
	    {3, 4}, {2, 5}, {3, 6}, {0, 6}, {0, 3}, {1, 4}, {1, 2}, {0, 3},
	};
	static const double Q[][2] = {
	    {0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {0, 2}, {1, 3}, {4, 2}, {2, 0}, {1, 1},
	};
	static const double R[][2] = {
	    {0, 0}, {2, -2}, {2, -1}, {0, 0}, {2, 1}, {2, 2}, {0, 0}, {-2, 1}, {-2, -1},
	};
	struct shape s = {0};

	(void)state;
	for (size_t i = 0; i < sizeof P / sizeof *P; i++)
		add(&s, P[i][0], P[i][1]);
	check_area(&s);
	s.n = 0;
	for (size_t i = 0; i < sizeof R / sizeof *R; i++)
		add(&s, R[i][0], R[i][1]);
	check_area(&s);
	s.n = 0;
	for (size_t i = 0; i < sizeof Q / sizeof *Q; i++)
		add(&s, Q[i][0], Q[i][1]);
	check_area(&s); /* rounding makes the corners leave the sides */
	free(s.p);
}

/* Corners that lie on sides come to lie beside them: the area is off by as much, no more. */
static void test_rounding_does_no_harm(void **state)
{
	static const double P[][2] = {
	    {0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {0, 2}, {1, 3}, {4, 2}, {2, 0}, {1, 1},
	};
	enum { N = sizeof P / sizeof *P };

	(void)state;
	for (uint32_t seed = 0; seed < 2000; seed++) {
		struct shape s = {0};
		struct frame f;
		struct result r;
		uint32_t begin;

		random_state = seed;
		f = random_frame();
		begin = (uint32_t)(uniform() * N);
		for (uint32_t i = 0; i < N; i++) {
			double noise = seed % 2 ? 1e-6 * (uniform() - 0.5) : 0;

			add(&s, P[(begin + i) % N][0] + noise, P[(begin + i) % N][1] - noise);
		}
		r = split(&s, &f);
		assert_false(r.tangled);
		assert_true(fabs(r.area - 10) < (seed % 2 ? 1e-5 : 1e-12));
		free(s.p);
	}
}

/*
 * A tree of square cells, each grown from a side of another: where two cells meet otherwise there
 * is a slit between them, so the outline goes there and back over and over.
 */
static void grow_cells(struct shape *s, uint32_t cells, int width)
{
	enum { SIDE = 40 };
	bool used[SIDE][SIDE] = {{false}};
	uint32_t left = cells - 1;

	s->n = 0;
	for (int i = 0; i < 4; i++)
		add(s, SIDE / 2 + (i == 1 || i == 2), SIDE / 2 + (i > 1));
	used[SIDE / 2][SIDE / 2] = true;
	for (int tries = 0; left > 0 && tries < 100000; tries++) {
		uint32_t at = (uint32_t)(uniform() * s->n);
		double a[2] = {s->p[at][0], s->p[at][1]}, *b = s->p[(at + 1) % s->n];
		double out[2] = {b[1] - a[1], a[0] - b[0]}, end[2] = {b[0], b[1]};
		int x = (int)floor((a[0] + end[0] + out[0]) / 2);
		int y = (int)floor((a[1] + end[1] + out[1]) / 2);

		if (abs(x - SIDE / 2) > width || abs(y - SIDE / 2) > width || used[x][y])
			continue;
		used[x][y] = true;
		left--;
		add(s, 0, 0);
		add(s, 0, 0);
		memmove(s->p + at + 3, s->p + at + 1, (s->n - at - 3) * sizeof *s->p);
		for (int k = 0; k < 2; k++) {
			s->p[at + 1][k] = a[k] + out[k];
			s->p[at + 2][k] = end[k] + out[k];
		}
	}
}

static void test_outlines_that_go_there_and_back(void **state)
{
	struct shape s = {0};

	(void)state;
	for (uint32_t cells = 2; cells < 300; cells += 1 + cells / 6) {
		for (uint32_t seed = 0; seed < 40; seed++) {
			random_state = 1000 * cells + seed;
			grow_cells(&s, cells, seed % 2 ? 12 : (int)sqrt(cells) / 2 + 1);
			check_area(&s);
		}
	}
	free(s.p);
}

static void test_polygons_without_area(void **state)
{
	struct shape s = {0};
	struct result r;

	(void)state;
	for (uint32_t n = 3; n < 12; n++) {
		s.n = 0;
		for (uint32_t i = 0; i < n; i++)
			add(&s, 1, 2);
		r = split(&s, &FLAT);
		assert_true(r.area == 0 && !r.tangled && !r.nonplanar);
		s.n = 0;
		for (uint32_t i = 0; i < n; i++)
			add(&s, i * i % 7, 0);
		r = split(&s, &FLAT);
		assert_true(r.area == 0 && !r.tangled && !r.nonplanar);
	}
	free(s.p);
}

/* Flat, bent, concave, crossed, spiked, tiny, huge, far away: of 2^${scale}. */
static void random_quad(double xyz[4][3], int scale)
{
	struct frame f = random_frame();
	double lift = uniform() < 0.5 ? 0 : exp2(-30 * uniform()), far = exp2(40 * uniform());
	int grid = uniform() < 0.5 ? 3 : 1 << 20; /* few places: flat corners and repeated ones */
	bool axes = uniform() < 0.3;

	for (int i = 0; i < 4; i++) {
		double x = floor(grid * uniform()) / grid, y = floor(grid * uniform()) / grid;
		double z = lift * uniform();

		for (int k = 0; k < 3; k++) {
			double u = axes ? (k == 0 ? x : k == 1 ? y : z) : x * f.u[k] + y * f.v[k];

			xyz[i][k] = ldexp(u + (axes ? 0 : z + far * f.o[k] / 16), scale);
		}
	}
}

static void test_the_short_way_for_quads_is_no_other(void **state)
{
	const uint32_t corner[4] = {0, 1, 2, 3};
	struct mp_polygon p = {0};
	struct mp_error err;
	int usual = 0, bent = 0;

	(void)state;
	random_state = 4;
	for (int i = 0; i < 200000; i++) {
		double xyz[4][3];
		bool nonplanar;

		random_quad(xyz, i % 10 ? 0 : i / 10 % 2000 - 1000);
		if (!mp_polygon_usual_quad((const double(*)[3])xyz, corner, &nonplanar))
			continue;
		usual++;
		bent += nonplanar;
		assert_int_equal(mp_polygon_split(&p, (const double(*)[3])xyz, corner, 4, &err), 0);
		assert_int_equal(p.nonplanar, nonplanar);
		assert_false(p.tangled);
		for (uint32_t k = 0; k < 2; k++) {
			assert_int_equal(p.tri[k][0], 0);
			assert_int_equal(p.tri[k][1], k + 1);
			assert_int_equal(p.tri[k][2], k + 2);
		}
	}
	assert_true(usual > 20000 && bent > 2000 && usual - bent > 2000);
	mp_polygon_free(&p);
}

static void test_polygons_that_are_not_flat(void **state)
{
	const double LIFT[] = {0, 1e-7, 1e-4, 1e-2, 0.5};
	struct mp_polygon p = {0};
	struct mp_error err;

	(void)state;
	for (size_t i = 0; i < sizeof LIFT / sizeof *LIFT; i++) {
		for (int scale = -1000; scale <= 1000; scale += 250) {
			double xyz[5][3] = {
			    {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5, 0.2, 0}, {0, 1, 0}};
			const uint32_t corner[5] = {0, 1, 2, 3, 4};

			xyz[2][2] = LIFT[i];
			for (int k = 0; k < 15; k++)
				xyz[k / 3][k % 3] = ldexp(xyz[k / 3][k % 3], scale);
			for (uint32_t n = 4; n <= 5; n++) {
				assert_int_equal(
				    mp_polygon_split(&p, (const double(*)[3])xyz, corner, n, &err),
				    0);
				assert_int_equal(p.nonplanar, LIFT[i] > 5e-6);
				assert_false(p.tangled);
			}
		}
	}
	mp_polygon_free(&p);
}

static void test_polygons_that_cross_themselves(void **state)
{
	struct shape s = {0};

	(void)state;
	add(&s, 0, 0);
	add(&s, 2, 1);
	add(&s, 2, 0);
	add(&s, 0, 1.5);
	assert_true(split(&s, &FLAT).tangled);
	for (uint32_t n = 40; n < 3000;
	     n = 2 * n + 3) { /* whatever it is, it has n - 2 triangles */
		s.n = 0;
		random_state = n;
		for (uint32_t i = 0; i < n; i++)
			add(&s, floor(100 * uniform()), floor(100 * uniform()));
		assert_true(split(&s, &FLAT).tangled);
	}
	free(s.p);
}

/* Corners at the ends of the range of a double. */
static void test_huge_and_tiny_polygons(void **state)
{
	static const double P[7][2] = {{0, 0},  {1, -1},  {1, 1},    {0, .1},
				       {-1, 1}, {-1, -1}, {-.5, -.5}};
	struct mp_polygon p = {0};
	struct mp_error err;
	double xyz[7][3];
	uint32_t corner[7];

	(void)state;
	for (int scale = -1060; scale <= 1023; scale += 1) {
		for (uint32_t i = 0; i < 7; i++) {
			corner[i] = i;
			xyz[i][0] = ldexp(P[i][0], scale);
			xyz[i][1] = ldexp(P[i][1], scale);
			xyz[i][2] = ldexp(1, scale);
		}
		assert_int_equal(mp_polygon_split(&p, (const double(*)[3])xyz, corner, 7, &err), 0);
		assert_false(p.tangled || p.nonplanar);
	}
	mp_polygon_free(&p);
}

static void test_failing_allocations(void **state)
{
	struct shape s = {0};
	struct mp_error err;
	double xyz[60][3];
	uint32_t corner[60];
	long failed = 0;

	(void)state;
	random_state = 3;
	star(&s, 60, 0.1);
	for (uint32_t i = 0; i < 60; i++) {
		corner[i] = i;
		memcpy(xyz[i], s.p[i], sizeof s.p[i]);
		xyz[i][2] = 0;
	}
	for (long n = 1;; n++) {
		struct mp_polygon p = {0};
		int ret;

		alloc_fail_at(n);
		ret = mp_polygon_split(&p, (const double(*)[3])xyz, corner, 60, &err);
		alloc_fail_at(0);
		if (ret != 0) { /* and then it works */
			assert_int_equal(err.code, MP_NOMEM);
			failed++;
			assert_int_equal(
			    mp_polygon_split(&p, (const double(*)[3])xyz, corner, 60, &err), 0);
		}
		assert_false(p.tangled);
		mp_polygon_free(&p);
		if (ret == 0)
			break;
	}
	assert_int_equal(failed, 2);
	free(s.p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_convex_polygons_are_fans),
	    cmocka_unit_test(test_concave_quads),
	    cmocka_unit_test(test_random_stars),
	    cmocka_unit_test(test_spirals),
	    cmocka_unit_test(test_combs),
	    cmocka_unit_test(test_battlements),
	    cmocka_unit_test(test_holes_on_bridges),
	    cmocka_unit_test(test_bridges_that_share_a_corner),
	    cmocka_unit_test(test_corners_along_a_line),
	    cmocka_unit_test(test_repeated_corners_and_spikes),
	    cmocka_unit_test(test_boundaries_that_touch),
	    cmocka_unit_test(test_rounding_does_no_harm),
	    cmocka_unit_test(test_outlines_that_go_there_and_back),
	    cmocka_unit_test(test_polygons_without_area),
	    cmocka_unit_test(test_the_short_way_for_quads_is_no_other),
	    cmocka_unit_test(test_polygons_that_are_not_flat),
	    cmocka_unit_test(test_polygons_that_cross_themselves),
	    cmocka_unit_test(test_huge_and_tiny_polygons),
	    cmocka_unit_test(test_failing_allocations),
	};

	return cmocka_run_group_tests_name("polygon", tests, NULL, NULL);
}
