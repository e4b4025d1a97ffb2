#include "server/http.h"

#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>

#include "server/clients.h"
#include "server/clock.h"
#include "server/front_private.h"
#include "server/reply.h"
#include "server/route.h"

#if MHD_VERSION < 0x00097100
#error "libmicrohttpd 0.9.71 or newer is needed"
#endif

struct srv_http {
	struct srv_front *front;
	struct MHD_Daemon *daemon;
	struct srv_clients clients;
	unsigned long calls; /* of ours by the library, ever */
};

static int descriptor(struct MHD_Connection *connection)
{
	const union MHD_ConnectionInfo *info =
	    MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);

	return info != NULL ? info->connect_fd : -1;
}

/* ---- the head ---- */

static const struct field {
	const char *name;
	size_t value, count; /* offsets in struct srv_head; count 0: not counted */
} fields[] = {
#define VALUE(f) offsetof(struct srv_head, f)
    {"content-length", VALUE(content_length), VALUE(lengths)},
    {"transfer-encoding", VALUE(transfer_encoding), VALUE(transfers)},
    {"host", 0, VALUE(hosts)},
    {"content-type", VALUE(content_type), VALUE(types)},
    {"content-encoding", VALUE(content_encoding), VALUE(encodings)},
    {"expect", VALUE(expect), 0},
    {"origin", VALUE(origin), 0},
    {"authorization", VALUE(authorization), VALUE(authorizations)},
    {"accept", VALUE(accept), 0},
    {"x-request-id", VALUE(request_id), 0},
    {"access-control-request-method", VALUE(preflight_method), 0},
    {"access-control-request-private-network", VALUE(preflight_private), 0},
#undef VALUE
};

static enum MHD_Result read_header(void *cls, enum MHD_ValueKind kind, const char *name,
				   const char *value)
{
	struct srv_head *head = cls;

	(void)kind;
	if (value == NULL)
		value = "";
	if (!srv_guard_field(name, value))
		head->bad_bytes = true;
	for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
		if (strcasecmp(name, fields[i].name) != 0)
			continue;
		if (fields[i].value != 0)
			memcpy((char *)head + fields[i].value, &value, sizeof value);
		if (fields[i].count != 0)
			++*(unsigned *)(void *)((char *)head + fields[i].count);
	}
	return MHD_YES;
}

/* ---- the answer ---- */

static struct MHD_Response *make_response(struct srv_reply *r)
{
	struct MHD_Response *response;

	response = r->fd >= 0
		       ? MHD_create_response_from_fd64(r->len, r->fd)
		       : MHD_create_response_from_buffer(r->len, r->body, MHD_RESPMEM_MUST_FREE);
	if (response != NULL) {
		r->fd = -1;
		r->body = NULL;
	}
	return response;
}

static void add_header(void *to, const char *name, const char *value)
{
	(void)MHD_add_response_header(to, name, value);
}

/*
 * The library reads from a resumed connection before it asks for the answer, so that whoever has
 * closed its side meanwhile counts as gone.  Those with a timeout of their own have their turn
 * before that: resumed ones get one that never strikes, until they are answered.
 */
static void set_timeout(struct srv_exchange *ex, unsigned seconds)
{
	(void)MHD_set_connection_option(ex->connection, MHD_CONNECTION_OPTION_TIMEOUT, seconds);
}

static enum MHD_Result send_answer(struct srv_exchange *ex)
{
	struct MHD_Response *response = make_response(&ex->reply);
	enum MHD_Result queued;

	if (response == NULL)
		return MHD_NO;
	ex->reply.close = ex->reply.close || ex->front->draining;
	srv_reply_headers(ex, add_header, response);
	ex->sent = true;
	ex->sent_at = srv_now();
	set_timeout(ex, 0);
	queued = MHD_queue_response(ex->connection, (unsigned)ex->reply.status, response);
	MHD_destroy_response(response);
	return queued;
}

/* ---- what the library calls ---- */

static void *on_uri(void *cls, const char *uri, struct MHD_Connection *connection)
{
	struct srv_http *h = cls;
	struct srv_client *client = srv_clients_at(&h->clients, descriptor(connection));
	struct srv_exchange *ex = srv_exchange_new(h->front, uri);

	h->calls++;
	if (ex == NULL)
		return NULL;
	ex->connection = connection;
	if (client != NULL) {
		client->exchange = ex;
		ex->half_closed = client->half_closed;
		ex->inside = client->inside;
		(void)snprintf(ex->client, sizeof ex->client, "%s", client->name);
	}
	return ex;
}

static enum MHD_Result suspend(struct srv_exchange *ex)
{
	ex->suspended = true;
	MHD_suspend_connection(ex->connection);
	return MHD_YES;
}

static enum MHD_Result first_call(struct srv_exchange *ex, const char *method, const char *version)
{
	struct srv_head head = {.method = method, .http11 = strcmp(version, "HTTP/1.1") == 0};

	(void)MHD_get_connection_values(ex->connection, MHD_HEADER_KIND, read_header, &head);
	srv_exchange_head(ex, &head);
	/* Who waits for a 100 gets a refusal instead; who does not must be let finish first. */
	if (ex->answered && (ex->distrusted || (ex->expects_body && ex->expects_continue)))
		return send_answer(ex);
	return MHD_YES;
}

static enum MHD_Result on_request(void *cls, struct MHD_Connection *connection, const char *url,
				  const char *method, const char *version, const char *bytes,
				  size_t *len, void **context)
{
	struct srv_exchange *ex = *context;
	struct srv_http *h = cls;

	(void)connection;
	(void)url;
	h->calls++;
	if (ex == NULL || ex->gone || ex->sent) /* sent: past the library */
		return MHD_NO;
	if (!ex->head_seen)
		return first_call(ex, method, version);
	if (*len > 0) {
		ssize_t taken = srv_exchange_bytes(ex, (const uint8_t *)bytes, *len);

		if (taken < 0) {
			srv_http_last_words(ex);
			return MHD_NO;
		}
		*len -= (size_t)taken;
		ex->intake.leftover = *len;
		return *len > 0 ? suspend(ex) : MHD_YES;
	}
	if (!ex->body_ended)
		srv_exchange_end(ex);
	if (ex->gone)
		return MHD_NO;
	return ex->answered ? send_answer(ex) : suspend(ex);
}

static void log_access(const struct srv_exchange *ex)
{
	struct srv_access a = {.id = ex->id,
			       .method = ex->method,
			       .path = ex->path,
			       .client = ex->client,
			       .code =
				   ex->reply.code != API_OK ? api_problem_name(ex->reply.code) : "",
			       .format = ex->has_result ? ex->result.format : "",
			       .status = ex->sent ? ex->reply.status : 0,
			       .received = ex->received,
			       .sent = ex->sent ? ex->reply.len : 0,
			       .seconds = srv_now() - ex->began};
	bool probe = strcmp(ex->path, "/livez") == 0 || strcmp(ex->path, "/readyz") == 0;

	if (!probe || srv_log_wants(SRV_DEBUG))
		srv_log_access(&a);
}

static void finish(struct srv_http *h, struct srv_exchange *ex)
{
	struct srv_client *client = srv_clients_at(&h->clients, descriptor(ex->connection));

	if (client != NULL) {
		client->exchange = NULL;
		client->since = srv_now();
		client->served = true;
	}
	if (ex->head_seen) {
		log_access(ex);
		srv_metrics_count(&h->front->metrics, ex);
	}
	srv_exchange_free(ex);
}

static void on_completed(void *cls, struct MHD_Connection *connection, void **context,
			 enum MHD_RequestTerminationCode why)
{
	(void)connection;
	(void)why;
	if (*context != NULL)
		finish(cls, *context);
	*context = NULL;
}

static void on_connection(void *cls, struct MHD_Connection *connection, void **context,
			  enum MHD_ConnectionNotificationCode what)
{
	struct srv_http *h = cls;
	int fd = descriptor(connection);
	struct srv_client *client = srv_clients_at(&h->clients, fd);

	(void)context;
	if (what != MHD_CONNECTION_NOTIFY_CLOSED)
		return;
	/* some heads that the library refuses by itself, such as 2,000 parameters, end without
	 * on_completed() */
	if (client != NULL && client->exchange != NULL)
		finish(h, client->exchange);
	srv_clients_closed(&h->clients, fd);
}

static void on_error(void *cls, const char *fmt, va_list ap)
{
	char text[300];

	(void)cls;
	(void)vsnprintf(text, sizeof text, fmt, ap);
	text[strcspn(text, "\n")] = '\0';
	srv_log(SRV_DEBUG, "http: %s", text);
}

/* ---- connections ---- */

static bool take(void *self, int fd, const struct sockaddr *from, socklen_t len)
{
	struct srv_http *h = self;

	return MHD_add_connection(h->daemon, fd, from, len) == MHD_YES; /* else it is closed */
}

void srv_http_accept(struct srv_http *h, int listener, bool inside)
{
	srv_clients_accept(&h->clients, listener, inside, take, h);
}

void srv_http_client_event(struct srv_http *h, int fd, uint32_t events)
{
	srv_clients_event(&h->clients, fd, events);
}

void srv_http_resume(struct srv_exchange *ex)
{
	if (!ex->suspended)
		return;
	ex->suspended = false;
	set_timeout(ex, 86400);
#if MHD_VERSION >= 0x01000000
	/* 1.0 ends a connection whose client has closed its side, whatever is still owed to it. */
	if (ex->half_closed && ex->answered && ex->body_ended && !ex->gone)
		srv_http_last_words(ex);
#endif
	MHD_resume_connection(ex->connection);
}

bool srv_http_drained(const struct srv_exchange *ex)
{
	char c;

	return ex->intake.ahead + ex->intake.told == 0 &&
	       recv(descriptor(ex->connection), &c, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

void srv_http_shut(struct srv_exchange *ex)
{
	(void)shutdown(descriptor(ex->connection), SHUT_RDWR);
}

void srv_http_last_words(struct srv_exchange *ex)
{
	if (ex->sent || ex->reply.body == NULL)
		return;
	ex->reply.close = true;
	srv_reply_write(ex, descriptor(ex->connection));
	ex->sent = true;
}

void srv_http_tick(struct srv_http *h, double now, bool drain)
{
	srv_clients_tick(&h->clients, now, drain);
}

/* ---- life ---- */

struct srv_http *srv_http_start(struct srv_front *front)
{
	struct srv_http *h = calloc(1, sizeof *h);

	if (h == NULL)
		return NULL;
	h->front = front;
	if (srv_clients_init(&h->clients, front) == 0)
		h->daemon = MHD_start_daemon(
		    MHD_USE_EPOLL | MHD_USE_NO_LISTEN_SOCKET | MHD_ALLOW_SUSPEND_RESUME |
			MHD_USE_ERROR_LOG,
		    0, NULL, NULL, on_request, h, MHD_OPTION_EXTERNAL_LOGGER, on_error, NULL,
		    MHD_OPTION_URI_LOG_CALLBACK, on_uri, h, MHD_OPTION_NOTIFY_COMPLETED,
		    on_completed, h, MHD_OPTION_NOTIFY_CONNECTION, on_connection, h,
		    MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)SRV_CONNECTION_BYTES,
		    MHD_OPTION_CONNECTION_LIMIT, (unsigned)h->clients.most + SRV_INSIDE_RESERVE,
		    MHD_OPTION_END);
	if (h->daemon == NULL) {
		srv_clients_free(&h->clients);
		free(h);
		return NULL;
	}
	srv_intake_start(&h->clients);
	return h;
}

void srv_http_stop(struct srv_http *h)
{
	/* The library aborts the process when it is stopped with a suspended connection: none may
	 * stay so, and none become so. */
	for (struct srv_exchange *ex = h->front->exchanges; ex != NULL; ex = ex->next)
		srv_exchange_abort(ex);
	for (int i = 0; i < 4; i++)
		(void)MHD_run(h->daemon);
	MHD_stop_daemon(h->daemon);
	srv_intake_start(NULL);
	srv_clients_free(&h->clients);
	free(h);
}

int srv_http_epoll(struct srv_http *h)
{
	const union MHD_DaemonInfo *info = MHD_get_daemon_info(h->daemon, MHD_DAEMON_INFO_EPOLL_FD);

	return info != NULL ? info->epoll_fd : -1;
}

bool srv_http_run(struct srv_http *h)
{
	unsigned long calls = h->calls;

	(void)MHD_run(h->daemon);
	return h->calls != calls;
}

int srv_http_timeout(struct srv_http *h)
{
	MHD_UNSIGNED_LONG_LONG ms;

	if (MHD_get_timeout(h->daemon, &ms) != MHD_YES)
		return -1;
	return ms > 1000 ? 1000 : (int)ms;
}

unsigned srv_http_connections(const struct srv_http *h)
{
	return h->clients.open;
}
