#include "server/reply.h"

#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/clock.h"
#include "server/front_private.h"
#include "server/line.h"

typedef void adder(void *to, const char *name, const char *value);

static void timing(const struct srv_exchange *ex, adder *add, void *to)
{
	char text[200];
	struct srv_line l = SRV_LINE(text);

	if (ex->has_result) {
		srv_line_say(&l, "receive;dur=");
		srv_line_thousandths(&l, 1e3 * (ex->last_byte - ex->began));
		srv_line_say(&l, ", queue;dur=");
		srv_line_thousandths(&l, 1e3 * (ex->dispatched - ex->queued_at));
		srv_line_say(&l, ", decode;dur=");
		srv_line_thousandths(&l, ex->result.decode_ms);
		srv_line_say(&l, ", analyse;dur=");
		srv_line_thousandths(&l, ex->result.analyse_ms);
		srv_line_say(&l, ", ");
	}
	srv_line_say(&l, "total;dur=");
	srv_line_thousandths(&l, 1e3 * (srv_now() - ex->began));
	add(to, "Server-Timing", text);
}

static void cors(const struct srv_exchange *ex, adder *add, void *to)
{
	add(to, "Vary", "Origin");
	if (ex->origin[0] == '\0')
		return;
	add(to, "Access-Control-Allow-Origin", ex->origin);
	if (!ex->reply.preflight) {
		add(to, "Access-Control-Expose-Headers",
		    "X-Request-Id, Server-Timing, Retry-After, Mesh-Origin");
		return;
	}
	add(to, "Access-Control-Allow-Methods", ex->reply.allow);
	add(to, "Access-Control-Allow-Headers",
	    "Authorization, Content-Type, Content-Encoding, X-Request-Id");
	add(to, "Access-Control-Max-Age", "600");
	if (ex->reply.preflight_private)
		add(to, "Access-Control-Allow-Private-Network", "true");
}

void srv_reply_headers(const struct srv_exchange *ex, adder *add, void *to)
{
	const struct srv_reply *r = &ex->reply;
	char number[16];

	if (r->content_type != NULL)
		add(to, "Content-Type", r->content_type);
	add(to, "X-Request-Id", ex->id);
	timing(ex, add, to);
	add(to, "X-Content-Type-Options", "nosniff");
	add(to, "Cache-Control", "no-store");
	cors(ex, add, to);
	if (ex->has_result && ex->result.origin[0] != '\0')
		add(to, "Mesh-Origin", ex->result.origin);
	if (r->allow != NULL)
		add(to, "Allow", r->allow);
	if (r->authenticate != NULL)
		add(to, "WWW-Authenticate", r->authenticate);
	if (r->accept_post != NULL)
		add(to, "Accept-Post", r->accept_post);
	if (r->accept_encoding != NULL)
		add(to, "Accept-Encoding", r->accept_encoding);
	if (r->retry_after > 0) {
		(void)snprintf(number, sizeof number, "%u", r->retry_after);
		add(to, "Retry-After", number);
	}
	if (r->close)
		add(to, "Connection", "close");
}

struct text {
	char bytes[2048];
	size_t len;
};

static void add_line(void *to, const char *name, const char *value)
{
	struct text *t = to;
	size_t left = sizeof t->bytes - t->len;
	int n = snprintf(t->bytes + t->len, left, "%s: %s\r\n", name, value);

	if (n > 0 && (size_t)n < left)
		t->len += (size_t)n;
}

void srv_reply_write(const struct srv_exchange *ex, int sock)
{
	struct text t = {.len = 0};
	char length[24];

	t.len = (size_t)snprintf(t.bytes, sizeof t.bytes, "HTTP/1.1 %d %s\r\n", ex->reply.status,
				 ex->reply.status < 400 ? "OK" : "Problem");
	srv_reply_headers(ex, add_line, &t);
	(void)snprintf(length, sizeof length, "%zu\r\n", ex->reply.len);
	add_line(&t, "Content-Length", length);
	(void)send(sock, t.bytes, t.len, MSG_NOSIGNAL | MSG_DONTWAIT | MSG_MORE);
	(void)send(sock, ex->reply.body, ex->reply.len, MSG_NOSIGNAL | MSG_DONTWAIT);
}

/* ---- what a worker answers ---- */

/* Fit to stand in a header, a log line and a label of the metrics. */
static bool plain(const char *text)
{
	for (; *text != '\0'; text++)
		if (*text < 0x20 || *text > 0x7e || *text == '"' || *text == '\\')
			return false;
	return true;
}

static bool is_time(double ms)
{
	return ms >= 0 && ms < 1e12;
}

/* A sealed file of the length that was said: a pipe would never end. */
static bool sane_file(int fd, uint64_t len)
{
	int seals = fcntl(fd, F_GET_SEALS);

	return seals >= 0 && (seals & SRV_ANSWER_SEALS) == SRV_ANSWER_SEALS && len <= INT64_MAX &&
	       lseek(fd, 0, SEEK_END) == (off_t)len;
}

/* The worker's words are copied once and then judged: it may write while we read. */
static bool sane(struct srv_result *r, int fd)
{
	r->format[sizeof r->format - 1] = '\0';
	r->content_type[sizeof r->content_type - 1] = '\0';
	r->origin[sizeof r->origin - 1] = '\0';
	if (fd < 0 ? r->len > SRV_ANSWER : !sane_file(fd, r->len))
		return false;
	return r->status >= 200 && r->status < 600 && r->code >= 0 && r->code < API_CODES &&
	       r->content_type[0] != '\0' && plain(r->content_type) && plain(r->format) &&
	       plain(r->origin) && is_time(r->decode_ms) && is_time(r->analyse_ms);
}

/*
 * Answers that are no longer than this are on their way at once, and their number is that of the
 * connections, which are counted: they need no room in the budget, so that a few large ones that
 * nobody reads do not stop everybody else.
 */
enum { SMALL_ANSWER = 64 << 10 };

/*
 * An answer takes memory until its client has read it, which may take its time: all of them have
 * half of the budget, so that uploads keep the rest.
 */
static bool afford(struct srv_exchange *ex, uint64_t bytes)
{
	struct srv_budget *b = &ex->front->budget;
	uint64_t left = b->answers < b->most / 2 ? b->most / 2 - b->answers : 0;

	if (bytes <= SMALL_ANSWER)
		return true;
	if (left > srv_budget_left(b))
		left = srv_budget_left(b);
	if (bytes > left && b->answers > 0) /* the only one may be of any size */
		return false;
	b->used += bytes;
	if (b->used > b->highest)
		b->highest = b->used;
	b->answers += bytes;
	ex->charged = bytes;
	return true;
}

/* The bytes of the answer: 0, or -1 where memory is out; then ${fd} is still the caller's. */
static int take_over(struct srv_exchange *ex, const struct srv_segment *segment, int fd)
{
	struct srv_reply *r = &ex->reply;

	r->len = (size_t)ex->result.len;
	r->fd = fd;
	if (fd >= 0)
		return 0;
	r->body = malloc(r->len > 0 ? r->len : 1);
	if (r->body == NULL)
		return -1;
	memcpy(r->body, segment->answer, r->len);
	return 0;
}

enum api_code srv_reply_take(struct srv_exchange *ex, const struct srv_segment *segment, int fd)
{
	enum api_code code = API_OK;

	ex->result = segment->result;
	if (!sane(&ex->result, fd))
		code = API_INTERNAL;
	else if (!afford(ex, ex->result.len) || take_over(ex, segment, fd) != 0)
		code = API_MEMORY_FULL;
	if (code != API_OK) {
		if (fd >= 0)
			close(fd);
		return code;
	}
	ex->reply.status = ex->result.status;
	ex->reply.code = (enum api_code)ex->result.code;
	ex->reply.content_type = ex->result.content_type;
	ex->has_result = true;
	return API_OK;
}
