#include "server/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <seccomp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Memory, descriptors that are there, time, random bytes, and the way out. */
static const int both[] = {
    SCMP_SYS(read),          SCMP_SYS(write),          SCMP_SYS(pread64),
    SCMP_SYS(recvmsg),       SCMP_SYS(sendmsg),        SCMP_SYS(close),
    SCMP_SYS(munmap),        SCMP_SYS(mremap),         SCMP_SYS(brk),
    SCMP_SYS(madvise),       SCMP_SYS(poll),           SCMP_SYS(ppoll),
    SCMP_SYS(futex),         SCMP_SYS(getrandom),      SCMP_SYS(memfd_create),
    SCMP_SYS(ftruncate),     SCMP_SYS(lseek),          SCMP_SYS(fstat),
    SCMP_SYS(clock_gettime), SCMP_SYS(gettimeofday),   SCMP_SYS(clock_nanosleep),
    SCMP_SYS(nanosleep),     SCMP_SYS(sched_yield),    SCMP_SYS(restart_syscall),
    SCMP_SYS(rt_sigaction),  SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn),
    SCMP_SYS(getpid),        SCMP_SYS(gettid),         SCMP_SYS(exit),
    SCMP_SYS(exit_group)};

enum { MAP_TYPE_BITS = 0x0f }; /* of the flags of mmap() */

/* Sockets that were given to it or that it accepts; signals through descriptors of workers. */
static const int front[] = {
    SCMP_SYS(accept4),       SCMP_SYS(recvfrom),    SCMP_SYS(sendto),
    SCMP_SYS(sendmmsg),      SCMP_SYS(writev),      SCMP_SYS(readv),
    SCMP_SYS(sendfile),      SCMP_SYS(shutdown),    SCMP_SYS(setsockopt),
    SCMP_SYS(getsockopt),    SCMP_SYS(getsockname), SCMP_SYS(getpeername),
    SCMP_SYS(epoll_wait),    SCMP_SYS(epoll_pwait), SCMP_SYS(epoll_ctl),
    SCMP_SYS(epoll_create1), SCMP_SYS(eventfd2),    SCMP_SYS(pipe2),
    SCMP_SYS(fcntl),         SCMP_SYS(dup),         SCMP_SYS(pidfd_send_signal),
    SCMP_SYS(getrlimit),     SCMP_SYS(prlimit64)};

/* No way back from here: these end the process, and the master writes down that they did. */
static const int deadly[] = {SCMP_SYS(execve),
			     SCMP_SYS(execveat),
			     SCMP_SYS(fork),
			     SCMP_SYS(vfork),
			     SCMP_SYS(clone),
			     SCMP_SYS(clone3),
			     SCMP_SYS(socket),
			     SCMP_SYS(socketpair),
			     SCMP_SYS(ptrace),
			     SCMP_SYS(process_vm_readv),
			     SCMP_SYS(process_vm_writev)};

static int allow(scmp_filter_ctx ctx, const int *list, size_t count, uint32_t action)
{
	for (size_t i = 0; i < count; i++) {
		int rc = seccomp_rule_add(ctx, action, list[i], 0);

		/* a call that this architecture does not have needs no rule */
		if (rc != 0 && rc != -EDOM && rc != -EINVAL)
			return rc;
	}
	return 0;
}

#define LIST(list) list, sizeof(list) / sizeof(list)[0]

/* Memory may be mapped, never to be executed, nor shared: RLIMIT_DATA counts what is private. */
static int allow_mapping(scmp_filter_ctx ctx)
{
	int rc = seccomp_rule_add(ctx, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 2,
				  SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0),
				  SCMP_A3(SCMP_CMP_MASKED_EQ, MAP_TYPE_BITS, MAP_PRIVATE));

	return rc != 0 ? rc
		       : seccomp_rule_add(ctx, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1,
					  SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
}

/* The way out through abort(): a signal to itself, and to nobody else of the same user. */
static int allow_abort(scmp_filter_ctx ctx)
{
	return seccomp_rule_add(ctx, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1,
				SCMP_A0(SCMP_CMP_EQ, (scmp_datum_t)getpid(), 0));
}

/* A worker seals its answers. */
static int allow_sealing(scmp_filter_ctx ctx)
{
	int rc = seccomp_rule_add(ctx, SCMP_ACT_ALLOW, SCMP_SYS(fcntl), 1,
				  SCMP_A1(SCMP_CMP_EQ, F_ADD_SEALS, 0));

	return rc == -EDOM || rc == -EINVAL ? 0 : rc;
}

static int filter_calls(enum srv_sandbox_role role)
{
	scmp_filter_ctx ctx = seccomp_init(SCMP_ACT_ERRNO(EPERM));
	int rc;

	if (ctx == NULL)
		return -ENOMEM;
	rc = allow(ctx, LIST(both), SCMP_ACT_ALLOW);
	rc = rc != 0 ? rc : allow(ctx, LIST(deadly), SCMP_ACT_KILL_PROCESS);
	rc = rc != 0 ? rc : allow_mapping(ctx);
	rc = rc != 0 ? rc : allow_abort(ctx);
	if (rc == 0)
		rc = role == SRV_SANDBOX_FRONT ? allow(ctx, LIST(front), SCMP_ACT_ALLOW)
					       : allow_sealing(ctx);
	rc = rc != 0 ? rc : seccomp_load(ctx);
	seccomp_release(ctx);
	return rc;
}

/* Handle every right of the file system's first version and grant none. */
static int lock_files(void)
{
	struct landlock_ruleset_attr rights = {.handled_access_fs =
						   (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1};
	int fd = (int)syscall(SYS_landlock_create_ruleset, &rights, sizeof rights, 0), rc;

	if (fd < 0)
		return -errno;
	rc = (int)syscall(SYS_landlock_restrict_self, fd, 0) == 0 ? 0 : -errno;
	close(fd);
	return rc;
}

int srv_sandbox_enter(enum srv_sandbox_role role, char *why, size_t size)
{
	int files, calls;

	if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) {
		(void)snprintf(why, size, "no_new_privs: %s", strerror(errno));
		return -1;
	}
	files = lock_files();
	calls = filter_calls(role);
	if (files == 0 && calls == 0)
		return 0;
	(void)snprintf(why, size, "%s%s%s%s%s", files != 0 ? "no Landlock: " : "",
		       files != 0 ? strerror(-files) : "", files != 0 && calls != 0 ? "; " : "",
		       calls != 0 ? "no seccomp: " : "", calls != 0 ? strerror(-calls) : "");
	return -1;
}

int srv_sandbox_obey(enum srv_sandbox_mode mode, enum srv_sandbox_role role, char *why, size_t size)
{
	why[0] = '\0';
#ifdef MP_SANITIZED
	mode = SRV_SANDBOX_OFF;
#endif
	if (mode == SRV_SANDBOX_OFF || srv_sandbox_enter(role, why, size) == 0)
		return 0;
	return mode == SRV_SANDBOX_REQUIRE ? -1 : 0;
}
