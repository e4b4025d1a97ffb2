#ifndef SRV_MEMORY_H
#define SRV_MEMORY_H

#include <stdint.h>

#include "server/config.h"

/* How the memory is shared out, so that the sum stays below what the container has. */
struct srv_memory {
	uint64_t total;  /* --memory, or 80 % of the smaller of cgroup limit and machine */
	uint64_t spool;  /* bodies that wait */
	uint64_t worker; /* each worker of the general kind */
	uint64_t lane;   /* the worker for small bodies */
};

void srv_memory_plan(const struct srv_config *config, struct srv_memory *out);

#endif
