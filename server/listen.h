#ifndef SRV_LISTEN_H
#define SRV_LISTEN_H

#include <stddef.h>

/*
 * Open a listening TCP socket (non-blocking, close-on-exec) on ${address}: HOST:PORT,
 * [IPV6]:PORT or :PORT (every interface).  ${url} becomes http://HOST:PORT with the port that was
 * picked.  The descriptor, or -1 with one line in ${why}.
 */
int srv_listen_open(const char *address, char *url, size_t url_size, char *why, size_t size);

/*
 * Connect to where a daemon with that address answers (0.0.0.0 and :: mean loopback), within
 * ${seconds}.  The descriptor (blocking, with send and receive time-outs) or -1.
 */
int srv_listen_connect(const char *address, int seconds);

#endif
