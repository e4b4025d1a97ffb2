#include "server/reply.h"

#include <stdio.h>

#include "server/clock.h"

typedef void adder(void *to, const char *name, const char *value);

static void timing(const struct srv_exchange *ex, adder *add, void *to)
{
	char text[200];

	if (ex->has_result)
		(void)snprintf(
		    text, sizeof text,
		    "receive;dur=%.3f, queue;dur=%.3f, decode;dur=%.3f, analyse;dur=%.3f, "
		    "total;dur=%.3f",
		    1e3 * (ex->last_byte - ex->began), 1e3 * (ex->dispatched - ex->queued_at),
		    ex->result.decode_ms, ex->result.analyse_ms, 1e3 * (srv_now() - ex->began));
	else
		(void)snprintf(text, sizeof text, "total;dur=%.3f", 1e3 * (srv_now() - ex->began));
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
	if (r->allow != NULL)
		add(to, "Allow", r->allow);
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
