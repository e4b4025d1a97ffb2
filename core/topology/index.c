#include "core/topology/index.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/sort.h"
#include "core/topology/edges.h"

/* An edge and the direction of its use are one sortable word: 32 + 31 + 1 bits. */
#define MOST_NUMBERS (UINT32_C(1) << 31)

enum { BATCH = 64, CORNERS = 3 * BATCH }; /* triangles and corners looked up together */

/* The corners of a batch whose numbers have not come before, each number once. */
struct fresh {
	uint32_t number[CORNERS + 1]; /* and one that is written in vain */
	uint16_t corner[CORNERS + 1]; /* 4 * triangle + 0, 1 or 2 */
	union {
		double wide[CORNERS][3];
		float narrow[CORNERS][3];
	} point;
	uint32_t vertex[CORNERS];
	unsigned count;
};

static void give_back(struct mp_index *x)
{
	free(x->vertex);
	free(x->count);
	free(x->tri);
	x->vertex = x->count = NULL;
	x->tri = NULL;
	x->top = x->room = x->tri_room = 0;
	mp_places_free(&x->places);
}

static void turn_off(struct mp_index *x)
{
	x->off = true;
	give_back(x);
}

static bool resize(uint32_t **array, size_t room)
{
	uint32_t *new = room > SIZE_MAX / sizeof *new ? NULL : realloc(*array, room * sizeof *new);

	if (new != NULL)
		*array = mp_huge(new, room * sizeof *new);
	return new != NULL;
}

/* Numbers below ${top} may come. */
static int reserve(struct mp_index *x, size_t top, struct mp_error *err)
{
	size_t room = x->room;

	if (top <= x->top)
		return 0;
	while (room < top)
		room = room < 1024 ? 1024 : 2 * room; /* at most 2^32: no overflow in 64 bits */
	if (room > x->room) {
		if (!resize(&x->vertex, room) || (x->count != NULL && !resize(&x->count, room)))
			return mp_fail_nomem(err);
		x->room = room;
	}
	memset(x->vertex + x->top, 0, (top - x->top) * sizeof *x->vertex);
	x->top = top;
	return 0;
}

/* The same for ${count} more triangles that are kept. */
static int reserve_triangles(struct mp_index *x, size_t count, struct mp_error *err)
{
	size_t need = (size_t)(x->triangles - x->kept_from) + count, room = x->tri_room;
	void *new;

	if (need <= room)
		return 0;
	while (room < need)
		room = room < 1024 ? 1024 : 2 * room;
	if (room > SIZE_MAX / sizeof *x->tri ||
	    (new = realloc(x->tri, room * sizeof *x->tri)) == NULL)
		return mp_fail_nomem(err);
	x->tri = mp_huge(new, room * sizeof *x->tri);
	x->tri_room = room;
	return 0;
}

/* Without a branch for each corner: which of them are new is anybody's guess. */
static void find_fresh(struct mp_index *x, const uint32_t (*number)[3], unsigned count,
		       struct fresh *f)
{
	uint32_t *vertex = x->vertex;
	unsigned n = 0;

	for (unsigned i = 0; i < count; i++)
		for (unsigned k = 0; k < 3; k++) {
			uint32_t known = vertex[number[i][k]], is_new = known == 0 ? 1 : 0;

			vertex[number[i][k]] = known + is_new; /* the right one follows */
			f->number[n] = number[i][k];
			f->corner[n] = (uint16_t)(4 * i + k);
			n += is_new;
		}
	f->count = n;
}

/* Triangles in one of two forms, as a sink gets them. */
struct source {
	const double (*tri)[9];
	const float (*xyz)[MP_BLOCK];
};

static void take_points(const float (*xyz)[MP_BLOCK], size_t at, struct fresh *f)
{
	for (unsigned i = 0; i < f->count; i++) {
		size_t t = at + f->corner[i] / 4;

		for (unsigned j = 0; j < 3; j++)
			f->point.narrow[i][j] = xyz[3 * (f->corner[i] % 4) + j][t];
	}
}

/* The vertices of fresh numbers of triangles from ${at} on. */
static int find_vertices(struct mp_index *x, const struct source *from, size_t at,
			 struct mp_vertices *v, struct fresh *f, struct mp_error *err)
{
	if (from->tri != NULL) {
		mp_places_free(&x->places); /* knows floats only */
		for (unsigned i = 0; i < f->count; i++)
			memcpy(f->point.wide[i],
			       &from->tri[at + f->corner[i] / 4][3 * (f->corner[i] % 4)],
			       sizeof f->point.wide[i]);
		return mp_vertices_add_points(v, (const double(*)[3])f->point.wide, f->count,
					      f->vertex, err);
	}
	take_points(from->xyz, at, f);
	return x->places.known ? mp_places_add(&x->places, v, f->number, f->point.narrow, f->count,
					       f->vertex, err)
			       : mp_vertices_add_float_points(v, (const float(*)[3])f->point.narrow,
							      f->count, f->vertex, err);
}

/* From here on vertices and numbers are counted apart. */
static int begin_counts(struct mp_index *x, struct mp_error *err)
{
	if (!resize(&x->count, x->room))
		return mp_fail_nomem(err);
	for (size_t i = 0; i < x->top; i++)
		x->count[i] = x->vertex[i] - 1; /* whatever, where it has not come */
	x->kept_from = x->triangles;
	return 0;
}

/* The fresh numbers have their vertices. */
static int learn(struct mp_index *x, const struct fresh *f, struct mp_error *err)
{
	uint32_t differ = 0;

	for (unsigned i = 0; i < f->count; i++) {
		x->vertex[f->number[i]] = f->vertex[i] + 1;
		differ |= f->vertex[i] ^ (x->numbers + i);
	}
	if (differ != 0 && x->count == NULL && begin_counts(x, err))
		return -1;
	for (unsigned i = 0; x->count != NULL && i < f->count; i++)
		x->count[f->number[i]] = x->numbers + i;
	x->numbers += f->count;
	return 0;
}

static int keep(struct mp_index *x, const uint32_t (*number)[3], size_t count, struct mp_error *err)
{
	uint64_t at = x->triangles - x->kept_from;

	if (x->count == NULL)
		return 0;
	if (reserve_triangles(x, count, err))
		return -1;
	for (size_t i = 0; i < count; i++)
		for (unsigned k = 0; k < 3; k++)
			x->tri[at + i][k] = x->count[number[i][k]];
	return 0;
}

static int add_batch(struct mp_index *x, struct mp_vertices *v, const struct source *from,
		     size_t at, const uint32_t (*number)[3], unsigned count, uint32_t (*out)[3],
		     struct mp_error *err)
{
	struct fresh f;

	find_fresh(x, number, count, &f);
	if (find_vertices(x, from, at, v, &f, err) || learn(x, &f, err) ||
	    keep(x, number, count, err))
		return -1;
	for (unsigned i = 0; i < count; i++)
		for (unsigned k = 0; k < 3; k++)
			out[i][k] = x->vertex[number[i][k]] - 1;
	x->triangles += count;
	return 0;
}

/* Whether each new number is the next vertex, which nothing has to be looked up for. */
static bool are_apart(const struct mp_index *x, const struct mp_vertices *v,
		      const struct source *from)
{
	return x->places.known && x->places.first == NULL && from->xyz != NULL &&
	       x->count == NULL && x->numbers == mp_vertices_count(v);
}

/* As add_batch(), then. */
static int add_apart(struct mp_index *x, struct mp_vertices *v, const struct source *from,
		     size_t at, const uint32_t (*number)[3], unsigned count, uint32_t (*out)[3],
		     struct mp_error *err)
{
	uint32_t *vertex = x->vertex, last = x->numbers;
	struct fresh f;

	for (unsigned i = 0; i < count; i++)
		for (unsigned k = 0; k < 3; k++) {
			uint32_t known = vertex[number[i][k]], is_new = known == 0 ? 1 : 0;

			f.corner[last - x->numbers] = (uint16_t)(4 * i + k);
			last += is_new;
			known += is_new * last;
			vertex[number[i][k]] = known;
			out[i][k] = known - 1;
		}
	f.count = last - x->numbers;
	x->numbers = last;
	x->triangles += count;
	take_points(from->xyz, at, &f);
	return mp_vertices_append(v, (const float(*)[3])f.point.narrow, f.count, err);
}

static uint32_t largest(const uint32_t *number, size_t count)
{
	uint32_t most = 0;

	for (size_t i = 0; i < count; i++)
		most = number[i] > most ? number[i] : most;
	return most;
}

static int add(struct mp_index *x, struct mp_vertices *v, const struct source *from,
	       const uint32_t (*number)[3], size_t count, uint32_t (*out)[3], struct mp_error *err)
{
	uint32_t most = x->off || count == 0 ? 0 : largest(number[0], 3 * count);

	if (most >= MOST_NUMBERS || x->numbers >= MOST_NUMBERS - 3 * count)
		turn_off(x);
	if (x->off)
		return from->tri != NULL ? mp_vertices_add(v, from->tri, count, out, err)
					 : mp_vertices_add_floats(v, from->xyz, count, out, err);
	if (reserve(x, (size_t)most + 1, err))
		return -1;
	for (size_t at = 0; at < count; at += BATCH) {
		unsigned n = count - at < BATCH ? (unsigned)(count - at) : BATCH;

		if (are_apart(x, v, from)
			? add_apart(x, v, from, at, number + at, n, out + at, err)
			: add_batch(x, v, from, at, number + at, n, out + at, err))
			return -1;
	}
	return 0;
}

int mp_index_add(struct mp_index *x, struct mp_vertices *v, const double (*tri)[9],
		 const uint32_t (*number)[3], size_t count, uint32_t (*out)[3],
		 struct mp_error *err)
{
	const struct source from = {.tri = tri};

	return add(x, v, &from, number, count, out, err);
}

int mp_index_add_floats(struct mp_index *x, struct mp_vertices *v, const float (*xyz)[MP_BLOCK],
			const uint32_t (*number)[3], size_t count, uint32_t (*out)[3],
			struct mp_error *err)
{
	const struct source from = {.xyz = xyz};

	return add(x, v, &from, number, count, out, err);
}

void mp_index_expect(struct mp_index *x, struct mp_vertices *v, const struct mp_points *points)
{
	struct mp_error ignored;

	if (x->off || points->count >= MOST_NUMBERS || reserve(x, points->count, &ignored))
		return;
	if (mp_vertices_count(v) == 0)
		mp_places_find(&x->places, v, points);
	mp_vertices_expect(v, points->count, !x->places.known);
}

void mp_index_next(struct mp_index *x, size_t triangles)
{
	x->top = 0;
	mp_places_free(&x->places);
	if (x->triangles != triangles)
		turn_off(x);
}

/* Smaller number << 32 | larger number << 1 | whether the use runs from the larger one. */
static size_t make_keys(const struct mp_index *x, const uint32_t (*tri)[3], uint64_t *key)
{
	size_t n = 0;

	for (uint64_t t = 0; t < x->triangles; t++) {
		const uint32_t *v = t < x->kept_from ? tri[t] : x->tri[t - x->kept_from];

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

int mp_index_find(struct mp_index *x, const uint32_t (*tri)[3], uint32_t vertices,
		  struct mp_by_index *out, struct mp_error *err)
{
	uint64_t *key;
	size_t n;

	memset(out, 0, sizeof *out);
	/*
	 * A number has one place, and every place that is used has a number: where there are as
	 * many of the one as of the other, they are the same vertices.
	 */
	if (x->off || x->numbers == vertices || x->triangles == 0) {
		mp_index_free(x);
		return 0;
	}
	key = x->triangles > SIZE_MAX / 3 / sizeof *key
		  ? NULL
		  : malloc(3 * (size_t)x->triangles * sizeof *key);
	if (key == NULL) {
		mp_index_free(x);
		return mp_fail_nomem(err);
	}
	n = make_keys(x, tri, key);
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
