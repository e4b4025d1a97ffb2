/* What follows is about the recv() of <sys/socket.h>, not about one that checks sizes. */
#undef _FORTIFY_SOURCE

#include <stdbool.h>

#include "server/intake.h"

#include <errno.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include "server/clients.h"
#include "server/exchange.h"
#include "server/front_private.h"
#include "server/pool.h"

/* The end of a body, which may have the next request behind it, is left to the library. */
enum { LAST = 256 << 10 };

enum { MOST = SRV_RING / 2 }; /* bytes at a time, for others want to be served, too */

static struct srv_clients *clients;

void srv_intake_start(struct srv_clients *c)
{
	clients = c;
}

/*
 * How many bytes may go into the ring now, at least ${len} if any: only behind everything that
 * came before, and in whole pieces.
 */
static size_t wanted(const struct srv_exchange *ex, size_t len, struct iovec room[2])
{
	const struct srv_intake *in = &ex->intake;
	uint64_t known = ex->received + in->told + in->ahead;
	size_t n;

	if (ex->worker == NULL || ex->answered || ex->gone || ex->body_ended || in->leftover > 0 ||
	    known + LAST >= in->length)
		return 0;
	n = srv_pool_room(ex, room);
	if (n > MOST)
		n = MOST;
	if (n > in->length - LAST - known)
		n = (size_t)(in->length - LAST - known);
	return n - n % len;
}

/* Receive up to ${n} bytes into the ring. */
static ssize_t fill(struct srv_exchange *ex, int fd, struct iovec room[2], size_t n)
{
	struct msghdr msg = {.msg_iov = room, .msg_iovlen = 2};
	ssize_t got;

	if (room[0].iov_len >= n) {
		room[0].iov_len = n;
		msg.msg_iovlen = 1;
	} else {
		room[1].iov_len = n - room[0].iov_len;
	}
	got = recvmsg(fd, &msg, 0);
	if (got > 0) {
		srv_pool_filled(ex, (size_t)got);
		ex->intake.ahead += (size_t)got;
	}
	return got;
}

static size_t tell(struct srv_exchange *ex, size_t len)
{
	struct srv_intake *in = &ex->intake;
	size_t n = in->ahead < len ? in->ahead : len;

	in->ahead -= n;
	in->told += n;
	ex->front->unsaid = ex->front->unsaid || in->ahead > 0;
	return n;
}

/*
 * Fewer bytes than the library has asked for tell it to sleep until more come, so they may be said
 * only where the socket has no more at this very moment: in the meantime it may have heard of them.
 */
ssize_t srv_intake_read(struct srv_exchange *ex, int fd, uint8_t *bytes, size_t len)
{
	struct srv_intake *in = &ex->intake;
	struct iovec room[2];
	ssize_t got;
	size_t n;

	if (in->ahead >= len)
		return (ssize_t)tell(ex, len);
	n = wanted(ex, len, room);
	if (n > 0) {
		got = fill(ex, fd, room, n);
		return got > 0 || in->ahead > 0 ? (ssize_t)tell(ex, len) : got;
	}
	n = tell(ex, len);
	got = recvfrom(fd, bytes + n, len - n, 0, NULL, NULL);
	return got > 0 || n == 0 ? (ssize_t)n + got : (ssize_t)n;
}

/* The system's, for all who are not the library reading a body. */
ssize_t recv(int fd, void *bytes, size_t len, int flags)
{
	struct srv_client *client =
	    clients != NULL && flags == 0 ? srv_clients_at(clients, fd) : NULL;

	if (client != NULL && client->used && client->exchange != NULL)
		return srv_intake_read(client->exchange, fd, bytes, len);
	return recvfrom(fd, bytes, len, flags, NULL, NULL);
}
