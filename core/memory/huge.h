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

/*
 * Before others, whose malloc() cannot be asked, take about ${bytes} in a process that has none
 * warm: where the C library keeps what is freed (server/worker.c tells it to), the memory they get
 * will have huge pages.  Nothing of it is touched; elsewhere, and with too little memory, nothing
 * happens.
 */
void mp_huge_heap(size_t bytes);

/*
 * realloc(table, size) of a table of which the first ${used} bytes matter: asks for huge pages
 * before the new one is filled, not after.  NULL: no memory, and ${table} is as it was.
 */
void *mp_huge_grow(void *table, size_t used, size_t size);

#endif
