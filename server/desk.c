#include "server/desk.h"

/* Sleeping is Dekker's pattern, as in segment.c. */

static bool take_flag(_Atomic uint32_t *flag)
{
	return atomic_load(flag) != 0 && atomic_exchange(flag, 0) != 0;
}

void srv_desk_reset(struct srv_desk *d)
{
	atomic_store(&d->posted, 0);
	atomic_store(&d->done, 0);
	atomic_store(&d->worker_sleeps, 0);
	atomic_store(&d->front_sleeps, 0);
}

void srv_desk_post(struct srv_desk *d, uint32_t n, unsigned berth)
{
	atomic_store(&d->berth[berth].begun, SRV_JOB_WAITS);
	d->order[n % SRV_BERTHS] = (uint8_t)berth;
	atomic_store(&d->used, 1);
	atomic_store(&d->posted, n + 1);
}

bool srv_desk_must_tell_worker(struct srv_desk *d)
{
	return take_flag(&d->worker_sleeps);
}

bool srv_desk_is_at(const struct srv_desk *d, uint32_t heard)
{
	return atomic_load(&d->done) == heard;
}

bool srv_desk_front_sleeps(struct srv_desk *d, uint32_t heard)
{
	atomic_store(&d->front_sleeps, 1);
	return srv_desk_is_at(d, heard);
}

void srv_desk_front_woke(struct srv_desk *d)
{
	atomic_store_explicit(&d->front_sleeps, 0, memory_order_relaxed);
}

struct srv_segment *srv_desk_job(struct srv_desk *d, uint32_t n)
{
	if (atomic_load(&d->posted) == n)
		return NULL;
	return &d->berth[d->order[n % SRV_BERTHS] % SRV_BERTHS];
}

bool srv_desk_worker_sleeps(struct srv_desk *d, uint32_t done)
{
	atomic_store(&d->worker_sleeps, 1);
	if (atomic_load(&d->posted) == done)
		return true;
	atomic_store(&d->worker_sleeps, 0);
	return false;
}

void srv_desk_done(struct srv_desk *d, uint32_t done)
{
	atomic_store(&d->done, done);
}

bool srv_desk_must_tell_front(struct srv_desk *d)
{
	return take_flag(&d->front_sleeps);
}

static bool claim(struct srv_segment *job, uint32_t as)
{
	uint32_t waits = SRV_JOB_WAITS;

	return atomic_compare_exchange_strong(&job->begun, &waits, as);
}

bool srv_desk_begin(struct srv_segment *job)
{
	return claim(job, SRV_JOB_BEGUN);
}

bool srv_desk_withdraw(struct srv_segment *job)
{
	return claim(job, SRV_JOB_WITHDRAWN);
}
