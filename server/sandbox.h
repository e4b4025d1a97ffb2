#ifndef SRV_SANDBOX_H
#define SRV_SANDBOX_H

#include <stddef.h>

/*
 * What a process may still ask of the kernel once it has met strangers' bytes: a seccomp list
 * (libseccomp) and an empty Landlock rule set, where the kernel has them.
 */
enum srv_sandbox_mode { SRV_SANDBOX_AUTO, SRV_SANDBOX_REQUIRE, SRV_SANDBOX_OFF };
enum srv_sandbox_role { SRV_SANDBOX_WORKER, SRV_SANDBOX_FRONT };

/*
 * Shut the door behind this process, for good.  A worker keeps memory, its descriptors and time:
 * open and everything unlisted answer EPERM; exec, fork, socket and ptrace end it with SIGSYS.
 * The front keeps its sockets besides.  Returns 0; or -1 where something is missing, which
 * ${why} then names (what was there is in force all the same).
 */
int srv_sandbox_enter(enum srv_sandbox_role role, char *why, size_t size);

/*
 * The same as the mode wants it: nothing for off and in sanitizer builds, whose runtime makes calls
 * that no list has; -1 only where it is required and something is missing.  ${why} is "" or says
 * what is missing.
 */
int srv_sandbox_obey(enum srv_sandbox_mode mode, enum srv_sandbox_role role, char *why,
		     size_t size);

#endif
