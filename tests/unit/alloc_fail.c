#include "alloc_fail.h"

#include <errno.h>
#include <malloc.h>
#include <stdbool.h>
#include <stddef.h>

/* The names that the linker's --wrap makes. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_free(void *p);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void __wrap_free(void *p);

static _Atomic long counted; /* atomic: second_thread.h */
static _Atomic long failing; /* value of counted at which to fail, 0 = never */

static _Atomic long used, most; /* bytes, since alloc_peak_begin() */

void alloc_peak_begin(void)
{
	used = most = 0;
}

long alloc_peak(void)
{
	return most;
}

static void *took(void *p)
{
	if (p != NULL)
		used += (long)malloc_usable_size(p);
	if (used > most)
		most = used;
	return p;
}

void alloc_fail_at(long n)
{
	failing = n > 0 ? counted + n : 0;
}

long alloc_count(void)
{
	return counted;
}

static bool fails(void)
{
	if (++counted != failing)
		return false;
	failing = 0;
	errno = ENOMEM;
	return true;
}

void *__wrap_malloc(size_t size)
{
	return fails() ? NULL : took(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
	return fails() ? NULL : took(__real_calloc(count, size));
}

void *__wrap_realloc(void *old, size_t size)
{
	long before;
	void *new;

	if (fails())
		return NULL;
	before = old == NULL ? 0 : (long)malloc_usable_size(old);
	new = __real_realloc(old, size);
	if (new != NULL || size == 0)
		used -= before;
	return took(new);
}

void __wrap_free(void *p)
{
	if (p != NULL)
		used -= (long)malloc_usable_size(p);
	__real_free(p);
}
