#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/front_private.h"
#include "server/reply.h"

/* What a worker that has been taken over may hand to the front. */

enum { LONG = 300000 };

struct scene {
	struct srv_front front;
	struct srv_exchange ex;
	struct srv_segment segment;
};

static int make(void **state)
{
	struct scene *s = calloc(1, sizeof *s);

	if (s == NULL)
		return -1;
	s->front.budget.most = 10 << 20;
	s->ex.front = &s->front;
	s->ex.reply.fd = -1;
	s->segment.result.status = 200;
	strcpy(s->segment.result.content_type, "application/json");
	strcpy(s->segment.result.format, "obj");
	*state = s;
	return 0;
}

static int unmake(void **state)
{
	struct scene *s = *state;

	if (s->ex.reply.fd >= 0)
		close(s->ex.reply.fd);
	free(s->ex.reply.body);
	free(s);
	return 0;
}

static int made_file(off_t len, int seals)
{
	int fd = memfd_create("answer", MFD_CLOEXEC | MFD_ALLOW_SEALING);

	assert_true(fd >= 0);
	assert_int_equal(ftruncate(fd, len), 0);
	assert_int_equal(fcntl(fd, F_ADD_SEALS, seals), 0);
	return fd;
}

static void takes(struct scene *s, int fd, enum api_code code)
{
	assert_int_equal(srv_reply_take(&s->ex, &s->segment, fd), code);
	assert_int_equal(s->ex.has_result, code == API_OK);
	if (code != API_OK && fd >= 0) /* no descriptor is left behind */
		assert_int_equal(fcntl(fd, F_GETFD), -1);
}

static void a_sealed_file_of_the_length_that_was_said_is_taken(void **state)
{
	struct scene *s = *state;

	s->segment.result.len = LONG;
	takes(s, made_file(LONG, SRV_ANSWER_SEALS), API_OK);
	assert_int_equal(s->front.budget.answers, LONG);
}

static void a_file_that_can_change_is_not(void **state)
{
	static const int seal[] = {F_SEAL_SEAL, F_SEAL_SHRINK, F_SEAL_GROW, F_SEAL_WRITE};

	for (size_t i = 0; i < sizeof seal / sizeof seal[0]; i++) {
		struct scene *s = *state;

		s->segment.result.len = LONG;
		takes(s, made_file(LONG, SRV_ANSWER_SEALS & ~seal[i]), API_INTERNAL);
		assert_int_equal(s->front.budget.used, 0);
	}
}

static void a_file_of_another_length_is_not(void **state)
{
	struct scene *s = *state;

	s->segment.result.len = LONG + 1;
	takes(s, made_file(LONG, SRV_ANSWER_SEALS), API_INTERNAL);
	s->segment.result.len = UINT64_MAX; /* (off_t)-1 */
	takes(s, made_file(LONG, SRV_ANSWER_SEALS), API_INTERNAL);
}

static void what_cannot_be_sealed_is_not(void **state)
{
	struct scene *s = *state;
	int ends[2], plain = open("/dev/null", O_RDWR | O_CLOEXEC);

	assert_int_equal(pipe(ends), 0);
	s->segment.result.len = 0;
	takes(s, ends[0], API_INTERNAL);
	takes(s, ends[1], API_INTERNAL);
	takes(s, plain, API_INTERNAL); /* its length is 0 */
}

static void more_than_the_segment_holds_is_not(void **state)
{
	struct scene *s = *state;

	s->segment.result.len = SRV_ANSWER + 1;
	takes(s, -1, API_INTERNAL);
}

static void texts_without_end_or_with_line_breaks_are_not(void **state)
{
	struct scene *s = *state;

	memset(s->segment.result.content_type, 'a', sizeof s->segment.result.content_type);
	takes(s, -1, API_OK);
	assert_int_equal(strlen(s->ex.result.content_type), sizeof s->ex.result.content_type - 1);
	free(s->ex.reply.body);
	s->ex.reply.body = NULL;
	s->ex.has_result = false;
	strcpy(s->segment.result.origin, "0,0,0\r\nX: y");
	takes(s, -1, API_INTERNAL);
	strcpy(s->segment.result.origin, "0,0,0");
	s->segment.result.status = 100;
	takes(s, -1, API_INTERNAL);
	s->segment.result.status = 200;
	s->segment.result.code = API_CODES;
	takes(s, -1, API_INTERNAL);
}

#define TEST(f) cmocka_unit_test_setup_teardown(f, make, unmake)

int main(void)
{
	const struct CMUnitTest tests[] = {
	    TEST(a_sealed_file_of_the_length_that_was_said_is_taken),
	    TEST(a_file_that_can_change_is_not),
	    TEST(a_file_of_another_length_is_not),
	    TEST(what_cannot_be_sealed_is_not),
	    TEST(more_than_the_segment_holds_is_not),
	    TEST(texts_without_end_or_with_line_breaks_are_not),
	};

	return cmocka_run_group_tests_name("reply", tests, NULL, NULL);
}
