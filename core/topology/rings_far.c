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
	APART = 16, /* links: what two threads write does not lie in one line of a cache */
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

/*
 * Without a branch for each corner: which of them are wanted is anybody's guess.  Those that are
 * not go where nothing is.
 */
INLINE void scatter_as(const struct mp_rings_side *s, bool wide)
{
	const struct mp_rings_look *l = s->look;
	const uint32_t(*tri)[3] = l->r->mesh->tri;
	uint32_t t = s->begin * MP_RINGS_BLOCK,
		 end = s->begin == s->end ? t : mp_rings_block_end(l->r, s->end - 1);
	const uint32_t window = l->window;
	struct mp_rings_place *place = s->place;
	unsigned shift = l->shift;
	void *link = l->link;

	for (; t < end; t++) {
		const uint32_t *v = tri[t];

		if (!mp_has_edges(v))
			continue;
		for (unsigned k = 0; k < 3; k++) {
			struct mp_rings_place *p = &place[v[k] >> shift];
			struct mp_ring_link x = {v[k], v[(k + 1) % 3], v[(k + 2) % 3]};

			put(link, p->next, x, window, wide);
			p->next += p->step;
		}
	}
}

static void scatter(void *side)
{
	const struct mp_rings_side *s = side;

	if (s->look->wide)
		scatter_as(s, true);
	else
		scatter_as(s, false);
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

/* As many windows as there is room for from ${from} on, one at least: where their links go. */
static void choose_windows(struct mp_rings_look *l, size_t from, uint64_t room)
{
	uint64_t sum = 0;
	size_t i = from;

	for (size_t k = 0; k < l->windows; k++)
		for (unsigned side = 0; side < l->sides; side++)
			l->side[side].place[k] = (struct mp_rings_place){room + side * APART, 0};
	for (; i < l->windows && (i == from || sum + l->first[i + 1] <= room); i++) {
		for (unsigned side = 0; side < l->sides; side++) {
			l->side[side].place[i] = (struct mp_rings_place){sum, 1};
			sum += l->side[side].links[i];
		}
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

static int begin_places(struct mp_rings_look *l)
{
	for (unsigned i = 0; i < l->sides; i++) {
		struct mp_rings_side *s = &l->side[i];

		s->place = malloc(l->windows * sizeof *s->place);
		if (s->place == NULL)
			return -1;
	}
	return 0;
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
	size =
	    ((size_t)room + 2 * APART) * (l->wide ? sizeof(struct mp_ring_link) : sizeof(uint64_t));
	l->link = mp_huge(malloc(size), size);
	if (l->link == NULL || begin_places(l))
		return -1;
	for (size_t i = 0; i < l->windows && good == 1; i = l->to) {
		choose_windows(l, i, room);
		mp_rings_share(l, scatter);
		good = mp_rings_look_at(l, l->from, l->to, add_links);
	}
	return good;
}
