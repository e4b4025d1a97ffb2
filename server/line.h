#ifndef SRV_LINE_H
#define SRV_LINE_H

#include <stddef.h>
#include <stdint.h>

/*
 * A short text that is put together piece by piece: header values and lines of the log, of which
 * every request needs some (snprintf() took as long for them as for all else the front does with a
 * small one).  What does not fit is cut off.  Zeroed but for its size it is empty.
 */
struct srv_line {
	char *text; /* size bytes, ended by a NUL */
	size_t len, size;
};

/* The line that is to stand in an array. */
#define SRV_LINE(array) ((struct srv_line){(array), 0, sizeof(array)})

void srv_line_say(struct srv_line *, const char *text);
void srv_line_count(struct srv_line *, uint64_t n);

/* With leading zeros to ${digits}, at most 20. */
void srv_line_digits(struct srv_line *, uint64_t n, unsigned digits);

/* With three decimals, as %.3f; less than 0 and what is no number are 0.000. */
void srv_line_thousandths(struct srv_line *, double x);

#endif
