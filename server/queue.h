#ifndef SRV_QUEUE_H
#define SRV_QUEUE_H

#include <stdint.h>

/* Requests that wait for a worker, first come, first served. */

struct srv_exchange;

struct srv_queue {
	struct srv_exchange *first, **last;
	unsigned length, most;
	double service; /* seconds of work a request, a moving mean; for Retry-After */
};

void srv_queue_init(struct srv_queue *, uint64_t most);

/* Sets queued and queued_at. */
void srv_queue_add(struct srv_queue *, struct srv_exchange *ex);

/* Before all others; queued_at stays what it was. */
void srv_queue_put_back(struct srv_queue *, struct srv_exchange *ex);

/* From wherever it stands. */
void srv_queue_remove(struct srv_queue *, struct srv_exchange *ex);

/* One request took so long. */
void srv_queue_learn(struct srv_queue *, double seconds);

#endif
