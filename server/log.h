#ifndef SRV_LOG_H
#define SRV_LOG_H

#include <stdbool.h>
#include <stddef.h>

enum srv_level { SRV_ERROR, SRV_WARN, SRV_INFO, SRV_DEBUG };

/* ${role} ("master", "front", "worker 3") stands in every line; kept by pointer. */
void srv_log_setup(enum srv_level most, bool json, const char *role);
void srv_log_role(const char *role);
bool srv_log_wants(enum srv_level level);

/*
 * One line on standard error.  A write(2) has whole lines and is atomic, so that those of several
 * processes never mix.
 */
void srv_log(enum srv_level level, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

struct srv_access {
	const char *id, *method, *path, *client, *code, *format;
	int status; /* 0: the connection ended before an answer */
	unsigned long long received, sent;
	double seconds;
};

/*
 * The line of one request; user-controlled strings are escaped.  It is held until srv_log_flush(),
 * the next line of srv_log(), or until there are many.
 */
void srv_log_access(const struct srv_access *);
void srv_log_flush(void);

#endif
