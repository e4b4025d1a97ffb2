#include "core/bodies/parts.h"

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

static bool is_like(const struct mp_parts *p, const struct mp_part *part, const char *name,
		    size_t len, bool gap)
{
	return part->gap == gap && part->len == len &&
	       (len == 0 || memcmp(p->pool + part->name, name, len) == 0);
}

static int add(struct mp_parts *p, uint64_t first, const char *name, size_t len, bool gap,
	       struct mp_error *err)
{
	bool again = p->count > 0 && p->part[p->count - 1].first == first;
	size_t at = again ? p->part[p->count - 1].name : p->used;

	if (p->count > 0 && !again && is_like(p, &p->part[p->count - 1], name, len, gap))
		return 0;
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
	p->part[p->count - 1] = (struct mp_part){first, at, len, gap};
	p->used = at + len;
	return 0;
}

int mp_parts_add(struct mp_parts *p, uint64_t first, const char *name, size_t len,
		 struct mp_error *err)
{
	return add(p, first, name, len, false, err);
}

int mp_parts_end(struct mp_parts *p, uint64_t first, struct mp_error *err)
{
	return p->count == 0 ? 0 : add(p, first, "", 0, true, err);
}

const struct mp_part *mp_parts_at(const struct mp_parts *p, uint64_t t, uint64_t *end)
{
	size_t low = 0, high = p->count; /* part[low - 1].first <= t < part[high].first */

	while (low < high) {
		size_t middle = low + (high - low) / 2;

		if (p->part[middle].first <= t)
			low = middle + 1;
		else
			high = middle;
	}
	*end = low < p->count ? p->part[low].first : UINT64_MAX;
	return low == 0 || p->part[low - 1].gap ? NULL : &p->part[low - 1];
}

const char *mp_parts_name(const struct mp_parts *p, const uint32_t *tri, size_t count, size_t *len)
{
	const struct mp_part *name = NULL;
	uint64_t end = 0;

	*len = 0;
	for (uint64_t i = 0; i < count; i = tri != NULL ? i + 1 : end) {
		const struct mp_part *part;
		uint64_t t = tri != NULL ? tri[i] : i;

		if (t < end)
			continue;
		part = mp_parts_at(p, t, &end);
		if (part == NULL || part->len == 0 ||
		    (name != NULL && !is_like(p, name, p->pool + part->name, part->len, false)))
			return NULL;
		name = part;
	}
	if (name == NULL)
		return NULL;
	*len = name->len;
	return p->pool + name->name;
}

void mp_parts_free(struct mp_parts *p)
{
	free(p->part);
	free(p->pool);
	memset(p, 0, sizeof *p);
}
