#include "core/parts.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more: doubles.  The old memory stays good when this fails. */
static void *grow(void *old, size_t item, size_t need, size_t *room)
{
	size_t more = *room < 16 ? 16 : *room;
	void *new;

	while (more < need)
		more = more > SIZE_MAX / 2 ? SIZE_MAX : 2 * more;
	if (more > SIZE_MAX / item)
		return NULL;
	new = realloc(old, more * item);
	if (new != NULL)
		*room = more;
	return new;
}

int mp_parts_add(struct mp_parts *p, uint64_t first, const char *name, size_t len,
		 struct mp_error *err)
{
	bool again = p->count > 0 && p->part[p->count - 1].first == first;
	size_t at = again ? p->part[p->count - 1].name : p->used;

	if (len > SIZE_MAX - at)
		return mp_fail_nomem(err);
	if (at + len > p->pool_room) {
		char *pool = grow(p->pool, 1, at + len, &p->pool_room);

		if (pool == NULL)
			return mp_fail_nomem(err);
		p->pool = pool;
	}
	if (!again && p->count == p->room) {
		struct mp_part *part = grow(p->part, sizeof *part, p->count + 1, &p->room);

		if (part == NULL)
			return mp_fail_nomem(err);
		p->part = part;
	}
	if (!again)
		p->count++;
	if (len > 0)
		memcpy(p->pool + at, name, len);
	p->part[p->count - 1] = (struct mp_part){first, at, len};
	p->used = at + len;
	return 0;
}

const char *mp_parts_name(const struct mp_parts *p, uint64_t first, uint64_t last, size_t *len)
{
	size_t low = 0, high = p->count; /* part[low - 1].first <= first < part[high].first */

	while (low < high) {
		size_t middle = low + (high - low) / 2;

		if (p->part[middle].first <= first)
			low = middle + 1;
		else
			high = middle;
	}
	*len = 0;
	if (low == 0 || p->part[low - 1].len == 0)
		return NULL;
	if (low < p->count && p->part[low].first <= last)
		return NULL;
	*len = p->part[low - 1].len;
	return p->pool + p->part[low - 1].name;
}

void mp_parts_free(struct mp_parts *p)
{
	free(p->part);
	free(p->pool);
	memset(p, 0, sizeof *p);
}
