#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/segment.h"

/* The byte at a position of the endless stream that the tests send. */
static uint8_t byte_at(uint64_t position)
{
	return (uint8_t)((position * 0x9e3779b97f4a7c15u) >> 56);
}

static int make(void **state)
{
	struct srv_segment *s = calloc(1, sizeof *s);

	if (s == NULL)
		return -1;
	srv_ring_reset(s);
	*state = s;
	return 0;
}

static int unmake(void **state)
{
	free(*state);
	return 0;
}

/* Put ${len} bytes of the stream from ${position} on, out of an exact-size copy. */
static size_t put(struct srv_segment *s, uint64_t position, size_t len, bool *wake)
{
	uint8_t *copy = malloc(len > 0 ? len : 1);
	size_t n;

	assert_non_null(copy);
	for (size_t i = 0; i < len; i++)
		copy[i] = byte_at(position + i);
	n = srv_ring_put(s, copy, len, wake);
	free(copy);
	return n;
}

/* Take everything that is there, checking that it is the stream from ${position} on. */
static uint64_t drain(struct srv_segment *s, uint64_t position, bool *told)
{
	const uint8_t *bytes;
	bool ended;
	size_t n;

	*told = false;
	while ((n = srv_ring_peek(s, &bytes, &ended)) > 0) {
		for (size_t i = 0; i < n; i++)
			assert_int_equal(bytes[i], byte_at(position + i));
		position += n;
		*told = srv_ring_take(s, n) || *told;
	}
	return position;
}

static void what_goes_in_comes_out(void **state)
{
	struct srv_segment *s = *state;
	const uint8_t *bytes;
	bool wake, ended, told;

	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 0);
	assert_false(ended);
	assert_int_equal(srv_ring_put(s, NULL, 0, &wake), 0);
	assert_int_equal(put(s, 0, 1000, &wake), 1000);
	assert_false(wake);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 1000);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 1000); /* looking takes nothing */
	assert_false(srv_ring_take(s, 300));
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 700);
	assert_int_equal(bytes[0], byte_at(300));
	assert_true(drain(s, 300, &told) == 1000);
	assert_false(told);
}

/* Every place of the ring is crossed at a length that divides nothing. */
static void the_stream_goes_round_the_ring_unbroken(void **state)
{
	struct srv_segment *s = *state;
	uint64_t in = 0, out = 0;
	bool wake, told;

	while (in < 5u * SRV_RING) {
		size_t n = put(s, in, 77777, &wake);

		assert_int_equal(n, 77777);
		in += n;
		out = drain(s, out, &told);
		assert_true(out == in);
	}
}

static void a_view_ends_at_the_ring_s_end_and_is_short(void **state)
{
	struct srv_segment *s = *state;
	const uint8_t *bytes;
	bool wake, ended, told;

	assert_int_equal(put(s, 0, SRV_RING - 10, &wake), SRV_RING - 10);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), SRV_RING / 8);
	assert_true(drain(s, 0, &told) == SRV_RING - 10);
	assert_int_equal(put(s, SRV_RING - 10, 30, &wake), 30);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 10);
	(void)srv_ring_take(s, 10);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 20);
	assert_ptr_equal(bytes, s->ring);
	assert_int_equal(bytes[0], byte_at(SRV_RING));
}

static void positions_may_wrap_at_two_to_the_64(void **state)
{
	struct srv_segment *s = *state;
	uint64_t start = UINT64_MAX - 999;
	bool wake, told;

	atomic_store(&s->head, start);
	atomic_store(&s->tail, start);
	assert_int_equal(put(s, start, 5000, &wake), 5000);
	assert_true(drain(s, start, &told) == 4000);
	assert_int_equal(put(s, 4000, SRV_RING + 1, &wake), SRV_RING);
}

static void a_full_ring_takes_no_more_until_half_is_free(void **state)
{
	struct srv_segment *s = *state;
	bool wake, told;

	assert_int_equal(put(s, 0, SRV_RING + 5, &wake), SRV_RING);
	assert_int_equal(atomic_load(&s->front_waits), 1);
	assert_int_equal(put(s, SRV_RING, 1, &wake), 0);
	assert_false(srv_ring_take(s, SRV_RING / 2 - 1));
	assert_true(srv_ring_take(s, 1));   /* the one message */
	assert_false(srv_ring_take(s, 10)); /* not twice */
	assert_int_equal(put(s, SRV_RING, 100, &wake), 100);
	assert_true(drain(s, SRV_RING / 2 + 10, &told) == SRV_RING + 100);
	assert_false(told);
}

/* Room that was made since the last look ends the waiting: no message is owed. */
static void a_put_that_fits_owes_no_message(void **state)
{
	struct srv_segment *s = *state;
	bool wake;

	assert_int_equal(put(s, 0, SRV_RING, &wake), SRV_RING);
	assert_int_equal(atomic_load(&s->front_waits), 0);
	assert_int_equal(put(s, 0, 1, &wake), 0);
	assert_int_equal(atomic_load(&s->front_waits), 1);
	assert_false(srv_ring_take(s, 10));
	assert_int_equal(put(s, 0, 10, &wake), 10);
	assert_int_equal(atomic_load(&s->front_waits), 0);
	assert_false(srv_ring_take(s, SRV_RING));
}

static void a_sleeper_is_woken_once(void **state)
{
	struct srv_segment *s = *state;
	bool wake;

	assert_true(srv_ring_sleep(s));
	assert_int_equal(put(s, 0, 0, &wake), 0);
	assert_false(wake); /* nothing came */
	assert_false(srv_ring_wake(s));
	assert_int_equal(put(s, 0, 10, &wake), 10);
	assert_false(wake);            /* not for so few, */
	assert_true(srv_ring_wake(s)); /* unless no more is coming */
	assert_false(srv_ring_wake(s));
	assert_int_equal(put(s, 10, SRV_RING / 2, &wake), SRV_RING / 2);
	assert_false(wake);
}

static void a_sleeper_is_woken_by_a_quarter_of_the_ring(void **state)
{
	struct srv_segment *s = *state;
	bool wake;

	assert_true(srv_ring_sleep(s));
	assert_int_equal(put(s, 0, SRV_RING / 4 - 1, &wake), SRV_RING / 4 - 1);
	assert_false(wake);
	assert_int_equal(put(s, SRV_RING / 4 - 1, 1, &wake), 1);
	assert_true(wake);
	assert_false(srv_ring_wake(s));
}

static void nobody_sleeps_over_bytes_the_end_or_a_cancellation(void **state)
{
	struct srv_segment *s = *state;
	bool wake;

	assert_int_equal(put(s, 0, 1, &wake), 1);
	assert_false(srv_ring_sleep(s));
	assert_int_equal(atomic_load(&s->worker_waits), 0);
	(void)srv_ring_take(s, 1);
	assert_true(srv_ring_sleep(s));

	srv_ring_reset(s);
	srv_ring_end(s, &wake);
	assert_false(wake);
	assert_false(srv_ring_sleep(s));

	srv_ring_reset(s);
	atomic_store(&s->cancelled, 1);
	assert_false(srv_ring_sleep(s));
	assert_int_equal(atomic_load(&s->worker_waits), 0);
}

static void the_end_wakes_and_leaves_the_last_bytes(void **state)
{
	struct srv_segment *s = *state;
	const uint8_t *bytes;
	bool wake, ended;

	assert_true(srv_ring_sleep(s));
	srv_ring_end(s, &wake);
	assert_true(wake);

	srv_ring_reset(s);
	assert_int_equal(put(s, 0, 5, &wake), 5);
	srv_ring_end(s, &wake);
	assert_false(wake);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 5);
	assert_true(ended);
	(void)srv_ring_take(s, 5);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 0);
	assert_true(ended);
}

static void a_reset_ring_knows_nothing_of_the_last_job(void **state)
{
	struct srv_segment *s = *state;
	const uint8_t *bytes;
	bool wake, ended;

	(void)put(s, 0, SRV_RING + 1, &wake);
	srv_ring_end(s, &wake);
	atomic_store(&s->cancelled, 1);
	atomic_store(&s->worker_waits, 1);
	s->receive_ms = s->queued_at = 7;
	srv_ring_reset(s);
	assert_int_equal(srv_ring_peek(s, &bytes, &ended), 0);
	assert_false(ended);
	assert_true(s->receive_ms == 0 && s->queued_at == 0);
	assert_int_equal(put(s, 0, 10, &wake), 10);
	assert_false(wake);
	assert_false(srv_ring_take(s, 10));
	assert_true(srv_ring_sleep(s));
}

/* The worker has met the uploader's bytes: whatever it writes as tail, nothing leaves the ring. */
static void a_lying_tail_leads_nowhere(void **state)
{
	static const uint64_t head = 3u * SRV_RING + 17;
	/* ahead, absurd, too far behind, just full, one byte of room */
	const uint64_t lies[] = {head + 1,        UINT64_MAX,         0, head - SRV_RING - 1,
				 head - SRV_RING, head - SRV_RING + 1};
	struct srv_segment *s = *state;
	struct srv_segment *before = malloc(sizeof *before);
	bool wake;

	assert_non_null(before);
	for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
		size_t room =
		    head - lies[i] <= SRV_RING ? (size_t)(SRV_RING - (head - lies[i])) : 0;

		srv_ring_reset(s);
		memset(s->answer, 0x5a, sizeof s->answer);
		memset(&s->words, 0x5a, sizeof s->words);
		memset(&s->result, 0x5a, sizeof s->result);
		atomic_store(&s->head, head);
		atomic_store(&s->tail, lies[i]);
		memcpy(before, s, sizeof *s);
		assert_true(put(s, 0, 2 * SRV_RING, &wake) == room);
		assert_true(atomic_load(&s->head) == head + room);
		assert_memory_equal(before->answer, s->answer, sizeof s->answer);
		assert_memory_equal(&before->words, &s->words, sizeof s->words);
		assert_memory_equal(&before->result, &s->result, sizeof s->result);
	}
	free(before);
}

/* ---- two threads ---- */

enum { STRESS = 48 << 20, PATIENCE_S = 60 };

struct stress {
	struct srv_segment *s;
	sem_t wake, room; /* the messages */
	uint64_t wrong, received;
	bool stuck;
};

static uint32_t next_random(uint32_t *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return *seed >> 8;
}

static bool wait_for(sem_t *sem)
{
	struct timespec end;

	clock_gettime(CLOCK_REALTIME, &end);
	end.tv_sec += PATIENCE_S;
	while (sem_timedwait(sem, &end) != 0)
		if (errno != EINTR)
			return false;
	return true;
}

/* As in worker.c: look, take some, sleep where there is nothing. */
static void *consume(void *arg)
{
	struct stress *t = arg;
	uint32_t seed = 7;

	for (;;) {
		const uint8_t *bytes;
		bool ended;
		size_t n = srv_ring_peek(t->s, &bytes, &ended);

		if (n > 0) {
			if (next_random(&seed) % 4 == 0)
				n = 1 + next_random(&seed) % n;
			for (size_t i = 0; i < n; i++)
				t->wrong += bytes[i] != byte_at(t->received + i);
			t->received += n;
			if (srv_ring_take(t->s, n))
				sem_post(&t->room);
		} else if (ended) {
			return NULL;
		} else if (srv_ring_sleep(t->s) && !wait_for(&t->wake)) {
			t->stuck = true;
			return NULL;
		}
	}
}

/* As in http.c and pool.c: put, and where it did not fit, wait for the message. */
static bool produce(struct stress *t, uint8_t *chunk, size_t most)
{
	uint32_t seed = 11;
	bool wake;

	for (uint64_t at = 0; at < STRESS;) {
		size_t len = 1 + next_random(&seed) % (next_random(&seed) % 8 == 0 ? most : 700);
		size_t done = 0;

		for (size_t i = 0; i < len; i++)
			chunk[i] = byte_at(at + i);
		while (done < len) {
			done += srv_ring_put(t->s, chunk + done, len - done, &wake);
			if (wake)
				sem_post(&t->wake);
			if (done < len && !wait_for(&t->room))
				return false;
		}
		at += len;
		if (next_random(&seed) % 4 == 0 && srv_ring_wake(t->s))
			sem_post(&t->wake);
	}
	srv_ring_end(t->s, &wake);
	if (wake)
		sem_post(&t->wake);
	return true;
}

static void two_threads_lose_no_byte_and_no_message(void **state)
{
	static uint8_t chunk[96 << 10];
	struct stress t = {.s = *state};
	pthread_t consumer;
	bool sent;

	sem_init(&t.wake, 0, 0);
	sem_init(&t.room, 0, 0);
	assert_int_equal(pthread_create(&consumer, NULL, consume, &t), 0);
	sent = produce(&t, chunk, sizeof chunk);
	pthread_join(consumer, NULL);
	sem_destroy(&t.wake);
	sem_destroy(&t.room);
	assert_true(sent);
	assert_false(t.stuck);
	assert_true(t.received >= STRESS);
	assert_true(t.wrong == 0);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, make, unmake)
	const struct CMUnitTest segment[] = {
	    TEST(what_goes_in_comes_out),
	    TEST(the_stream_goes_round_the_ring_unbroken),
	    TEST(a_view_ends_at_the_ring_s_end_and_is_short),
	    TEST(positions_may_wrap_at_two_to_the_64),
	    TEST(a_full_ring_takes_no_more_until_half_is_free),
	    TEST(a_put_that_fits_owes_no_message),
	    TEST(a_sleeper_is_woken_once),
	    TEST(a_sleeper_is_woken_by_a_quarter_of_the_ring),
	    TEST(nobody_sleeps_over_bytes_the_end_or_a_cancellation),
	    TEST(the_end_wakes_and_leaves_the_last_bytes),
	    TEST(a_reset_ring_knows_nothing_of_the_last_job),
	    TEST(a_lying_tail_leads_nowhere),
	    TEST(two_threads_lose_no_byte_and_no_message),
	};

	return cmocka_run_group_tests(segment, NULL, NULL);
}
