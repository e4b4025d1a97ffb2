#ifndef ALLOC_FAIL_H
#define ALLOC_FAIL_H

/*
 * Makes allocations fail on demand.  Link with
 * -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free; what libraries allocate is not seen.
 */

/* The n-th allocation from now (1 = the next) fails, once; 0 = none. */
void alloc_fail_at(long n);

/* Allocations asked for since the start, the failed ones among them. */
long alloc_count(void);

/*
 * The most bytes that were in use at one time since alloc_peak_begin(), beyond what was in use
 * then; as the allocator rounds them.  Right where what is freed here was allocated here.
 */
void alloc_peak_begin(void);
long alloc_peak(void);

#endif
