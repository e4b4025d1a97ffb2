#ifndef SRV_POOL_H
#define SRV_POOL_H

#include <stdbool.h>
#include <sys/types.h>

#include "server/desk.h"
#include "server/exchange.h"
#include "server/queue.h"

/*
 * The front's view of the workers and of the requests that wait for one.
 *
 * A worker does one job after the other.  While it is at a brief one (a small body in plain sight
 * that is no Draco file) it is given some more of the kind, so that neither process has to wake the
 * other one between them.  They are done in their order; the front keeps their bodies, and takes
 * them back where the worker ends or where the first of them turns out not to be brief.
 */

enum srv_worker_state {
	SRV_ABSENT, /* the master has not announced one */
	SRV_IDLE,
	SRV_BUSY,
	SRV_LEAVING, /* gave its last answer and exits; killed if it does not */
	SRV_DYING    /* killed by us, the master reaps it */
};

struct srv_post {                      /* a job that was given to a worker and is not over */
	struct srv_exchange *exchange; /* NULL: nobody waits for its answer any more */
	unsigned berth;
	uint64_t cost; /* see dispatch.c */
};

struct srv_worker {
	enum srv_worker_state state;
	unsigned slot;
	bool lane;  /* takes small bodies only */
	bool ended; /* its socket has: no job for it, it is dead or will be soon */
	int sock, pidfd;
	int file; /* of the answer that is to come, or -1 */
	pid_t pid;
	struct srv_desk *desk;
	struct srv_post post[SRV_BERTHS]; /* while BUSY; the first one is in work */
	unsigned posts;
	uint64_t cost;          /* of all of them */
	bool brief;             /* all of them are, as far as one knows */
	bool untold;            /* it may sleep, and has not been told of the last of them */
	uint32_t posted, heard; /* jobs ever given to it, and those that are over */
	double since;           /* the first one began, or LEAVING did */
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

/* Requests of that class that wait for a worker, or for their turn with one. */
unsigned srv_pool_waiting(const struct srv_pool *, bool small);

/* May one more wait (or is a worker free)? */
bool srv_pool_accepts(const struct srv_pool *, bool small);
bool srv_pool_has_idle(const struct srv_pool *); /* for a body of any size */

/* Let ${ex} wait for a worker (ex->small is set): 0, or -1 where the queue is full. */
int srv_pool_enqueue(struct srv_pool *, struct srv_exchange *ex);

/* Give waiting requests to workers. */
void srv_pool_dispatch(struct srv_pool *);

/*
 * About to sleep for at most ${ms}: give out what waits, tell workers.  Returns for how long it
 * may be.  Behind it: hear of what is over.
 */
int srv_pool_before_sleep(struct srv_pool *, int ms);
void srv_pool_after_sleep(struct srv_pool *);

/* ${ex} is over: out of the queue, off its worker (which is told, or killed). */
void srv_pool_drop(struct srv_pool *, struct srv_exchange *ex);

/* Body bytes for the worker of ${ex}: how many its ring took. */
size_t srv_pool_put(struct srv_exchange *ex, const uint8_t *bytes, size_t len);

/* The same for whoever writes into the ring: the room in it; and how much was written there. */
size_t srv_pool_room(const struct srv_exchange *ex, struct iovec room[2]);
void srv_pool_filled(struct srv_exchange *ex, size_t len);

/* No more of them are coming at once: its worker may sleep no longer. */
void srv_pool_wake(struct srv_exchange *ex);

/* The body of ${ex}, which has a worker, is complete. */
void srv_pool_end(struct srv_exchange *ex);

/* Is ${ex} what its worker is at, and not behind another one? */
bool srv_pool_in_work(const struct srv_exchange *ex);

/* The worker of ${ex} is lost in its work: end it at once, whatever it does. */
void srv_pool_kill(struct srv_exchange *ex);

/* Seconds after which a request of that class may be tried again. */
unsigned srv_pool_retry_after(const struct srv_pool *, bool small);

void srv_pool_tick(struct srv_pool *, double now);

#endif
