#include "server/queue.h"

#include <stddef.h>

#include "server/clock.h"
#include "server/exchange.h"

void srv_queue_init(struct srv_queue *q, uint64_t most)
{
	q->first = NULL;
	q->last = &q->first;
	q->most = (unsigned)most;
}

void srv_queue_add(struct srv_queue *q, struct srv_exchange *ex)
{
	ex->queued = true;
	ex->queued_at = srv_now();
	ex->behind = NULL;
	*q->last = ex;
	q->last = &ex->behind;
	q->length++;
}

void srv_queue_put_back(struct srv_queue *q, struct srv_exchange *ex)
{
	ex->queued = true;
	ex->behind = q->first;
	q->first = ex;
	if (ex->behind == NULL)
		q->last = &ex->behind;
	q->length++;
}

void srv_queue_remove(struct srv_queue *q, struct srv_exchange *ex)
{
	for (struct srv_exchange **at = &q->first; *at != NULL; at = &(*at)->behind) {
		if (*at != ex)
			continue;
		*at = ex->behind;
		if (q->last == &ex->behind)
			q->last = at;
		q->length--;
		break;
	}
	ex->queued = false;
	ex->behind = NULL;
}

void srv_queue_learn(struct srv_queue *q, double seconds)
{
	q->service = q->service == 0 ? seconds : 0.9 * q->service + 0.1 * seconds;
}
