#include "core/topology/rings.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/topology/ring_window.h"

/*
 * Window by window of vertices, so that the links in work stay in a cache.  In a mesh whose
 * triangles come side by side a block of them belongs to a window or two, and is read again for
 * each.  Where they come in no order, links are first sorted into windows, as many at a time as
 * there is room for.
 */
enum {
	BLOCK = 1024,
	AHEAD = 16 /* what to prefetch for: about the latency of a cache */
};

struct look {
	struct mp_rings *r;
	struct mp_ring_window w;
	uint32_t window;   /* vertices of each but the last */
	size_t windows;    /* how many */
	struct span *span; /* of every BLOCK triangles */
	size_t blocks;     /* how many */
	uint32_t *block;   /* near: those of window i are block[first[i]] .. block[first[i + 1]] */
	uint64_t *first;   /* and of links, if far */
	struct mp_ring_link *link; /* far: those of some windows, in order */
};

struct span {
	uint32_t min, max; /* windows of its triangles' vertices */
};

static void end_look(struct look *l)
{
	mp_ring_window_free(&l->w);
	free(l->span);
	free(l->block);
	free(l->first);
	free(l->link);
}

static uint32_t end_of_block(const struct mp_rings *r, uint32_t t)
{
	return r->mesh->triangles - t < BLOCK ? r->mesh->triangles : t + BLOCK;
}

static struct span span_of(const uint32_t *corner, size_t count)
{
	struct span s = {UINT32_MAX, 0};

	for (size_t i = 0; i < count; i++) {
		s.min = corner[i] < s.min ? corner[i] : s.min;
		s.max = corner[i] > s.max ? corner[i] : s.max;
	}
	return s;
}

/* Returns how often a block would be read. */
static uint64_t find_spans(struct look *l)
{
	const struct mp_mesh *mesh = l->r->mesh;
	uint64_t visits = 0, faces = 0;

	for (uint32_t t = 0; t < mesh->triangles; t = end_of_block(l->r, t)) {
		uint32_t end = end_of_block(l->r, t);
		struct span s = span_of(mesh->tri[t], 3 * (size_t)(end - t));

		for (uint32_t i = t; i < end; i++)
			faces += mp_has_edges(mesh->tri[i]);
		s.min /= l->window;
		s.max /= l->window;
		visits += s.max - s.min + 1;
		l->span[t / BLOCK] = s;
	}
	l->r->faces = faces;
	return visits;
}

static void begin_window(struct look *l, size_t i)
{
	uint32_t low = (uint32_t)i * l->window, left = l->r->vertices - low;

	mp_ring_window_begin(&l->w, low, left < l->window ? left : l->window);
}

/*
 * The window's links are there.  Smallest neighbours become roots at once: those of smaller
 * vertices are roots already.
 */
static int end_window(struct look *l)
{
	uint32_t *label = l->r->label, low = l->w.low, used = 0;
	int good = mp_ring_window_look(&l->w, label + low);

	if (good != 1)
		return good;
	for (uint32_t i = 0; i < l->w.count; i++)
		used += l->w.links[i] > 0;
	for (uint32_t v = low; v < low + l->w.count; v++)
		label[v] = label[label[v]];
	l->r->used += used;
	return 1;
}

static inline __attribute__((always_inline)) void add_triangle(struct look *l, const uint32_t v[3],
							       bool whole)
{
	if (!mp_has_edges(v))
		return;
	for (unsigned k = 0; k < 3; k++)
		if (whole || v[k] - l->w.low < l->w.count)
			mp_ring_window_add(&l->w, v[k], v[(k + 1) % 3], v[(k + 2) % 3]);
}

static void add_block(struct look *l, uint32_t block)
{
	const uint32_t(*tri)[3] = l->r->mesh->tri;
	uint32_t t = block * BLOCK, end = end_of_block(l->r, t);

	if (l->span[block].min == l->span[block].max)
		for (; t < end; t++)
			add_triangle(l, tri[t], true);
	else
		for (; t < end; t++)
			add_triangle(l, tri[t], false);
}

/* Which blocks each window has. */
static int sort_blocks(struct look *l, uint64_t visits)
{
	uint64_t sum = 0;

	l->block = malloc((size_t)(visits + 1) * sizeof *l->block);
	if (l->block == NULL)
		return -1;
	for (size_t b = 0; b < l->blocks; b++)
		for (uint32_t i = l->span[b].min; i <= l->span[b].max; i++)
			l->first[i + 1]++;
	for (size_t i = 0; i < l->windows; i++) { /* where it begins: filling moves that on */
		uint64_t n = l->first[i + 1];

		l->first[i + 1] = sum;
		sum += n;
	}
	for (size_t b = 0; b < l->blocks; b++)
		for (uint32_t i = l->span[b].min; i <= l->span[b].max; i++)
			l->block[l->first[i + 1]++] = (uint32_t)b;
	return 0;
}

static int look_near(struct look *l, uint64_t visits)
{
	int good = 1;

	if (sort_blocks(l, visits))
		return -1;
	for (size_t i = 0; i < l->windows && good == 1; i++) {
		begin_window(l, i);
		for (uint64_t b = l->first[i]; b < l->first[i + 1]; b++)
			add_block(l, l->block[b]);
		good = end_window(l);
	}
	return good;
}

/* How many links each window has; the most of them. */
static uint64_t count_links(struct look *l)
{
	const struct mp_mesh *mesh = l->r->mesh;
	unsigned shift = (unsigned)__builtin_ctz(l->window);
	uint64_t most = 0;

	for (uint32_t t = 0; t < mesh->triangles; t++)
		for (unsigned k = 0; k < 3 && mp_has_edges(mesh->tri[t]); k++)
			l->first[(mesh->tri[t][k] >> shift) + 1]++;
	for (size_t i = 0; i < l->windows; i++)
		most = l->first[i + 1] > most ? l->first[i + 1] : most;
	return most;
}

static inline struct mp_ring_link link_of(const uint32_t v[3], unsigned k)
{
	return (struct mp_ring_link){v[k], v[k == 2 ? 0 : k + 1], v[k == 0 ? 2 : k - 1]};
}

/* Without a branch for each corner: which of them are wanted is anybody's guess. */
static void scatter_block(struct look *l, uint32_t begin, uint32_t end, uint32_t low,
			  uint32_t count, uint64_t *at)
{
	const uint32_t(*tri)[3] = l->r->mesh->tri + begin;
	unsigned shift = (unsigned)__builtin_ctz(l->window);
	struct mp_ring_link *link = l->link;
	uint16_t corner[3 * BLOCK + 1];
	uint32_t n = 0;

	for (uint32_t t = 0; t < end - begin; t++) {
		bool used = mp_has_edges(tri[t]);

		for (uint32_t k = 0; k < 3; k++) {
			corner[n] = (uint16_t)(4 * t + k);
			n += used & ((tri[t][k] >> shift) - low < count);
		}
	}
	for (uint32_t i = 0; i < n; i++) {
		const uint32_t *v = tri[corner[i] / 4];
		unsigned k = corner[i] % 4;

		link[at[(v[k] >> shift) - low]++] = link_of(v, k);
	}
}

/*
 * The links of windows ${from} .. ${to} - 1, sorted; ${at}: where those of each are to go,
 * afterwards where they end.
 */
static void scatter(struct look *l, size_t from, size_t to, uint64_t *at)
{
	for (uint32_t t = 0; t < l->r->mesh->triangles; t = end_of_block(l->r, t))
		scatter_block(l, t, end_of_block(l->r, t), (uint32_t)from, (uint32_t)(to - from),
			      at);
}

static int look_at_links(struct look *l, size_t window, uint64_t begin, uint64_t end)
{
	const struct mp_ring_link *link = l->link;

	begin_window(l, window);
	for (uint64_t i = begin; i < end; i++) {
		if (i + AHEAD < end) {
			uint32_t next = link[i + AHEAD].vertex - l->w.low;

			__builtin_prefetch(&l->w.line[next], 1);
		}
		mp_ring_window_add(&l->w, link[i].vertex, link[i].leaves, link[i].comes);
	}
	return end_window(l);
}

/* As many windows as there is room for from ${from} on, one at least; returns the end of them. */
static size_t look_at_some(struct look *l, size_t from, uint64_t room, int *good)
{
	uint64_t sum = 0, begin = 0;
	size_t to = from;

	while (to < l->windows && (to == from || sum + l->first[to + 1] <= room)) {
		uint64_t n = l->first[to + 1];

		l->first[to++ + 1] = sum; /* from counts to places */
		sum += n;
	}
	scatter(l, from, to, l->first + from + 1);
	for (size_t i = from; i < to && *good == 1; i++) {
		*good = look_at_links(l, i, begin, l->first[i + 1]);
		begin = l->first[i + 1];
	}
	return to;
}

static int look_far(struct look *l)
{
	uint64_t most = count_links(l), room = l->r->room.links;
	int good = 1;

	if (room < l->r->faces / 2 * 3) /* half of all */
		room = l->r->faces / 2 * 3;
	if (room > 3 * l->r->faces)
		room = 3 * l->r->faces;
	if (room < most)
		room = most;
	l->link = mp_huge(malloc((size_t)room * sizeof *l->link), (size_t)room * sizeof *l->link);
	if (l->link == NULL)
		return -1;
	for (size_t i = 0; i < l->windows && good == 1;)
		i = look_at_some(l, i, room, &good);
	return good;
}

static int look(struct look *l)
{
	struct mp_rings *r = l->r;
	uint64_t visits;

	l->span = malloc((l->blocks + 1) * sizeof *l->span);
	l->first = calloc(l->windows + 1, sizeof *l->first);
	if (l->span == NULL || l->first == NULL)
		return -1;
	visits = find_spans(l);
	if (r->faces == 0 || r->faces % 2 != 0)
		return 0;
	if (mp_ring_window_init(&l->w, r->vertices < l->window ? r->vertices : l->window,
				(size_t)(r->faces / 4 * 3 + BLOCK), r->mesh->watcher))
		return -1;
	return visits <= 2 * l->blocks + 2 ? look_near(l, visits) : look_far(l);
}

int mp_rings_find(struct mp_rings *r)
{
	struct look l = {.r = r, .window = r->room.vertices};
	int good;

	r->faces = r->used = 0;
	if (r->vertices == 0)
		return 0;
	l.windows = (r->vertices - 1) / l.window + 1;
	l.blocks = r->mesh->triangles / BLOCK + 1;
	if (r->mesh->triangles % BLOCK == 0)
		l.blocks--;
	good = look(&l);
	end_look(&l);
	return good;
}
