#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/sandbox.h"

#ifdef MP_SANITIZED
enum { SANITIZED = 1 }; /* a sanitizer's runtime makes calls that no list has */
#else
enum { SANITIZED = 0 };
#endif

enum { HELD = 40, BROKEN, MISSING };

/* What ${act} does in a sandboxed child: its wait status; act returns the exit status. */
static int in_child(enum srv_sandbox_role role, int (*act)(void))
{
	int status = 0;
	pid_t pid = fork();

	if (pid == 0) {
		char why[200] = "";

		if (srv_sandbox_enter(role, why, sizeof why) != 0 && strstr(why, "seccomp") != NULL)
			_exit(MISSING);
		_exit(act());
	}
	assert_true(pid > 0);
	assert_int_equal(waitpid(pid, &status, 0), pid);
	if (WIFEXITED(status) && WEXITSTATUS(status) == MISSING)
		skip(); /* a kernel without seccomp */
	return status;
}

static int do_exec(void)
{
	char *argv[] = {(char *)(uintptr_t) "/bin/true", NULL};

	execv(argv[0], argv);
	return BROKEN;
}

static int do_fork(void)
{
	return fork() == 0 ? BROKEN : BROKEN;
}

static int do_socket(void)
{
	(void)socket(AF_INET, SOCK_STREAM, 0);
	return BROKEN;
}

static int do_open(void)
{
	return open("/etc/passwd", O_RDONLY) < 0 && errno == EPERM ? HELD : BROKEN;
}

static int do_write_file(void)
{
	return open("/tmp/masspropd-sandbox", O_CREAT | O_WRONLY, 0600) < 0 && errno == EPERM
		   ? HELD
		   : BROKEN;
}

static int do_map_code(void)
{
	void *p = mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

	return p == MAP_FAILED && errno == EPERM ? HELD : BROKEN;
}

static int do_kill(void)
{
	return kill(getppid(), 0) != 0 && errno == EPERM ? HELD : BROKEN;
}

/* abort() signals itself: nobody else may be meant by that call. */
static int do_signal_a_thread(void)
{
	pid_t other = getppid();

	return syscall(SYS_tgkill, other, other, 0) != 0 && errno == EPERM ? HELD : BROKEN;
}

/* RLIMIT_DATA does not count what is shared. */
static int do_map_shared(void)
{
	void *p = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);

	return p == MAP_FAILED && errno == EPERM ? HELD : BROKEN;
}

static int do_seal(void)
{
	int fd = memfd_create("answer", MFD_CLOEXEC | MFD_ALLOW_SEALING);

	return fcntl(fd, F_ADD_SEALS, F_SEAL_WRITE) == 0 && fcntl(fd, F_DUPFD, 0) < 0 &&
		       errno == EPERM
		   ? HELD
		   : BROKEN;
}

/* What a worker lives by. */
static int do_work(void)
{
	char *big = malloc(64 << 20), byte;
	int fd = memfd_create("answer", MFD_CLOEXEC);

	if (big == NULL || fd < 0)
		return BROKEN;
	memset(big, 1, 64 << 20);
	big = realloc(big, 96 << 20);
	return big != NULL && write(fd, big, 100) == 100 && pread(fd, &byte, 1, 99) == 1 &&
		       byte == 1
		   ? HELD
		   : BROKEN;
}

static int do_abort(void)
{
	abort();
}

static void dies(enum srv_sandbox_role role, int (*act)(void))
{
	int status = in_child(role, act);

	assert_true(WIFSIGNALED(status));
	assert_int_equal(WTERMSIG(status), SIGSYS);
}

static void holds(enum srv_sandbox_role role, int (*act)(void))
{
	int status = in_child(role, act);

	assert_true(WIFEXITED(status));
	assert_int_equal(WEXITSTATUS(status), HELD);
}

static void a_worker_that_executes_forks_or_connects_is_killed(void **state)
{
	(void)state;
	if (SANITIZED)
		skip();
	dies(SRV_SANDBOX_WORKER, do_exec);
	dies(SRV_SANDBOX_WORKER, do_fork);
	dies(SRV_SANDBOX_WORKER, do_socket);
}

static void a_worker_opens_and_signals_nothing(void **state)
{
	(void)state;
	if (SANITIZED)
		skip();
	holds(SRV_SANDBOX_WORKER, do_open);
	holds(SRV_SANDBOX_WORKER, do_write_file);
	holds(SRV_SANDBOX_WORKER, do_kill);
	holds(SRV_SANDBOX_WORKER, do_signal_a_thread);
	holds(SRV_SANDBOX_WORKER, do_map_code);
	holds(SRV_SANDBOX_WORKER, do_map_shared);
}

static void a_worker_still_works(void **state)
{
	int status;

	(void)state;
	if (SANITIZED)
		skip();
	holds(SRV_SANDBOX_WORKER, do_work);
	holds(SRV_SANDBOX_WORKER, do_seal);
	status = in_child(SRV_SANDBOX_WORKER, do_abort);
	assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

static void the_front_executes_forks_and_opens_nothing_either(void **state)
{
	(void)state;
	if (SANITIZED)
		skip();
	dies(SRV_SANDBOX_FRONT, do_exec);
	dies(SRV_SANDBOX_FRONT, do_fork);
	dies(SRV_SANDBOX_FRONT, do_socket);
	holds(SRV_SANDBOX_FRONT, do_open);
	holds(SRV_SANDBOX_FRONT, do_kill);
	holds(SRV_SANDBOX_FRONT, do_signal_a_thread);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_worker_that_executes_forks_or_connects_is_killed),
	    cmocka_unit_test(a_worker_opens_and_signals_nothing),
	    cmocka_unit_test(a_worker_still_works),
	    cmocka_unit_test(the_front_executes_forks_and_opens_nothing_either),
	};

	return cmocka_run_group_tests_name("sandbox", tests, NULL, NULL);
}
