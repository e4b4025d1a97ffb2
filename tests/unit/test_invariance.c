#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/report/report.h"
#include "tests/unit/mesh_random.h"
#include "tests/unit/report_of.h"

/*
 * What must not change, or change as it is known to, when a mesh is written down another way:
 * exact results bit for bit, certified ones within their bounds.  Coordinates are whole numbers,
 * so that what is done to them is done exactly.
 */
#ifdef MP_SANITIZED
enum { MESHES = 25 };
#else
enum { MESHES = 150 };
#endif

enum { GRID = 6 }; /* coordinates are multiples: edges have middles, triangles too */

static const enum mp_precision_wish wish[2] = {MP_WISH_CERTIFIED, MP_WISH_EXACT};

/* What a change does to each result. */
struct change {
	double volume, area; /* factors */
	double inertia;      /* of the tensor, in its new axes */
	double turn[3][3];   /* of the centroid, */
	double move[3];      /* and after that */
	double tensor[3][3]; /* the tensor becomes tensor*I*tensor^T times inertia */
	bool bits;           /* exact results become exactly that */
};

static const struct change nothing = {.volume = 1,
				      .area = 1,
				      .inertia = 1,
				      .turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
				      .tensor = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
				      .bits = true};

/* A random mesh with coordinates up to about 2^20; spares those without a volume. */
static void draw(struct mesh *m, uint64_t *state)
{
	for (;;) {
		struct random_mesh random;
		struct mp_report r;
		double most = 0;
		bool good;

		mesh_random(&random, state);
		for (size_t i = 0; i < 9 * random.mesh.count; i++)
			most = fmax(most, fabs(random.mesh.tri[i / 9][i % 9]));
		for (size_t i = 0; i < 9 * random.mesh.count; i++)
			random.mesh.tri[i / 9][i % 9] =
			    GRID * rint(random.mesh.tri[i / 9][i % 9] / most * 0x1p17);
		report_of_ascii(&random.mesh, NULL, &r);
		good = r.total.inertia_defined && r.topology.closed;
		mp_report_free(&r);
		if (good) {
			*m = random.mesh;
			return;
		}
		mesh_free(&random.mesh);
	}
}

static void near_enough(const char *what, double value, double want, double bound)
{
	if (!(fabs(value - want) <= bound * (1 + 1e-12) + fabs(want) * 0x1p-51))
		fail_msg("%s: %.17g instead of %.17g, bounds %g", what, value, want, bound);
}

/* Linear: ${bits} and exact numbers leave no room; else each may be off by its bound. */
static void check_centroid(const struct mp_report *a, const struct mp_report *b,
			   const struct change *c, bool bits)
{
	for (int i = 0; i < 3; i++) {
		double want = c->move[i], scale = 0;

		for (int k = 0; k < 3; k++) {
			want += c->turn[i][k] * a->total.centroid[k];
			scale += fabs(c->turn[i][k]);
		}
		if (bits && c->move[i] == 0)
			assert_true(b->total.centroid[i] == want);
		else
			near_enough("centroid", b->total.centroid[i], want,
				    scale * a->bounds.centroid + b->bounds.centroid +
					0x1p-50 * fabs(c->move[i]));
	}
}

static void check_inertia(const struct mp_report *a, const struct mp_report *b,
			  const struct change *c, bool bits)
{
	for (int i = 0; i < 9; i++) {
		double want = 0, scale = 0, size = 0;

		for (int k = 0; k < 9; k++) {
			double f = c->tensor[i / 3][k / 3] * c->tensor[i % 3][k % 3];

			want += f * a->total.inertia[k / 3][k % 3];
			scale += fabs(f);
			size += fabs(f * a->total.inertia[k / 3][k % 3]);
		}
		if (bits)
			assert_true(b->total.inertia[i / 3][i % 3] == want * c->inertia);
		else
			near_enough("inertia", b->total.inertia[i / 3][i % 3], want * c->inertia,
				    c->inertia * (scale * a->bounds.inertia + 0x1p-50 * size) +
					b->bounds.inertia);
	}
	for (int k = 0; k < 3; k++)
		near_enough("moments", b->principal.moments[k],
			    a->principal.moments[k] * c->inertia,
			    c->inertia * a->bounds.moments + b->bounds.moments);
}

static void check(const struct mp_report *a, const struct mp_report *b, const struct change *c)
{
	bool bits = c->bits && b->precision == MP_PRECISION_EXACT;

	assert_int_equal(a->precision, b->precision);
	assert_true(b->total.volume_defined && b->total.inertia_defined);
	if (bits)
		assert_true(b->total.volume == a->total.volume * c->volume);
	near_enough("volume", b->total.volume, a->total.volume * c->volume,
		    fabs(c->volume) * a->bounds.volume + b->bounds.volume);
	near_enough("area", b->total.area, a->total.area * c->area,
		    c->area * a->bounds.area + b->bounds.area);
	check_centroid(a, b, c, bits);
	check_inertia(a, b, c, bits);
}

/* Before and after ${act}, by both kinds of sums, of many meshes. */
static void every_mesh(uint64_t seed, void (*act)(struct mesh *, uint64_t *, struct change *))
{
	uint64_t state = seed;

	for (int i = 0; i < MESHES; i++) {
		struct mp_request request = request_plain();
		struct change change = nothing;
		struct mp_report a[2], b;
		struct mesh m;

		draw(&m, &state);
		for (int w = 0; w < 2; w++) {
			request.precision = wish[w];
			report_of_ascii(&m, &request, &a[w]);
		}
		act(&m, &state, &change);
		for (int w = 0; w < 2; w++) {
			request.precision = wish[w];
			report_of_ascii(&m, &request, &b);
			check(&a[w], &b, &change);
			mp_report_free(&b);
			mp_report_free(&a[w]);
		}
		mesh_free(&m);
	}
}

static void reorder(struct mesh *m, uint64_t *state, struct change *c)
{
	(void)c;
	for (size_t i = m->count - 1; i > 0; i--) {
		size_t j = (size_t)(random_bits(state) % (i + 1));
		int by = (int)(random_bits(state) % 3);
		double t[9];

		memcpy(t, m->tri[j], sizeof t);
		memcpy(m->tri[j], m->tri[i], sizeof t);
		for (int k = 0; k < 9; k++)
			m->tri[i][k] = t[(k + 3 * by) % 9];
	}
}

static void the_order_of_facets_and_corners_does_not_matter(void **unused)
{
	(void)unused;
	every_mesh(101, reorder);
}

static void turn_inside_out(struct mesh *m, uint64_t *state, struct change *c)
{
	(void)state;
	mesh_flip(m, 0);
	c->volume = -1;
}

static void flipping_changes_the_sign_alone(void **unused)
{
	(void)unused;
	every_mesh(102, turn_inside_out);
}

static void shift(struct mesh *m, uint64_t *state, struct change *c)
{
	for (int k = 0; k < 3; k++)
		c->move[k] = rint(random_between(state, -1, 1) * 0x1p40);
	mesh_move(m, 0, c->move[0], c->move[1], c->move[2]);
}

static void moving_far_away_moves_the_centroid_alone(void **unused)
{
	(void)unused;
	every_mesh(103, shift);
}

static void grow(struct mesh *m, uint64_t *state, struct change *c)
{
	double by = ldexp(1, (int)(random_bits(state) % 200) - 100);

	mesh_scale(m, 0, by, by, by);
	c->volume = by * by * by;
	c->area = by * by;
	c->inertia = by * by * by * by * by;
	for (int k = 0; k < 3; k++)
		c->turn[k][k] = by;
}

static void scaling_by_powers_of_two_changes_no_digit(void **unused)
{
	(void)unused;
	every_mesh(104, grow);
}

/* Axes change places and signs: nothing is rounded. */
static void permute(struct mesh *m, uint64_t *state, struct change *c)
{
	static const double right[3][3] = {{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};

	(void)state;
	memcpy(c->turn, right, sizeof right);
	memcpy(c->tensor, right, sizeof right);
	for (size_t i = 0; i < 3 * m->count; i++) {
		double *x = m->tri[i / 3] + i % 3 * 3, y[3] = {-x[1], x[2], -x[0]};

		memcpy(x, y, sizeof y);
	}
}

static void quarter_turns_change_no_digit(void **unused)
{
	(void)unused;
	every_mesh(105, permute);
}

/* 3-4-5 about two axes: 25 times a rotation. */
static void rotate(struct mesh *m, uint64_t *state, struct change *c)
{
	static const double r[3][3] = {{15, -20, 0}, {12, 9, -20}, {16, 12, 15}};

	(void)state;
	for (size_t i = 0; i < 3 * m->count; i++) {
		double *x = m->tri[i / 3] + i % 3 * 3, y[3];

		for (int k = 0; k < 3; k++)
			y[k] = r[k][0] * x[0] + r[k][1] * x[1] + r[k][2] * x[2];
		memcpy(x, y, sizeof y);
	}
	memcpy(c->turn, r, sizeof r);
	memcpy(c->tensor, r, sizeof r);
	for (int k = 0; k < 9; k++)
		c->tensor[k / 3][k % 3] /= 25;
	c->volume = 25 * 25 * 25;
	c->area = 25 * 25;
	c->inertia = 25.0 * 25 * 25 * 25 * 25;
	c->bits = false;
}

static void turning_turns_the_tensor(void **unused)
{
	(void)unused;
	every_mesh(106, rotate);
}

/* A point inside: three triangles for one. */
static void split_inside(struct mesh *m, uint64_t *state, struct change *c)
{
	size_t count = m->count;

	(void)c;
	for (size_t i = 0; i < count; i++) {
		double t[9], middle[3];

		if (random_chance(state, 0.5))
			continue;
		memcpy(t, m->tri[i], sizeof t);
		for (int k = 0; k < 3; k++)
			middle[k] = (t[k] + t[3 + k] + t[6 + k]) / 3;
		memcpy(m->tri[i] + 6, middle, sizeof middle);
		mesh_triangle(m, t + 3, t + 6, middle);
		mesh_triangle(m, t + 6, t, middle);
	}
}

static void points_inside_facets_change_nothing(void **unused)
{
	(void)unused;
	every_mesh(107, split_inside);
}

/* A point on one edge of every triangle that has it, or (cracks) of one of them. */
static void split_edges(struct mesh *m, uint64_t *state, struct change *c)
{
	size_t count = m->count;

	(void)state;
	(void)c;
	for (size_t i = 0; i < count; i++) {
		double t[9], middle[3];

		memcpy(t, m->tri[i], sizeof t);
		for (int k = 0; k < 3; k++)
			middle[k] = (t[k] + t[3 + k]) / 2;
		memcpy(m->tri[i] + 3, middle, sizeof middle);
		mesh_triangle(m, middle, t + 3, t + 6);
	}
}

static void points_on_edges_change_nothing(void **unused)
{
	(void)unused;
	every_mesh(108, split_edges);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(the_order_of_facets_and_corners_does_not_matter),
	    cmocka_unit_test(flipping_changes_the_sign_alone),
	    cmocka_unit_test(moving_far_away_moves_the_centroid_alone),
	    cmocka_unit_test(scaling_by_powers_of_two_changes_no_digit),
	    cmocka_unit_test(quarter_turns_change_no_digit),
	    cmocka_unit_test(turning_turns_the_tensor),
	    cmocka_unit_test(points_inside_facets_change_nothing),
	    cmocka_unit_test(points_on_edges_change_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
