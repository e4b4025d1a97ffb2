#include "server/spawn.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/channel.h"
#include "server/clock.h"
#include "server/front.h"
#include "server/worker.h"

/* What every child does first: own signals, and no life beyond the master's. */
static void become_child(struct srv_master *m, const char *role)
{
	srv_log_role(role);
	(void)prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != m->pid) /* it died before the line above */
		_exit(0);
	close(m->signals);
	/* a terminal's Ctrl-C reaches the whole group: only the master may act on it */
	(void)signal(SIGINT, SIG_IGN);
	(void)signal(SIGTERM, SIG_IGN);
	(void)signal(SIGHUP, SIG_IGN);
	(void)sigprocmask(SIG_SETMASK, &m->old_mask, NULL);
}

/* Files of the kind that answers are lie in memory, too: few of them, each within the same limit.
 */
static void limit_memory(uint64_t bytes, int sock)
{
#ifndef MP_SANITIZED
	struct rlimit limit = {bytes, bytes}, few = {(rlim_t)sock + 8, (rlim_t)sock + 8};

	(void)signal(SIGXFSZ, SIG_IGN); /* the write fails */
	(void)setrlimit(RLIMIT_DATA, &limit);
	(void)setrlimit(RLIMIT_FSIZE, &limit);
	(void)setrlimit(RLIMIT_NOFILE, &few);
#else
	(void)bytes;
	(void)sock;
#endif
}

/*
 * Who answers small requests must not wait behind those who work on large ones for seconds: large
 * work yields, and the front and the lane ask the scheduler (Linux 6.12 and later; others pass it
 * over) for short turns, which come sooner.
 */
static void take_turns(bool large)
{
	struct {
		uint32_t size, policy;
		uint64_t flags;
		int32_t nice;
		uint32_t priority;
		uint64_t runtime, deadline, period;
	} wish = {.size = 48, .policy = SCHED_OTHER, .nice = getpriority(PRIO_PROCESS, 0)};

	if (large) {
		wish.nice = wish.nice < 15 ? wish.nice + 5 : 19;
		(void)setpriority(PRIO_PROCESS, 0, wish.nice);
		return;
	}
	wish.runtime = 100000; /* nanoseconds, the least there is */
	(void)syscall(SYS_sched_setattr, 0, &wish, 0);
}

_Noreturn static void worker_child(struct srv_master *m, unsigned i, int sock)
{
	struct rlimit no_core = {0, 0};

	become_child(m, m->slot[i].role);
	close(m->channel);
	if (m->keys >= 0)
		close(m->keys); /* a file that takes over this process shall find none */
	for (unsigned k = 0; k < m->listeners; k++)
		close(m->listener[k]);
	for (unsigned k = 0; k < m->slots; k++) /* another customer's bytes are none of ours */
		if (k != i)
			(void)munmap(m->slot[k].desk, sizeof(struct srv_desk));
	(void)setrlimit(RLIMIT_CORE, &no_core);
	limit_memory(i + 1 == m->slots ? m->memory.lane : m->memory.worker, sock);
	take_turns(i + 1 < m->slots);
	srv_worker_run(m->config, sock, m->slot[i].desk, i + 1 < m->slots);
}

static void announce(struct srv_master *m, unsigned i, int sock)
{
	struct srv_order order = {.kind = SRV_ORDER_WORKER_NEW, .slot = i, .pid = m->slot[i].pid};
	int fd[2] = {sock, (int)syscall(SYS_pidfd_open, m->slot[i].pid, 0)};

	if (fd[1] < 0 || srv_channel_send(m->channel, &order, sizeof order, fd, 2) != 0) {
		srv_log(SRV_ERROR, "cannot hand over %s: %s", m->slot[i].role, strerror(errno));
		(void)kill(m->slot[i].pid, SIGKILL); /* reaped and tried again */
	}
	if (fd[1] >= 0)
		close(fd[1]);
}

void srv_spawn_worker(struct srv_master *m, unsigned i)
{
	struct srv_slot *s = &m->slot[i];
	int pair[2];
	pid_t pid;

	s->retry = srv_now() + SRV_SPAWN_PAUSE;
	if (srv_channel_pair(pair, 0) != 0 || fcntl(pair[0], F_SETFL, O_NONBLOCK) != 0) {
		srv_log(SRV_ERROR, "no socket for %s: %s", s->role, strerror(errno));
		return;
	}
	atomic_store(&s->desk->used, 0);
	pid = fork();
	if (pid == 0) {
		close(pair[0]);
		worker_child(m, i, pair[1]);
	}
	close(pair[1]);
	if (pid < 0) {
		srv_log(SRV_ERROR, "cannot fork %s: %s", s->role, strerror(errno));
	} else {
		s->pid = pid;
		s->forked = srv_now();
		announce(m, i, pair[0]);
	}
	close(pair[0]);
}

_Noreturn static void front_child(struct srv_master *m, int channel)
{
	struct srv_desk *desk[SRV_SLOTS];
	struct srv_front_gift gift = {.config = m->config,
				      .listener = m->listener,
				      .listeners = m->listeners,
				      .metrics_apart = m->config->metrics_listen != NULL,
				      .keys = m->keys,
				      .master = channel,
				      .desk = desk,
				      .slots = m->slots,
				      .spool_budget = m->memory.spool};

	become_child(m, "front");
	take_turns(false);
	for (unsigned i = 0; i < m->slots; i++)
		desk[i] = m->slot[i].desk;
	exit(srv_front_run(&gift));
}

int srv_spawn_front(struct srv_master *m)
{
	int pair[2];

	if (srv_channel_pair(pair, 1) != 0)
		return -1;
	m->front_forked = srv_now();
	m->front = fork();
	if (m->front == 0) {
		close(pair[0]);
		front_child(m, pair[1]);
	}
	close(pair[1]);
	if (m->front < 0) {
		close(pair[0]);
		m->front = 0;
		return -1;
	}
	m->channel = pair[0];
	return 0;
}
