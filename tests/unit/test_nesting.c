#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "alloc_fail.h"
#include "core/bodies/nesting.h"
#include "soup.h"

struct nested {
	struct found f;
	struct mp_box *box;
	struct mp_nest *nest;
};

static int nest(struct nested *n, struct mp_error *err)
{
	found_boxes(&n->f, n->box);
	return mp_nesting_find(&n->f.built.mesh, &n->f.t, n->box, n->nest, err);
}

static void look(struct nested *n)
{
	found_look(&n->f, 0);
	n->box = malloc(n->f.t.bodies * sizeof *n->box);
	n->nest = malloc(n->f.t.bodies * sizeof *n->nest);
	assert_int_equal(nest(n, NULL), 0);
}

static void done(struct nested *n)
{
	found_free(&n->f);
	free(n->box);
	free(n->nest);
	memset(n, 0, sizeof *n);
}

static void is(const struct nested *n, uint32_t body, uint32_t depth, uint32_t parent)
{
	assert_true(n->nest[body].decided);
	assert_int_equal(n->nest[body].depth, depth);
	assert_int_equal(n->nest[body].parent, parent);
}

static void shells_in_shells(void **unused)
{
	struct nested n = {0};

	(void)unused;
	for (int i = 0; i <= 20; i++) /* the odd ones from within to without */
		soup_cube(&n.f.soup, i, i, i, 100 - 2 * i);
	look(&n);
	assert_int_equal(n.f.t.bodies, 21);
	for (uint32_t i = 0; i <= 20; i++)
		is(&n, i, i, i == 0 ? MP_NO_BODY : i - 1);
	done(&n);
	for (int i = 20; i >= 0; i--)
		soup_cube(&n.f.soup, i, i, i, 100 - 2 * i);
	look(&n);
	for (uint32_t i = 0; i <= 20; i++)
		is(&n, i, 20 - i, i == 20 ? MP_NO_BODY : i + 1);
	done(&n);
}

static void the_hole_of_a_torus_is_outside(void **unused)
{
	struct nested n = {0};

	(void)unused;
	soup_torus(&n.f.soup, 40, 20, 10, 3);
	soup_cube(&n.f.soup, -1, -1, -1, 2);           /* in the hole */
	soup_cube(&n.f.soup, 9.5, -0.5, -0.5, 1);      /* in the ring */
	soup_cube(&n.f.soup, 9.75, -0.25, -0.25, 0.5); /* in that one */
	soup_cube(&n.f.soup, -12.9, -12.9, -0.5, 1);   /* in the box, outside of the ring */
	look(&n);
	is(&n, 0, 0, MP_NO_BODY);
	is(&n, 1, 0, MP_NO_BODY);
	is(&n, 2, 1, 0);
	is(&n, 3, 2, 2);
	is(&n, 4, 0, MP_NO_BODY);
	done(&n);
}

/* Most of the corners lie on the container's surface and say nothing; one does. */
static void touching_bodies_are_decided_by_what_does_not_touch(void **unused)
{
	const double min[3] = {0, 0.25, 0.25}, max[3] = {4, 0.5, 0.5};
	const double apex[3] = {2, 2, 1}, a[3] = {1, 1, 0}, b[3] = {3, 1, 0}, c[3] = {2, 3, 0};
	const double under[3] = {2, 2, -1};
	struct nested n = {0};

	(void)unused;
	soup_cube(&n.f.soup, 0, 0, 0, 4);
	soup_add(&n.f.soup, a, c, b); /* stands on the bottom from within */
	soup_add(&n.f.soup, a, b, apex);
	soup_add(&n.f.soup, b, c, apex);
	soup_add(&n.f.soup, c, a, apex);
	look(&n);
	is(&n, 1, 1, 0);
	done(&n);
	soup_cube(&n.f.soup, 0, 0, 0, 4);
	soup_cube(&n.f.soup, 0, 0, -4, 1); /* stretches the box, touches nothing */
	soup_add(&n.f.soup, a, b, c);
	soup_add(&n.f.soup, a, under, b);
	soup_add(&n.f.soup, b, under, c);
	soup_add(&n.f.soup, c, under, a);
	look(&n);
	is(&n, 2, 0, MP_NO_BODY);
	done(&n);
	soup_cube(&n.f.soup, 0, 0, 0, 4);
	soup_box(&n.f.soup, min, max); /* all corners are on the walls */
	look(&n);
	assert_false(n.nest[1].decided);
	assert_int_equal(n.nest[1].depth, 0);
	is(&n, 0, 0, MP_NO_BODY);
	done(&n);
}

/* A box twice, once more divided: they share vertices, but no edge.  Beside them an easy case. */
static void coincident_shells_do_not_contain_each_other(void **unused)
{
	struct nested n = {0};

	(void)unused;
	soup_cube(&n.f.soup, 0, 0, 0, 64);
	for (int i = 0; i < 4; i++)
		soup_divide(&n.f.soup, 0);
	soup_cube(&n.f.soup, 0, 0, 0, 64);
	for (int i = 0; i < 5; i++)
		soup_divide(&n.f.soup, 12u << 8);
	soup_cube(&n.f.soup, 100, 0, 0, 9);
	soup_cube(&n.f.soup, 101, 1, 1, 1);
	look(&n);
	assert_int_equal(n.f.t.bodies, 4);
	assert_true(n.f.t.watertight);
	for (int b = 0; b < 2; b++) {
		assert_false(n.nest[b].decided);
		assert_int_equal(n.nest[b].depth, 0);
		assert_int_equal(n.nest[b].parent, MP_NO_BODY);
	}
	is(&n, 3, 1, 2); /* the work on the others was bearable */
	done(&n);
}

/* Half in, half out, and the corner that is looked at first is in. */
static void what_sticks_out_is_not_contained(void **unused)
{
	struct nested n = {0};

	(void)unused;
	for (int k = 0; k < 3; k++) {
		soup_cube(&n.f.soup, 0, 0, 0, 4);
		soup_cube(&n.f.soup, k == 0 ? 3 : 1, k == 1 ? 3 : 1, k == 2 ? 3 : 1, 2);
		look(&n);
		is(&n, 1, 0, MP_NO_BODY);
		done(&n);
	}
}

/* One of the two tetrahedra in the corners of a cube of 4, one facet with a dent. */
static void add_dented(struct soup *s, bool mirror, double scale)
{
	double p[5][3] = {{0, 0, 0}, {4, 4, 0}, {4, 0, 4}, {0, 4, 4}, {2.5, 2.5, 2.5}};

	for (int i = 0; mirror && i < 5; i++)
		p[i][1] = 4 - p[i][1];
	for (int i = 0; i < 15; i++)
		p[i / 3][i % 3] *= scale;
	soup_add(s, p[4], p[1], p[3]);
	soup_add(s, p[4], p[3], p[2]);
	soup_add(s, p[4], p[2], p[1]);
	soup_add(s, p[0], p[1], p[2]);
	soup_add(s, p[0], p[2], p[3]);
	soup_add(s, p[0], p[3], p[1]);
}

/*
 * The same box, and the dent of each is in the other.  Where both are judged by their dents each
 * lies in the other: never a ring of parents.  By which corner depends on places, so scales differ.
 */
static void crossing_bodies_are_undecided(void **unused)
{
	int rings = 0;

	(void)unused;
	for (int scale = 1; scale <= 400; scale++) {
		struct nested n = {0};

		add_dented(&n.f.soup, false, scale);
		add_dented(&n.f.soup, true, scale);
		look(&n);
		assert_int_equal(n.f.t.bodies, 2);
		assert_int_equal(n.nest[0].decided, n.nest[1].decided);
		assert_true(n.nest[0].parent == MP_NO_BODY || n.nest[1].parent == MP_NO_BODY);
		for (int b = 0; b < 2 && !n.nest[b].decided; b++)
			assert_int_equal(n.nest[b].parent, MP_NO_BODY);
		rings += !n.nest[0].decided;
		done(&n);
	}
	assert_true(rings > 0);
}

/* Inside a body that overlaps itself everything counts twice, and is inside. */
static void a_place_wound_twice_is_inside(void **unused)
{
	const double min[3] = {1, 1, 0}, max[3] = {5, 5, 4}, high[3] = {4, 4, 9};
	const double low[3] = {0, 0, 0};
	struct nested n = {0};

	(void)unused;
	soup_box(&n.f.soup, low, high);
	soup_box(&n.f.soup, min, max);
	soup_cube(&n.f.soup, 2, 2, 1, 1);
	/* A prism joins the boxes into one body: an edge of either becomes one of its edges. */
	soup_add(&n.f.soup, low, min, (const double[3]){0, 0, 9});
	soup_add(&n.f.soup, (const double[3]){0, 0, 9}, min, (const double[3]){1, 1, 4});
	for (int i = 0; i < 2; i++) { /* and back, so that the body stays closed */
		const double *t = n.f.soup.tri[36 + i];
		double p[9];

		memcpy(p, t, sizeof p);
		soup_add(&n.f.soup, p, p + 6, p + 3);
	}
	look(&n);
	assert_int_equal(n.f.t.bodies, 2);
	assert_true(n.f.t.closed);
	is(&n, 1, 1, 0);
	done(&n);
}

static void only_closed_bodies_contain(void **unused)
{
	struct nested n = {0};

	(void)unused;
	soup_cube(&n.f.soup, 0, 0, 0, 9);
	soup_drop(&n.f.soup, 5);
	soup_cube(&n.f.soup, 1, 1, 1, 1);
	look(&n);
	is(&n, 1, 0, MP_NO_BODY);
	done(&n);
}

/* A container with a T-junction on the ray of the inner body's corner. */
static void bodies_with_cracks_contain(void **unused)
{
	const double o[3] = {0, 0, 0}, a[3] = {8, 0, 0}, b[3] = {0, 8, 0}, c[3] = {0, 0, 8};
	const double m[3] = {4, 4, 0}, q[3] = {4, 0, 4};
	struct nested n = {0};

	(void)unused;
	soup_add(&n.f.soup, o, b, a);
	soup_add(&n.f.soup, o, a, c);
	soup_add(&n.f.soup, o, c, b);
	soup_add(&n.f.soup, a, m, q); /* the face a b c in four, m and q on its edges */
	soup_add(&n.f.soup, m, b, q);
	soup_add(&n.f.soup, q, b, c);
	soup_tetrahedron(&n.f.soup, 1, 4, 0.5, 0.25);
	soup_tetrahedron(&n.f.soup, 1, 0.5, 4, 0.25);
	look(&n);
	assert_true(n.f.t.body[0].cracks_only);
	is(&n, 1, 1, 0);
	is(&n, 2, 1, 0);
	done(&n);
}

/* Whole coordinates: rays run along edges and through corners all the time. */
static void random_boxes_agree_with_their_coordinates(void **unused)
{
	uint64_t state = 99;

	(void)unused;
	for (int round = 0; round < 200; round++) {
		struct nested n = {0};
		double p[24][3], size[24];
		int count = 0;

		for (int tries = 0; tries < 60 && count < 24; tries++) {
			double s = (double)(1 + soup_random(&state) % (tries < 20 ? 12 : 3));
			double q[3];
			bool good = true;

			for (int k = 0; k < 3; k++)
				q[k] = (double)(soup_random(&state) % 12);
			for (int i = 0; i < count; i++) { /* apart, or one well in the other */
				bool apart = false, in = true, around = true;

				for (int k = 0; k < 3; k++) {
					apart |= q[k] > p[i][k] + size[i] || q[k] + s < p[i][k];
					in &= q[k] > p[i][k] && q[k] + s < p[i][k] + size[i];
					around &= q[k] < p[i][k] && q[k] + s > p[i][k] + size[i];
				}
				good &= apart || in || around;
			}
			if (!good)
				continue;
			memcpy(p[count], q, sizeof q);
			size[count++] = s;
			soup_cube(&n.f.soup, q[0], q[1], q[2], s);
		}
		look(&n);
		assert_int_equal(n.f.t.bodies, count);
		for (int i = 0; i < count; i++) {
			uint32_t depth = 0, parent = MP_NO_BODY;

			for (int j = 0; j < count; j++) {
				bool in = i != j;

				for (int k = 0; k < 3; k++)
					in &= p[i][k] > p[j][k] &&
					      p[i][k] + size[i] < p[j][k] + size[j];
				depth += in;
				if (in && (parent == MP_NO_BODY || size[j] < size[parent]))
					parent = (uint32_t)j;
			}
			is(&n, (uint32_t)i, depth, parent);
		}
		done(&n);
	}
}

/* Neither many bodies in one nor many side by side reach the work limit. */
static void many_bodies(void **unused)
{
	uint64_t state = 7;
	struct nested n = {0};

	(void)unused;
	soup_torus(&n.f.soup, 100, 60, 100, 40);
	for (int i = 0; i < 8000; i++) {
		const int at[3] = {i % 20, i / 20 % 20, i / 400};

		soup_tetrahedron(&n.f.soup, 200 - 20 * at[0], 20 * at[1] - 200, 3 * at[2] - 30.5,
				 1);
	}
	soup_shuffle(&n.f.soup, &state);
	look(&n);
	assert_int_equal(n.f.t.bodies, 8001);
	for (uint32_t b = 0; b < 8001; b++) {
		const double *p = n.box[b].min;
		double d = hypot(hypot(p[0], p[1]) - 100, p[2]);

		assert_true(n.nest[b].decided);
		if (fabs(d - 40) > 3 && n.f.t.body[b].triangles == 4)
			assert_int_equal(n.nest[b].depth, d < 40);
	}
	done(&n);
}

/* 20,000 shells one in the other are 2 * 10^8 pairs: that is too much, and said so. */
static void too_much_is_undecided(void **unused)
{
	enum { N = 20000 };
	struct nested n = {0};

	(void)unused;
	for (int i = 0; i < N; i++)
		soup_tetrahedron(&n.f.soup, i, i, i, 4.0 * N - 4 * i);
	look(&n);
	assert_int_equal(n.f.t.bodies, N);
	for (uint32_t b = 0; b < N; b++) {
		assert_false(n.nest[b].decided);
		assert_int_equal(n.nest[b].parent, MP_NO_BODY);
	}
	done(&n);
}

/* Cubes through the wall of a ring, within its box: some of their corners are in it, some not. */
static void where_bodies_overlap_the_order_of_the_file_decides_nothing(void **unused)
{
	enum { CUBES = 12, ORDERS = 20 };
	uint32_t known[CUBES] = {0};
	uint64_t state = 7;

	(void)unused;
	for (int order = 0; order < ORDERS; order++) {
		struct nested n = {0};
		uint32_t ring = MP_NO_BODY, inside[CUBES] = {0};

		soup_torus(&n.f.soup, 40, 20, 10, 3);
		for (int i = 0; i < CUBES; i++)
			soup_cube(&n.f.soup, 6 + 0.0625 * i, 0.03125 * i, -0.4375, 1.5);
		soup_shuffle(&n.f.soup, &state);
		look(&n);
		for (uint32_t b = 0; b < n.f.t.bodies; b++)
			if (n.f.t.body[b].triangles > 12)
				ring = b;
		for (uint32_t b = 0; b < n.f.t.bodies; b++) /* cubes may count others, too */
			if (b != ring)
				inside[(int)((n.box[b].min[0] - 6) * 16)] = n.nest[b].depth;
		for (int i = 0; i < CUBES; i++) {
			if (order == 0)
				known[i] = inside[i];
			assert_int_equal(inside[i], known[i]);
		}
		done(&n);
	}
}

static void a_failed_allocation_is_reported(void **unused)
{
	struct nested n = {0};
	long total, failures = 0;

	(void)unused;
	for (int i = 0; i < 80; i++)
		soup_cube(&n.f.soup, i, i, i, 400 - 2 * i);
	look(&n);
	total = -alloc_count();
	assert_int_equal(nest(&n, NULL), 0);
	total += alloc_count();
	for (long i = 1; i <= total; i++) {
		struct mp_error err = {.code = MP_OK};
		int failed;

		alloc_fail_at(i);
		failed = nest(&n, &err);
		alloc_fail_at(0);
		assert_int_equal(failed, -1);
		assert_int_equal(err.code, MP_NOMEM);
		failures++;
	}
	assert_true(failures >= 8);
	done(&n);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(shells_in_shells),
	    cmocka_unit_test(the_hole_of_a_torus_is_outside),
	    cmocka_unit_test(touching_bodies_are_decided_by_what_does_not_touch),
	    cmocka_unit_test(coincident_shells_do_not_contain_each_other),
	    cmocka_unit_test(what_sticks_out_is_not_contained),
	    cmocka_unit_test(crossing_bodies_are_undecided),
	    cmocka_unit_test(a_place_wound_twice_is_inside),
	    cmocka_unit_test(only_closed_bodies_contain),
	    cmocka_unit_test(bodies_with_cracks_contain),
	    cmocka_unit_test(random_boxes_agree_with_their_coordinates),
	    cmocka_unit_test(many_bodies),
	    cmocka_unit_test(too_much_is_undecided),
	    cmocka_unit_test(where_bodies_overlap_the_order_of_the_file_decides_nothing),
	    cmocka_unit_test(a_failed_allocation_is_reported),
	};

	return cmocka_run_group_tests_name("nesting", tests, NULL, NULL);
}
