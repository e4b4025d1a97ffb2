#ifndef SRV_SECOND_H
#define SRV_SECOND_H

#include <pthread.h>
#include <stdbool.h>

#include "api/job.h"
#include "server/config.h"

/* A worker's second thread, which sleeps until core has work for it. */
struct srv_second {
	struct mp_second lent; /* to be given to a job, if srv_second_start() said so */
	enum srv_sandbox_mode sandbox;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t given, done; /* one waits at each: a signal is for nobody else */
	bool started, refused;      /* its sandbox closed, or did not and has to */
	void (*work)(void *arg);    /* NULL: none */
	void *arg;
};

/*
 * Begin the thread: before the process' own sandbox closes, which allows no other; it closes its
 * own in the same way.  1; 0 where there is but one processor to run on or no thread to be had: the
 * worker does without; -1 where the sandbox is required and cannot be closed.
 */
int srv_second_start(struct srv_second *, enum srv_sandbox_mode sandbox);

#endif
