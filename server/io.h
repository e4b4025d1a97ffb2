#ifndef SRV_IO_H
#define SRV_IO_H

#include <stddef.h>

/* Write all of ${len} bytes, however often a signal interrupts; 0, or -1 with errno. */
int srv_write_all(int fd, const void *bytes, size_t len);

#endif
