#ifndef SRV_REPLY_H
#define SRV_REPLY_H

#include "server/exchange.h"

/* The headers that go with an answer, one call of ${add} each. */
void srv_reply_headers(const struct srv_exchange *ex,
		       void (*add)(void *to, const char *name, const char *value), void *to);

/* Write the whole answer to a socket: what does not fit into its buffer is lost. */
void srv_reply_write(const struct srv_exchange *ex, int sock);

/*
 * Make the reply of ${ex} from what its worker left in ${segment} and ${fd} (-1: none; owned from
 * here on), and charge it to the budget.  API_OK, API_INTERNAL where it makes no sense, or
 * API_MEMORY_FULL.
 */
enum api_code srv_reply_take(struct srv_exchange *ex, const struct srv_segment *segment, int fd);

#endif
