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
 * only roots get another parent, at once or not at all, and what a path skips stays above it.  So
 * which sets there are depends on nobody's speed, what is on the way to their roots does.
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

/* Whether two sets became one by this call. */
static inline bool mp_shared_unite(uint32_t *parent, uint32_t x, uint32_t y)
{
	uint32_t high, low;

	if (mp_shared_parent(parent, x) == mp_shared_parent(parent, y))
		return false;
	do {
		x = mp_shared_find(parent, x);
		y = mp_shared_find(parent, y);
		if (x == y)
			return false;
		high = x > y ? x : y;
		low = x > y ? y : x;
	} while (!__atomic_compare_exchange_n(&parent[high], &high, low, false, __ATOMIC_RELAXED,
					      __ATOMIC_RELAXED));
	return true;
}

#endif
