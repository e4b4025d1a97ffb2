#ifndef SRV_HTTP_H
#define SRV_HTTP_H

#include "server/exchange.h"

/* HTTP by libmicrohttpd: the one place that knows it.  External epoll mode, no thread. */

struct srv_http;
struct srv_front;

/* NULL: could not start. */
struct srv_http *srv_http_start(struct srv_front *);
void srv_http_stop(struct srv_http *);

/* The descriptor to watch for reading. */
int srv_http_epoll(struct srv_http *);

/* A listening socket is readable: take what waits, up to a bounded number.  ${inside}: it is the
 * one for /metrics and the probes. */
void srv_http_accept(struct srv_http *, int listener, bool inside);

/* Do what is ready; false where no request came any further by it. */
bool srv_http_run(struct srv_http *);

/* Milliseconds until srv_http_run() is due without any event; -1: never. */
int srv_http_timeout(struct srv_http *);

/* Something happened to a client's socket: its end, an error. */
void srv_http_client_event(struct srv_http *, int fd, uint32_t events);

void srv_http_resume(struct srv_exchange *); /* nothing where it is not suspended */
/* Has the client closed its side, and nothing of what it sent is left to read? */
bool srv_http_drained(const struct srv_exchange *);

void srv_http_shut(struct srv_exchange *); /* end the connection under it */

/* Send the answer of ${ex} past the library, as far as the socket takes it at once. */
void srv_http_last_words(struct srv_exchange *);

/* Head deadlines; with ${drain} connections without a request are ended. */
void srv_http_tick(struct srv_http *, double now, bool drain);

unsigned srv_http_connections(const struct srv_http *);

#endif
