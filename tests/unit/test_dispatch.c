#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "server/channel.h"
#include "server/clock.h"
#include "server/front_private.h"

/* What the front gives to workers, and takes back.  The workers are the tests. */

enum { WORKERS = 2 /* and the lane */, SLOTS = WORKERS + 1, LANE = SLOTS - 1, MOST = 40 };

struct scene {
	struct srv_config config;
	struct srv_front_gift gift;
	struct srv_front front;
	struct srv_desk *desk[SLOTS];
	int worker[SLOTS]; /* their ends of the sockets */
	struct srv_exchange *ex[MOST];
	unsigned count;
};

static int make(void **state)
{
	struct scene *s = calloc(1, sizeof *s);

	if (s == NULL)
		return -1;
	s->config.workers = WORKERS;
	s->gift = (struct srv_front_gift){.config = &s->config, .desk = s->desk, .slots = SLOTS};
	s->front.config = &s->config;
	s->front.gift = &s->gift;
	s->front.budget.most = 100 << 20;
	s->front.epoll = epoll_create1(0);
	for (unsigned i = 0; i < SLOTS; i++) {
		s->desk[i] = aligned_alloc(64, sizeof *s->desk[i]);
		if (s->desk[i] == NULL)
			return -1;
	}
	*state = s;
	return srv_pool_init(&s->front.pool, &s->front);
}

static void start_worker(struct scene *s, unsigned i)
{
	int pair[2];

	assert_int_equal(srv_channel_pair(pair, 1), 0);
	s->worker[i] = pair[1];
	srv_pool_add(&s->front.pool, i, (pid_t)(100 + i), pair[0], -1);
}

static int unmake(void **state)
{
	struct scene *s = *state;

	for (unsigned i = 0; i < SLOTS; i++) {
		if (s->front.pool.worker[i].sock >= 0)
			close(s->front.pool.worker[i].sock);
		if (s->worker[i] > 0)
			close(s->worker[i]);
		free(s->desk[i]);
	}
	for (unsigned i = 0; i < s->count; i++) {
		srv_body_clear(&s->ex[i]->body);
		free(s->ex[i]->reply.body);
		free(s->ex[i]);
	}
	free(s->front.pool.worker);
	close(s->front.epoll);
	free(s);
	return 0;
}

/* A request with a complete body of ${len} bytes that begins with ${first}. */
static struct srv_exchange *ask(struct scene *s, char first, size_t len)
{
	struct srv_exchange *ex = calloc(1, sizeof *ex);
	uint8_t *bytes = malloc(len);

	assert_non_null(ex);
	assert_non_null(bytes);
	memset(bytes, first, len);
	s->ex[s->count++] = ex;
	ex->front = &s->front;
	ex->path = "/v1/mass-properties";
	ex->query = "";
	ex->reply.fd = -1;
	ex->plain = true;
	srv_body_init(&ex->body, &s->front.budget);
	assert_int_equal(srv_body_add(&ex->body, bytes, len), 0);
	free(bytes);
	ex->received = len;
	ex->body_ended = true;
	ex->small = ex->body.fd < 0;
	assert_int_equal(srv_pool_enqueue(&s->front.pool, ex), 0);
	srv_pool_dispatch(&s->front.pool);
	return ex;
}

static void put_answer(struct srv_segment *job)
{
	job->result.status = 200;
	strcpy(job->result.content_type, "application/json");
	job->result.len = 1;
	job->answer[0] = (char)job->ring[0];
}

/* Worker ${i} does its next job, well. */
static void work(struct scene *s, unsigned i, uint32_t n)
{
	struct srv_segment *job = srv_desk_job(s->desk[i], n);

	assert_non_null(job);
	if (srv_desk_begin(job))
		put_answer(job);
	srv_desk_done(s->desk[i], n + 1);
}

static unsigned on(const struct scene *s, unsigned i)
{
	return s->front.pool.worker[i].posts;
}

static void wait_for_turn(struct scene *s)
{
	struct timespec pause = {.tv_nsec = 6000000};

	(void)nanosleep(&pause, NULL);
	(void)srv_pool_before_sleep(&s->front.pool, 100);
}

static void brief_work_stands_in_line(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *ex[5];

	start_worker(s, LANE);
	for (int i = 0; i < 5; i++)
		ex[i] = ask(s, (char)('a' + i), 100);
	assert_int_equal(on(s, LANE), 5);
	assert_int_equal(srv_pool_waiting(&s->front.pool, true), 4);
	for (uint32_t n = 0; n < 5; n++)
		work(s, LANE, n);
	srv_pool_after_sleep(&s->front.pool);
	assert_int_equal(on(s, LANE), 0);
	for (int i = 0; i < 5; i++) {
		assert_true(ex[i]->answered);
		assert_int_equal(ex[i]->reply.status, 200);
		assert_int_equal(ex[i]->reply.body[0], 'a' + i); /* each its own */
	}
	assert_int_equal(s->front.budget.used, 0);
}

/* A Draco file is alone with its worker, and so is what may hide one. */
static void what_may_meet_foreign_code_is_alone(void **state)
{
	struct scene *s = *state;

	start_worker(s, LANE);
	(void)ask(s, 'D', 100);
	(void)ask(s, 's', 100);
	assert_int_equal(on(s, LANE), 1);
	assert_int_equal(s->front.pool.small.length, 1);
	work(s, LANE, 0);
	srv_pool_after_sleep(&s->front.pool);
	assert_int_equal(on(s, LANE), 1);
	(void)ask(s, 'D', 100); /* not behind another one either */
	assert_int_equal(on(s, LANE), 1);
	assert_int_equal(s->front.pool.small.length, 1);
}

static void forms_and_encoded_bodies_are_alone(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *ex;

	start_worker(s, LANE);
	(void)ask(s, 's', 100);
	ex = ask(s, 's', 33 << 10); /* too large to be brief */
	assert_int_equal(on(s, LANE), 1);
	srv_pool_drop(&s->front.pool, ex);
	ex = s->ex[1];
	ex->plain = false;
	srv_body_clear(&ex->body);
	assert_int_equal(srv_body_add(&ex->body, (const uint8_t *)"solid", 5), 0);
	assert_int_equal(srv_pool_enqueue(&s->front.pool, ex), 0);
	srv_pool_dispatch(&s->front.pool);
	assert_int_equal(on(s, LANE), 1);
}

static void others_are_woken_for_what_would_wait(void **state)
{
	struct scene *s = *state;

	for (unsigned i = 0; i < SLOTS; i++)
		start_worker(s, i);
	for (int i = 0; i < 12; i++)
		(void)ask(s, 's', 6000);
	for (unsigned i = 0; i < SLOTS; i++)
		assert_int_equal(on(s, i), 4);
}

static void nobody_waits_behind_one_that_takes_its_time(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *ex[4];

	start_worker(s, LANE);
	for (int i = 0; i < 4; i++)
		ex[i] = ask(s, (char)('a' + i), 100);
	assert_true(srv_desk_begin(srv_desk_job(s->desk[LANE], 0)));
	wait_for_turn(s);
	assert_true(srv_pool_in_work(ex[0]));
	assert_int_equal(s->front.pool.small.length, 3);
	assert_ptr_equal(s->front.pool.small.first, ex[1]); /* in their order */
	start_worker(s, 0);
	assert_int_equal(on(s, 0), 3);
	for (uint32_t n = 0; n < 3; n++)
		work(s, 0, n);
	put_answer(srv_desk_job(s->desk[LANE], 0));
	srv_desk_done(s->desk[LANE], 1);
	for (uint32_t n = 1; n < 4; n++) /* passed over */
		work(s, LANE, n);
	srv_pool_after_sleep(&s->front.pool);
	for (int i = 0; i < 4; i++)
		assert_int_equal(ex[i]->reply.body[0], 'a' + i);
	assert_int_equal(on(s, LANE) + on(s, 0), 0);
}

static void a_dead_worker_costs_one_answer(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *ex[5];

	start_worker(s, LANE);
	for (int i = 0; i < 5; i++)
		ex[i] = ask(s, (char)('a' + i), 100);
	work(s, LANE, 0);
	assert_true(srv_desk_begin(srv_desk_job(s->desk[LANE], 1)));
	assert_true(srv_desk_begin(srv_desk_job(s->desk[LANE], 2))); /* a lie changes nothing */
	srv_pool_gone(&s->front.pool, LANE, 100 + LANE, SIGKILL);
	assert_int_equal(ex[0]->reply.status, 200);
	assert_int_equal(ex[1]->reply.code, API_WORKER_LOST);
	assert_int_equal(s->front.pool.small.length, 3);
	start_worker(s, 0);
	for (uint32_t n = 0; n < 3; n++)
		work(s, 0, n);
	srv_pool_after_sleep(&s->front.pool);
	for (int i = 2; i < 5; i++)
		assert_int_equal(ex[i]->reply.body[0], 'a' + i);
}

/* Who leaves while it waits is passed over; who leaves in work costs the worker, not the others. */
static void a_client_that_leaves_harms_nobody(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *ex[4];

	start_worker(s, LANE);
	for (int i = 0; i < 4; i++)
		ex[i] = ask(s, (char)('a' + i), 100);
	srv_pool_drop(&s->front.pool, ex[1]);
	assert_int_equal(s->front.metrics.lost[SRV_LOST_CLIENT], 0);
	assert_int_equal(srv_pool_waiting(&s->front.pool, true), 2);
	srv_pool_drop(&s->front.pool, ex[0]);
	assert_int_equal(s->front.metrics.lost[SRV_LOST_CLIENT], 1);
	assert_int_equal(s->front.pool.small.length, 2);
	srv_pool_gone(&s->front.pool, LANE, 100 + LANE, SIGKILL);
	start_worker(s, LANE);
	for (uint32_t n = 0; n < 2; n++)
		work(s, LANE, n);
	srv_pool_after_sleep(&s->front.pool);
	assert_false(ex[0]->answered || ex[1]->answered);
	assert_int_equal(ex[2]->reply.body[0], 'c');
	assert_int_equal(ex[3]->reply.body[0], 'd');
}

static void large_work_is_not_held_up_by_small(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *large;

	start_worker(s, 0);
	(void)ask(s, 'a', 100);
	large = ask(s, 'L', 300 << 10);
	assert_true(large->queued && !large->small);
	(void)ask(s, 'b', 100); /* came later: does not go before it */
	assert_int_equal(on(s, 0), 1);
	work(s, 0, 0);
	srv_pool_after_sleep(&s->front.pool);
	assert_true(srv_pool_in_work(large));
	assert_int_equal(on(s, 0), 1);
}

static void a_worker_that_did_what_it_was_not_given_is_ended(void **state)
{
	struct scene *s = *state;

	start_worker(s, LANE);
	(void)ask(s, 'a', 100);
	srv_desk_done(s->desk[LANE], 7);
	srv_pool_after_sleep(&s->front.pool);
	assert_int_equal(on(s, LANE), 0);
	assert_true(s->front.pool.worker[LANE].ended);
	assert_int_equal(s->ex[0]->reply.code, API_INTERNAL); /* there was no answer */
}

/* It has nothing to do and says nothing, so it is looked at when it is to have a job. */
static void a_worker_that_is_ahead_of_its_jobs_gets_none(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *ex[2];

	start_worker(s, LANE);
	start_worker(s, 0);
	ex[0] = ask(s, 'a', 100);
	work(s, LANE, 0);
	srv_pool_after_sleep(&s->front.pool);
	srv_desk_done(s->desk[LANE], 2); /* as if it had done the next one, too */
	put_answer(&s->desk[LANE]->berth[0]);
	ex[1] = ask(s, 'b', 100);
	assert_true(s->front.pool.worker[LANE].ended);
	assert_int_equal(on(s, LANE), 0);
	assert_int_equal(on(s, 0), 1);
	work(s, 0, 0);
	srv_pool_after_sleep(&s->front.pool);
	assert_int_equal(ex[0]->reply.body[0], 'a');
	assert_int_equal(ex[1]->reply.body[0], 'b');
}

static void who_was_to_have_gone_to_it_waits_for_another(void **state)
{
	struct scene *s = *state;
	struct srv_exchange *ex;

	start_worker(s, 0);
	srv_desk_done(s->desk[0], 1);
	ex = ask(s, 'L', 300 << 10);
	assert_true(s->front.pool.worker[0].ended);
	assert_true(ex->queued && ex->body.fd >= 0 && ex->worker == NULL);
	start_worker(s, 1);
	assert_true(srv_pool_in_work(ex));
}

/* A large answer: a sealed file of ${len} bytes, all of them ${letter}. */
static void work_large(struct scene *s, unsigned i, uint32_t n, char letter, size_t len)
{
	struct srv_segment *job = srv_desk_job(s->desk[i], n);
	int fd = memfd_create("answer", MFD_ALLOW_SEALING);
	char *bytes = malloc(len);

	assert_non_null(job);
	assert_non_null(bytes);
	memset(bytes, letter, len);
	assert_int_equal(write(fd, bytes, len), (ssize_t)len);
	free(bytes);
	assert_int_equal(fcntl(fd, F_ADD_SEALS, SRV_ANSWER_SEALS), 0);
	assert_true(srv_desk_begin(job));
	put_answer(job);
	job->result.len = len;
	assert_int_equal(srv_channel_send(s->worker[i], "D", 1, NULL, 0), 0); /* of earlier ones */
	assert_int_equal(srv_channel_send(s->worker[i], "F", 1, &fd, 1), 0);
	close(fd);
	srv_desk_done(s->desk[i], n + 1);
}

static char first_byte(struct srv_exchange *ex)
{
	char c = 0;

	assert_int_equal(pread(ex->reply.fd, &c, 1, 0), 1);
	close(ex->reply.fd);
	return c;
}

/* The front may hear late, of several files at once, and of small answers between them. */
static void each_has_its_own_file(void **state)
{
	struct scene *s = *state;
	const size_t len = SRV_ANSWER + 1;
	struct srv_exchange *ex[5];

	start_worker(s, LANE);
	for (int i = 0; i < 5; i++)
		ex[i] = ask(s, (char)('a' + i), 100);
	work(s, LANE, 0);
	work_large(s, LANE, 1, 'b', len);
	work(s, LANE, 2);
	work_large(s, LANE, 3, 'd', len);
	work_large(s, LANE, 4, 'e', len);
	srv_pool_after_sleep(&s->front.pool);
	for (int i = 0; i < 5; i++) {
		assert_int_equal(ex[i]->reply.status, 200);
		assert_int_equal(i == 0 || i == 2 ? ex[i]->reply.body[0] : first_byte(ex[i]),
				 'a' + i);
	}
	assert_int_equal(s->front.pool.worker[LANE].file, -1);
}

static void send_file(struct scene *s, unsigned i)
{
	int fd = memfd_create("answer", MFD_ALLOW_SEALING);

	assert_int_equal(srv_channel_send(s->worker[i], "F", 1, &fd, 1), 0);
	close(fd);
	srv_pool_hear(&s->front.pool, i);
}

/* Mail that stays unread would wake the front for ever. */
static void a_file_without_an_answer_ends_its_worker(void **state)
{
	struct scene *s = *state;

	start_worker(s, 0);
	send_file(s, 0);
	assert_true(s->front.pool.worker[0].ended);
	start_worker(s, 1);
	(void)ask(s, 'a', 100);
	send_file(s, 1);
	assert_false(s->front.pool.worker[1].ended);
	send_file(s, 1);
	assert_true(s->front.pool.worker[1].ended);
	for (unsigned i = 0; i < 2; i++)
		srv_pool_gone(&s->front.pool, i, (pid_t)(100 + i), SIGKILL);
	assert_int_equal(s->ex[0]->reply.code, API_WORKER_LOST);
}

/* What a worker still had when it ended is nothing that its successor has to do. */
static void a_successor_begins_with_an_empty_line(void **state)
{
	struct scene *s = *state;

	for (int life = 0; life < 3; life++) {
		start_worker(s, LANE);
		(void)ask(s, 'x', 100);
		srv_pool_gone(&s->front.pool, LANE, 100 + LANE, SIGSEGV);
		close(s->worker[LANE]);
	}
	for (unsigned i = 0; i < SLOTS; i++)
		start_worker(s, i);
	for (int i = 0; i < 3; i++)
		(void)ask(s, 's', 100);
	assert_int_equal(on(s, LANE), 3);
}

static void who_is_dead_already_costs_nothing(void **state)
{
	struct scene *s = *state;

	start_worker(s, LANE);
	assert_true(srv_desk_worker_sleeps(s->desk[LANE], 0));
	close(s->worker[LANE]);
	s->worker[LANE] = -1;
	(void)ask(s, 'a', 100);
	(void)ask(s, 'b', 100);
	(void)srv_pool_before_sleep(&s->front.pool, 100);
	assert_int_equal(s->front.pool.small.length, 2);
	srv_pool_gone(&s->front.pool, LANE, 100 + LANE, SIGKILL);
	start_worker(s, 0);
	assert_int_equal(on(s, 0), 2);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, make, unmake)
	const struct CMUnitTest tests[] = {
	    TEST(brief_work_stands_in_line),
	    TEST(what_may_meet_foreign_code_is_alone),
	    TEST(forms_and_encoded_bodies_are_alone),
	    TEST(others_are_woken_for_what_would_wait),
	    TEST(nobody_waits_behind_one_that_takes_its_time),
	    TEST(a_dead_worker_costs_one_answer),
	    TEST(a_client_that_leaves_harms_nobody),
	    TEST(large_work_is_not_held_up_by_small),
	    TEST(a_worker_that_did_what_it_was_not_given_is_ended),
	    TEST(a_worker_that_is_ahead_of_its_jobs_gets_none),
	    TEST(who_was_to_have_gone_to_it_waits_for_another),
	    TEST(each_has_its_own_file),
	    TEST(a_file_without_an_answer_ends_its_worker),
	    TEST(a_successor_begins_with_an_empty_line),
	    TEST(who_is_dead_already_costs_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
