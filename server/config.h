#ifndef SRV_CONFIG_H
#define SRV_CONFIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/log.h"
#include "server/sandbox.h"

enum { SRV_LISTEN_MAX = 16, SRV_ORIGIN_MAX = 64 };

struct srv_config_text;

/* What flags and environment say; strings live until srv_config_free(). */
struct srv_config {
	struct srv_config_text *texts;
	const char *listen[SRV_LISTEN_MAX];
	unsigned listens;
	const char *origin[SRV_ORIGIN_MAX]; /* exact, "*.suffix" or "*" */
	unsigned origins;
	const char *metrics_listen; /* where /metrics is served alone; NULL: beside the rest */
	const char *api_key_file;   /* NULL: everybody may ask */
	uint64_t workers;
	uint64_t queue; /* requests that wait, per class; 0 = by the number of workers */
	uint64_t max_body, max_decoded, max_triangles; /* bytes, bytes, count */
	uint64_t memory; /* bytes for workers and spool; 0 = found out */
	double header_timeout, body_timeout, deadline, write_timeout; /* seconds */
	double drain_delay, drain_timeout;
	enum srv_sandbox_mode sandbox;
	enum srv_level log_level;
	bool log_json;
	bool help, version, health; /* asked for instead of serving */
};

/*
 * srv_config_load(config, argc, argv, why, size):
 * Defaults, then MASSPROPD_* of the environment, then flags.  An unknown flag or variable of that
 * prefix, a value that is none, one out of its range: -1 with one line in ${why}.
 */
int srv_config_load(struct srv_config *config, int argc, char **argv, char *why, size_t size);

void srv_config_free(struct srv_config *config); /* legal after a failed load too */

/* The text of --help; names every flag, its variable and its default. */
void srv_config_help(void);

#endif
