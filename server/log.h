#ifndef SRV_LOG_H
#define SRV_LOG_H

#include <stdbool.h>
#include <stddef.h>

enum srv_level { SRV_ERROR, SRV_WARN, SRV_INFO, SRV_DEBUG };

/* ${role} ("master", "front", "worker 3") stands in every line; kept by pointer. */
void srv_log_setup(enum srv_level most, bool json, const char *role);
void srv_log_role(const char *role);
bool srv_log_wants(enum srv_level level);

/* One line on standard error, one write(2), so that lines of several processes never mix. */
void srv_log(enum srv_level level, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

struct srv_access {
	const char *id, *method, *path, *client, *code, *format;
	int status; /* 0: the connection ended before an answer */
	unsigned long long received, sent;
	double seconds;
};

/* The line of one request; user-controlled strings are escaped. */
void srv_log_access(const struct srv_access *);

#endif
