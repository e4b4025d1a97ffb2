#ifndef SRV_FRONT_PRIVATE_H
#define SRV_FRONT_PRIVATE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/body.h"
#include "server/config.h"
#include "server/front.h"
#include "server/keys.h"
#include "server/metrics.h"
#include "server/pool.h"

struct srv_http;

/* The one process that meets clients: one thread, one epoll set. */
struct srv_front {
	const struct srv_front_gift *gift;
	const struct srv_config *config;
	int epoll;
	struct srv_http *http;
	struct srv_pool pool;
	struct srv_budget budget;
	struct srv_keys keys;
	struct srv_metrics metrics;
	struct srv_exchange *exchanges; /* all in flight */
	unsigned in_flight;
	bool draining; /* /readyz says 503 */
	bool refusing; /* no new work is taken */
	double drain_began;
	bool stop;
	bool unwoken; /* some worker may sleep over bytes of its body */
	bool unsaid;  /* some ring has bytes that the library has not heard of */
	unsigned unwoken_rounds;
	unsigned fruitless; /* rounds in a row without an event or a step of a request */
	char *capabilities;
	size_t capabilities_len;
};

/* What an epoll event belongs to: the kind in the upper half of its 64 bits. */
enum srv_event { SRV_EV_LISTENER, SRV_EV_MASTER, SRV_EV_HTTP, SRV_EV_WORKER, SRV_EV_CLIENT };

int srv_front_watch(struct srv_front *, int fd, enum srv_event kind, unsigned index,
		    uint32_t events);

#endif
