#include "core/topology/index.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/sort.h"
#include "core/topology/edges.h"

/* An edge and the direction of its use are one sortable word: 32 + 31 + 1 bits. */
#define MOST_NUMBERS (UINT32_C(1) << 31)

static int reserve(struct mp_index *x, size_t count, struct mp_error *err)
{
	size_t room = x->room;
	void *new;

	if (count <= room - x->triangles)
		return 0;
	while (room < x->triangles + count)
		room = room < 1024 ? 1024 : 2 * room; /* triangles < 2^32: no overflow in 64 bits */
	if (room > SIZE_MAX / sizeof *x->tri ||
	    (new = realloc(x->tri, room * sizeof *x->tri)) == NULL)
		return mp_fail_nomem(err);
	x->tri = mp_huge(new, room * sizeof *x->tri);
	x->room = room;
	return 0;
}

static void give_back(struct mp_index *x)
{
	free(x->tri);
	x->tri = NULL;
	x->triangles = x->room = 0;
}

int mp_index_add(struct mp_index *x, const uint32_t (*tri)[3], size_t count, struct mp_error *err)
{
	uint32_t most = MOST_NUMBERS - 1 - x->base;

	if (x->off)
		return 0;
	if (reserve(x, count, err))
		return -1;
	for (size_t i = 0; i < 3 * count; i++) {
		uint32_t number = tri[i / 3][i % 3];

		if (number > most) {
			x->off = true;
			give_back(x);
			return 0;
		}
		number += x->base;
		x->tri[x->triangles + i / 3][i % 3] = number;
		if (number >= x->top)
			x->top = number + 1;
	}
	x->triangles += count;
	return 0;
}

void mp_index_next(struct mp_index *x, size_t triangles)
{
	x->base = x->top;
	if (x->triangles == triangles && x->top < MOST_NUMBERS)
		return;
	x->off = true;
	give_back(x);
}

/* How many different numbers there are; SIZE_MAX where memory is out. */
static size_t count_numbers(const struct mp_index *x)
{
	uint64_t *seen = calloc((size_t)x->top / 64 + 1, sizeof *seen);
	size_t count = 0;

	if (seen == NULL)
		return SIZE_MAX;
	for (size_t i = 0; i < 3 * x->triangles; i++) {
		uint32_t number = x->tri[i / 3][i % 3];
		uint64_t bit = UINT64_C(1) << (number % 64);

		count += (seen[number / 64] & bit) == 0;
		seen[number / 64] |= bit;
	}
	free(seen);
	return count;
}

/* Smaller number << 32 | larger number << 1 | whether the use runs from the larger one. */
static size_t make_keys(const struct mp_index *x, uint64_t *key)
{
	size_t n = 0;

	for (size_t t = 0; t < x->triangles; t++) {
		const uint32_t *v = x->tri[t];

		if (!mp_has_edges(v))
			continue;
		for (int k = 0; k < 3; k++) {
			uint64_t from = v[k], to = v[k == 2 ? 0 : k + 1];

			key[n++] = from < to ? from << 32 | to << 1 : to << 32 | from << 1 | 1;
		}
	}
	return n;
}

static void count_edges(const uint64_t *key, size_t n, struct mp_by_index *out)
{
	out->closed = out->watertight = n > 0;
	for (size_t i = 0, end; i < n; i = end) {
		size_t uses, back = 0;

		for (end = i; end < n && key[end] >> 1 == key[i] >> 1; end++)
			back += key[end] & 1;
		uses = end - i;
		out->boundary_edges += uses == 1;
		out->non_manifold_edges += uses > 2;
		out->misoriented_edges += uses == 2 && back != 1;
		out->watertight = out->watertight && uses == 2;
		out->closed = out->closed && 2 * back == uses;
	}
}

int mp_index_find(struct mp_index *x, uint32_t vertices, struct mp_by_index *out,
		  struct mp_error *err)
{
	size_t numbers = 0, n;
	uint64_t *key;

	memset(out, 0, sizeof *out);
	if (!x->off && x->triangles > 0)
		numbers = count_numbers(x);
	/*
	 * A number has one place, and every place that is used has a number: where there are as
	 * many of the one as of the other, they are the same vertices.
	 */
	if (numbers == 0 || numbers == vertices) {
		mp_index_free(x);
		return 0;
	}
	key = numbers < SIZE_MAX ? malloc(3 * x->triangles * sizeof *key) : NULL;
	if (key == NULL) {
		mp_index_free(x);
		return mp_fail_nomem(err);
	}
	n = make_keys(x, key);
	mp_index_free(x);
	mp_sort_u64(key, n);
	count_edges(key, n, out);
	out->given = true;
	free(key);
	return 0;
}

void mp_index_compare(struct mp_by_index *by, const struct mp_topology *t)
{
	bool same = by->closed == t->closed && by->watertight == t->watertight &&
		    by->boundary_edges == t->boundary_edges &&
		    by->non_manifold_edges == t->non_manifold_edges &&
		    by->misoriented_edges == t->misoriented_edges;

	if (same)
		by->given = false;
}

void mp_index_free(struct mp_index *x)
{
	give_back(x);
}
