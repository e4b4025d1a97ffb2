#include "server/exchange.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "server/clock.h"
#include "server/front_private.h"
#include "server/http.h"
#include "server/reply.h"
#include "server/route.h"

/* A sender that brings the first bytes at this rate is not worth spooling: its worker may begin. */
static const double fast_rate = 8e6;    /* bytes a second */
static const double least_rate = 64e3;  /* bytes a second, over --body-timeout */
static const double crowded_rate = 1e6; /* of one that holds a worker while others wait */
static const double crowded_after_s = 5;
static const double write_piece = 4e6; /* bytes of an answer that --write-timeout is for */
static const uint64_t discard_bytes = 64
				      << 20; /* behind a verdict, before the connection is closed */
static const double discard_s = 10;

/* No path that is served is longer than the rest of this, and no query than is taken. */
enum { URI_MAX = SRV_QUERY_MAX + 4096 };

/* "/path?query", or the same behind "http://host" (absolute form, RFC 9112 3.2.2). */
static void split_uri(struct srv_exchange *ex)
{
	char *at = ex->uri, *mark;

	if (strncasecmp(at, "http://", 7) == 0 || strncasecmp(at, "https://", 8) == 0) {
		char *slash = strchr(strstr(at, "//") + 2, '/');

		at = slash != NULL ? slash : at + strlen(at);
	}
	ex->path = *at != '\0' ? at : "/";
	ex->query = "";
	mark = strchr(at, '?');
	if (mark != NULL) {
		*mark = '\0';
		ex->query = mark + 1;
		ex->query_len = strlen(mark + 1);
	}
}

struct srv_exchange *srv_exchange_new(struct srv_front *front, const char *uri)
{
	struct srv_exchange *ex = calloc(1, sizeof *ex);

	if (ex == NULL)
		return NULL;
	ex->uri = strndup(uri, URI_MAX);
	if (ex->uri == NULL) {
		free(ex);
		return NULL;
	}
	split_uri(ex);
	ex->front = front;
	ex->began = srv_now();
	ex->reply.fd = -1;
	srv_body_init(&ex->body, &front->budget);
	ex->next = front->exchanges;
	if (ex->next != NULL)
		ex->next->previous = ex;
	front->exchanges = ex;
	front->in_flight++;
	return ex;
}

void srv_exchange_free(struct srv_exchange *ex)
{
	srv_pool_drop(&ex->front->pool, ex);
	srv_body_clear(&ex->body);
	free(ex->reply.body);
	if (ex->reply.fd >= 0)
		close(ex->reply.fd);
	if (ex->previous != NULL)
		ex->previous->next = ex->next;
	else
		ex->front->exchanges = ex->next;
	if (ex->next != NULL)
		ex->next->previous = ex->previous;
	ex->front->in_flight--;
	ex->front->budget.used -= ex->charged;
	ex->front->budget.answers -= ex->charged;
	free(ex->uri);
	free(ex);
}

void srv_exchange_head(struct srv_exchange *ex, const struct srv_head *head)
{
	ex->head_seen = true;
	ex->rate_at = srv_now();
	srv_route_head(ex, head);
}

/* ---- answers ---- */

static void answered(struct srv_exchange *ex)
{
	ex->answered = true;
	ex->answered_at = srv_now();
	ex->answered_bytes = ex->received;
	ex->blocked_since = 0;
	srv_pool_drop(&ex->front->pool, ex);
	srv_body_clear(&ex->body);
	srv_http_resume(ex);
}

void srv_exchange_say(struct srv_exchange *ex, int status, const char *type, const char *text,
		      size_t len)
{
	struct srv_reply *r = &ex->reply;

	r->status = status;
	r->content_type = type;
	r->body = malloc(len > 0 ? len : 1);
	r->len = r->body != NULL ? len : 0;
	if (r->len > 0)
		memcpy(r->body, text, len);
	answered(ex);
}

void srv_exchange_problem(struct srv_exchange *ex, const struct api_problem *p)
{
	struct srv_reply *r = &ex->reply;

	if (ex->answered)
		return;
	r->status = api_problem_status(p->code);
	r->code = p->code;
	r->content_type = "application/problem+json";
	r->body = api_problem_json(p, ex->path, ex->id, &r->len);
	if (r->body == NULL)
		r->len = 0;
	if (r->status == 429 || r->status == 503)
		r->retry_after = srv_pool_retry_after(&ex->front->pool, ex->small);
	if (p->code == API_UNSUPPORTED_MEDIA_TYPE)
		r->accept_post = api_accept_post;
	if (p->code == API_UNSUPPORTED_ENCODING)
		r->accept_encoding = api_accept_encoding;
	answered(ex);
}

static void refuse(struct srv_exchange *ex, enum api_code code, const char *detail)
{
	struct api_problem p;

	(void)api_problem_set(&p, code, "%s", detail);
	srv_exchange_problem(ex, &p);
}

void srv_exchange_result(struct srv_exchange *ex, struct srv_segment *segment, int fd)
{
	enum api_code code = srv_reply_take(ex, segment, fd);

	if (code == API_OK)
		answered(ex);
	else
		refuse(ex, code,
		       code == API_INTERNAL ? "the answer could not be taken over"
					    : "too many answers are waiting for their clients");
}

void srv_exchange_abort(struct srv_exchange *ex)
{
	ex->gone = true;
	srv_pool_drop(&ex->front->pool, ex);
	srv_body_clear(&ex->body);
	srv_http_shut(ex);
	srv_http_resume(ex);
}

/* ---- the body ---- */

static void check_size(struct srv_exchange *ex)
{
	struct api_problem p;

	if (ex->answered || ex->received <= ex->front->config->max_body)
		return;
	(void)api_problem_set(&p, API_BODY_TOO_LARGE, "the body is too large");
	p.limit = ex->front->config->max_body;
	p.actual = ex->received;
	srv_exchange_problem(ex, &p);
}

static void enqueue(struct srv_exchange *ex)
{
	if (srv_pool_enqueue(&ex->front->pool, ex) != 0)
		refuse(ex, API_QUEUE_FULL, "as many requests are waiting as may wait");
	else
		srv_pool_dispatch(&ex->front->pool);
}

/* A body too large for memory: stream it to a worker where it comes fast, else spool it. */
static void outgrown(struct srv_exchange *ex, double now)
{
	bool fast = (double)ex->received >= fast_rate * (now - ex->first_byte);
	bool idle = srv_pool_has_idle(&ex->front->pool);
	bool fits = srv_body_fits(&ex->body);

	/* From a queue on nothing is read until a worker takes it: no memory is needed meanwhile.
	 */
	if ((fast && (ex->body.fd < 0 || idle)) || (!fits && (idle || ex->streams))) {
		ex->small = false;
		enqueue(ex);
	}
}

static void spool(struct srv_exchange *ex, const uint8_t *bytes, size_t len)
{
	if (srv_body_add(&ex->body, bytes, len) == 0)
		return;
	refuse(ex, API_MEMORY_FULL, "too many large bodies are waiting");
}

/* Behind a verdict the rest of the body is swallowed, so that the client lives to read it. */
static bool discards(const struct srv_exchange *ex, double now)
{
	return ex->received - ex->answered_bytes <= discard_bytes &&
	       now - ex->answered_at <= discard_s;
}

static void unblock(struct srv_exchange *ex, double now)
{
	if (ex->blocked_since > 0)
		ex->blocked += now - ex->blocked_since;
	ex->blocked_since = 0;
}

ssize_t srv_exchange_bytes(struct srv_exchange *ex, const uint8_t *bytes, size_t len)
{
	double now = srv_now();
	size_t taken = len, told = ex->intake.told < len ? ex->intake.told : len;

	ex->intake.told = 0;
	if (ex->gone || (ex->answered && !discards(ex, now)))
		return -1;
	if (ex->received == 0)
		ex->first_byte = now;
	unblock(ex, now);
	if (!ex->answered && ex->worker == NULL && !ex->queued &&
	    (ex->body.len + len > SRV_BODY_SMALL || (ex->streams && !srv_body_fits(&ex->body))))
		outgrown(ex, now);
	if (ex->queued)
		return 0;
	if (ex->worker != NULL) {
		taken = told + srv_pool_put(ex, bytes + told, len - told);
		ex->front->unwoken = true;
		if (taken < len)
			ex->blocked_since = now;
	} else if (!ex->answered) {
		spool(ex, bytes, len);
	}
	ex->received += taken;
	ex->last_byte = now;
	check_size(ex);
	if (ex->answered) { /* nobody will make room: the rest is swallowed, too */
		ex->received += len - taken;
		taken = len;
	}
	return (ssize_t)taken;
}

void srv_exchange_end(struct srv_exchange *ex)
{
	ex->body_ended = true;
	if (ex->received == 0)
		ex->last_byte = srv_now();
	if (ex->answered)
		return;
	if (ex->worker != NULL) {
		srv_pool_end(ex);
		return;
	}
	ex->small = ex->body.fd < 0 && !ex->has_content_encoding;
	enqueue(ex);
}

/* ---- time ---- */

/* The library cannot answer in the middle of a body: the words go out under it. */
static void too_slow(struct srv_exchange *ex, const char *detail)
{
	if (!ex->answered)
		refuse(ex, API_TOO_SLOW, detail);
	srv_http_last_words(ex);
	srv_exchange_abort(ex);
}

static void tick_body(struct srv_exchange *ex, double now)
{
	const struct srv_config *config = ex->front->config;
	double window = now - ex->rate_at;
	double rate = window > 0 ? (double)(ex->received - ex->rate_bytes) / window : 0;
	bool crowded = ex->worker != NULL && ex->front->pool.large.first != NULL;

	if (ex->suspended || ex->queued) { /* it waits for us */
		ex->rate_at = now;
		ex->rate_bytes = ex->received;
		return;
	}
	if (ex->half_closed && srv_http_drained(ex)) { /* the rest of the body will never come */
		srv_exchange_abort(ex);
	} else if (crowded && window >= crowded_after_s && rate < crowded_rate) {
		too_slow(ex, "the body comes too slowly while others wait");
	} else if (window >= config->body_timeout) {
		if (rate < least_rate)
			too_slow(ex, "the body comes too slowly");
		ex->rate_at = now;
		ex->rate_bytes = ex->received;
	}
}

static double worked(const struct srv_exchange *ex, double now)
{
	double since = ex->body_ended
			   ? (ex->last_byte > ex->dispatched ? ex->last_byte : ex->dispatched)
			   : ex->blocked_since;

	return ex->blocked + (since > 0 ? now - since : 0);
}

void srv_exchange_tick(struct srv_exchange *ex, double now)
{
	const struct srv_config *config = ex->front->config;

	if (ex->gone)
		return;
	if (ex->sent) {
		if (now - ex->sent_at >
		    config->write_timeout * (1 + (double)ex->reply.len / write_piece))
			srv_exchange_abort(ex);
		return;
	}
	if (srv_pool_in_work(ex) && worked(ex, now) > config->deadline) {
		struct api_problem p;

		(void)api_problem_set(&p, API_TOO_EXPENSIVE,
				      "the file took longer than %g s of work", config->deadline);
		srv_pool_kill(ex);
		srv_exchange_problem(ex, &p);
		return;
	}
	if (ex->head_seen && !ex->body_ended)
		tick_body(ex, now);
}
