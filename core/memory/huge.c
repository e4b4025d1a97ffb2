#include "core/memory/huge.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum {
	LARGE = 16 << 20, /* what a table has at least: less is reused warm by the next mesh */
	SMALLEST = 4096,  /* bytes of a page, and the largest one that anybody has */
	LARGEST = 65536
};

/*
 * Every page that has some of it: were the first or the last one left out, the kernel would keep
 * the table in two pieces, which realloc() cannot move but has to copy.  What does not begin with a
 * page is refused, so that the pages' size is found.
 */
void *mp_huge(void *table, size_t size)
{
#ifdef MADV_HUGEPAGE
	for (size_t page = SMALLEST; table != NULL && size >= LARGE && page <= LARGEST; page *= 2) {
		size_t before = (uintptr_t)table & (page - 1);

		if (madvise((char *)table - before, before + size, MADV_HUGEPAGE) == 0)
			break;
	}
#else
	(void)size;
#endif
	return table;
}

void mp_huge_heap(size_t bytes)
{
	free(mp_huge(malloc(bytes), bytes));
}

void *mp_huge_grow(void *table, size_t used, size_t size)
{
	void *new;

	if (size < LARGE)
		return realloc(table, size);
	new = mp_huge(malloc(size), size);
	if (new != NULL && used > 0)
		memcpy(new, table, used);
	if (new != NULL)
		free(table);
	return new;
}
