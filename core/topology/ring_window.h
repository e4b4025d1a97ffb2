#ifndef MP_RING_WINDOW_H
#define MP_RING_WINDOW_H

#include "core/topology/ring_kernel.h"
#include "core/topology/topology.h"

/* Private to manifold.c: the links of some vertices that are numbered side by side. */

struct mp_ring_link {
	uint32_t vertex, leaves, comes; /* see ring_kernel.h */
};

/* What is shown at a time, unless one vertex alone has more links. */
enum { MP_RING_SHOWN = 512 };
struct mp_ring_show {
	uint32_t row[MP_RING_SHOWN + 1];
	uint64_t link[MP_RING_SHOWN * MP_RING_LINE];
};

struct mp_ring_window { /* all 0 before init() */
	const struct mp_ring_kernel *kernel;
	size_t number;       /* for the watcher */
	uint32_t low, count; /* vertices low .. low + count - 1 */
	void *memory;        /* where line lies */
	struct mp_ring_line *line;
	uint8_t *links;            /* of each vertex, up to MP_RING_LINE + 1 for more */
	struct mp_ring_show *show; /* if there is a watcher */
	const struct mp_links_sink *watcher;
	uint64_t *key;            /* of far links, sorted: vertex - low << 32 | which */
	struct mp_ring_link *far; /* those that have no room in their vertex's line */
	size_t fars, room, most;  /* most: from there on the short way is none */
	bool crowded;             /* it was reached */
	bool failed;              /* memory was out */
};

/*
 * For up to ${count} vertices at a time, and ${most} links that have no room; the links of good
 * ones are shown to ${watcher} unless that is NULL.  -1: no memory.
 */
int mp_ring_window_init(struct mp_ring_window *, uint32_t count, size_t most,
			const struct mp_links_sink *watcher);
void mp_ring_window_free(struct mp_ring_window *); /* legal after init() failed, too */

/* No links yet. */
void mp_ring_window_begin(struct mp_ring_window *, size_t number, uint32_t low, uint32_t count);

void mp_ring_window_add_far(struct mp_ring_window *, struct mp_ring_link);

/* vertex - low < count */
static inline void mp_ring_window_add(struct mp_ring_window *w, uint32_t vertex, uint32_t leaves,
				      uint32_t comes)
{
	uint32_t i = vertex - w->low;
	unsigned n = w->links[i];

	if (__builtin_expect(n >= MP_RING_LINE, 0)) {
		mp_ring_window_add_far(w, (struct mp_ring_link){vertex, leaves, comes});
		return;
	}
	w->line[i].link[n] = (uint64_t)leaves << 32 | comes;
	w->links[i] = (uint8_t)(n + 1);
}

/*
 * All links are there: 1 if every vertex has none or one ring of more than two, and then
 * label[0 .. count) is the smallest linked vertex of each, or itself; 0 if not or if there was no
 * room for all links; -1 where memory is out.
 */
int mp_ring_window_look(struct mp_ring_window *, uint32_t *label);

#endif
