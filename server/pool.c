#include "server/pool.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/channel.h"
#include "server/clock.h"
#include "server/front_private.h"
#include "server/http.h"
#include "server/pool_private.h"
#include "server/worker.h"

static const double grace_s = 0.5; /* of a worker that was told to drop its job, or leaves */

enum { MESSAGES = 16 }; /* of one worker in a row: one that floods must not hold the others up */

int srv_pool_init(struct srv_pool *p, struct srv_front *front)
{
	uint64_t asked = front->config->queue, workers = front->config->workers;

	p->front = front;
	p->workers = front->gift->slots;
	p->worker = calloc(p->workers, sizeof *p->worker);
	if (p->worker == NULL)
		return -1;
	for (unsigned i = 0; i < p->workers; i++) {
		p->worker[i].slot = i;
		p->worker[i].lane = i + 1 == p->workers;
		p->worker[i].desk = front->gift->desk[i];
		p->worker[i].sock = p->worker[i].pidfd = p->worker[i].file = -1;
	}
	srv_queue_init(&p->small, asked != 0 ? asked : 64 * workers);
	srv_queue_init(&p->large, asked != 0 ? asked : 4 * workers);
	return 0;
}

int srv_pool_tell(struct srv_worker *w, enum srv_message what, int fd)
{
	char byte = (char)what;

	return srv_channel_send(w->sock, &byte, 1, &fd, fd >= 0);
}

/* Nothing that it may say counts any more. */
static void turn_from(struct srv_pool *p, struct srv_worker *w)
{
	w->ended = true;
	(void)epoll_ctl(p->front->epoll, EPOLL_CTL_DEL, w->sock, NULL);
}

void srv_pool_bury(struct srv_pool *p, struct srv_worker *w)
{
	turn_from(p, w);
	(void)syscall(SYS_pidfd_send_signal, w->pidfd, SIGKILL, NULL, 0);
}

static void kill_worker(struct srv_pool *p, struct srv_worker *w, enum srv_loss cause)
{
	if (w->state == SRV_DYING || w->state == SRV_ABSENT)
		return;
	srv_metrics_lost(&p->front->metrics, cause);
	w->state = SRV_DYING;
	srv_pool_bury(p, w);
	srv_pool_take_back(p, w, 1, true);
	w->posts = 0;
}

void srv_pool_add(struct srv_pool *p, unsigned slot, pid_t pid, int sock, int pidfd)
{
	struct srv_worker *w;

	if (slot >= p->workers) {
		close(sock);
		close(pidfd);
		return;
	}
	w = &p->worker[slot];
	if (w->state != SRV_ABSENT) /* the master could not get its word on the last one through */
		srv_pool_gone(p, slot, w->pid, SIGKILL);
	w->ended = false;
	w->sock = sock;
	w->pidfd = pidfd;
	w->pid = pid;
	w->state = SRV_IDLE;
	w->posted = w->heard = 0;
	w->cost = 0;
	srv_desk_reset(w->desk);
	if (srv_pool_tell(w, SRV_MSG_BEGIN, -1) != 0)
		srv_pool_bury(p, w);
	else if (srv_front_watch(p->front, sock, SRV_EV_WORKER, slot, EPOLLIN) != 0)
		kill_worker(p, w, SRV_LOST_OUTSIDE);
	srv_pool_dispatch(p);
}

static void drop_file(struct srv_worker *w)
{
	if (w->file >= 0)
		close(w->file);
	w->file = -1;
}

static bool from_outside(int status)
{
	return WIFSIGNALED(status) && (WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGTERM);
}

/* What the end of a worker means for the request it had. */
static void blame(struct srv_exchange *ex, int status)
{
	struct api_problem problem;

	if (from_outside(status))
		(void)api_problem_set(&problem, API_WORKER_LOST,
				      "the worker on this request was ended from outside; nothing "
				      "is wrong with the file");
	else if (WIFEXITED(status) && WEXITSTATUS(status) == SRV_EXIT_NO_MEMORY)
		(void)api_problem_set(&problem, API_TOO_EXPENSIVE,
				      "the request needs more memory than one request may use");
	else
		(void)api_problem_set(
		    &problem, API_DECODER_CRASHED,
		    "the worker on this request crashed; the same bytes would do it again");
	srv_exchange_problem(ex, &problem);
}

void srv_pool_gone(struct srv_pool *p, unsigned slot, pid_t pid, int status)
{
	struct srv_worker *w = slot < p->workers ? &p->worker[slot] : NULL;
	struct srv_exchange *ex;

	if (w == NULL || w->state == SRV_ABSENT || w->pid != pid)
		return;
	turn_from(p, w);
	srv_pool_hear(p, slot); /* it may have answered before it died */
	srv_pool_take_back(p, w, 1, true);
	ex = w->posts > 0 ? w->post[0].exchange : NULL;
	if (w->state != SRV_DYING) /* else it was counted when it was told to go */
		srv_metrics_lost(&p->front->metrics, w->state == SRV_LEAVING ? SRV_LOST_RETIRED
						     : from_outside(status)  ? SRV_LOST_OUTSIDE
									     : SRV_LOST_CRASH);
	close(w->sock); /* leaves the epoll set with it */
	close(w->pidfd);
	drop_file(w);
	w->sock = w->pidfd = -1;
	w->state = SRV_ABSENT;
	w->posts = 0;
	if (ex != NULL) {
		ex->worker = NULL;
		blame(ex, status);
	}
	srv_pool_dispatch(p);
}

static bool hears(const struct srv_worker *w)
{
	return w->state == SRV_BUSY || w->state == SRV_IDLE;
}

/*
 * Read what it has to say, with ${file} up to the next file.  False: its end of the socket is
 * closed.  A second file stays there until the first one is taken: it is another answer's.
 */
static bool read_mail(struct srv_worker *w, bool file)
{
	for (int i = 0; i < MESSAGES && w->file < 0; i++) {
		int fd = -1;
		size_t fds = 1;
		char byte;
		ssize_t n = srv_channel_receive(w->sock, &byte, 1, &fd, &fds);

		if (n < 0 && errno == ECONNRESET) /* it died with mail unread: hear its own */
			continue;
		if (n <= 0)
			return n != 0;
		if (fds > 0)
			w->file = fd;
		if (byte == SRV_MSG_ROOM && w->posts > 0 && w->post[0].exchange != NULL)
			srv_http_resume(w->post[0].exchange);
		if (byte == SRV_MSG_DONE && !file) /* the last word of most */
			break;
	}
	return true;
}

/* The next one of its line is in work from now on. */
static void step(struct srv_worker *w, double now)
{
	w->cost -= w->post[0].cost;
	memmove(w->post, w->post + 1, --w->posts * sizeof w->post[0]);
	w->heard++;
	w->since = now;
	if (w->posts == 0)
		w->state = SRV_IDLE;
	else if (w->post[0].exchange != NULL)
		w->post[0].exchange->dispatched = now;
}

/* The first job is over; its answer lies in its berth, and its file may wait in the socket. */
static void answered(struct srv_pool *p, struct srv_worker *w)
{
	struct srv_segment *s = &w->desk->berth[w->post[0].berth];
	struct srv_exchange *ex = w->post[0].exchange;
	double now = srv_now();
	int fd = -1;

	if (s->result.len > SRV_ANSWER) { /* else the file is of one behind it */
		(void)read_mail(w, true);
		fd = w->file;
		w->file = -1;
	}
	step(w, now);
	if (s->result.retire != 0) { /* its last one, whatever else it was given */
		srv_pool_take_back(p, w, 0, true);
		w->posts = 0;
		w->state = SRV_LEAVING;
		turn_from(p, w);
	}
	if (ex == NULL) { /* cancelled meanwhile */
		if (fd >= 0)
			close(fd);
		return;
	}
	ex->worker = NULL;
	srv_queue_learn(ex->small ? &p->small : &p->large, now - ex->dispatched);
	srv_exchange_result(ex, s, fd);
}

void srv_pool_collect(struct srv_pool *p, struct srv_worker *w)
{
	while (w->state == SRV_BUSY && !srv_desk_is_at(w->desk, w->heard))
		answered(p, w);
	if (w->state == SRV_IDLE && (w->file >= 0 || !srv_desk_is_at(w->desk, w->heard)))
		srv_pool_bury(p, w); /* it says that it did what it was not given */
}

void srv_pool_hear(struct srv_pool *p, unsigned slot)
{
	struct srv_worker *w = &p->worker[slot];
	bool there = true, held = w->file >= 0; /* more mail: its job is over */

	if (hears(w)) {
		there = read_mail(w, false);
		srv_pool_collect(p, w);
	}
	if (hears(w) && (!there || (held && w->file >= 0)))
		srv_pool_bury(p, w);
	srv_pool_dispatch(p);
}

struct srv_worker *srv_pool_idle(const struct srv_pool *p, bool lane)
{
	for (unsigned i = 0; i < p->workers; i++)
		if (p->worker[i].state == SRV_IDLE && p->worker[i].lane == lane &&
		    !p->worker[i].ended)
			return &p->worker[i];
	return NULL;
}

bool srv_pool_has_idle(const struct srv_pool *p)
{
	return srv_pool_idle(p, false) != NULL;
}

size_t srv_pool_put(struct srv_exchange *ex, const uint8_t *bytes, size_t len)
{
	bool wake;
	size_t n = srv_ring_put(ex->segment, bytes, len, &wake);

	if (wake)
		(void)srv_pool_tell(ex->worker, SRV_MSG_WAKE, -1);
	return n;
}

size_t srv_pool_room(const struct srv_exchange *ex, struct iovec room[2])
{
	return srv_ring_room(ex->segment, room);
}

void srv_pool_filled(struct srv_exchange *ex, size_t len)
{
	bool wake;

	srv_ring_filled(ex->segment, len, &wake);
	ex->front->unwoken = true;
	if (wake)
		(void)srv_pool_tell(ex->worker, SRV_MSG_WAKE, -1);
}

void srv_pool_wake(struct srv_exchange *ex)
{
	if (srv_ring_wake(ex->segment))
		(void)srv_pool_tell(ex->worker, SRV_MSG_WAKE, -1);
}

void srv_pool_end(struct srv_exchange *ex)
{
	bool wake;

	ex->segment->receive_ms = 1e3 * (ex->last_byte - ex->began);
	srv_ring_end(ex->segment, &wake);
	if (wake)
		(void)srv_pool_tell(ex->worker, SRV_MSG_WAKE, -1);
}

/* It looks up before its next bytes. */
static void cancel(struct srv_worker *w, struct srv_segment *s)
{
	bool wake;

	w->since = srv_now();
	atomic_store(&s->cancelled, 1);
	srv_ring_end(s, &wake);
	if (wake)
		(void)srv_pool_tell(w, SRV_MSG_WAKE, -1);
}

void srv_pool_drop(struct srv_pool *p, struct srv_exchange *ex)
{
	struct srv_worker *w = ex->worker;
	bool first;

	if (ex->queued)
		srv_queue_remove(ex->small ? &p->small : &p->large, ex);
	if (w == NULL)
		return;
	first = srv_pool_in_work(ex);
	ex->worker = NULL;
	for (unsigned i = 0; i < w->posts; i++)
		if (w->post[i].exchange == ex)
			w->post[i].exchange = NULL;
	if (w->state != SRV_BUSY)
		return;
	if (!first) /* where it is too late for that, the worker comes to its end by itself */
		(void)srv_desk_withdraw(ex->segment);
	else if (ex->body_ended) /* deep in its work: it would not look up in time */
		kill_worker(p, w, SRV_LOST_CLIENT);
	else
		cancel(w, ex->segment);
}

bool srv_pool_in_work(const struct srv_exchange *ex)
{
	const struct srv_worker *w = ex->worker;

	return w != NULL && w->posts > 0 && w->post[0].exchange == ex;
}

void srv_pool_kill(struct srv_exchange *ex)
{
	struct srv_worker *w = ex->worker;

	ex->worker = NULL;
	kill_worker(&ex->front->pool, w, SRV_LOST_DEADLINE);
}

unsigned srv_pool_retry_after(const struct srv_pool *p, bool small)
{
	const struct srv_queue *q = small ? &p->small : &p->large;
	unsigned workers = p->workers - (small ? 0 : 1);
	double wait = q->service * (srv_pool_waiting(p, small) + 1) / workers;

	return wait < 1 ? 1 : wait > 120 ? 120 : (unsigned)ceil(wait);
}

/* A client that closed its side while others wait gives up its place: it has most likely left. */
static void make_way(struct srv_pool *p)
{
	if ((p->large.first == NULL && p->small.first == NULL) || srv_pool_idle(p, false) != NULL)
		return;
	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];

		if (w->state == SRV_BUSY && w->post[0].exchange != NULL &&
		    w->post[0].exchange->half_closed && (!w->lane || p->small.first != NULL)) {
			srv_exchange_abort(w->post[0].exchange);
			return;
		}
	}
}

void srv_pool_tick(struct srv_pool *p, double now)
{
	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];
		bool unwanted = w->state == SRV_BUSY && w->post[0].exchange == NULL;

		if ((unwanted || w->state == SRV_LEAVING) && now - w->since > grace_s)
			kill_worker(p, w,
				    w->state == SRV_LEAVING ? SRV_LOST_RETIRED : SRV_LOST_CLIENT);
	}
	make_way(p);
	srv_pool_dispatch(p);
}
