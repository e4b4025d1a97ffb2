#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/report_of.h"

static const double TURN = 6.28318530717958647692;

static uint64_t next(uint64_t *s)
{
	*s ^= *s << 13;
	*s ^= *s >> 7;
	*s ^= *s << 17;
	return *s;
}

static void turn(struct mesh *m, size_t i)
{
	double second[3];

	memcpy(second, m->tri[i] + 3, sizeof second);
	memcpy(m->tri[i] + 3, m->tri[i] + 6, sizeof second);
	memcpy(m->tri[i] + 6, second, sizeof second);
}

static void copy(const struct mesh *from, struct mesh *to)
{
	*to = *from;
	to->room = from->count;
	to->tri = malloc(from->count * sizeof *to->tri);
	assert_non_null(to->tri);
	memcpy(to->tri, from->tri, from->count * sizeof *to->tri);
}

/* Turns each triangle from ${first} on with a chance of ${parts} in 16; how many. */
static size_t turn_some(struct mesh *m, size_t first, unsigned parts, uint64_t *seed)
{
	size_t n = 0;

	for (size_t i = first; i < m->count; i++) {
		if (next(seed) % 16 >= parts)
			continue;
		turn(m, i);
		n++;
	}
	return n;
}

/* The report's triangles are those of ${m}, corner by corner; coordinates must be floats. */
static bool is_mesh(const struct mp_report *r, const struct mesh *m)
{
	for (size_t i = 0; i < 3 * m->count; i++) {
		double p[3];

		mp_vertices_get(r->vertices, r->tri[i / 3][i % 3], p);
		for (size_t k = 0; k < 3; k++)
			if (p[k] != m->tri[i / 3][3 * (i % 3) + k])
				return false;
	}
	return true;
}

static void to_floats(struct mesh *m)
{
	for (size_t i = 0; i < 9 * m->count; i++)
		m->tri[i / 9][i % 9] = round(1024 * m->tri[i / 9][i % 9]) / 1024;
}

static void box(struct mesh *m, double at, double size, bool inward)
{
	const double low[3] = {at, at, at}, high[3] = {at + size, at + size, at + size};
	size_t from = m->count;

	mesh_box(m, low, high);
	if (inward)
		mesh_flip(m, from);
}

/* Boxes in boxes, four deep, a torus round another solid and one beside. */
static void make_nested(struct mesh *m)
{
	box(m, 100, 40, false);
	box(m, 105, 30, true);
	box(m, 110, 20, false);
	box(m, 115, 10, true);
	mesh_torus(m, 20, 6, 14, 9);
	box(m, -3, 6, false);
	to_floats(m);
}

static void same_solid(const struct mp_report *a, const struct mp_report *b)
{
	assert_true(a->total.volume == b->total.volume);
	assert_memory_equal(a->total.centroid, b->total.centroid, sizeof a->total.centroid);
	assert_memory_equal(a->total.inertia, b->total.inertia, sizeof a->total.inertia);
	assert_memory_equal(&a->bounds, &b->bounds, sizeof a->bounds);
	assert_int_equal(a->orientation, b->orientation);
	assert_int_equal(a->solid, b->solid);
	assert_int_equal(a->warnings, b->warnings);
	assert_int_equal(a->bodies_listed, b->bodies_listed);
	for (uint32_t i = 0; i < a->bodies_listed; i++) {
		assert_int_equal(a->body[i].orientation, b->body[i].orientation);
		assert_int_equal(a->body[i].cavity, b->body[i].cavity);
		assert_true(a->body[i].mass.volume == b->body[i].mass.volume);
	}
}

/* What is turned at random comes back, to the bit, and is promised before. */
static void assert_repaired(const struct mesh *good, uint64_t *seed)
{
	static const enum mp_precision_wish wishes[] = {MP_WISH_EXACT, MP_WISH_CERTIFIED,
							MP_WISH_PRECISION_AUTO};
	static const unsigned parts[] = {1, 8, 16};

	for (int i = 0; i < 9; i++) {
		struct mp_request request = request_plain();
		struct mesh bad;
		struct mp_report a, b, c;
		size_t turned;

		copy(good, &bad);
		turned = turn_some(&bad, 0, parts[i / 3], seed);
		request.precision = wishes[i % 3];
		report_of_binary(good, &request, &a);
		report_of_binary(&bad, &request, &b);
		request.orient = true;
		report_of_binary(&bad, &request, &c);
		assert_true(a.topology.closed && a.orientation == MP_ORIENTATION_OUTWARD);
		same_solid(&a, &c);
		assert_true(is_mesh(&c, good));
		assert_int_equal(c.flipped_triangles, turned);
		assert_true(c.topology.winding_consistent);
		assert_false(c.volume_if_oriented_defined);
		if (parts[i / 3] < 16 && b.topology.misoriented_edges > 0) {
			assert_false(b.total.volume_defined);
			assert_true(b.volume_if_oriented_defined);
			assert_near(b.volume_if_oriented, a.total.volume,
				    1e-12 * a.total.volume + a.bounds.volume);
			assert_int_equal(b.flipped_triangles, 0);
		}
		mp_report_free(&a);
		mp_report_free(&b);
		mp_report_free(&c);
		mesh_free(&bad);
	}
}

static void nested_bodies_come_back(void **state)
{
	struct mesh m = {0};
	uint64_t seed = 1234;

	(void)state;
	make_nested(&m);
	assert_repaired(&m, &seed);
	mesh_free(&m);
}

static void bodies_that_share_an_edge_or_a_vertex_come_back(void **state)
{
	static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
	uint64_t seed = 777;

	(void)state;
	for (int shared = 0; shared < 2; shared++) {
		struct mesh m = {0};

		mesh_box(&m, low, high);
		mesh_box(&m, low, high);
		mesh_move(&m, 12, 1, 1, shared);
		mesh_sphere(&m, 0.25, 8, 6); /* inside the first */
		to_floats(&m);
		mesh_flip(&m, 24);
		mesh_move(&m, 24, 0.5, 0.5, 0.5);
		assert_repaired(&m, &seed);
		mesh_free(&m);
	}
}

/* ${corner}: r and z of a section's corners; the strips between them around the z axis. */
static void revolve(struct mesh *m, const double (*corner)[2], size_t n, int around)
{
	for (size_t k = 0; k + 1 < n; k++) {
		for (int i = 0; i < around; i++) {
			double p[4][3];

			for (int c = 0; c < 4; c++) {
				const double *at = corner[k + (c == 1 || c == 2)];
				double angle = TURN * ((i + (c > 1)) % around) / around;

				p[c][0] = at[0] * cos(angle);
				p[c][1] = at[0] * sin(angle);
				p[c][2] = at[1];
			}
			mesh_quad(m, p[0], p[1], p[2], p[3]);
		}
	}
}

/*
 * Two rings whose sections are crescents that touch at both ends: four sheets between two circles,
 * none of which is closed, and four triangles at every edge of the circles.
 */
static void sheets_between_edges_of_many_come_back(void **state)
{
	static const double arc[4][3][2] = {{{20, 0}, {15, 6}, {10, 0}},
					    {{10, 0}, {15, 2}, {20, 0}},
					    {{20, 0}, {15, -2}, {10, 0}},
					    {{10, 0}, {15, -6}, {20, 0}}};
	struct mesh m = {0};
	struct mp_report r;
	uint64_t seed = 31;

	(void)state;
	for (int i = 0; i < 4; i++)
		revolve(&m, arc[i], 3, 12);
	to_floats(&m);
	report_of_binary(&m, NULL, &r);
	assert_int_equal(r.topology.bodies, 1);
	assert_int_equal(r.topology.non_manifold_edges, 24);
	if (r.total.volume < 0)
		mesh_flip(&m, 0);
	mp_report_free(&r);
	assert_repaired(&m, &seed);
	mesh_free(&m);
}

/* The surface of random cubes: edges of four triangles, pinched vertices, holes, cavities. */
static void make_cubes(struct mesh *m, uint64_t *seed, unsigned parts)
{
	enum { N = 4 };
	bool full[N + 2][N + 2][N + 2] = {{{false}}};

	for (int i = 0; i < N * N * N; i++)
		full[1 + i / (N * N)][1 + i / N % N][1 + i % N] = next(seed) % 16 < parts;
	for (int i = 0; i < (N + 1) * (N + 1) * (N + 1); i++) {
		int at[3] = {i / ((N + 1) * (N + 1)), i / (N + 1) % (N + 1), i % (N + 1)};

		for (int k = 0; k < 3; k++) {
			int to[3] = {at[0], at[1], at[2]};
			double p[4][3];
			bool a = full[at[0]][at[1]][at[2]], b;

			to[k]++;
			b = full[to[0]][to[1]][to[2]];
			if (a == b)
				continue;
			for (int c = 0; c < 4; c++) {
				p[c][k] = at[k];
				p[c][(k + 1) % 3] = at[(k + 1) % 3] - (c == 0 || c == 3);
				p[c][(k + 2) % 3] = at[(k + 2) % 3] - (c < 2);
			}
			if (a)
				mesh_quad(m, p[0], p[1], p[2], p[3]);
			else
				mesh_quad(m, p[3], p[2], p[1], p[0]);
		}
	}
}

static void heaps_of_cubes_come_back(void **state)
{
	uint64_t seed = 20;
	int tried = 0;

	(void)state;
	for (int i = 0; i < 60; i++) {
		struct mesh m = {0};
		struct mp_report r;

		make_cubes(&m, &seed, 3 + (unsigned)i % 11);
		report_of_binary(&m, NULL, &r);
		assert_true(r.topology.closed && r.total.volume > 0);
		if (!MP_WARNED(&r, MP_WARN_NESTING_UNDECIDED)) {
			assert_repaired(&m, &seed);
			tried++;
		}
		mp_report_free(&r);
		mesh_free(&m);
	}
	assert_true(tried > 50);
}

static void open_bodies_are_wound_as_most_of_their_triangles(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0}, bad;
	struct mp_report r;

	(void)state;
	mesh_sphere(&m, 8, 12, 8);
	to_floats(&m);
	m.count -= 12; /* no cap */
	copy(&m, &bad);
	for (size_t i = 0; i < 10; i++)
		turn(&bad, 7 * i);
	request.orient = true;
	report_of_binary(&bad, &request, &r);
	assert_int_equal(r.flipped_triangles, 10);
	assert_true(is_mesh(&r, &m) && r.topology.winding_consistent);
	assert_false(r.total.volume_defined || r.volume_if_oriented_defined);
	assert_int_equal(r.body[0].genus, -1);
	assert_true(r.body[0].orientable);
	mp_report_free(&r);
	request.orient = false;
	report_of_binary(&bad, &request, &r);
	assert_true(r.body[0].orientable && !r.volume_if_oriented_defined);
	assert_false(MP_WARNED(&r, MP_WARN_NON_ORIENTABLE));
	mp_report_free(&r);
	mesh_free(&bad);
	mesh_free(&m);
}

static void moebius(struct mesh *m, int n)
{
	for (int i = 0; i < n; i++) {
		double p[4][3];

		for (int c = 0; c < 4; c++) {
			int j = i + (c == 1 || c == 2);
			double side = c > 1 ? 1 : -1, angle = TURN * (j % n) / n;

			if (j == n)
				side = -side;
			p[c][0] = (10 + side * cos(angle / 2)) * cos(angle);
			p[c][1] = (10 + side * cos(angle / 2)) * sin(angle);
			p[c][2] = side * sin(angle / 2);
		}
		mesh_quad(m, p[0], p[1], p[2], p[3]);
	}
}

/* The figure-8 immersion: it crosses itself, but no vertices coincide. */
static void klein(struct mesh *m, int n, int k)
{
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < k; j++) {
			double p[4][3];

			for (int c = 0; c < 4; c++) {
				int a = i + (c == 1 || c == 2), b = j + (c > 1);
				double u, v, r;

				if (a == n)
					b = k - b;
				u = TURN * (a % n) / n;
				v = TURN * ((b % k) + 0.25 * 0) / k;
				r = 10 + 3 * (cos(u / 2) * sin(v) - sin(u / 2) * sin(2 * v));
				p[c][0] = r * cos(u);
				p[c][1] = r * sin(u);
				p[c][2] = 3 * (sin(u / 2) * sin(v) + cos(u / 2) * sin(2 * v)) +
					  0.5 * cos(v);
			}
			mesh_quad(m, p[0], p[1], p[2], p[3]);
		}
	}
}

static void what_has_one_side_is_named_and_left(void **state)
{
	uint64_t seed = 8;

	(void)state;
	for (int which = 0; which < 2; which++) {
		struct mp_request request = request_plain();
		struct mesh m = {0}, bad;
		struct mp_report r;
		size_t strip, turned;

		if (which == 0)
			moebius(&m, 21);
		else
			klein(&m, 21, 13);
		strip = m.count;
		box(&m, 100, 5, false);
		to_floats(&m);
		copy(&m, &bad);
		turned = turn_some(&bad, strip, 5, &seed);
		report_of_binary(&bad, NULL, &r);
		assert_int_equal(r.topology.bodies, 2);
		assert_false(r.body[0].orientable);
		assert_true(r.body[1].orientable);
		assert_true(MP_WARNED(&r, MP_WARN_NON_ORIENTABLE));
		assert_int_equal(r.body[0].watertight, which == 1);
		assert_int_equal(r.body[0].genus, -1);
		assert_int_equal(r.body[1].genus, 0);
		assert_false(r.volume_if_oriented_defined || r.total.volume_defined);
		mp_report_free(&r);
		request.orient = true;
		report_of_binary(&bad, &request, &r);
		assert_true(is_mesh(&r, &m));
		assert_int_equal(r.flipped_triangles, turned);
		assert_true(!r.body[0].orientable && MP_WARNED(&r, MP_WARN_NON_ORIENTABLE));
		assert_true(r.body[1].mass.volume == 125);
		mp_report_free(&r);
		mesh_free(&bad);
		mesh_free(&m);
	}
}

/* Faces of a box that share no edge: each is cut at its edges in its own way. */
static void make_cracked(struct mesh *m)
{
	for (int f = 0; f < 6; f++) {
		int k = f / 2, cuts = k == 0 ? 1 : k == 1 ? 2 : 4;
		double rim[4 * 5][3], centre[3] = {6, 6, 6};
		size_t n = 0;

		centre[k] = f % 2 == 0 ? 0 : 12;
		for (int side = 0; side < 4; side++) {
			for (int i = 0; i < cuts; i++) {
				double s = 12.0 * i / cuts;
				double u = side == 0 ? s : side == 1 ? 12 : side == 2 ? 12 - s : 0;
				double v = side == 0 ? 0 : side == 1 ? s : side == 2 ? 12 : 12 - s;

				rim[n][k] = centre[k];
				rim[n][(k + 1) % 3] = u;
				rim[n++][(k + 2) % 3] = v;
			}
		}
		for (size_t i = 0; i < n; i++) {
			const double *a = rim[i], *b = rim[(i + 1) % n];

			mesh_triangle(m, centre, f % 2 == 0 ? b : a, f % 2 == 0 ? a : b);
		}
	}
}

static void cracked_solids_are_turned_as_one(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	make_cracked(&m);
	request.orient = true;
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume == 1728 && r.flipped_triangles == 0);
	assert_int_equal(r.topology.bodies, 6);
	mp_report_free(&r);
	mesh_flip(&m, 0);
	turn(&m, 9);
	report_of_binary(&m, &request, &r);
	assert_true(r.total.volume == 1728 && r.flipped_triangles == m.count - 1);
	mp_report_free(&r);
	request.orient = false;
	report_of_binary(&m, &request, &r);
	assert_true(r.volume_if_oriented_defined);
	assert_near(r.volume_if_oriented, 1728, 1e-9);
	mp_report_free(&r);
	mesh_free(&m);
}

static void turned_twice_is_not_turned(void **state)
{
	struct mp_request request = request_plain();
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	make_nested(&m);
	turn(&m, 3);
	turn(&m, 50);
	request.orient = request.flip = true;
	report_of_binary(&m, &request, &r);
	assert_int_equal(r.flipped_triangles, 2);
	assert_true(r.total.volume > 0 && r.orientation == MP_ORIENTATION_OUTWARD);
	mp_report_free(&r);
	mesh_free(&m);
}

/* Tables with ${holes} holes through them, of cubes. */
static void make_table(struct mesh *m, int holes)
{
	for (int x = 0; x <= 2 * holes; x++) {
		for (int y = 0; y < 3; y++) {
			const double low[3] = {x, y, 0}, high[3] = {x + 1, y + 1, 1};

			if (x % 2 == 0 || y != 1)
				mesh_box(m, low, high);
		}
	}
	for (size_t i = 0; i < m->count; i++) { /* walls between cubes: both sides go */
		for (size_t j = i + 1; j < m->count; j++) {
			double a[9], sum = 0;

			memcpy(a, m->tri[j], sizeof a);
			for (int c = 0; c < 3; c++)
				for (int d = 0; d < 3; d++)
					sum += memcmp(m->tri[i] + 3 * c, a + 3 * d, 24) == 0;
			if (sum < 3)
				continue;
			memcpy(m->tri[j], m->tri[--m->count], sizeof a);
			memcpy(m->tri[i], m->tri[--m->count], sizeof a);
			i--;
			break;
		}
	}
}

static void genus_counts_handles(void **state)
{
	(void)state;
	for (int holes = 0; holes < 4; holes++) {
		struct mesh m = {0};
		struct mp_report r;

		make_table(&m, holes);
		report_of_binary(&m, NULL, &r);
		assert_true(r.topology.watertight);
		assert_int_equal(r.body[0].genus, holes);
		mp_report_free(&r);
		mesh_torus(&m, 20, 6, 14, 9); /* another body, and a pinched pair */
		box(&m, 50, 1, false);
		box(&m, 51, 1, false);
		report_of_binary(&m, NULL, &r);
		assert_int_equal(r.topology.bodies, 4);
		assert_int_equal(r.topology.non_manifold_vertices, 1);
		assert_int_equal(r.body[0].genus, holes);
		assert_int_equal(r.body[1].genus, 1);
		assert_int_equal(r.body[2].genus, 0);
		assert_int_equal(r.body[3].genus, 0);
		mp_report_free(&r);
		turn(&m, 2); /* how it is wound does not matter */
		report_of_binary(&m, NULL, &r);
		assert_int_equal(r.body[0].genus, holes);
		mp_report_free(&r);
		mesh_free(&m);
	}
}

/* A body that touches itself in a vertex: a chain of cubes whose ends meet corner to corner. */
static void a_pinched_body_has_no_genus(void **state)
{
	static const double at[][3] = {{0, 0, 0}, {0, 0, -1}, {1, 0, -1}, {2, 0, -1}, {3, 0, -1},
				       {3, 0, 0}, {3, 0, 1},  {3, 1, 1},  {2, 1, 1},  {1, 1, 1}};
	struct mesh m = {0};
	struct mp_report r;

	(void)state;
	for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
		double high[3];

		for (int k = 0; k < 3; k++)
			high[k] = at[i][k] + 1;
		mesh_box(&m, at[i], high);
	}
	for (size_t i = 0; i < m.count; i++) {
		for (size_t j = i + 1; j < m.count; j++) {
			int sum = 0;

			for (int c = 0; c < 9; c++)
				sum +=
				    memcmp(m.tri[i] + 3 * (c / 3), m.tri[j] + 3 * (c % 3), 24) == 0;
			if (sum < 3)
				continue;
			memcpy(m.tri[j], m.tri[--m.count], sizeof m.tri[j]);
			memcpy(m.tri[i], m.tri[--m.count], sizeof m.tri[i]);
			i--;
			break;
		}
	}
	report_of_binary(&m, NULL, &r);
	assert_int_equal(r.topology.bodies, 1);
	assert_int_equal(r.topology.non_manifold_vertices, 1);
	assert_true(r.topology.watertight);
	assert_int_equal(r.body[0].genus, -1);
	assert_true(r.body[0].orientable);
	mp_report_free(&r);
	mesh_free(&m);
}

static void every_allocation_may_fail(void **state)
{
	struct mp_request request = request_plain();

	(void)state;
	for (int orient = 0; orient < 2; orient++) {
		struct mesh m = {0};
		uint64_t seed = 3;

		make_nested(&m);
		make_cracked(&m);
		moebius(&m, 9);
		make_cubes(&m, &seed, 8);
		(void)turn_some(&m, 0, 5, &seed);
		request.orient = orient == 1;
		report_without_memory(&m, &request, 5000);
		mesh_free(&m);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(nested_bodies_come_back),
	    cmocka_unit_test(bodies_that_share_an_edge_or_a_vertex_come_back),
	    cmocka_unit_test(sheets_between_edges_of_many_come_back),
	    cmocka_unit_test(heaps_of_cubes_come_back),
	    cmocka_unit_test(open_bodies_are_wound_as_most_of_their_triangles),
	    cmocka_unit_test(what_has_one_side_is_named_and_left),
	    cmocka_unit_test(cracked_solids_are_turned_as_one),
	    cmocka_unit_test(turned_twice_is_not_turned),
	    cmocka_unit_test(genus_counts_handles),
	    cmocka_unit_test(a_pinched_body_has_no_genus),
	    cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests_name("orient", tests, NULL, NULL);
}
