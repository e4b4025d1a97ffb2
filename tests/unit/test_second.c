#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "alloc_fail.h"
#include "core/moments/uncertainty.h"
#include "core/topology/topology_parts.h"
#include "second_thread.h"
#include "soup.h"

/* A second thread changes nothing: not what is found, and not one bit of a sum. */

/* ---- who lends, but no thread: its work is done before the other's, or behind it ---- */

struct pretended {
	struct mp_second lent;
	bool late;
	void (*work)(void *arg);
	void *arg;
	unsigned begun;
};

static void pretend_begin(void *self, void (*work)(void *arg), void *arg)
{
	struct pretended *p = self;

	assert_null(p->work); /* one at a time */
	p->begun++;
	p->work = work;
	p->arg = arg;
	if (!p->late)
		work(arg);
}

static void pretend_wait(void *self)
{
	struct pretended *p = self;

	if (p->late && p->work != NULL)
		p->work(p->arg);
	p->work = NULL;
}

static struct pretended *pretend(struct pretended *p, bool late)
{
	*p = (struct pretended){.lent = {pretend_begin, pretend_wait, p}, .late = late};
	return p;
}

/* ---- what is compared ---- */

struct result {
	struct mp_topology t;
	struct mp_deviation deviation;
	bool good;
};

static void set_box(const struct soup *s, struct mp_rounded_solid *r)
{
	for (int k = 0; k < 3; k++)
		r->min[k] = r->max[k] = s->tri[0][k];
	for (size_t i = 0; i < 9 * s->count; i++) {
		r->min[i % 3] = fmin(r->min[i % 3], s->tri[i / 9][i % 9]);
		r->max[i % 3] = fmax(r->max[i % 3], s->tri[i / 9][i % 9]);
	}
	r->volume = 1;
	for (int k = 0; k < 3; k++)
		r->centroid[k] = r->min[k] / 2 + r->max[k] / 2;
}

/* ${room}: of the short way alone; NULL: all of the topology, as it is used. */
static void find(const struct soup *s, const struct built *b, const struct mp_second *second,
		 const struct mp_manifold_room *room, struct result *out)
{
	struct mp_rounded_solid r = {.mesh = &b->mesh, .float32 = true};
	struct mp_uncertainty_state state;
	struct mp_mesh mesh = b->mesh;

	memset(out, 0, sizeof *out);
	set_box(s, &r);
	mp_uncertainty_begin(&state, &r);
	mesh.second = second;
	mesh.watcher = &state.watcher;
	if (room != NULL) {
		assert_int_equal(mp_manifold_find(&mesh, room, &out->t, &out->good), 0);
		assert_true(state.seen == out->good);
	} else {
		assert_int_equal(mp_topology_find(&mesh, 50, &out->t, NULL), 0);
		out->good = state.seen;
	}
	assert_int_equal(mp_uncertainty_end(&state, &r, &out->deviation, NULL), 0);
}

static void assert_same_list(const struct mp_defect_list *a, const struct mp_defect_list *b)
{
	assert_int_equal(a->count, b->count);
	if (a->count == 0)
		return;
	assert_memory_equal(a->triangle_at, b->triangle_at, (a->count + 1) * sizeof(size_t));
	assert_memory_equal(a->vertex_at, b->vertex_at, (a->count + 1) * sizeof(size_t));
	assert_memory_equal(a->triangles, b->triangles,
			    a->triangle_at[a->count] * sizeof(uint32_t));
	assert_memory_equal(a->vertices, b->vertices, a->vertex_at[a->count] * sizeof(uint32_t));
}

static void assert_same(const struct result *a, const struct result *b, uint32_t triangles)
{
	const struct mp_topology *x = &a->t, *y = &b->t;

	assert_int_equal(a->good, b->good);
	assert_true(a->deviation.volume == b->deviation.volume);
	for (int k = 0; k < 3; k++)
		assert_true(a->deviation.centroid[k] == b->deviation.centroid[k]);
	assert_int_equal(x->vertices, y->vertices);
	assert_int_equal(x->faces, y->faces);
	assert_int_equal(x->edges, y->edges);
	assert_int_equal(x->closed, y->closed);
	assert_int_equal(x->boundary_edges, y->boundary_edges);
	assert_int_equal(x->non_manifold_vertices, y->non_manifold_vertices);
	assert_int_equal(x->bodies, y->bodies);
	assert_int_equal(x->body_of == NULL, y->body_of == NULL);
	if (x->body_of != NULL)
		assert_memory_equal(x->body_of, y->body_of, triangles * sizeof *x->body_of);
	for (uint32_t i = 0; i < x->bodies; i++) {
		assert_int_equal(x->body[i].first, y->body[i].first);
		assert_int_equal(x->body[i].triangles, y->body[i].triangles);
		assert_int_equal(x->body[i].fans, y->body[i].fans);
	}
	for (int k = 0; k < MP_DEFECT_KINDS; k++)
		assert_same_list(&x->defect[k], &y->defect[k]);
}

/* With and without, by real threads and by those that come early or late; returns who was woken. */
static unsigned compare(const struct soup *s, const struct mp_manifold_room *room)
{
	struct result alone, with;
	struct second_thread *thread = malloc(sizeof *thread); /* outlives a failure */
	struct pretended early, late;
	struct built b;
	unsigned begun;

	assert_non_null(thread);
	assert_int_equal(soup_build(s, 3, &b, NULL), 0);
	assert_true(second_thread_begin(thread));
	const struct mp_second *lent[] = {&thread->lent, &pretend(&early, false)->lent,
					  &pretend(&late, true)->lent};

	find(s, &b, NULL, room, &alone);
	for (size_t i = 0; i < sizeof lent / sizeof *lent; i++) {
		find(s, &b, lent[i], room, &with);
		assert_same(&alone, &with, b.mesh.triangles);
		mp_topology_free(&with.t);
	}
	assert_null(early.work);
	assert_null(late.work);
	assert_int_equal(early.begun, late.begun);
	begun = thread->begun;
	assert_int_equal(early.begun, begun);
	mp_topology_free(&alone.t);
	second_thread_end(thread);
	free(thread);
	built_free(&b);
	return begun;
}

/* ---- meshes ---- */

/* Of several bodies, some of whose vertices have many triangles; ${hubs}: how many. */
static void make(struct soup *s, unsigned n, unsigned hubs)
{
	soup_cube(s, 20, 0, 0, 1);
	soup_torus(s, n, n, 5, 1);
	if (hubs > 0)
		soup_bipyramid(s, hubs, 40);
	soup_torus(s, n / 2, n, 7, 1);
	soup_tetrahedron(s, 60, 0, 0, 1);
}

/* 1: a hole, 2: a triangle wound against the rest, 3: two bodies that share an edge. */
static void damage(struct soup *s, unsigned how)
{
	if (how == 1)
		soup_drop(s, s->count / 2);
	if (how == 2)
		soup_flip(s, s->count / 3);
	if (how == 3) {
		soup_cube(s, 80, 0, 0, 1);
		soup_cube(s, 81, 1, 0, 1);
	}
}

static void large_meshes_are_found_the_same(void **unused)
{
	uint64_t state = 5;

	(void)unused;
	for (unsigned round = 0; round < 8; round++) {
		struct soup s = {0};

		make(&s, 190, 300);
		damage(&s, round / 2);
		if (round % 2)
			soup_shuffle(&s, &state);
		assert_true(s.count > 100000);
		assert_true(compare(&s, NULL) > 1);
		soup_free(&s);
	}
}

/* A fifth of all corners at two vertices. */
static void crowded_meshes_are_found_the_same(void **unused)
{
	uint64_t state = 6;

	(void)unused;
	for (unsigned round = 0; round < 2; round++) {
		struct soup s = {0};

		make(&s, 160, 30000);
		if (round % 2)
			soup_shuffle(&s, &state);
		assert_true(compare(&s, NULL) > 1);
		soup_free(&s);
	}
}

static void small_meshes_wake_nobody(void **unused)
{
	struct soup s = {0};

	(void)unused;
	soup_torus(&s, 200, 200, 5, 1);
	assert_int_equal(compare(&s, NULL), 0);
	soup_free(&s);
}

/* Of windows and links that are few: many windows, many times of sorting. */
static void whatever_is_kept_at_a_time(void **unused)
{
	uint64_t state = 7;

	(void)unused;
	for (unsigned round = 0; round < 16; round++) {
		struct soup s = {0};

		make(&s, 12 + round, round % 3 == 0 ? 100 : 0);
		damage(&s, round / 4);
		if (round % 2)
			soup_shuffle(&s, &state);
		for (uint32_t vertices = 1; vertices <= 1 << 15; vertices *= 8)
			for (uint32_t links = 1; links < 5000; links *= 32) {
				const struct mp_manifold_room room = {vertices, links, 0};

				assert_true(compare(&s, &room) > 0);
			}
		soup_free(&s);
	}
}

static void a_failed_allocation_on_either_side_is_told(void **unused)
{
	static const struct mp_manifold_room room = {64, 100, 0};
	uint64_t seed = 8;

	(void)unused;
	for (unsigned round = 0; round < 4; round++) {
		struct soup s = {0};
		struct built b;
		long total = 1;

		make(&s, 20, 100);
		if (round % 2)
			soup_shuffle(&s, &seed);
		assert_int_equal(soup_build(&s, 3, &b, NULL), 0);
		for (long n = 0; n <= total; n++) {
			struct mp_rounded_solid r = {.mesh = &b.mesh, .float32 = true};
			struct mp_uncertainty_state state;
			struct mp_topology t = {0};
			struct pretended p;
			bool good = false;
			long before = alloc_count();
			int failed;

			set_box(&s, &r);
			mp_uncertainty_begin(&state, &r);
			b.mesh.second = &pretend(&p, round / 2)->lent;
			b.mesh.watcher = &state.watcher;
			alloc_fail_at(n); /* the first time none, to count them */
			failed = mp_manifold_find(&b.mesh, &room, &t, &good);
			alloc_fail_at(0);
			assert_null(p.work);
			assert_null(state.window);
			if (n == 0)
				total = alloc_count() - before;
			assert_int_equal(failed, n == 0 ? 0 : -1);
			assert_int_equal(good, n == 0);
			mp_topology_free(&t);
		}
		assert_true(total > 12);
		built_free(&b);
		soup_free(&s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(large_meshes_are_found_the_same),
	    cmocka_unit_test(crowded_meshes_are_found_the_same),
	    cmocka_unit_test(small_meshes_wake_nobody),
	    cmocka_unit_test(whatever_is_kept_at_a_time),
	    cmocka_unit_test(a_failed_allocation_on_either_side_is_told),
	};

	return cmocka_run_group_tests_name("second", tests, NULL, NULL);
}
