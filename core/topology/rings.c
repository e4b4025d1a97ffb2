#include "core/topology/rings.h"

#include <stdlib.h>
#include <string.h>

#include "core/topology/rings_parts.h"

/*
 * In a mesh whose triangles come side by side a block of them belongs to a window or two, and is
 * read again for each.  Where they come in no order, links are first sorted into windows
 * (rings_far.c).
 */

void mp_rings_share(struct mp_rings_look *l, void (*work)(void *side))
{
	mp_second_share(l->sides == 2 ? l->r->mesh->second : NULL, work, &l->side[0], &l->side[1]);
}

static struct mp_rings_span span_of(const uint32_t *corner, size_t count)
{
	struct mp_rings_span s = {UINT32_MAX, 0};

	for (size_t i = 0; i < count; i++) {
		s.min = corner[i] < s.min ? corner[i] : s.min;
		s.max = corner[i] > s.max ? corner[i] : s.max;
	}
	return s;
}

void mp_rings_count(struct mp_rings_side *s, uint32_t b)
{
	const struct mp_rings_look *l = s->look;
	const uint32_t(*tri)[3] = l->r->mesh->tri;
	uint32_t end = mp_rings_block_end(l->r, b);
	unsigned shift = l->shift;
	uint64_t *links = s->links;

	for (uint32_t t = b * MP_RINGS_BLOCK; t < end; t++)
		for (unsigned k = 0; k < 3 && mp_has_edges(tri[t]); k++)
			links[tri[t][k] >> shift]++;
}

/* Is it read for more windows than two?  Then its links are counted while it is in a cache. */
static bool is_wide(const struct mp_rings_span *s)
{
	return s->max - s->min > 1;
}

static void survey(void *side)
{
	struct mp_rings_side *s = side;
	const struct mp_rings_look *l = s->look;

	for (uint32_t b = s->begin; b < s->end; b++) {
		uint32_t t = b * MP_RINGS_BLOCK, end = mp_rings_block_end(l->r, b);
		struct mp_rings_span span = span_of(l->r->mesh->tri[t], 3 * (size_t)(end - t));

		span.min >>= l->shift;
		span.max >>= l->shift;
		l->span[b] = span;
		s->visits += span.max - span.min + 1;
		if (is_wide(&span))
			mp_rings_count(s, b);
	}
}

/* What survey() has left. */
static void count_rest(void *side)
{
	struct mp_rings_side *s = side;

	for (uint32_t b = s->begin; b < s->end; b++)
		if (!is_wide(&s->look->span[b]))
			mp_rings_count(s, b);
}

static void begin_window(struct mp_rings_side *s, size_t i)
{
	const struct mp_rings_look *l = s->look;
	uint32_t low = (uint32_t)i << l->shift, left = l->r->vertices - low;

	mp_ring_window_begin(&s->w, i, low, left < l->window ? left : l->window);
}

/* The window's links are there. */
static int end_window(struct mp_rings_side *s)
{
	const uint8_t *links = s->w.links;
	uint32_t used = 0, all = 0;

	for (uint32_t i = 0; i < s->w.count; i++) {
		used += links[i] > 0;
		all += links[i] < MP_RING_LINE ? links[i] : MP_RING_LINE;
	}
	s->used += used;
	s->corners += all + s->w.fars;
	return mp_ring_window_look(&s->w, s->look->r->label + s->w.low);
}

static void look_at_windows(void *side)
{
	struct mp_rings_side *s = side;
	struct mp_rings_look *l = s->look;

	while (s->good == 1 && !atomic_load_explicit(&l->over, memory_order_relaxed)) {
		size_t i = atomic_fetch_add_explicit(&l->next, 1, memory_order_relaxed);

		if (i >= l->end)
			break;
		begin_window(s, i);
		l->add(s, i);
		s->good = end_window(s);
	}
	if (s->good != 1)
		atomic_store_explicit(&l->over, true, memory_order_relaxed);
}

int mp_rings_look_at(struct mp_rings_look *l, size_t from, size_t to,
		     void (*add)(struct mp_rings_side *, size_t window))
{
	atomic_store(&l->next, from);
	l->end = to;
	l->add = add;
	mp_rings_share(l, look_at_windows);
	return l->side[0].good < l->side[1].good ? l->side[0].good : l->side[1].good;
}

static inline __attribute__((always_inline)) void add_triangle(struct mp_ring_window *w,
							       const uint32_t v[3], bool whole)
{
	if (!mp_has_edges(v))
		return;
	for (unsigned k = 0; k < 3; k++)
		if (whole || v[k] - w->low < w->count)
			mp_ring_window_add(w, v[k], v[(k + 1) % 3], v[(k + 2) % 3]);
}

static void add_block(struct mp_rings_side *s, uint32_t b)
{
	const struct mp_rings_look *l = s->look;
	const uint32_t(*tri)[3] = l->r->mesh->tri;
	uint32_t t = b * MP_RINGS_BLOCK, end = mp_rings_block_end(l->r, b);

	if (l->span[b].min == l->span[b].max)
		for (; t < end; t++)
			add_triangle(&s->w, tri[t], true);
	else
		for (; t < end; t++)
			add_triangle(&s->w, tri[t], false);
}

static void add_blocks(struct mp_rings_side *s, size_t window)
{
	const struct mp_rings_look *l = s->look;

	for (uint64_t i = l->first[window]; i < l->first[window + 1]; i++)
		add_block(s, l->block[i]);
}

/* Which blocks each window has. */
static int sort_blocks(struct mp_rings_look *l, uint64_t visits)
{
	uint64_t sum = 0;

	l->block = malloc((size_t)(visits + 1) * sizeof *l->block);
	l->first = calloc(l->windows + 1, sizeof *l->first);
	if (l->block == NULL || l->first == NULL)
		return -1;
	for (uint32_t b = 0; b < l->blocks; b++)
		for (uint32_t i = l->span[b].min; i <= l->span[b].max; i++)
			l->first[i + 1]++;
	for (size_t i = 0; i < l->windows; i++) { /* where it begins: filling moves that on */
		uint64_t n = l->first[i + 1];

		l->first[i + 1] = sum;
		sum += n;
	}
	for (uint32_t b = 0; b < l->blocks; b++)
		for (uint32_t i = l->span[b].min; i <= l->span[b].max; i++)
			l->block[l->first[i + 1]++] = b;
	return 0;
}

static int look_near(struct mp_rings_look *l, uint64_t visits)
{
	return sort_blocks(l, visits) ? -1 : mp_rings_look_at(l, 0, l->windows, add_blocks);
}

static int look_far(struct mp_rings_look *l)
{
	mp_rings_share(l, count_rest);
	return mp_rings_look_far(l);
}

/* Memory that both sides need, before either begins. */
static int begin(struct mp_rings_look *l)
{
	const struct mp_rings *r = l->r;
	uint32_t count = r->vertices < l->window ? r->vertices : l->window;
	size_t most = (size_t)r->mesh->triangles / 4 * 3 + MP_RINGS_BLOCK;

	l->span = malloc(((size_t)l->blocks + 1) * sizeof *l->span);
	if (l->span == NULL)
		return -1;
	for (unsigned i = 0; i < l->sides; i++) {
		struct mp_rings_side *s = &l->side[i];

		s->look = l;
		s->begin = i == 0 ? 0 : l->blocks / 2;
		s->end = i + 1 == l->sides ? l->blocks : l->blocks / 2;
		s->links = calloc(l->windows + 1, sizeof *s->links);
		if (s->links == NULL || mp_ring_window_init(&s->w, count, most, r->mesh->watcher))
			return -1;
	}
	return 0;
}

static int look(struct mp_rings_look *l)
{
	struct mp_rings *r = l->r;
	const struct mp_links_sink *watcher = r->mesh->watcher;
	uint64_t visits;
	int good;

	if (begin(l))
		return -1;
	mp_rings_share(l, survey);
	visits = l->side[0].visits + l->side[1].visits;
	if (watcher != NULL && watcher->begin(watcher->self, l->windows))
		return -1;
	good = visits <= 2 * (uint64_t)l->blocks + 2 ? look_near(l, visits) : look_far(l);
	r->used = l->side[0].used + l->side[1].used;
	r->faces = (l->side[0].corners + l->side[1].corners) / 3;
	if (good == 1 && r->faces == 0)
		good = 0;
	if (watcher != NULL)
		watcher->end(watcher->self, good == 1);
	return good;
}

static void end(struct mp_rings_look *l)
{
	for (unsigned i = 0; i < l->sides; i++) {
		mp_ring_window_free(&l->side[i].w);
		free(l->side[i].links);
		free(l->side[i].place);
	}
	free(l->span);
	free(l->block);
	free(l->first);
	free(l->link);
}

int mp_rings_find(struct mp_rings *r)
{
	const struct mp_mesh *mesh = r->mesh;
	struct mp_rings_look l = {.r = r, .window = r->room.vertices};
	int good;

	if (r->vertices == 0 || mesh->triangles == 0)
		return 0;
	l.shift = (unsigned)__builtin_ctz(l.window);
	l.windows = ((r->vertices - 1) >> l.shift) + 1;
	l.blocks = (mesh->triangles - 1) / MP_RINGS_BLOCK + 1;
	l.sides = mesh->second != NULL && mesh->triangles > r->room.alone ? 2 : 1;
	l.side[0].good = l.side[1].good = 1;
	good = look(&l);
	end(&l);
	return good;
}
