#ifndef SRV_CONFIG_VALUE_H
#define SRV_CONFIG_VALUE_H

#include <stdint.h>

/*
 * Values with units: sizes take B, kB, MB, GB (powers of ten) and KiB, MiB, GiB, durations ms, s,
 * min, h, counts k and M; a bare number is bytes, seconds or ones.  Fractions are allowed (1.5GiB).
 * 0, or -1 where the text is no such value or is out of range.
 */
int srv_value_size(const char *text, uint64_t *bytes);
int srv_value_duration(const char *text, double *seconds);
int srv_value_count(const char *text, uint64_t *count);

#endif
