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
		p->worker[i].segment = front->gift->segment[i];
		p->worker[i].sock = p->worker[i].pidfd = -1;
	}
	srv_queue_init(&p->small, asked != 0 ? asked : 64 * workers);
	srv_queue_init(&p->large, asked != 0 ? asked : 4 * workers);
	return 0;
}

static int tell(struct srv_worker *w, enum srv_message what, const int *fd, size_t fds)
{
	char byte = (char)what;

	return srv_channel_send(w->sock, &byte, 1, fd, fds);
}

/* Nothing that it may say counts any more. */
static void turn_from(struct srv_pool *p, struct srv_worker *w)
{
	w->ended = true;
	(void)epoll_ctl(p->front->epoll, EPOLL_CTL_DEL, w->sock, NULL);
}

/* Its end of the socket is closed: it is dead and the master will say how, or it is made so. */
static void bury(struct srv_pool *p, struct srv_worker *w)
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
	w->exchange = NULL;
	bury(p, w);
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
	if (srv_front_watch(p->front, sock, SRV_EV_WORKER, slot, EPOLLIN) != 0)
		kill_worker(p, w, SRV_LOST_OUTSIDE);
	srv_pool_dispatch(p);
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
	srv_pool_hear(p, slot); /* it may have answered before it died */
	ex = w->exchange;
	if (w->state != SRV_DYING) /* else it was counted when it was told to go */
		srv_metrics_lost(&p->front->metrics, w->state == SRV_LEAVING ? SRV_LOST_RETIRED
						     : from_outside(status)  ? SRV_LOST_OUTSIDE
									     : SRV_LOST_CRASH);
	close(w->sock); /* leaves the epoll set with it */
	close(w->pidfd);
	w->sock = w->pidfd = -1;
	w->state = SRV_ABSENT;
	w->exchange = NULL;
	if (ex != NULL) {
		ex->worker = NULL;
		blame(ex, status);
	}
}

static void answered(struct srv_pool *p, struct srv_worker *w, int fd)
{
	struct srv_exchange *ex = w->exchange;

	w->state = w->segment->result.retire != 0 ? SRV_LEAVING : SRV_IDLE;
	w->since = srv_now();
	w->exchange = NULL;
	if (w->state == SRV_LEAVING)
		turn_from(p, w);
	if (ex == NULL) { /* cancelled meanwhile */
		if (fd >= 0)
			close(fd);
		return;
	}
	ex->worker = NULL;
	srv_queue_learn(ex->small ? &p->small : &p->large, srv_now() - ex->dispatched);
	srv_exchange_result(ex, w->segment, fd);
}

static bool hears(const struct srv_worker *w)
{
	return w->state == SRV_BUSY || w->state == SRV_CANCELLING || w->state == SRV_IDLE;
}

void srv_pool_hear(struct srv_pool *p, unsigned slot)
{
	struct srv_worker *w = &p->worker[slot];

	for (int i = 0; i < MESSAGES && hears(w); i++) {
		int fd = -1;
		size_t fds = 1;
		char byte;
		ssize_t n = srv_channel_receive(w->sock, &byte, 1, &fd, &fds);

		if (fds == 0)
			fd = -1;
		if (n < 0 && errno == ECONNRESET) /* it died with mail unread: hear its own */
			continue;
		if (n == 0)
			bury(p, w);
		if (n <= 0)
			break;
		if (byte == SRV_MSG_ANSWER && w->state != SRV_IDLE) {
			answered(p, w, fd);
			break; /* it says nothing more until it is told to */
		}
		if (fd >= 0)
			close(fd);
		if (byte == SRV_MSG_IDLE && w->state == SRV_CANCELLING)
			w->state = SRV_IDLE;
		else if (byte == SRV_MSG_ROOM && w->state == SRV_BUSY)
			srv_http_resume(w->exchange);
	}
	srv_pool_dispatch(p);
}

static struct srv_worker *idle(const struct srv_pool *p, bool lane)
{
	for (unsigned i = 0; i < p->workers; i++)
		if (p->worker[i].state == SRV_IDLE && p->worker[i].lane == lane &&
		    !p->worker[i].ended)
			return &p->worker[i];
	return NULL;
}

bool srv_pool_has_idle(const struct srv_pool *p)
{
	return idle(p, false) != NULL;
}

bool srv_pool_accepts(const struct srv_pool *p, bool small)
{
	const struct srv_queue *q = small ? &p->small : &p->large;

	return q->length < q->most || idle(p, false) != NULL || (small && idle(p, true) != NULL);
}

int srv_pool_enqueue(struct srv_pool *p, struct srv_exchange *ex)
{
	struct srv_queue *q = ex->small ? &p->small : &p->large;

	if (!srv_pool_accepts(p, ex->small))
		return -1;
	srv_queue_add(q, ex);
	return 0;
}

static void set_words(struct srv_words *words, const struct srv_exchange *ex)
{
	words->query_len = (uint32_t)ex->query_len;
	if (ex->query_len > 0)
		memcpy(words->query, ex->query, ex->query_len);
	words->has_content_type = ex->has_content_type;
	words->has_content_encoding = ex->has_content_encoding;
	memcpy(words->content_type, ex->content_type, sizeof words->content_type);
	memcpy(words->content_encoding, ex->content_encoding, sizeof words->content_encoding);
	strncpy(words->instance, ex->path, sizeof words->instance - 1);
	memcpy(words->request_id, ex->id, sizeof words->request_id);
	words->mesh = ex->endpoint == SRV_MESH;
	words->spooled = ex->body.spooled;
}

/*
 * A free worker takes ${ex}: what has come of the body goes over, the rest will follow.  False
 * where the worker died just now; ${ex} is as it was.
 */
static bool start(struct srv_pool *p, struct srv_worker *w, struct srv_exchange *ex)
{
	double now = srv_now();
	bool wake;

	srv_ring_reset(w->segment);
	set_words(&w->segment->words, ex);
	w->segment->queue_ms = 1e3 * (now - ex->queued_at);
	if (ex->body.fd < 0)
		(void)srv_ring_put(w->segment, ex->body.bytes, ex->body.len, &wake);
	if (ex->body_ended) {
		w->segment->receive_ms = 1e3 * (ex->last_byte - ex->began);
		srv_ring_end(w->segment, &wake);
	}
	atomic_store(&w->segment->used, 1);
	if (tell(w, SRV_MSG_JOB, &ex->body.fd, ex->body.fd >= 0) != 0) {
		bury(p, w);
		return false;
	}
	ex->worker = w;
	ex->dispatched = now;
	w->exchange = ex;
	w->state = SRV_BUSY;
	srv_body_clear(&ex->body);
	if (!ex->body_ended)
		srv_http_resume(ex);
	return true;
}

size_t srv_pool_put(struct srv_exchange *ex, const uint8_t *bytes, size_t len)
{
	bool wake;
	size_t n = srv_ring_put(ex->worker->segment, bytes, len, &wake);

	if (wake)
		(void)tell(ex->worker, SRV_MSG_WAKE, NULL, 0);
	return n;
}

void srv_pool_wake(struct srv_exchange *ex)
{
	if (srv_ring_wake(ex->worker->segment))
		(void)tell(ex->worker, SRV_MSG_WAKE, NULL, 0);
}

void srv_pool_end(struct srv_exchange *ex)
{
	bool wake;

	ex->worker->segment->receive_ms = 1e3 * (ex->last_byte - ex->began);
	srv_ring_end(ex->worker->segment, &wake);
	if (wake)
		(void)tell(ex->worker, SRV_MSG_WAKE, NULL, 0);
}

void srv_pool_dispatch(struct srv_pool *p)
{
	for (;;) {
		struct srv_exchange *small = p->small.first, *large = p->large.first, *ex;
		struct srv_worker *w = small != NULL ? idle(p, true) : NULL;

		ex = small;
		if (w == NULL) {
			w = idle(p, false);
			if (small == NULL || (large != NULL && large->queued_at < small->queued_at))
				ex = large;
		}
		if (w == NULL || ex == NULL)
			return;
		if (start(p, w, ex))
			srv_queue_remove(ex->small ? &p->small : &p->large, ex);
	}
}

void srv_pool_drop(struct srv_pool *p, struct srv_exchange *ex)
{
	struct srv_worker *w = ex->worker;
	bool wake;

	if (ex->queued)
		srv_queue_remove(ex->small ? &p->small : &p->large, ex);
	if (w == NULL)
		return;
	ex->worker = NULL;
	w->exchange = NULL;
	if (w->state != SRV_BUSY)
		return;
	if (ex->body_ended) { /* deep in its work: it would not look up in time */
		kill_worker(p, w, SRV_LOST_CLIENT);
		return;
	}
	w->state = SRV_CANCELLING;
	w->since = srv_now();
	atomic_store(&w->segment->cancelled, 1);
	srv_ring_end(w->segment, &wake);
	if (wake)
		(void)tell(w, SRV_MSG_WAKE, NULL, 0);
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
	double wait = q->service * (q->length + 1) / workers;

	return wait < 1 ? 1 : wait > 120 ? 120 : (unsigned)ceil(wait);
}

/* A client that closed its side while others wait gives up its place: it has most likely left. */
static void make_way(struct srv_pool *p)
{
	if ((p->large.first == NULL && p->small.first == NULL) || idle(p, false) != NULL)
		return;
	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];

		if (w->state == SRV_BUSY && w->exchange->half_closed &&
		    (!w->lane || p->small.first != NULL)) {
			srv_exchange_abort(w->exchange);
			return;
		}
	}
}

void srv_pool_tick(struct srv_pool *p, double now)
{
	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];

		if ((w->state == SRV_CANCELLING || w->state == SRV_LEAVING) &&
		    now - w->since > grace_s)
			kill_worker(p, w,
				    w->state == SRV_LEAVING ? SRV_LOST_RETIRED : SRV_LOST_CLIENT);
	}
	make_way(p);
	srv_pool_dispatch(p);
}
