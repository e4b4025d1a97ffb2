#ifndef SRV_MASTER_H
#define SRV_MASTER_H

#include "server/config.h"

/*
 * Serve: open the sockets, fork the front and the workers, replace what dies, until SIGTERM or
 * SIGINT.  Returns the exit status: 0 after a drain, 1 where serving could not begin.
 */
int srv_master_run(const struct srv_config *config);

#endif
