#ifndef SRV_POOL_PRIVATE_H
#define SRV_POOL_PRIVATE_H

#include "server/pool.h"

/* Between pool.c, who the workers are, and dispatch.c, what they are given. */

/* One byte to the worker, with ${fd} where it is not -1. */
int srv_pool_tell(struct srv_worker *w, enum srv_message what, int fd);

/* Its end of the socket is closed: it is dead and the master will say how, or it is made so. */
void srv_pool_bury(struct srv_pool *p, struct srv_worker *w);

/* Hear of the jobs that are over. */
void srv_pool_collect(struct srv_pool *p, struct srv_worker *w);

/* A worker that may be given a job when it has none, or NULL. */
struct srv_worker *srv_pool_idle(const struct srv_pool *p, bool lane);

/*
 * What ${w} was given from number ${from} on goes back to the queue, as far as the worker has not
 * begun it, and where ${dead}, all of it.
 */
void srv_pool_take_back(struct srv_pool *p, struct srv_worker *w, unsigned from, bool dead);

#endif
