#ifndef SRV_POOL_H
#define SRV_POOL_H

#include <stdbool.h>
#include <sys/types.h>

#include "server/exchange.h"
#include "server/queue.h"
#include "server/segment.h"

/* The front's view of the workers and of the requests that wait for one. */

enum srv_worker_state {
	SRV_ABSENT, /* the master has not announced one */
	SRV_IDLE,
	SRV_BUSY,
	SRV_CANCELLING, /* told to drop its job; killed if it does not */
	SRV_LEAVING,    /* gave its last answer and exits; killed if it does not */
	SRV_DYING       /* killed by us, the master reaps it */
};

struct srv_worker {
	enum srv_worker_state state;
	unsigned slot;
	bool lane;  /* takes small bodies only */
	bool ended; /* its socket has: no job for it, it is dead or will be soon */
	int sock, pidfd;
	pid_t pid;
	struct srv_segment *segment;
	struct srv_exchange *exchange; /* while BUSY */
	double since;                  /* of CANCELLING and LEAVING */
};

struct srv_pool {
	struct srv_front *front;
	struct srv_worker *worker;
	unsigned workers;
	struct srv_queue small, large;
};

int srv_pool_init(struct srv_pool *, struct srv_front *);

/* Orders of the master. The descriptors are owned from here on. */
void srv_pool_add(struct srv_pool *, unsigned slot, pid_t pid, int sock, int pidfd);
void srv_pool_gone(struct srv_pool *, unsigned slot, pid_t pid, int status);

/* A worker's socket is readable. */
void srv_pool_hear(struct srv_pool *, unsigned slot);

/* Is there room in the queue of that class (or a worker free)? */
bool srv_pool_accepts(const struct srv_pool *, bool small);
bool srv_pool_has_idle(const struct srv_pool *); /* for a body of any size */

/* Let ${ex} wait for a worker (ex->small is set): 0, or -1 where the queue is full. */
int srv_pool_enqueue(struct srv_pool *, struct srv_exchange *ex);

/* Give waiting requests to free workers. */
void srv_pool_dispatch(struct srv_pool *);

/* ${ex} is over: out of the queue, off its worker (which is told, or killed). */
void srv_pool_drop(struct srv_pool *, struct srv_exchange *ex);

/* Body bytes for the worker of ${ex}: how many its ring took. */
size_t srv_pool_put(struct srv_exchange *ex, const uint8_t *bytes, size_t len);

/* No more of them are coming at once: its worker may sleep no longer. */
void srv_pool_wake(struct srv_exchange *ex);

/* The body of ${ex}, which has a worker, is complete. */
void srv_pool_end(struct srv_exchange *ex);

/* The worker of ${ex} is lost in its work: end it at once, whatever it does. */
void srv_pool_kill(struct srv_exchange *ex);

/* Seconds after which a request of that class may be tried again. */
unsigned srv_pool_retry_after(const struct srv_pool *, bool small);

void srv_pool_tick(struct srv_pool *, double now);

#endif
