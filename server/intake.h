#ifndef SRV_INTAKE_H
#define SRV_INTAKE_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/*
 * Large bodies go from their socket into the ring of their worker, without a stop in between.
 *
 * The library knows no buffer but its own, of some 64 kB, and copying out of that costs a third of
 * what receiving does.  So the recv() that it calls is defined here: for a body that flows to a
 * worker it reads as much as the ring has room for and says "so many as you asked for", now and
 * until all of it has been said.  What the library then hands on is counted, not looked at: the
 * bytes are where they belong.  Of a body's end, of a pause and of everything else the library
 * learns as before; where it is linked in a way that calls another recv(), all bytes go the long
 * way.
 */

struct srv_clients;
struct srv_exchange;

struct srv_intake {
	uint64_t length; /* of the body by its head; 0: not known, or none */
	size_t ahead;    /* bytes in the ring that the library has not heard of */
	size_t told;     /* of which it has heard, but on_request() has not */
	size_t leftover; /* bytes in the library's buffer that had no room in the ring */
};

/* From now on; NULL: no longer. */
void srv_intake_start(struct srv_clients *);

/* What recv() does for the connection of ${ex}. */
ssize_t srv_intake_read(struct srv_exchange *ex, int fd, uint8_t *bytes, size_t len);

#endif
