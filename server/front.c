#include "server/front.h"

#include <errno.h>
#include <malloc.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "api/capabilities.h"
#include "server/channel.h"
#include "server/clock.h"
#include "server/front_private.h"
#include "server/http.h"

enum { TRIM_FROM = 4 << 20 }; /* bytes */
enum { EVENTS = 64, TICK_MS = 100, MOST_FRUITLESS = 100, MOST_UNWOKEN = 16, MOST_SAID = 8 };

int srv_front_watch(struct srv_front *f, int fd, enum srv_event kind, unsigned index,
		    uint32_t events)
{
	struct epoll_event e = {.events = events, .data.u64 = (uint64_t)kind << 32 | index};

	return epoll_ctl(f->epoll, EPOLL_CTL_ADD, fd, &e);
}

static void obey(struct srv_front *f, const struct srv_order *order, const int *fd, size_t fds)
{
	if (order->kind == SRV_ORDER_WORKER_NEW && fds == 2) {
		srv_pool_add(&f->pool, order->slot, order->pid, fd[0], fd[1]);
		return;
	}
	if (order->kind == SRV_ORDER_KEYS && fds == 1)
		srv_log(SRV_INFO, "API keys: %s",
			srv_keys_load(&f->keys, fd[0]) == 0 ? "new ones are in force"
							    : "no memory, the old ones stay");
	for (size_t i = 0; i < fds; i++)
		close(fd[i]);
	if (order->kind == SRV_ORDER_WORKER_GONE)
		srv_pool_gone(&f->pool, order->slot, order->pid, order->status);
	if (order->kind == SRV_ORDER_DRAIN && !f->draining) {
		f->draining = true;
		f->drain_began = srv_now();
	}
}

static void hear_master(struct srv_front *f)
{
	struct srv_order order;
	ssize_t n;

	for (;;) {
		int fd[2] = {-1, -1};
		size_t fds = 2;

		n = srv_channel_receive(f->gift->master, &order, sizeof order, fd, &fds);
		if (n != (ssize_t)sizeof order)
			break;
		obey(f, &order, fd, fds);
	}
	if (n == 0)
		_exit(1); /* no master, no workers */
}

static bool inside(const struct srv_front *f, unsigned listener)
{
	return f->gift->metrics_apart && listener + 1 == f->gift->listeners;
}

static void handle(struct srv_front *f, const struct epoll_event *e)
{
	unsigned index = (unsigned)(e->data.u64 & 0xffffffffu);

	switch ((enum srv_event)(e->data.u64 >> 32)) {
	case SRV_EV_LISTENER:
		if (!f->refusing)
			srv_http_accept(f->http, f->gift->listener[index], inside(f, index));
		break;
	case SRV_EV_MASTER:
		hear_master(f);
		break;
	case SRV_EV_WORKER:
		srv_pool_hear(&f->pool, index);
		break;
	case SRV_EV_CLIENT:
		srv_http_client_event(f->http, (int)index, e->events);
		break;
	case SRV_EV_HTTP:
		break; /* the library runs after every round */
	}
}

static void tick_drain(struct srv_front *f, double now)
{
	double since = now - f->drain_began;

	if (!f->draining || since < f->config->drain_delay)
		return;
	if (!f->refusing) {
		f->refusing = true;
		/* who has connected is answered, whoever comes later is refused by the system */
		for (unsigned i = 0; i < f->gift->listeners; i++) {
			srv_http_accept(f->http, f->gift->listener[i], inside(f, i));
			(void)epoll_ctl(f->epoll, EPOLL_CTL_DEL, f->gift->listener[i], NULL);
			close(f->gift->listener[i]);
		}
	}
	if (srv_http_connections(f->http) == 0 ||
	    since > f->config->drain_delay + f->config->drain_timeout)
		f->stop = true;
}

/* What a crowd needed goes back to the system when it has left: the heap keeps holes by itself. */
static void shrink(struct srv_front *f)
{
	struct srv_budget *b = &f->budget;

	if (b->highest < TRIM_FROM || b->used > b->highest / 8)
		return;
	b->highest = b->used;
	(void)malloc_trim(0);
}

static void tick(struct srv_front *f, double now)
{
	struct srv_exchange *next;

	for (struct srv_exchange *ex = f->exchanges; ex != NULL; ex = next) {
		next = ex->next;
		srv_exchange_tick(ex, now);
	}
	srv_pool_tick(&f->pool, now);
	srv_http_tick(f->http, now, f->refusing);
	tick_drain(f, now);
	shrink(f);
	srv_log_flush();
}

static bool sends(const struct srv_front *f)
{
	const struct srv_exchange *ex = f->exchanges;

	while (ex != NULL && (!ex->sent || ex->gone))
		ex = ex->next;
	return ex != NULL;
}

static int wait_ms(struct srv_front *f)
{
	int ms = srv_http_timeout(f->http);

	/* The library would poll without end on a chunk-size line that does not fit its buffer. */
	if (ms == 0 && f->fruitless > MOST_FRUITLESS && !sends(f))
		return TICK_MS / 5;
	return ms >= 0 && ms < TICK_MS ? ms : TICK_MS;
}

/*
 * Waking a worker costs as much as what it does with a piece of a body, so it sleeps until there
 * are several: until the front has nothing to do but to wait, or was too busy for a while.
 */
static int wake_for_bytes(struct srv_front *f)
{
	int ms = wait_ms(f);

	if (!f->unwoken || (ms == 0 && f->unwoken_rounds++ < MOST_UNWOKEN))
		return ms;
	for (struct srv_exchange *ex = f->exchanges; ex != NULL; ex = ex->next)
		if (ex->worker != NULL)
			srv_pool_wake(ex);
	f->unwoken = false;
	f->unwoken_rounds = 0;
	return ms;
}

/*
 * As far as the library gets without waiting for anything: bytes that it only has to hear of are
 * said in one go, some 64 kB at a time.  False where no request came any further.
 */
static bool run(struct srv_front *f)
{
	bool further = false;
	int rounds = 0;

	do {
		f->unsaid = false;
		further = srv_http_run(f->http) || further;
	} while (f->unsaid && ++rounds < MOST_SAID);
	return further;
}

static void loop(struct srv_front *f)
{
	struct epoll_event event[EVENTS];
	double ticked = srv_now();

	while (!f->stop) {
		int ms = srv_pool_before_sleep(&f->pool, wake_for_bytes(f)), n;
		double now;

		if (ms > 0)
			srv_log_flush();
		n = epoll_wait(f->epoll, event, EVENTS, ms);
		srv_pool_after_sleep(&f->pool);
		for (int i = 0; i < n; i++)
			handle(f, &event[i]);
		f->fruitless = run(f) || n > 0 ? 0 : f->fruitless + 1;
		now = srv_now();
		if (now - ticked >= 1e-3 * TICK_MS) {
			ticked = now;
			tick(f, now);
			(void)srv_http_run(f->http);
		}
	}
}

static int make_capabilities(struct srv_front *f)
{
	struct api_limits_in_force limits = {.max_body = f->config->max_body,
					     .max_decoded = f->config->max_decoded,
					     .max_triangles = f->config->max_triangles,
					     .deadline_s = f->config->deadline,
					     .workers = (unsigned)f->config->workers};

	f->capabilities = api_capabilities_json(&limits, &f->capabilities_len);
	return f->capabilities != NULL ? 0 : -1;
}

static int set_up(struct srv_front *f)
{
	if (f->gift->keys >= 0 && srv_keys_load(&f->keys, f->gift->keys) != 0)
		return -1;
	f->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (f->epoll < 0 || srv_pool_init(&f->pool, f) != 0 || make_capabilities(f) != 0)
		return -1;
	f->http = srv_http_start(f);
	if (f->http == NULL ||
	    srv_front_watch(f, srv_http_epoll(f->http), SRV_EV_HTTP, 0, EPOLLIN) != 0 ||
	    srv_front_watch(f, f->gift->master, SRV_EV_MASTER, 0, EPOLLIN) != 0)
		return -1;
	for (unsigned i = 0; i < f->gift->listeners; i++)
		if (srv_front_watch(f, f->gift->listener[i], SRV_EV_LISTENER, i, EPOLLIN) != 0)
			return -1;
	return 0;
}

int srv_front_run(const struct srv_front_gift *gift)
{
	struct srv_front f = {
	    .gift = gift, .config = gift->config, .budget = {.most = gift->spool_budget}};
	struct srv_order ready = {.kind = SRV_ORDER_READY};
	char why[200];

	if (set_up(&f) != 0) {
		srv_log(SRV_ERROR, "cannot begin: %s", strerror(errno));
		return 1;
	}
	if (srv_sandbox_obey(f.config->sandbox, SRV_SANDBOX_FRONT, why, sizeof why) != 0) {
		srv_log(SRV_ERROR, "the sandbox is required, but there is %s", why);
		return 1;
	}
	if (why[0] != '\0')
		srv_log(SRV_WARN, "the sandbox is weaker than it might be: %s", why);
	if (srv_channel_send(gift->master, &ready, sizeof ready, NULL, 0) != 0)
		return 1;
	loop(&f);
	srv_http_stop(f.http);
	srv_log_flush();
	free(f.pool.worker);
	free(f.capabilities);
	srv_keys_free(&f.keys);
	close(f.epoll);
	return 0;
}
