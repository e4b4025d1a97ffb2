#ifndef SRV_CLIENTS_H
#define SRV_CLIENTS_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

/* The table of connections, by descriptor: accepting, head and idle deadlines, who has left. */

struct srv_front;
struct srv_exchange;

/*
 * The library's memory for each, half of which takes the head.  It is cleared for every request, so
 * that twice as much costs a small one 7 % more time; large bodies go another way (intake.h).
 */
enum { SRV_CONNECTION_BYTES = 64 << 10 };
enum { SRV_INSIDE_RESERVE = 8 }; /* more, for the listener that strangers do not reach */

struct srv_client {
	bool used, served; /* served: it has had an answer before */
	bool half_closed;  /* it will send no more */
	bool inside;       /* came to the listener for /metrics */
	double since;      /* accepted, or its last answer out */
	struct srv_exchange *exchange;
	char name[48]; /* its address */
};

struct srv_clients {
	struct srv_front *front;
	struct srv_client *client;
	int entries, top;  /* all in use are below top */
	int most, reserve; /* reserve: a descriptor to refuse with when none are left */
	unsigned open;
};

/*
 * Sized by RLIMIT_NOFILE, and by the memory: the heads of all connections may take half of what
 * waiting bodies may.  0, or -1.
 */
int srv_clients_init(struct srv_clients *, struct srv_front *);
void srv_clients_free(struct srv_clients *);

/* NULL where ${fd} is out of the table. */
struct srv_client *srv_clients_at(struct srv_clients *, int fd);

/*
 * Take what waits at ${listener}, up to a bounded number, and pass each connection to ${take},
 * which owns the descriptor from then on and returns false where it has closed it.
 */
void srv_clients_accept(struct srv_clients *, int listener, bool inside,
			bool (*take)(void *self, int fd, const struct sockaddr *from,
				     socklen_t len),
			void *self);

/* Something happened to a client's socket (epoll's event bits): its end, an error. */
void srv_clients_event(struct srv_clients *, int fd, uint32_t events);

void srv_clients_closed(struct srv_clients *, int fd);

/* End those that are over their time; with ${drain} all without a request. */
void srv_clients_tick(struct srv_clients *, double now, bool drain);

#endif
