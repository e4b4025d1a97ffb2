#include "core/topology/smallest.h"

#include <stdlib.h>

#include "core/sort.h"

static void halve(struct mp_smallest *s)
{
	mp_sort_u64(s->key, s->count);
	if (s->count > s->most)
		s->count = s->most;
}

static void grow(struct mp_smallest *s)
{
	size_t room = s->room == 0 ? 16 : 2 * s->room;
	uint64_t *key;

	if (room > 2 * s->most)
		room = 2 * s->most;
	key = realloc(s->key, room * sizeof *key);
	if (key == NULL) {
		s->failed = true;
		return;
	}
	s->key = key;
	s->room = room;
}

void mp_smallest_add(struct mp_smallest *s, uint64_t key)
{
	if (s->most == 0 || s->failed)
		return;
	if (s->count == s->room) {
		if (s->room < 2 * s->most)
			grow(s);
		else
			halve(s);
		if (s->failed)
			return;
	}
	s->key[s->count++] = key;
}

int mp_smallest_finish(struct mp_smallest *s)
{
	if (s->failed)
		return -1;
	halve(s);
	return 0;
}

void mp_smallest_free(struct mp_smallest *s)
{
	free(s->key);
	s->key = NULL;
}
