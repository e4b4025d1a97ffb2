#ifndef SRV_REPLY_H
#define SRV_REPLY_H

#include "server/exchange.h"

/* The headers that go with an answer, one call of ${add} each. */
void srv_reply_headers(const struct srv_exchange *ex,
		       void (*add)(void *to, const char *name, const char *value), void *to);

#endif
