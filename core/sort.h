#ifndef MP_SORT_H
#define MP_SORT_H

#include <stddef.h>
#include <stdint.h>

/*
 * mp_sort_u64(a, n):
 * Ascending, in place, O(n) whatever the keys: insertion below a few dozen, else radix exchange by
 * bytes from the top ("American flag", McIlroy, Bostic & McIlroy 1993).
 */
void mp_sort_u64(uint64_t *a, size_t n);

#endif
