#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/sandbox.h"
#include "server/second.h"

enum { HELD = 40, BROKEN, ALONE };

struct sum {
	const struct mp_second *second;
	uint64_t n, of;
};

static void add_up(void *arg)
{
	struct sum *s = arg;

	for (uint64_t i = 1; i <= s->n; i++)
		s->of += i;
}

/* Each begin() is seen by the wait() behind it, and what was done by whoever waited. */
static void work_is_done_in_turn(void **state)
{
	static struct srv_second second; /* its thread stays */
	struct sum s = {.n = 100};
	int started = srv_second_start(&second, SRV_SANDBOX_OFF);

	(void)state;
	assert_true(started >= 0);
	s.second = started > 0 ? &second.lent : NULL;
	for (uint64_t i = 1; i <= 2000; i++) {
		mp_second_begin(s.second, add_up, &s);
		mp_second_wait(s.second);
		assert_int_equal(s.of, i * 5050);
	}
	mp_second_wait(s.second); /* for nothing */
}

static void without_a_second_it_is_done_at_once(void **state)
{
	struct sum s = {.n = 4};

	(void)state;
	mp_second_begin(NULL, add_up, &s);
	assert_int_equal(s.of, 10);
	mp_second_wait(NULL);
}

/* In a child whose second thread, as a worker's, closed its sandbox: the child's wait status. */
static int in_second(void (*work)(void *result), bool own)
{
	int status = 0;
	pid_t pid = fork();

	if (pid == 0) {
		static struct srv_second second;
		char why[200] = "";
		int result = BROKEN;

		if (srv_second_start(&second, SRV_SANDBOX_AUTO) <= 0 ||
		    (own && srv_sandbox_obey(SRV_SANDBOX_AUTO, SRV_SANDBOX_WORKER, why,
					     sizeof why) != 0) ||
		    why[0] != '\0') /* a kernel without some of it */
			_exit(ALONE);
		mp_second_begin(&second.lent, work, &result);
		mp_second_wait(&second.lent);
		_exit(result);
	}
	assert_true(pid > 0);
	assert_int_equal(waitpid(pid, &status, 0), pid);
	if (WIFEXITED(status) && WEXITSTATUS(status) == ALONE)
		skip();
	return status;
}

static void do_open(void *result)
{
	*(int *)result = open("/etc/passwd", O_RDONLY) < 0 && (errno == EPERM || errno == EACCES)
			     ? HELD
			     : BROKEN;
}

static void do_fork(void *result)
{
	*(int *)result = fork() == 0 ? BROKEN : BROKEN;
}

static void do_allocate(void *result)
{
	char *p = malloc(64 << 20);

	*(int *)result = p != NULL ? HELD : BROKEN;
	for (size_t i = 0; p != NULL && i < 64 << 20; i += 4096)
		p[i] = 1;
	free(p);
}

static void its_sandbox_is_a_worker_s(void **state)
{
	int status;

	(void)state;
#ifdef MP_SANITIZED
	skip(); /* a sanitizer's runtime makes calls that no list has */
#endif
	status = in_second(do_open, false);
	assert_true(WIFEXITED(status));
	assert_int_equal(WEXITSTATUS(status), HELD);
	status = in_second(do_fork, true);
	assert_true(WIFSIGNALED(status));
	assert_int_equal(WTERMSIG(status), SIGSYS);
}

static void it_allocates_behind_both_sandboxes(void **state)
{
	int status = in_second(do_allocate, true);

	(void)state;
	assert_true(WIFEXITED(status));
	assert_int_equal(WEXITSTATUS(status), HELD);
}

static void one_processor_needs_no_second(void **state)
{
	cpu_set_t all, one;
	struct srv_second second;

	(void)state;
	assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
	CPU_ZERO(&one);
	for (size_t i = 0; CPU_COUNT(&one) == 0; i++)
		if (CPU_ISSET(i, &all))
			CPU_SET(i, &one);
	assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
	assert_int_equal(srv_second_start(&second, SRV_SANDBOX_REQUIRE), 0);
	assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(without_a_second_it_is_done_at_once),
	    cmocka_unit_test(its_sandbox_is_a_worker_s),
	    cmocka_unit_test(it_allocates_behind_both_sandboxes),
	    cmocka_unit_test(one_processor_needs_no_second),
	    cmocka_unit_test(work_is_done_in_turn), /* its thread does not go along with a fork */
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
