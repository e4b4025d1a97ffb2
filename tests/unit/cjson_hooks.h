#ifndef CJSON_HOOKS_H
#define CJSON_HOOKS_H

#include <stdlib.h>

#include <cjson/cJSON.h>

/* Set up and tear down for tests in which cJSON's allocations are to fail as alloc_fail.h says. */

static void *hooked_malloc(size_t size)
{
	return malloc(size);
}

static int hook(void **state)
{
	cJSON_Hooks hooks = {hooked_malloc, free};

	(void)state;
	cJSON_InitHooks(&hooks);
	return 0;
}

static int unhook(void **state)
{
	(void)state;
	cJSON_InitHooks(NULL);
	return 0;
}

#endif
