#ifndef SRV_SPAWN_H
#define SRV_SPAWN_H

#include <signal.h>
#include <stdbool.h>
#include <sys/types.h>

#include "server/config.h"
#include "server/desk.h"
#include "server/memory.h"

/* The master's state, and how it forks its children. */

enum { SRV_SLOTS = 257 };

struct srv_slot {
	struct srv_desk *desk;
	pid_t pid;     /* 0: none */
	double forked; /* when */
	double retry;  /* not before, after a failed or short-lived start */
	char role[24];
};

struct srv_master {
	const struct srv_config *config;
	struct srv_memory memory;
	int listener[SRV_LISTEN_MAX + 1]; /* the one for /metrics comes last, where there is one */
	char url[SRV_LISTEN_MAX + 1][96];
	unsigned listeners;
	int keys; /* memfd of the API keys, -1: none are in force */
	struct srv_slot slot[SRV_SLOTS];
	unsigned slots;
	pid_t pid, front;
	int channel; /* to the front */
	int signals;
	bool ready, draining;
	double front_forked;
	sigset_t old_mask;
};

/* A start that fails, or a worker that ended in less than this without a job, is tried again after
 * it [s].  One that was killed at work is replaced at once, or whoever leaves early could keep all
 * of them away. */
#define SRV_SPAWN_PAUSE 0.2

/* Fork the worker of slot ${i} and hand its socket to the front.  Failures are logged; retry is
 * set. */
void srv_spawn_worker(struct srv_master *m, unsigned i);

/* Fork the front; 0, or -1 with errno. */
int srv_spawn_front(struct srv_master *m);

#endif
