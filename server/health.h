#ifndef SRV_HEALTH_H
#define SRV_HEALTH_H

#include "server/config.h"

/* Ask /livez of the daemon that serves on the first configured address: 0 alive, 1 not. */
int srv_health_ask(const struct srv_config *config);

#endif
