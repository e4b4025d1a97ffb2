#include <string.h>

#include "core/obj/polygon_sweep.h"
#include "core/sort.h"

static int compare(const double *a, const double *b)
{
	if (a[0] != b[0])
		return a[0] < b[0] ? -1 : 1;
	return (a[1] > b[1]) - (a[1] < b[1]);
}

/* One round of the merge sort: pairs of runs of ${width} corners. */
static void merge_runs(const struct polygon_sweep *s, size_t width, const uint32_t *from,
		       uint32_t *to)
{
	for (size_t at = 0; at < s->n;) {
		size_t a = at, a_end = s->n - a > width ? a + width : s->n;
		size_t b = a_end, b_end = s->n - b > width ? b + width : s->n;

		while (at < b_end) {
			bool first = b == b_end;

			if (!first && a < a_end)
				first = compare(s->xy[from[a]], s->xy[from[b]]) <= 0;
			to[at++] = first ? from[a++] : from[b++];
		}
	}
}

/* ${order} by coordinates, ${rank} of equal corners the same. */
static void sort_corners(struct polygon_sweep *s, uint32_t *other)
{
	uint32_t *from = s->order, *to = other, group = 0;

	for (uint32_t i = 0; i < s->n; i++)
		from[i] = i;
	for (size_t width = 1; width < s->n; width *= 2) {
		uint32_t *swap = from;

		merge_runs(s, width, from, to);
		from = to;
		to = swap;
	}
	if (from != s->order)
		memcpy(s->order, from, s->n * sizeof *from);
	for (uint32_t i = 0; i < s->n; i++) {
		if (compare(s->xy[s->order[i]], s->xy[s->order[group]]) != 0)
			group = i;
		s->rank[s->order[i]] = group;
	}
}

static void join(struct polygon_sweep *s, uint32_t a, uint32_t b)
{
	s->next[a] = b;
	s->prev[b] = a;
}

/* Equal neighbours: a triangle without area, then one of the two is gone. */
static void take_out_repeated(struct polygon_sweep *s)
{
	for (uint32_t i = 0; i < s->n; i++) {
		if (s->rank[i] != s->rank[s->next[i]] || s->next[s->next[i]] == i)
			continue;
		polygon_sweep_emit(s, s->prev[i], i, s->next[i]);
		join(s, s->prev[i], s->next[i]);
		s->next[i] = POLYGON_NONE;
	}
}

/* There from ${e} and back from ${f}, its tip: two triangles without area. */
static void take_out_spike(struct polygon_sweep *s, uint32_t e, uint32_t f)
{
	polygon_sweep_emit(s, e, f, s->next[f]);
	polygon_sweep_emit(s, s->prev[e], e, s->next[f]);
}

/* The edges from ${e} and ${f} are equal and opposite. */
static void take_out(struct polygon_sweep *s, uint32_t e, uint32_t f)
{
	uint32_t after_e = s->next[e], before_f = s->prev[f];
	bool e_first = after_e == f, f_first = s->next[f] == e;

	if (e_first && !f_first)
		take_out_spike(s, e, f);
	if (f_first && !e_first)
		take_out_spike(s, f, e);
	if (!f_first)
		join(s, s->prev[e], s->next[f]);
	if (!e_first)
		join(s, before_f, after_e);
	s->next[e] = s->next[f] = POLYGON_NONE;
}

/* The bridges among ${count} edges with one leftmost point; ${key}: the other point and the edge.
 */
static void take_out_bridges_at(struct polygon_sweep *s, const uint64_t *key, size_t count)
{
	size_t right = 0, left = 0; /* the next edge that goes there */

	for (size_t end = 0; end < count;) {
		uint32_t far = (uint32_t)(key[end] >> 32);

		right = left = end;
		while (end < count && key[end] >> 32 == far)
			end++;
		for (;; right++, left++) {
			while (right < end && s->rank[(uint32_t)key[right]] == far)
				right++;
			while (left < end && s->rank[(uint32_t)key[left]] != far)
				left++;
			if (right == end || left == end)
				break;
			take_out(s, (uint32_t)key[right], (uint32_t)key[left]);
		}
	}
}

static void take_out_bridges(struct polygon_sweep *s, uint64_t *key)
{
	size_t count = 0, begin = 0, end = 0;

	for (uint32_t e = 0; e < s->n; e++) {
		uint32_t a = s->rank[e], b;

		if (s->next[e] == POLYGON_NONE)
			continue;
		b = s->rank[s->next[e]];
		key[count++] = (uint64_t)(a < b ? a : b) << 32 | e;
	}
	mp_sort_u64(key, count);
	for (; begin < count; begin = end) {
		uint32_t near = (uint32_t)(key[begin] >> 32);

		for (end = begin; end < count && key[end] >> 32 == near; end++) {
			uint32_t e = (uint32_t)key[end], a = s->rank[e], b = s->rank[s->next[e]];

			key[end] = (uint64_t)(a > b ? a : b) << 32 | e;
		}
		mp_sort_u64(key + begin, end - begin);
		take_out_bridges_at(s, key + begin, end - begin);
	}
}

void polygon_sweep_sort(struct polygon_sweep *s, void *room)
{
	sort_corners(s, room);
	take_out_repeated(s);
	take_out_bridges(s, room);
}
