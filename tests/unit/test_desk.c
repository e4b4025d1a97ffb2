#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>

#include "server/desk.h"

static int make(void **state)
{
	struct srv_desk *d = aligned_alloc(64, sizeof *d);

	if (d == NULL)
		return -1;
	srv_desk_reset(d);
	*state = d;
	return 0;
}

static int unmake(void **state)
{
	free(*state);
	return 0;
}

static void jobs_come_in_their_order_wherever_they_lie(void **state)
{
	static const unsigned berths[] = {3, 0, 7, 1};
	struct srv_desk *d = *state;

	assert_null(srv_desk_job(d, 0));
	for (uint32_t n = 0; n < 4; n++)
		srv_desk_post(d, n, berths[n]);
	for (uint32_t n = 0; n < 4; n++)
		assert_ptr_equal(srv_desk_job(d, n), &d->berth[berths[n]]);
	assert_null(srv_desk_job(d, 4));
}

static void numbers_may_wrap_at_two_to_the_32(void **state)
{
	struct srv_desk *d = *state;
	uint32_t n = UINT32_MAX - 1;

	atomic_store(&d->posted, n);
	for (int i = 0; i < 4; i++, n++) {
		assert_null(srv_desk_job(d, n));
		srv_desk_post(d, n, (unsigned)i);
		assert_ptr_equal(srv_desk_job(d, n), &d->berth[i]);
		srv_desk_done(d, n + 1);
	}
	assert_int_equal(atomic_load(&d->done), 2);
}

static void a_sleeping_worker_is_told_once(void **state)
{
	struct srv_desk *d = *state;

	assert_true(srv_desk_worker_sleeps(d, 0));
	srv_desk_post(d, 0, 0);
	srv_desk_post(d, 1, 1);
	assert_true(srv_desk_must_tell_worker(d));
	assert_false(srv_desk_must_tell_worker(d));
	assert_false(srv_desk_worker_sleeps(d, 0)); /* there is work */
	assert_false(srv_desk_must_tell_worker(d));
}

static void a_sleeping_front_is_told_once(void **state)
{
	struct srv_desk *d = *state;

	assert_false(srv_desk_must_tell_front(d));
	assert_true(srv_desk_front_sleeps(d, 0));
	srv_desk_done(d, 1);
	assert_true(srv_desk_must_tell_front(d));
	assert_false(srv_desk_must_tell_front(d));
	assert_false(srv_desk_front_sleeps(d, 0)); /* there is an answer */
	srv_desk_front_woke(d);
	srv_desk_done(d, 2);
	assert_false(srv_desk_must_tell_front(d)); /* it is awake and will look */
}

static void a_job_is_begun_or_withdrawn(void **state)
{
	struct srv_desk *d = *state;

	srv_desk_post(d, 0, 0);
	assert_true(srv_desk_begin(&d->berth[0]));
	assert_false(srv_desk_withdraw(&d->berth[0]));
	srv_desk_post(d, 1, 1);
	assert_true(srv_desk_withdraw(&d->berth[1]));
	assert_false(srv_desk_begin(&d->berth[1]));
	srv_desk_post(d, 2, 1); /* another job in the same place */
	assert_true(srv_desk_begin(&d->berth[1]));
}

enum { JOBS = 30000 };

struct race {
	struct srv_desk *desk;
	sem_t worker, front; /* the socket */
	unsigned done[JOBS];
};

static void *work(void *arg)
{
	struct race *r = arg;

	for (uint32_t n = 0; n < JOBS;) {
		struct srv_segment *job = srv_desk_job(r->desk, n);

		if (job == NULL) {
			if (srv_desk_worker_sleeps(r->desk, n))
				(void)sem_wait(&r->worker);
			continue;
		}
		if (srv_desk_begin(job))
			r->done[n]++;
		srv_desk_done(r->desk, ++n);
		if (srv_desk_must_tell_front(r->desk))
			(void)sem_post(&r->front);
	}
	return NULL;
}

/* Every job is done once, by the worker or by the front, and nobody sleeps for ever. */
static void two_processes_lose_nothing(void **state)
{
	struct race *r = calloc(1, sizeof *r);
	uint32_t posted = 0, heard = 0;
	pthread_t thread;

	assert_non_null(r);
	r->desk = *state;
	(void)sem_init(&r->worker, 0, 0);
	(void)sem_init(&r->front, 0, 0);
	assert_int_equal(pthread_create(&thread, NULL, work, r), 0);
	while (heard < JOBS) {
		heard = atomic_load(&r->desk->done);
		assert_true(heard <= posted);
		while (posted < JOBS && posted - heard < SRV_BERTHS) {
			srv_desk_post(r->desk, posted, posted % SRV_BERTHS);
			posted++;
		}
		if (posted - heard > 1 &&
		    srv_desk_withdraw(&r->desk->berth[(posted - 1) % SRV_BERTHS]))
			r->done[posted - 1]++;
		if (srv_desk_must_tell_worker(r->desk))
			(void)sem_post(&r->worker);
		if (heard < JOBS && srv_desk_front_sleeps(r->desk, heard))
			(void)sem_wait(&r->front);
		srv_desk_front_woke(r->desk);
	}
	(void)pthread_join(thread, NULL);
	for (unsigned n = 0; n < JOBS; n++)
		assert_int_equal(r->done[n], 1);
	(void)sem_destroy(&r->worker);
	(void)sem_destroy(&r->front);
	free(r);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, make, unmake)
	const struct CMUnitTest tests[] = {
	    TEST(jobs_come_in_their_order_wherever_they_lie),
	    TEST(numbers_may_wrap_at_two_to_the_32),
	    TEST(a_sleeping_worker_is_told_once),
	    TEST(a_sleeping_front_is_told_once),
	    TEST(a_job_is_begun_or_withdrawn),
	    TEST(two_processes_lose_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
