#ifndef SRV_METRICS_H
#define SRV_METRICS_H

#include <stddef.h>
#include <stdint.h>

#include "server/exchange.h"

/*
 * What /metrics tells, in the Prometheus text format (version 0.0.4): counters since the front
 * began, gauges of this moment, histograms of the stages of a request in seconds.
 */

enum { SRV_BUCKETS = 14, SRV_FORMATS = 8, SRV_STATUSES = 32 };
enum srv_stage { SRV_RECEIVE, SRV_QUEUE, SRV_DECODE, SRV_ANALYSE, SRV_STAGES };
enum srv_loss {
	SRV_LOST_DEADLINE,
	SRV_LOST_CLIENT,
	SRV_LOST_CRASH,
	SRV_LOST_OUTSIDE,
	SRV_LOST_RETIRED,
	SRV_LOSSES
};

struct srv_histogram {
	uint64_t bucket[SRV_BUCKETS + 1]; /* the last one: above all bounds */
	uint64_t count;
	double sum;
};

struct srv_metrics {
	struct {
		int status;
		char format[SRV_FORMAT_NAME];
		uint64_t count;
	} request[SRV_STATUSES * SRV_FORMATS];
	unsigned requests; /* rows in use */
	uint64_t aborted;  /* connections that ended before an answer */
	uint64_t received, sent, triangles;
	uint64_t lost[SRV_LOSSES];
	struct srv_histogram stage[SRV_STAGES];
};

/* A request is over. */
void srv_metrics_count(struct srv_metrics *, const struct srv_exchange *ex);

/* A worker is replaced. */
void srv_metrics_lost(struct srv_metrics *, enum srv_loss cause);

struct srv_front;

/* The text; heap string of ${*len} bytes, NULL when memory is out. */
char *srv_metrics_text(const struct srv_front *, size_t *len);

#endif
