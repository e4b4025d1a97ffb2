#ifndef SRV_BODY_H
#define SRV_BODY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * A body that has no worker yet: in memory while it is small, then in an anonymous file, which
 * the worker gets as a descriptor.  Every byte is charged to the budget of all waiting bodies and
 * of the answers that wait for their clients.
 */
enum { SRV_BODY_SMALL = 256 << 10 }; /* bytes; not more than a ring takes */

struct srv_budget {
	uint64_t most, used; /* one large answer may go beyond most */
	uint64_t answers;    /* of used */
	uint64_t highest;    /* of used, since the front last gave memory back */
};

uint64_t srv_budget_left(const struct srv_budget *);

struct srv_body {
	struct srv_budget *budget;
	uint8_t *bytes; /* the whole body while fd < 0 */
	size_t len, size;
	int fd;           /* -1, or the file that holds all of it */
	uint64_t spooled; /* bytes in the file */
	uint64_t charged;
};

void srv_body_init(struct srv_body *, struct srv_budget *budget);

/* Append; 0, or -1 where the budget or the system's memory is used up. */
int srv_body_add(struct srv_body *, const uint8_t *bytes, size_t len);

/* Would another large piece find room in the budget? */
bool srv_body_fits(const struct srv_body *);

void srv_body_clear(struct srv_body *); /* gives everything back; may be called again */

#endif
