#ifndef SRV_CLOCK_H
#define SRV_CLOCK_H

/* Seconds of the monotonic clock. */
double srv_now(void);

#endif
