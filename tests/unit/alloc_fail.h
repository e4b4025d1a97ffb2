#ifndef ALLOC_FAIL_H
#define ALLOC_FAIL_H

/*
 * Makes allocations fail on demand.  Link with
 * -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc; what libraries allocate is not seen.
 */

/* The n-th allocation from now (1 = the next) fails, once; 0 = none. */
void alloc_fail_at(long n);

/* Allocations asked for since the start, the failed ones among them. */
long alloc_count(void);

#endif
