#include <stdlib.h>

#include "core/sort.h"
#include "core/topology/topology_parts.h"

/*
 * A triangle's repetitions share its edge from the smallest corner to the middle one.  So it is
 * enough to sort the uses of each edge whose third corner is the largest by that corner.
 */
struct search {
	const struct mp_mesh *mesh;
	struct mp_smallest found; /* earliest << 32 | this */
	uint64_t count, opposite;
	struct mp_repeats *repeats;
	uint64_t *key; /* third corner << 32 | triangle, for one edge */
	size_t room;
};

static uint32_t third(const struct mp_mesh *mesh, uint32_t use)
{
	return mp_corner_vertex(mesh, mp_half_next(mp_half_next(mp_use_half(use))));
}

static uint32_t larger_end(const struct mp_mesh *mesh, uint32_t use)
{
	return mp_corner_vertex(mesh, mp_use_corner(use, true));
}

static void found(struct search *s, uint32_t earliest, uint32_t triangle)
{
	s->count++;
	mp_smallest_add(&s->found, (uint64_t)earliest << 32 | triangle);
}

static void mark(uint64_t *bit, uint32_t triangle)
{
	bit[triangle / 64] |= (uint64_t)1 << (triangle % 64);
}

/* ${same} of ${n} triangles go one way round, the others the other. */
static int begin_marking(struct search *s, size_t n, size_t same)
{
	size_t words = (size_t)s->mesh->triangles / 64 + 1;

	s->opposite += n - same < same ? n - same : same;
	if (s->repeats->spare != NULL)
		return 0;
	s->repeats->paired = calloc(words, sizeof *s->repeats->paired);
	s->repeats->spare = calloc(words, sizeof *s->repeats->spare);
	return s->repeats->paired == NULL || s->repeats->spare == NULL;
}

/* Triangle number ${i} of them, in file order. */
static void mark_one(struct search *s, uint32_t t, size_t i, size_t n, size_t same)
{
	if (same < n)
		mark(s->repeats->paired, t);
	if (i > 0 || 2 * same == n)
		mark(s->repeats->spare, t);
}

static int look_at_pair(struct search *s, uint32_t a, uint32_t b)
{
	uint32_t v = third(s->mesh, a), t = mp_use_triangle(a), u = mp_use_triangle(b);
	size_t same;

	if (v < larger_end(s->mesh, a) || v != third(s->mesh, b))
		return 0;
	same = mp_same_winding(s->mesh->tri[t], s->mesh->tri[u]) ? 2 : 1;
	if (begin_marking(s, 2, same))
		return -1;
	found(s, t, u);
	mark_one(s, t, 0, 2, same);
	mark_one(s, u, 1, 2, same);
	return 0;
}

/* Triangles on the same corners, key[0 .. n) in file order. */
static int look_at_same(struct search *s, const uint64_t *key, size_t n)
{
	const uint32_t *earliest = s->mesh->tri[(uint32_t)key[0]];
	size_t same = 0;

	for (size_t i = 0; i < n; i++)
		same += mp_same_winding(earliest, s->mesh->tri[(uint32_t)key[i]]);
	if (begin_marking(s, n, same))
		return -1;
	for (size_t i = 0; i < n; i++) {
		mark_one(s, (uint32_t)key[i], i, n, same);
		if (i > 0)
			found(s, (uint32_t)key[0], (uint32_t)key[i]);
	}
	return 0;
}

static int look_at_many(struct search *s, const uint32_t *use, size_t n)
{
	uint32_t top = larger_end(s->mesh, use[0]);
	size_t m = 0;

	if (n > s->room) {
		uint64_t *key = realloc(s->key, 2 * n * sizeof *key);

		if (key == NULL)
			return -1;
		s->key = key;
		s->room = 2 * n;
	}
	for (size_t i = 0; i < n; i++) {
		uint32_t v = third(s->mesh, use[i]);

		if (v > top)
			s->key[m++] = (uint64_t)v << 32 | mp_use_triangle(use[i]);
	}
	mp_sort_u64(s->key, m);
	for (size_t i = 0, end; i < m; i = end) {
		for (end = i + 1; end < m && s->key[end] >> 32 == s->key[i] >> 32;)
			end++;
		if (end - i > 1 && look_at_same(s, s->key + i, end - i))
			return -1;
	}
	return 0;
}

static int search(struct search *s, const struct mp_edges *e)
{
	enum { AHEAD = 24 };

	for (size_t i = 0, end; i < e->count; i = end) {
		end = mp_edges_end(e, i);
		if (i + AHEAD < e->count)
			__builtin_prefetch(s->mesh->tri[mp_use_triangle(e->use[i + AHEAD])]);
		if (end - i == 2 && look_at_pair(s, e->use[i], e->use[i + 1]))
			return -1;
		if (end - i > 2 && look_at_many(s, e->use + i, end - i))
			return -1;
	}
	return mp_smallest_finish(&s->found);
}

int mp_duplicates_find(const struct mp_mesh *mesh, const struct mp_edges *edges, uint32_t most,
		       struct mp_repeats *repeats, struct mp_topology *out)
{
	struct mp_defect_list *l = &out->defect[MP_DEFECT_DUPLICATE_TRIANGLE];
	struct search s = {.mesh = mesh, .found = {.most = most}, .repeats = repeats};
	int failed = search(&s, edges);

	out->duplicate_triangles = s.count;
	out->opposite_duplicates = s.opposite;
	if (!failed)
		failed = mp_defects_begin(l, s.found.count, 2 * s.found.count, 3 * s.found.count);
	for (size_t i = 0; !failed && i < s.found.count; i++) {
		uint32_t t[2] = {(uint32_t)(s.found.key[i] >> 32), (uint32_t)s.found.key[i]};

		mp_defects_add(l, t, 2, mesh->tri[t[1]], 3);
	}
	free(s.key);
	mp_smallest_free(&s.found);
	return failed;
}
