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

#endif
