#include "core/memory/huge.h"

#include <stdint.h>
#include <sys/mman.h>

enum {
	HUGE = 2 << 20,  /* bytes of a page of x86-64 and, mostly, aarch64 */
	LARGE = 16 << 20 /* what a table has at least: less is reused warm by the next mesh */
};

void *mp_huge(void *table, size_t size)
{
#ifdef MADV_HUGEPAGE
	size_t skip = -(uintptr_t)table & (HUGE - 1);

	if (table != NULL && size >= LARGE)
		(void)madvise((char *)table + skip, (size - skip) & ~(size_t)(HUGE - 1),
			      MADV_HUGEPAGE);
#else
	(void)size;
#endif
	return table;
}
