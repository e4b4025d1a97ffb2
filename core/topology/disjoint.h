#ifndef MP_DISJOINT_H
#define MP_DISJOINT_H

#include <stdbool.h>
#include <stdint.h>

/*
 * Disjoint sets over 0 .. n-1 in parent[n], private to the topology: parent[x] <= x always, so the
 * root is the smallest member.  Path halving (Tarjan & van Leeuwen 1984,
 * doi:10.1145/62.2160): O(log n) amortised.
 */
static inline uint32_t mp_set_find(uint32_t *parent, uint32_t x)
{
	while (parent[x] != x) {
		parent[x] = parent[parent[x]];
		x = parent[x];
	}
	return x;
}

/* Whether two sets became one. */
static inline bool mp_set_unite(uint32_t *parent, uint32_t x, uint32_t y)
{
	x = mp_set_find(parent, x);
	y = mp_set_find(parent, y);
	if (x < y)
		parent[y] = x;
	else
		parent[x] = y;
	return x != y;
}

/*
 * The same while another thread changes them (Anderson & Woll 1991, doi:10.1145/103418.103458):
 * only roots get another set's parent, at once or not at all, and what a path skips stays above it.
 * Which sets there are in the end depends on nobody's speed, only the ways to their roots do.
 */
static inline uint32_t mp_shared_parent(const uint32_t *parent, uint32_t x)
{
	return __atomic_load_n(&parent[x], __ATOMIC_RELAXED);
}

static inline uint32_t mp_shared_find(uint32_t *parent, uint32_t x)
{
	uint32_t up = mp_shared_parent(parent, x);

	while (up != x) {
		uint32_t top = mp_shared_parent(parent, up);

		if (top != up)
			__atomic_store_n(&parent[x], top, __ATOMIC_RELAXED);
		x = top;
		up = mp_shared_parent(parent, x);
	}
	return x;
}

/* find(), which becomes the parent. */
static inline uint32_t mp_shared_shorten(uint32_t *parent, uint32_t x)
{
	uint32_t up = mp_shared_parent(parent, x), root = mp_shared_find(parent, up);

	if (root != up)
		__atomic_store_n(&parent[x], root, __ATOMIC_RELAXED);
	return root;
}

/*
 * Whether two sets became one by this call.  By turns up from the one of the larger parent, and no
 * further than needed (Rem's algorithm in Dijkstra, A Discipline of Programming, 1976, ch. 23; with
 * a compare and swap: Dhulipala, Hong & Shun 2020, doi:10.14778/3436905.3436923).
 */
static inline bool mp_shared_unite(uint32_t *parent, uint32_t x, uint32_t y)
{
	for (;;) {
		uint32_t up = mp_shared_parent(parent, x), other = mp_shared_parent(parent, y);

		if (up == other)
			return false;
		if (up < other) {
			uint32_t keep = x;

			x = y;
			y = keep;
			keep = up;
			up = other;
			other = keep;
		}
		if (x != up) {
			__atomic_store_n(&parent[x], mp_shared_parent(parent, up),
					 __ATOMIC_RELAXED);
			x = up;
		} else if (__atomic_compare_exchange_n(&parent[x], &up, other, false,
						       __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
			return true;
		}
	}
}

#endif
