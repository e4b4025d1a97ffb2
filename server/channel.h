#ifndef SRV_CHANNEL_H
#define SRV_CHANNEL_H

#include <stddef.h>
#include <sys/types.h>

/* Small messages with descriptors over SOCK_SEQPACKET pairs. */

/* A pair of connected sockets, close-on-exec; ${nonblock}: both ends.  0 or -1 with errno. */
int srv_channel_pair(int fd[2], int nonblock);

/* Send ${len} bytes with ${fds} (0 to 4).  0, or -1 with errno (EAGAIN where the peer is behind).
 */
int srv_channel_send(int sock, const void *bytes, size_t len, const int *fd, size_t fds);

/*
 * Receive at most ${size} bytes and ${*fds} descriptors (set to how many came; the rest is
 * closed).  The length, 0 at the end of the peer, -1 with errno.
 */
ssize_t srv_channel_receive(int sock, void *bytes, size_t size, int *fd, size_t *fds);

/* What master and front tell each other. */
enum srv_order_kind {
	SRV_ORDER_WORKER_NEW,  /* master: slot has a worker; descriptors: its socket, its pidfd */
	SRV_ORDER_WORKER_GONE, /* master: the worker of slot is dead and reaped; status as of wait
				*/
	SRV_ORDER_KEYS,        /* master: API keys; descriptor: a memfd of srv_keys_read() */
	SRV_ORDER_DRAIN,       /* master: SIGTERM came */
	SRV_ORDER_READY        /* front: serving */
};

struct srv_order {
	enum srv_order_kind kind;
	unsigned slot;
	pid_t pid;
	int status;
};

#endif
