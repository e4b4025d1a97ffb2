#ifndef MP_HUGE_H
#define MP_HUGE_H

#include <stddef.h>

/*
 * Ask for huge pages below ${table} of ${size} bytes, fresh from malloc(), calloc() or realloc():
 * at millions of triangles nearly every look into a table at random would miss the processor's
 * address cache, too, and every 4 KiB fault the first time.  Small tables, NULL and systems without
 * huge pages are left alone.  Returns ${table}; never fails, what it holds stays.
 */
void *mp_huge(void *table, size_t size);

#endif
