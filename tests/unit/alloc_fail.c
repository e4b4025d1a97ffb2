#include "alloc_fail.h"

#include <errno.h>
#include <stdbool.h>
#include <stddef.h>

/* The names that the linker's --wrap makes. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);

static long counted;
static long failing; /* value of counted at which to fail, 0 = never */

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
	return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
	return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
	return fails() ? NULL : __real_realloc(old, size);
}
