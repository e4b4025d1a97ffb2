#include "server/master.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/channel.h"
#include "server/clock.h"
#include "server/front.h"
#include "server/keys.h"
#include "server/listen.h"
#include "server/memory.h"
#include "server/spawn.h"
#include "server/worker.h"

static int open_listeners(struct srv_master *m, char *why, size_t size)
{
	const struct srv_config *c = m->config;
	unsigned all = c->listens + (c->metrics_listen != NULL);

	for (unsigned i = 0; i < all; i++) {
		m->listener[i] = srv_listen_open(i < c->listens ? c->listen[i] : c->metrics_listen,
						 m->url[i], sizeof m->url[i], why, size);
		if (m->listener[i] < 0)
			return -1;
		m->listeners++;
	}
	return 0;
}

static int open_segments(struct srv_master *m, char *why, size_t size)
{
	m->slots = (unsigned)m->config->workers + 1;
	for (unsigned i = 0; i < m->slots; i++) {
		void *p = mmap(NULL, sizeof(struct srv_desk), PROT_READ | PROT_WRITE,
			       MAP_SHARED | MAP_ANONYMOUS, -1, 0);

		if (p == MAP_FAILED) {
			(void)snprintf(why, size, "no memory for worker %u", i);
			return -1;
		}
		m->slot[i].desk = p;
		if (i + 1 == m->slots)
			(void)snprintf(m->slot[i].role, sizeof m->slot[i].role, "small lane");
		else
			(void)snprintf(m->slot[i].role, sizeof m->slot[i].role, "worker %u", i);
	}
	return 0;
}

static void start_missing(struct srv_master *m)
{
	for (unsigned i = 0; i < m->slots; i++) /* in a drain too: requests may wait for one */
		if (m->slot[i].pid == 0 && m->front > 0 && srv_now() >= m->slot[i].retry)
			srv_spawn_worker(m, i);
}

/* Workers belong to one front: its sockets are gone with it. */
static void front_died(struct srv_master *m, int status)
{
	close(m->channel);
	m->channel = -1;
	m->front = m->ready ? 0 : -1; /* never served: it will not serve the second time either */
	srv_log(SRV_ERROR, "the front ended (%s %d)", WIFSIGNALED(status) ? "signal" : "status",
		WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
	for (unsigned i = 0; i < m->slots; i++) {
		m->slot[i].retry = 0;
		if (m->slot[i].pid > 0)
			(void)kill(m->slot[i].pid, SIGKILL);
	}
}

static void worker_died(struct srv_master *m, unsigned i, int status)
{
	struct srv_slot *s = &m->slot[i];
	struct srv_order order = {
	    .kind = SRV_ORDER_WORKER_GONE, .slot = i, .pid = s->pid, .status = status};
	bool ours = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
	bool retired = WIFEXITED(status) && WEXITSTATUS(status) == SRV_EXIT_RETIRED;

	srv_log(m->draining || retired ? SRV_DEBUG
		: ours                 ? SRV_INFO
				       : SRV_WARN,
		"%s (pid %d) ended (%s %d), replacing it", s->role, (int)s->pid,
		WIFSIGNALED(status) ? "signal" : "status",
		WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
	s->pid = 0;
	if (atomic_load(&s->desk->used) != 0 || srv_now() - s->forked > SRV_SPAWN_PAUSE)
		s->retry = 0; /* it had begun well: replace it at once */
	if (m->channel >= 0)
		(void)srv_channel_send(m->channel, &order, sizeof order, NULL, 0);
}

static void reap(struct srv_master *m)
{
	int status;
	pid_t pid;

	while ((pid = waitpid(-1, &status, WNOHANG)) > 0) {
		if (pid == m->front) {
			if (m->draining)
				m->front = -1;
			else
				front_died(m, status);
			continue;
		}
		for (unsigned i = 0; i < m->slots; i++)
			if (m->slot[i].pid == pid)
				worker_died(m, i, status);
	}
}

static void hear_front(struct srv_master *m)
{
	struct srv_order order;
	size_t fds = 0;

	while (m->channel >= 0 && srv_channel_receive(m->channel, &order, sizeof order, NULL,
						      &fds) == (ssize_t)sizeof order) {
		fds = 0;
		if (order.kind != SRV_ORDER_READY || m->ready)
			continue;
		m->ready = true;
		for (unsigned i = 0; i < m->listeners; i++)
			(void)printf("%s%s\n", m->url[i], i < m->config->listens ? "" : "/metrics");
		(void)fflush(stdout);
	}
}

static void begin_drain(struct srv_master *m)
{
	struct srv_order order = {.kind = SRV_ORDER_DRAIN};

	if (m->draining) { /* asked twice: at once */
		if (m->front > 0)
			(void)kill(m->front, SIGKILL);
		return;
	}
	m->draining = true;
	srv_log(SRV_INFO, "draining");
	for (unsigned i = 0; i < m->listeners; i++) { /* the front closes its own in time */
		close(m->listener[i]);
		m->listener[i] = -1;
	}
	if (m->front <= 0 || srv_channel_send(m->channel, &order, sizeof order, NULL, 0) != 0)
		m->front = -1;
}

/* SIGHUP: the key file again; one that is none leaves the keys before in force. */
static void change_keys(struct srv_master *m)
{
	struct srv_order order = {.kind = SRV_ORDER_KEYS};
	char why[300];
	int fd;

	if (m->config->api_key_file == NULL)
		return;
	fd = srv_keys_read(m->config->api_key_file, why, sizeof why);
	if (fd < 0) {
		srv_log(SRV_ERROR, "the API keys stay as they were: %s", why);
		return;
	}
	close(m->keys);
	m->keys = fd; /* a front that is yet to come has them from here */
	if (m->channel >= 0 && srv_channel_send(m->channel, &order, sizeof order, &fd, 1) != 0)
		srv_log(SRV_ERROR, "cannot hand over the API keys: %s", strerror(errno));
}

static void hear_signals(struct srv_master *m)
{
	struct signalfd_siginfo info;

	while (read(m->signals, &info, sizeof info) == (ssize_t)sizeof info)
		if (info.ssi_signo == SIGTERM || info.ssi_signo == SIGINT)
			begin_drain(m);
		else if (info.ssi_signo == SIGHUP)
			change_keys(m);
	reap(m);
}

/* The front ends by itself within the drain times; this is for one that does not. */
static bool overdue(const struct srv_master *m, double since)
{
	return m->draining &&
	       srv_now() - since > m->config->drain_delay + m->config->drain_timeout + 2;
}

static void serve(struct srv_master *m)
{
	double drain_began = 0;

	while (m->front != -1 && !(m->draining && overdue(m, drain_began))) {
		struct pollfd p[2] = {{.fd = m->signals, .events = POLLIN},
				      {.fd = m->channel, .events = POLLIN}};

		if (m->front == 0 && srv_now() - m->front_forked > SRV_SPAWN_PAUSE &&
		    srv_spawn_front(m) != 0)
			srv_log(SRV_ERROR, "cannot fork the front: %s", strerror(errno));
		start_missing(m);
		p[1].fd = m->channel;
		(void)poll(p, 2, 100);
		if (p[0].revents != 0)
			hear_signals(m);
		hear_front(m);
		if (m->draining && drain_began == 0)
			drain_began = srv_now();
	}
}

static void stop_children(struct srv_master *m)
{
	if (m->front > 0)
		(void)kill(m->front, SIGKILL);
	for (unsigned i = 0; i < m->slots; i++)
		if (m->slot[i].pid > 0)
			(void)kill(m->slot[i].pid, SIGKILL);
	while (waitpid(-1, NULL, 0) > 0)
		;
}

static void raise_descriptors(void)
{
	struct rlimit limit;

	if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < limit.rlim_max) {
		limit.rlim_cur = limit.rlim_max < 65536 ? limit.rlim_max : 65536;
		(void)setrlimit(RLIMIT_NOFILE, &limit);
	}
}

static int block_signals(struct srv_master *m)
{
	sigset_t set;

	sigemptyset(&set);
	sigaddset(&set, SIGTERM);
	sigaddset(&set, SIGINT);
	sigaddset(&set, SIGCHLD);
	sigaddset(&set, SIGHUP);
	(void)signal(SIGPIPE, SIG_IGN);
	(void)sigprocmask(SIG_BLOCK, &set, &m->old_mask);
	m->signals = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
	return m->signals;
}

int srv_master_run(const struct srv_config *config)
{
	static struct srv_master
	    m; /* the workers' roles are named from it for as long as they live */
	char why[300];

	m.config = config;
	m.channel = -1;
	m.keys = -1;
	m.pid = getpid();
	srv_memory_plan(config, &m.memory);
	raise_descriptors();
	if (config->api_key_file != NULL)
		m.keys = srv_keys_read(config->api_key_file, why, sizeof why);
	if ((config->api_key_file != NULL && m.keys < 0) ||
	    open_listeners(&m, why, sizeof why) != 0 || open_segments(&m, why, sizeof why) != 0) {
		(void)fprintf(stderr, "masspropd: %s\n", why);
		return 1;
	}
	if (block_signals(&m) < 0 || srv_spawn_front(&m) != 0) {
		(void)fprintf(stderr, "masspropd: cannot start: %s\n", strerror(errno));
		return 1;
	}
	srv_log(SRV_INFO,
		"%u workers and a small lane, %llu MB each and %llu MB, %llu MB for bodies",
		m.slots - 1, (unsigned long long)(m.memory.worker / 1000000),
		(unsigned long long)(m.memory.lane / 1000000),
		(unsigned long long)(m.memory.spool / 1000000));
	serve(&m);
	stop_children(&m);
	return m.ready || m.draining ? 0 : 1;
}
