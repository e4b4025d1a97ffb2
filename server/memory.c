#include "server/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The number in a file of one line, UINT64_MAX where there is none ("max", no such file). */
static uint64_t read_number(const char *path)
{
	FILE *f = fopen(path, "re");
	char line[64];
	uint64_t v = UINT64_MAX;

	if (f == NULL)
		return v;
	if (fgets(line, sizeof line, f) != NULL && line[0] >= '0' && line[0] <= '9')
		v = strtoull(line, NULL, 10);
	(void)fclose(f);
	return v;
}

/* Version 2 at the own path, version 1; a container sees its own group as the root. */
static uint64_t cgroup_limit(void)
{
	static const char *const path[] = {"/sys/fs/cgroup/memory.max",
					   "/sys/fs/cgroup/memory/memory.limit_in_bytes"};
	uint64_t least = UINT64_MAX;
	char line[512], own[600];
	FILE *f = fopen("/proc/self/cgroup", "re");

	for (size_t i = 0; i < 2; i++) {
		uint64_t v = read_number(path[i]);

		least = v < least ? v : least;
	}
	while (f != NULL && fgets(line, sizeof line, f) != NULL) {
		if (strncmp(line, "0::", 3) != 0)
			continue;
		line[strcspn(line, "\n")] = '\0';
		(void)snprintf(own, sizeof own, "/sys/fs/cgroup%s/memory.max", line + 3);
		least = read_number(own) < least ? read_number(own) : least;
	}
	if (f != NULL)
		(void)fclose(f);
	return least;
}

static uint64_t available(void)
{
	uint64_t machine = (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
	uint64_t group = cgroup_limit();

	return (group < machine ? group : machine) / 10 * 8;
}

void srv_memory_plan(const struct srv_config *config, struct srv_memory *out)
{
	const uint64_t lane_most = 256 << 20;

	out->total = config->memory != 0 ? config->memory : available();
	out->spool = out->total / 4;
	out->lane = out->total / 8 < lane_most ? out->total / 8 : lane_most;
	out->worker = (out->total - out->spool - out->lane) / config->workers;
}
