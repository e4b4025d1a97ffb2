#ifndef SRV_DESK_H
#define SRV_DESK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/segment.h"

/*
 * What the front and one worker share: a few berths for jobs and the order in which they are to be
 * done.  The worker goes from one job to the next without asking, and says how many are done; a
 * message on the socket is only for the one of the two that sleeps.  The front trusts nothing that
 * it reads from here, and never reads back what it wrote itself.
 */
enum { SRV_BERTHS = 8 };

struct srv_desk {
	_Alignas(64) _Atomic uint32_t posted; /* front: jobs given to this worker, ever */
	_Atomic uint32_t worker_sleeps;       /* tell the worker when there is a job */
	_Atomic uint32_t used;                /* it has been given a job: its start was good */
	uint8_t order[SRV_BERTHS];            /* front: job n lies in berth order[n % SRV_BERTHS] */
	_Alignas(64) _Atomic uint32_t done;   /* worker: jobs that are over, ever */
	_Atomic uint32_t front_sleeps;        /* tell the front when a job is over */
	struct srv_segment berth[SRV_BERTHS];
};

/* Front: for a worker that has not begun yet. */
void srv_desk_reset(struct srv_desk *);

/* Front: job number ${n} (from 0 on) lies ready in ${berth}. */
void srv_desk_post(struct srv_desk *, uint32_t n, unsigned berth);

/* Front: does the worker sleep, so that it must be told of what was posted? */
bool srv_desk_must_tell_worker(struct srv_desk *);

/* Front: are exactly ${heard} jobs over? */
bool srv_desk_is_at(const struct srv_desk *, uint32_t heard);

/* Front: about to sleep; false where more than ${heard} jobs are over. */
bool srv_desk_front_sleeps(struct srv_desk *, uint32_t heard);
void srv_desk_front_woke(struct srv_desk *);

/* Worker: where job number ${n} lies, NULL where there is none yet. */
struct srv_segment *srv_desk_job(struct srv_desk *, uint32_t n);

/* Worker: about to sleep with ${done} jobs behind it; false where another has come. */
bool srv_desk_worker_sleeps(struct srv_desk *, uint32_t done);

/* Worker: that many are over now.  Does the front sleep, so that it must be told? */
void srv_desk_done(struct srv_desk *, uint32_t done);
bool srv_desk_must_tell_front(struct srv_desk *);

/*
 * A job that is still behind another one can be taken back: either the worker begins it or the
 * front withdraws it, whoever comes first.  False: too late.
 */
bool srv_desk_begin(struct srv_segment *job);
bool srv_desk_withdraw(struct srv_segment *job);

#endif
