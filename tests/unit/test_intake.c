#include "server/intake.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/channel.h"
#include "server/front_private.h"
#include "tests/unit/mesh_random.h"

/* What the library and on_request() do with a body, around a real socket and a real ring. */

enum { LIBRARY = 8192, LENGTH = 5 << 20, LAST = 256 << 10 };

struct scene {
	struct srv_front front;
	struct srv_worker worker;
	struct srv_exchange ex;
	struct srv_segment *segment;
	int client, socket, mail;
	uint8_t buffer[LIBRARY]; /* the library's: what had no room in the ring stays there */
	size_t in_buffer;
	uint64_t sent, checked, direct; /* direct: past that buffer */
};

static uint8_t byte_at(uint64_t position)
{
	return (uint8_t)((position * 0x9e3779b97f4a7c15u) >> 56);
}

static int make(void **state)
{
	struct scene *s = calloc(1, sizeof *s);
	int pair[2], mail[2];

	if (s == NULL || socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, pair) != 0 ||
	    srv_channel_pair(mail, 1) != 0)
		return -1;
	s->client = pair[0];
	s->socket = pair[1];
	s->segment = calloc(1, sizeof *s->segment);
	if (s->segment == NULL)
		return -1;
	srv_ring_reset(s->segment);
	s->worker.sock = mail[0];
	s->mail = mail[1];
	s->ex.front = &s->front;
	s->ex.worker = &s->worker;
	s->ex.segment = s->segment;
	s->ex.intake.length = LENGTH;
	*state = s;
	return 0;
}

static int unmake(void **state)
{
	struct scene *s = *state;

	close(s->client);
	close(s->socket);
	close(s->mail);
	close(s->worker.sock);
	free(s->segment);
	free(s);
	return 0;
}

static void send_some(struct scene *s, size_t len)
{
	uint8_t bytes[70000];
	ssize_t n;

	if (len > LENGTH - s->sent)
		len = (size_t)(LENGTH - s->sent);
	for (size_t i = 0; i < len; i++)
		bytes[i] = byte_at(s->sent + i);
	n = send(s->client, bytes, len, MSG_DONTWAIT);
	if (n > 0)
		s->sent += (uint64_t)n;
}

/* The worker takes up to ${most} bytes, which are the next ones. */
static void take_some(struct scene *s, size_t most)
{
	const uint8_t *bytes;
	bool ended;
	size_t n = srv_ring_peek(s->segment, &bytes, &ended);

	if (n > most)
		n = most;
	for (size_t i = 0; i < n; i++)
		if (bytes[i] != byte_at(s->checked + i))
			fail_msg("byte %llu is another one", (unsigned long long)(s->checked + i));
	s->checked += n;
	(void)srv_ring_take(s->segment, n);
}

static bool is_empty(int fd)
{
	char c;

	return recvfrom(fd, &c, 1, MSG_PEEK | MSG_DONTWAIT, NULL, NULL) < 0 && errno == EAGAIN;
}

/* As the library: read once, then hand on all that is in the buffer. */
static ssize_t read_once(struct scene *s)
{
	size_t asked = LIBRARY - s->in_buffer, told, kept;
	struct srv_intake *in = &s->ex.intake;
	ssize_t n = srv_intake_read(&s->ex, s->socket, s->buffer + s->in_buffer, asked);

	if (n < (ssize_t)asked && !is_empty(s->socket))
		fail_msg("%zd of %zu bytes, and more are there", n, asked);
	if (n <= 0)
		return n;
	s->in_buffer += (size_t)n;
	told = in->told;
	in->told = 0;
	s->direct += told;
	kept = told + srv_pool_put(&s->ex, s->buffer + told, s->in_buffer - told);
	memmove(s->buffer, s->buffer + kept, s->in_buffer - kept);
	s->in_buffer -= kept;
	in->leftover = s->in_buffer;
	s->ex.received += kept;
	return n;
}

/*
 * Whatever the sizes and the order: the worker sees the body as it was sent, and fewer bytes than
 * asked for are only read where none are left, for the library then waits until more arrive.
 */
static void every_byte_arrives_in_order(void **state)
{
	struct scene *s = *state;
	uint64_t random = 4;

	while (s->checked < LENGTH) {
		unsigned what = (unsigned)(random_bits(&random) % 8);

		if (what < 3)
			send_some(s, random_bits(&random) % (what == 0 ? 70000 : 9000));
		else if (what < 6 && s->in_buffer < LIBRARY)
			(void)read_once(s);
		else if (what >= 6)
			take_some(s, random_bits(&random) % (SRV_RING / 8));
		if (s->in_buffer > 0) { /* resumed: what is left goes first */
			size_t n = srv_pool_put(&s->ex, s->buffer, s->in_buffer);

			memmove(s->buffer, s->buffer + n, s->in_buffer - n);
			s->in_buffer -= n;
			s->ex.received += n;
			s->ex.intake.leftover = s->in_buffer;
		}
	}
	assert_true(s->ex.received == LENGTH && s->ex.intake.ahead == 0);
	assert_true(s->direct > LENGTH / 2 && s->direct <= LENGTH - LAST);
}

static void a_full_ring_is_no_end(void **state)
{
	struct scene *s = *state;
	uint8_t bytes[LIBRARY];

	while (s->ex.received < SRV_RING) {
		send_some(s, 70000);
		assert_true(read_once(s) > 0);
	}
	send_some(s, 70000);
	assert_int_equal(srv_intake_read(&s->ex, s->socket, bytes, sizeof bytes), LIBRARY);
	assert_int_equal(bytes[0], byte_at(SRV_RING)); /* into the buffer */
}

static void an_end_and_an_error_are_passed_on(void **state)
{
	struct scene *s = *state;

	errno = 0;
	assert_int_equal(read_once(s), -1);
	assert_int_equal(errno, EAGAIN);
	send_some(s, 2 * LIBRARY);
	assert_int_equal(read_once(s), LIBRARY);
	shutdown(s->client, SHUT_WR);
	assert_int_equal(read_once(s), LIBRARY);
	assert_int_equal(srv_intake_read(&s->ex, s->socket, s->buffer, LIBRARY), 0);
}

/* What the ring has is told of to its end, but no more goes there when its worker has left. */
static void nothing_goes_to_a_worker_that_left(void **state)
{
	struct scene *s = *state;
	uint8_t bytes[LIBRARY] = {0};

	send_some(s, 3 * LIBRARY);
	assert_int_equal(srv_intake_read(&s->ex, s->socket, bytes, LIBRARY), LIBRARY);
	assert_int_equal(s->ex.intake.ahead, 2 * LIBRARY);
	s->ex.worker = NULL;
	s->ex.answered = true;
	send_some(s, LIBRARY);
	for (int i = 0; i < 2; i++)
		assert_int_equal(srv_intake_read(&s->ex, s->socket, bytes, LIBRARY), LIBRARY);
	assert_int_equal(bytes[1], 0);
	assert_true(atomic_load(&s->segment->head) == 3u * LIBRARY);
	assert_int_equal(srv_intake_read(&s->ex, s->socket, bytes, LIBRARY), LIBRARY);
	assert_int_equal(bytes[1], byte_at(3 * LIBRARY + 1));
	assert_true(atomic_load(&s->segment->head) == 3u * LIBRARY);
}

/* Nothing of the next request, and nothing of a body without a length. */
static void the_ring_gets_no_byte_that_is_not_of_the_body(void **state)
{
	static const uint64_t LENGTHS[] = {0, 100, LAST, LAST + LIBRARY - 1};
	struct scene *s = *state;
	uint8_t bytes[LIBRARY];

	for (size_t i = 0; i < sizeof LENGTHS / sizeof *LENGTHS; i++) {
		s->ex.intake.length = LENGTHS[i];
		send_some(s, LIBRARY);
		assert_int_equal(srv_intake_read(&s->ex, s->socket, bytes, LIBRARY), LIBRARY);
		assert_int_equal(s->ex.intake.told, 0);
		assert_true(atomic_load(&s->segment->head) == 0);
	}
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, make, unmake)

int main(void)
{
	const struct CMUnitTest tests[] = {
	    TEST(every_byte_arrives_in_order),
	    TEST(a_full_ring_is_no_end),
	    TEST(an_end_and_an_error_are_passed_on),
	    TEST(nothing_goes_to_a_worker_that_left),
	    TEST(the_ring_gets_no_byte_that_is_not_of_the_body),
	};

	return cmocka_run_group_tests_name("intake", tests, NULL, NULL);
}
