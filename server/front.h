#ifndef SRV_FRONT_H
#define SRV_FRONT_H

#include <stdbool.h>

#include "server/config.h"
#include "server/desk.h"

/* What the master hands to the process that meets the clients. */
struct srv_front_gift {
	const struct srv_config *config;
	const int *listener;
	unsigned listeners;
	bool metrics_apart;     /* the last listener is for /metrics and the probes alone */
	int keys;               /* memfd of srv_keys_read(), -1: no keys are in force */
	int master;             /* channel: srv_order both ways, non-blocking */
	struct srv_desk **desk; /* one per slot, the last slot is the lane for small bodies */
	unsigned slots;
	uint64_t spool_budget; /* bytes of bodies that may wait */
};

/* The front's whole life; returns the exit status. */
int srv_front_run(const struct srv_front_gift *gift);

#endif
