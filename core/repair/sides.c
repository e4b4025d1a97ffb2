#include "core/repair/sides.h"

#include <stdlib.h>
#include <string.h>

#include "core/sort.h"

enum { AHEAD = 24 }; /* uses to prefetch for: about the latency of memory */

struct finder {
	const struct mp_mesh *mesh;
	const struct mp_edges *edges;
	/*
	 * Disjoint sets with a sign: link[t] is a triangle of the same sheet that is not larger,
	 * << 1 | whether t is wound against it.  A root links to itself.
	 */
	uint32_t *link;
	uint8_t *flaw; /* of the sheet of each root */
	uint64_t *key; /* for the uses of one edge; twice as many as 32-bit words */
	size_t room;
	bool joined;                   /* sheets that meet at an edge were put together */
	const struct mp_sides *sheets; /* when they have numbers */
};

/* Its root; ${*against}: wound against it. */
static uint32_t find(uint32_t *link, uint32_t t, uint32_t *against)
{
	*against = 0;
	while (link[t] >> 1 != t) {
		uint32_t above = link[link[t] >> 1];

		link[t] = (above & ~1u) | ((above ^ link[t]) & 1); /* path halving */
		*against ^= link[t] & 1;
		t = link[t] >> 1;
	}
	return t;
}

/*
 * Triangles ${x} and ${y} are of one sheet, ${against}: wound against each other.  Its root, or
 * UINT32_MAX where they are known to be otherwise.
 */
static uint32_t unite(struct finder *f, uint32_t x, uint32_t y, uint32_t against)
{
	uint32_t p, q;

	x = find(f->link, x, &p);
	y = find(f->link, y, &q);
	against ^= p ^ q;
	if (x == y)
		return against != 0 ? UINT32_MAX : x;
	if (x > y) {
		uint32_t t = x;

		x = y;
		y = t;
	}
	f->link[y] = x << 1 | against;
	f->flaw[x] |= f->flaw[y];
	return x;
}

/* Are both used in the same direction? */
static uint32_t alike(uint32_t u, uint32_t v)
{
	return ((u ^ v) & MP_USE_BACK) == 0;
}

/* Across every edge that is used twice. */
static void join_sheets(struct finder *f)
{
	const struct mp_edges *e = f->edges;

	for (size_t i = 0, end; i < e->count; i = end) {
		uint32_t x = mp_use_triangle(e->use[i]), unused;

		end = mp_edges_end(e, i);
		if (i + AHEAD < e->count)
			__builtin_prefetch(&f->link[mp_use_triangle(e->use[i + AHEAD])], 1);
		if (end - i != 2)
			continue;
		if (unite(f, x, mp_use_triangle(e->use[i + 1]), alike(e->use[i], e->use[i + 1])) ==
		    UINT32_MAX)
			f->flaw[find(f->link, x, &unused)] |= MP_SIDE_ONE;
	}
}

static int reserve(struct finder *f, size_t n)
{
	uint64_t *key;

	if (n <= f->room)
		return 0;
	key = realloc(f->key, 2 * n * sizeof *key);
	if (key == NULL)
		return -1;
	f->key = key;
	f->room = 2 * n;
	return 0;
}

/* Sheets that use the edge [i, end) more often in the one direction than in the other. */
static int find_torn(struct finder *f, size_t i, size_t end)
{
	size_t n = end - i;
	int64_t sum = 0;

	if (reserve(f, n))
		return -1;
	for (size_t k = 0; k < n; k++) {
		uint32_t use = f->edges->use[i + k], against, root;

		root = find(f->link, mp_use_triangle(use), &against);
		f->key[k] = (uint64_t)root << 1 | (against ^ ((use & MP_USE_BACK) != 0));
	}
	mp_sort_u64(f->key, n);
	for (size_t k = 0; k < n; k++) {
		sum += (f->key[k] & 1) != 0 ? -1 : 1;
		if (k + 1 < n && f->key[k + 1] >> 1 == f->key[k] >> 1)
			continue;
		if (sum != 0)
			f->flaw[f->key[k] >> 1] |= MP_SIDE_TORN;
		sum = 0;
	}
	return 0;
}

static int find_flaws(struct finder *f)
{
	const struct mp_edges *e = f->edges;

	for (size_t i = 0, end; i < e->count; i = end) {
		uint32_t unused;

		end = mp_edges_end(e, i);
		if (end - i == 1)
			f->flaw[find(f->link, mp_use_triangle(e->use[i]), &unused)] |= MP_SIDE_HOLE;
		else if (end - i > 2 && find_torn(f, i, end))
			return -1;
	}
	return 0;
}

/* Is its sheet torn and nothing else; or, when sheets have numbers, closed? */
static bool takes_turns(struct finder *f, uint32_t use)
{
	uint32_t t = mp_use_triangle(use), unused;

	if (f->sheets != NULL)
		return f->sheets->flaw[f->sheets->of[t]] == 0;
	return f->flaw[find(f->link, t, &unused)] == MP_SIDE_TORN;
}

/* Sheets that take turns around the edge [i, end). */
static int join_around(struct finder *f, size_t i, size_t end)
{
	uint32_t *use;
	size_t n = 0;

	if (reserve(f, end - i))
		return -1;
	use = (uint32_t *)f->key;
	for (size_t k = i; k < end; k++)
		if (takes_turns(f, f->edges->use[k]))
			use[n++] = f->edges->use[k];
	if (n == 0 || n % 2 != 0 || !mp_around_sort(f->mesh, use, n, use + f->room))
		return 0;
	for (size_t k = 1; k < n; k++)
		(void)unite(f, mp_use_triangle(use[k - 1]), mp_use_triangle(use[k]),
			    alike(use[k - 1], use[k]));
	f->joined = true;
	return 0;
}

static int join_around_all(struct finder *f)
{
	const struct mp_edges *e = f->edges;

	f->joined = false;
	for (size_t i = 0, end; i < e->count; i = end) {
		end = mp_edges_end(e, i);
		if (end - i > 2 && join_around(f, i, end))
			return -1;
	}
	return 0;
}

static int join_torn(struct finder *f)
{
	if (join_around_all(f))
		return -1;
	if (!f->joined)
		return 0;
	for (uint32_t t = 0; t < f->mesh->triangles; t++)
		f->flaw[t] &= MP_SIDE_ONE;
	return find_flaws(f);
}

/* From roots to numbers. */
static int number(struct finder *f, struct mp_sides *out)
{
	for (uint32_t t = 0; t < f->mesh->triangles; t++) {
		uint32_t against, root;

		out->of[t] = MP_NO_BODY;
		if (!mp_has_edges(f->mesh->tri[t]))
			continue;
		root = find(f->link, t, &against);
		out->of[t] = root == t ? out->count++ : out->of[root];
		out->against[t / 64] |= (uint64_t)against << (t % 64);
	}
	out->flaw = malloc((size_t)out->count + 1);
	if (out->flaw == NULL)
		return -1;
	for (uint32_t t = 0; t < f->mesh->triangles; t++)
		if (out->of[t] != MP_NO_BODY && f->link[t] >> 1 == t)
			out->flaw[out->of[t]] = f->flaw[t];
	return 0;
}

static int find_beside(struct finder *f, struct mp_sides *out)
{
	uint32_t sheets = 0;

	out->beside = malloc(((size_t)out->count + 1) * sizeof *out->beside);
	if (out->beside == NULL)
		return -1;
	f->sheets = out;
	if (join_around_all(f))
		return -1;
	for (uint32_t t = 0; t < f->mesh->triangles; t++) {
		uint32_t root, against;

		if (out->of[t] != sheets) /* not the first of the next one */
			continue;
		root = find(f->link, t, &against);
		out->beside[sheets++] = out->of[root] << 1 | against;
	}
	return 0;
}

static int search(struct finder *f, struct mp_sides *out)
{
	size_t n = (size_t)f->mesh->triangles + 1;

	f->link = malloc(n * sizeof *f->link);
	f->flaw = calloc(n, sizeof *f->flaw);
	out->of = malloc(n * sizeof *out->of);
	out->against = calloc(n / 64 + 1, sizeof *out->against);
	if (f->link == NULL || f->flaw == NULL || out->of == NULL || out->against == NULL)
		return -1;
	for (uint32_t t = 0; t < f->mesh->triangles; t++)
		f->link[t] = t << 1;
	join_sheets(f);
	if (find_flaws(f) || join_torn(f))
		return -1;
	return number(f, out) || find_beside(f, out) ? -1 : 0;
}

int mp_sides_find(const struct mp_mesh *mesh, const struct mp_edges *edges, struct mp_sides *out,
		  struct mp_error *err)
{
	struct finder f = {.mesh = mesh, .edges = edges};
	int failed;

	memset(out, 0, sizeof *out);
	failed = search(&f, out);
	free(f.link);
	free(f.flaw);
	free(f.key);
	if (!failed)
		return 0;
	mp_sides_free(out);
	return mp_fail_nomem(err);
}

void mp_sides_free(struct mp_sides *s)
{
	free(s->of);
	free(s->against);
	free(s->flaw);
	free(s->beside);
	memset(s, 0, sizeof *s);
}
