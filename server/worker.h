#ifndef SRV_WORKER_H
#define SRV_WORKER_H

#include "server/config.h"
#include "server/desk.h"

enum { SRV_EXIT_RETIRED = 10, SRV_EXIT_NO_MEMORY = 11 };

/*
 * A worker's whole life: take one job after the other from ${desk} until ${sock} ends.  One for
 * ${large} meshes has a second thread for them where there are processors for it.  Never
 * returns; exits 0 when the front is gone, SRV_EXIT_RETIRED behind an answer that said so,
 * SRV_EXIT_NO_MEMORY where there was none left even for that.
 */
_Noreturn void srv_worker_run(const struct srv_config *config, int sock, struct srv_desk *desk,
			      bool large);

#endif
