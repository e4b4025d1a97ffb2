#include "server/clients.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/clock.h"
#include "server/front_private.h"

enum { ACCEPT_BURST = 64, LEAST_CONNECTIONS = 32, MOST_CONNECTIONS = 4096 };

static const double keep_alive_s = 75; /* between two requests of a connection */
static const double fin_grace_s = 1;   /* what a half-closed client sent may still be on its way */

/* How many connections to keep, of ${fds} descriptors. */
static int most_connections(const struct srv_front *front, int fds)
{
	uint64_t fit = front->budget.most / 2 / SRV_CONNECTION_BYTES;
	int most = fit < LEAST_CONNECTIONS  ? LEAST_CONNECTIONS
		   : fit > MOST_CONNECTIONS ? MOST_CONNECTIONS
					    : (int)fit;

	return fds / 2 - 32 < most ? fds / 2 - 32 : most;
}

int srv_clients_init(struct srv_clients *c, struct srv_front *front)
{
	struct rlimit limit;

	memset(c, 0, sizeof *c);
	c->front = front;
	c->reserve = fcntl(front->epoll, F_DUPFD_CLOEXEC, 0);
	if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
		return -1;
	c->entries = limit.rlim_cur > 65536 ? 65536 : (int)limit.rlim_cur;
	c->most = most_connections(front, c->entries);
	if (c->most <= 0) {
		errno = EMFILE;
		return -1;
	}
	c->client = calloc((size_t)c->entries, sizeof *c->client);
	return c->client != NULL ? 0 : -1;
}

void srv_clients_free(struct srv_clients *c)
{
	if (c->reserve >= 0)
		close(c->reserve);
	free(c->client);
}

struct srv_client *srv_clients_at(struct srv_clients *c, int fd)
{
	return fd >= 0 && fd < c->entries ? &c->client[fd] : NULL;
}

static void name_client(const struct sockaddr_storage *from, char *name, socklen_t size)
{
	const void *at = from->ss_family == AF_INET6
			     ? (const void *)&((const struct sockaddr_in6 *)from)->sin6_addr
			     : (const void *)&((const struct sockaddr_in *)from)->sin_addr;

	if (inet_ntop(from->ss_family, at, name, size) == NULL)
		name[0] = '\0';
}

static void turn_away(int fd)
{
	static const char words[] = "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\n"
				    "Retry-After: 1\r\nContent-Length: 0\r\n\r\n";

	(void)send(fd, words, sizeof words - 1, MSG_NOSIGNAL | MSG_DONTWAIT);
	(void)shutdown(fd, SHUT_WR);
	close(fd);
}

/* No descriptor is left: give up the reserve for a moment, so that the client hears of it. */
static void turn_away_blind(struct srv_clients *c, int listener)
{
	int fd;

	if (c->reserve < 0)
		return;
	close(c->reserve);
	fd = accept4(listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
	if (fd >= 0)
		turn_away(fd);
	c->reserve = fcntl(c->front->epoll, F_DUPFD_CLOEXEC, 0);
}

/* False: turned away. */
static bool enter(struct srv_clients *c, int fd, bool inside, const struct sockaddr_storage *from)
{
	struct srv_client *client = srv_clients_at(c, fd);
	int one = 1;

	if (client == NULL || c->open >= (unsigned)c->most + (inside ? SRV_INSIDE_RESERVE : 0)) {
		turn_away(fd);
		return false;
	}
	(void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
	memset(client, 0, sizeof *client);
	client->used = true;
	client->inside = inside;
	client->since = srv_now();
	name_client(from, client->name, sizeof client->name);
	c->open++;
	c->top = fd >= c->top ? fd + 1 : c->top;
	(void)srv_front_watch(c->front, fd, SRV_EV_CLIENT, (unsigned)fd, EPOLLRDHUP | EPOLLET);
	return true;
}

void srv_clients_accept(struct srv_clients *c, int listener, bool inside,
			bool (*take)(void *self, int fd, const struct sockaddr *from,
				     socklen_t len),
			void *self)
{
	for (int i = 0; i < ACCEPT_BURST; i++) {
		struct sockaddr_storage from;
		struct sockaddr *address = (struct sockaddr *)&from;
		socklen_t len = sizeof from;
		int fd = accept4(listener, address, &len, SOCK_CLOEXEC | SOCK_NONBLOCK);

		if (fd >= 0) {
			if (enter(c, fd, inside, &from) && !take(self, fd, address, len))
				srv_clients_closed(c, fd);
		} else if (errno == EMFILE || errno == ENFILE) {
			turn_away_blind(c, listener);
		} else if (errno != EINTR && errno != ECONNABORTED) {
			return;
		}
	}
}

void srv_clients_event(struct srv_clients *c, int fd, uint32_t events)
{
	struct srv_client *client = srv_clients_at(c, fd);

	if (client == NULL || !client->used)
		return;
	client->half_closed = true;
	if (client->exchange == NULL)
		return;
	client->exchange->half_closed = true;
	if ((events & (EPOLLHUP | EPOLLERR)) != 0)
		srv_exchange_abort(client->exchange);
}

void srv_clients_closed(struct srv_clients *c, int fd)
{
	struct srv_client *client = srv_clients_at(c, fd);

	if (client == NULL || !client->used)
		return;
	memset(client, 0, sizeof *client);
	c->open--;
}

void srv_clients_tick(struct srv_clients *c, double now, bool drain)
{
	for (int fd = 0; fd < c->top; fd++) {
		struct srv_client *client = &c->client[fd];
		struct srv_exchange *ex = client->exchange;
		double waited = now - (ex != NULL ? ex->began : client->since);

		if (!client->used || (ex != NULL && ex->head_seen))
			continue;
		if ((drain && ex == NULL) || (client->half_closed && waited > fin_grace_s) ||
		    waited > (ex == NULL && client->served ? keep_alive_s
							   : c->front->config->header_timeout))
			(void)shutdown(fd, SHUT_RDWR);
	}
}
