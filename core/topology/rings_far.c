#include <stdlib.h>

#include "core/memory/huge.h"
#include "core/topology/rings_parts.h"

/*
 * Links are sorted into windows, as many of these at a time as there is room for.  Each side has
 * its half of the triangles to sort, whose links stand in a window before those of the other half:
 * they come in the order of the triangles, whoever is faster.
 */
enum {
	AHEAD = 16, /* what to prefetch for: about the latency of a cache */
	/* A narrow link, 8 bytes: vertex in its window << 50 | leaves << 25 | comes. */
	WINDOW_BITS = 14,
	VERTEX_BITS = 25
};

static const uint32_t VERTICES = (uint32_t)1 << VERTEX_BITS;

#define INLINE static inline __attribute__((always_inline))

INLINE struct mp_ring_link get(const struct mp_rings_look *l, uint64_t at, uint32_t low, bool wide)
{
	uint64_t x;

	if (wide)
		return ((const struct mp_ring_link *)l->link)[at];
	x = ((const uint64_t *)l->link)[at];
	return (struct mp_ring_link){low + (uint32_t)(x >> 2 * VERTEX_BITS),
				     (uint32_t)(x >> VERTEX_BITS) & (VERTICES - 1),
				     (uint32_t)x & (VERTICES - 1)};
}

INLINE void put(void *link, uint64_t at, struct mp_ring_link x, uint32_t window, bool wide)
{
	if (wide)
		((struct mp_ring_link *)link)[at] = x;
	else
		((uint64_t *)link)[at] = (uint64_t)(x.vertex & (window - 1)) << 2 * VERTEX_BITS |
					 (uint64_t)x.leaves << VERTEX_BITS | x.comes;
}

/* Without a branch for each corner: which of them are wanted is anybody's guess. */
static uint32_t choose(const struct mp_rings_look *l, const uint32_t (*tri)[3], uint32_t count,
		       uint16_t *corner)
{
	uint32_t low = (uint32_t)l->from, windows = (uint32_t)(l->to - l->from), n = 0;
	unsigned shift = l->shift;

	for (uint32_t t = 0; t < count; t++) {
		bool used = mp_has_edges(tri[t]);

		for (uint32_t k = 0; k < 3; k++) {
			corner[n] = (uint16_t)(4 * t + k);
			n += used & ((tri[t][k] >> shift) - low < windows);
		}
	}
	return n;
}

INLINE void scatter_block(const struct mp_rings_side *s, uint32_t b, bool wide)
{
	const struct mp_rings_look *l = s->look;
	uint32_t begin = b * MP_RINGS_BLOCK, window = l->window;
	const uint32_t(*tri)[3] = l->r->mesh->tri + begin;
	uint16_t corner[3 * MP_RINGS_BLOCK + 1];
	uint32_t n = choose(l, tri, mp_rings_block_end(l->r, b) - begin, corner);
	unsigned shift = l->shift;
	uint64_t *to = s->links;
	void *link = l->link;

	for (uint32_t i = 0; i < n; i++) {
		const uint32_t *v = tri[corner[i] / 4];
		unsigned k = corner[i] % 4;

		put(link, to[v[k] >> shift]++,
		    (struct mp_ring_link){v[k], v[k == 2 ? 0 : k + 1], v[k == 0 ? 2 : k - 1]},
		    window, wide);
	}
}

static void scatter(void *side)
{
	struct mp_rings_side *s = side;

	if (s->look->wide)
		for (uint32_t b = s->begin; b < s->end; b++)
			scatter_block(s, b, true);
	else
		for (uint32_t b = s->begin; b < s->end; b++)
			scatter_block(s, b, false);
}

INLINE void add_as(struct mp_rings_side *s, uint64_t i, uint64_t end, bool wide)
{
	const struct mp_rings_look *l = s->look;
	uint32_t low = s->w.low;

	for (; i < end; i++) {
		struct mp_ring_link x = get(l, i, low, wide);

		if (i + AHEAD < end)
			__builtin_prefetch(&s->w.line[get(l, i + AHEAD, low, wide).vertex - low],
					   1);
		mp_ring_window_add(&s->w, x.vertex, x.leaves, x.comes);
	}
}

static void add_links(struct mp_rings_side *s, size_t window)
{
	const struct mp_rings_look *l = s->look;
	uint64_t begin = window == l->from ? 0 : l->first[window], end = l->first[window + 1];

	if (l->wide)
		add_as(s, begin, end, true);
	else
		add_as(s, begin, end, false);
}

/*
 * As many windows as there is room for from ${from} on, one at least.  Counts become places: where
 * the links of each side begin, and in first[] where those of a window end.
 */
static void choose_windows(struct mp_rings_look *l, size_t from, uint64_t room)
{
	uint64_t sum = 0;
	size_t i = from;

	for (; i < l->windows && (i == from || sum + l->first[i + 1] <= room); i++) {
		uint64_t n = l->side[0].links[i];

		l->side[0].links[i] = sum;
		if (l->sides == 2)
			l->side[1].links[i] = sum + n;
		sum += l->first[i + 1];
		l->first[i + 1] = sum;
	}
	l->from = from;
	l->to = i;
}

/* How many links there are, in all and (first[i + 1]) in window i; the most of one. */
static uint64_t sum_up(struct mp_rings_look *l, uint64_t *all)
{
	uint64_t most = 0;

	for (size_t i = 0; i < l->windows; i++) {
		uint64_t n = l->side[0].links[i] + (l->sides == 2 ? l->side[1].links[i] : 0);

		l->first[i + 1] = n;
		most = n > most ? n : most;
		*all += n;
	}
	return most;
}

int mp_rings_look_far(struct mp_rings_look *l)
{
	uint64_t all = 0, most, room = l->r->room.links;
	size_t size;
	int good = 1;

	l->first = calloc(l->windows + 1, sizeof *l->first);
	if (l->first == NULL)
		return -1;
	most = sum_up(l, &all);
	if (room < all / 2 + 1)
		room = all / 2 + 1;
	if (room > all)
		room = all;
	if (room < most)
		room = most;
	l->wide = l->r->vertices > VERTICES || l->shift > WINDOW_BITS;
	size = (size_t)room * (l->wide ? sizeof(struct mp_ring_link) : sizeof(uint64_t));
	l->link = mp_huge(malloc(size + 1), size);
	if (l->link == NULL)
		return -1;
	for (size_t i = 0; i < l->windows && good == 1; i = l->to) {
		choose_windows(l, i, room);
		mp_rings_share(l, scatter);
		good = mp_rings_look_at(l, l->from, l->to, add_links);
	}
	return good;
}
