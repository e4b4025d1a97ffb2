#include "core/topology/ring_window.h"

#include <stdlib.h>
#include <string.h>

#include "core/sort.h"
#include "core/topology/ring.h"

enum { ALIGNED = 64 };

int mp_ring_window_init(struct mp_ring_window *w, uint32_t count, size_t most,
			const struct mp_links_sink *watcher)
{
	w->watcher = watcher;
	w->kernel = mp_ring_kernel_get(mp_ring_kernel_count() - 1);
	w->most = most;
	w->memory = malloc((size_t)count * sizeof *w->line + ALIGNED);
	w->links = malloc((size_t)count + 1);
	w->show = watcher == NULL ? NULL : malloc(sizeof *w->show);
	if (w->memory == NULL || w->links == NULL || (watcher != NULL && w->show == NULL))
		return -1;
	w->line = (struct mp_ring_line *)(void *)((char *)w->memory +
						  (-(uintptr_t)w->memory & (ALIGNED - 1)));
	return 0;
}

void mp_ring_window_free(struct mp_ring_window *w)
{
	free(w->memory);
	free(w->links);
	free(w->show);
	free(w->key);
	free(w->far);
}

void mp_ring_window_begin(struct mp_ring_window *w, size_t number, uint32_t low, uint32_t count)
{
	w->number = number;
	w->low = low;
	w->count = count;
	w->fars = 0;
	memset(w->links, 0, count);
}

void mp_ring_window_add_far(struct mp_ring_window *w, struct mp_ring_link link)
{
	size_t room = w->room == 0 ? 64 : 2 * w->room;

	w->links[link.vertex - w->low] = MP_RING_LINE + 1;
	w->crowded = w->crowded || w->fars >= w->most;
	if (w->crowded || w->failed)
		return;
	if (w->fars == w->room) {
		struct mp_ring_link *new = realloc(w->far, room * sizeof *new);

		if (new == NULL) {
			w->failed = true;
			return;
		}
		w->far = new;
		w->room = room;
	}
	w->far[w->fars++] = link;
}

/* As mp_is_short_ring() of any number; sorts them. */
static bool is_ring(uint64_t *link, size_t n)
{
	size_t at = 0;

	if (n <= MP_SOME)
		return mp_is_short_ring(link, (unsigned)n, MP_SOME);
	mp_sort_u64(link, n);
	for (size_t i = 0; i < n; i++) {
		at = mp_find_link(link, n, (uint32_t)link[at]);
		if (at == n || (at == 0) != (i == n - 1))
			return false;
	}
	return true;
}

/* All links of one vertex, in their order: those in its line, and ${n} more by their keys. */
static void collect(const struct mp_ring_window *w, const uint64_t *key, size_t n, uint64_t *link)
{
	memcpy(link, w->line[key[0] >> 32].link, sizeof w->line->link);
	for (size_t j = 0; j < n; j++) {
		const struct mp_ring_link *far = &w->far[(uint32_t)key[j]];

		link[MP_RING_LINE + j] = (uint64_t)far->leaves << 32 | far->comes;
	}
}

/* Behind the last of ${keys} that are of the same vertex as the first, at ${i}. */
static size_t end_of(const uint64_t *key, size_t i, size_t keys)
{
	size_t end = i + 1;

	while (end < keys && key[end] >> 32 == key[i] >> 32)
		end++;
	return end;
}

static bool look_at_each(const struct mp_ring_window *w, uint64_t *link, uint32_t *label)
{
	for (size_t i = 0, end; i < w->fars; i = end) {
		uint32_t *own = &label[w->key[i] >> 32];
		size_t n;

		end = end_of(w->key, i, w->fars);
		n = MP_RING_LINE + end - i;
		collect(w, w->key + i, end - i, link);
		*own = mp_smallest_neighbour(link, n, *own);
		if (!is_ring(link, n))
			return false;
	}
	return true;
}

/* Vertices whose links have no room in their lines. */
static int look_far(struct mp_ring_window *w, uint32_t *label)
{
	size_t room = w->fars + MP_RING_LINE;

	free(w->key); /* and behind the keys the links of a vertex */
	w->key = malloc(2 * room * sizeof *w->key);
	if (w->key == NULL)
		return -1;
	for (size_t i = 0; i < w->fars; i++)
		w->key[i] = (uint64_t)(w->far[i].vertex - w->low) << 32 | i;
	mp_sort_u64(w->key, w->fars);
	return look_at_each(w, w->key + room, label);
}

/* The ${count} vertices before ${end}. */
static void show(const struct mp_ring_window *w, uint32_t end, uint32_t count)
{
	struct mp_ring_show *s = w->show;

	if (count > 0)
		w->watcher->take(w->watcher->self, w->number,
				 &(struct mp_links){w->low + end - count, count, s->row, s->link});
}

/* Vertex ${i}, the ${n} links of which no show has room for; ${key}: where its far ones begin. */
static void show_alone(const struct mp_ring_window *w, uint32_t i, size_t key, size_t n)
{
	uint64_t *link = w->key + w->fars + MP_RING_LINE;
	const uint32_t row[2] = {0, (uint32_t)n};

	collect(w, w->key + key, n - MP_RING_LINE, link);
	w->watcher->take(w->watcher->self, w->number, &(struct mp_links){w->low + i, 1, row, link});
}

/* Behind the ${count} vertices that are in the show already. */
static void add_to_show(const struct mp_ring_window *w, uint32_t i, size_t key, size_t n,
			uint32_t count)
{
	struct mp_ring_show *s = w->show;
	uint64_t *link = s->link + s->row[count];

	if (n > MP_RING_LINE)
		collect(w, w->key + key, n - MP_RING_LINE, link);
	else /* the whole line, of which the next one takes what is too much */
		memcpy(link, w->line[i].link, sizeof w->line->link);
	s->row[count + 1] = s->row[count] + (uint32_t)n;
}

static void show_all(const struct mp_ring_window *w)
{
	enum { ROOM = MP_RING_SHOWN * MP_RING_LINE };
	struct mp_ring_show *s = w->show;
	uint32_t count = 0;
	size_t key = 0;

	s->row[0] = 0;
	for (uint32_t i = 0; i < w->count; i++) {
		size_t n = w->links[i], next = key;

		if (n > MP_RING_LINE) {
			next = end_of(w->key, key, w->fars);
			n = MP_RING_LINE + next - key;
		}
		if (count == MP_RING_SHOWN || s->row[count] + n + MP_RING_LINE > ROOM) {
			show(w, i, count);
			count = 0;
		}
		if (n + MP_RING_LINE > ROOM)
			show_alone(w, i, key, n);
		else
			add_to_show(w, i, key, n, count++);
		key = next;
	}
	show(w, w->count, count);
}

int mp_ring_window_look(struct mp_ring_window *w, uint32_t *label)
{
	int good;

	if (w->failed)
		return -1;
	if (w->crowded || !w->kernel->look(w->line, w->links, w->count, w->low, label))
		return 0;
	good = w->fars > 0 ? look_far(w, label) : 1;
	if (good == 1 && w->watcher != NULL)
		show_all(w);
	return good;
}
