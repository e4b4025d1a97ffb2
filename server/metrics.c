#include "server/metrics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/capabilities.h"
#include "server/front_private.h"
#include "server/http.h"

/* Seconds: a 12-facet part takes tenths of a millisecond, the deadline is 30 s. */
static const double bound[SRV_BUCKETS] = {0.0001, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025,
					  0.1,    0.25,   1,     2.5,    10,    30,   120};

static const char *const stage_name[SRV_STAGES] = {"receive", "queue", "decode", "analyse"};
static const char *const loss_name[SRV_LOSSES] = {"deadline", "client_gone", "crash", "outside",
						  "retired"};

static void observe(struct srv_histogram *h, double seconds)
{
	int i = 0;

	while (i < SRV_BUCKETS && seconds > bound[i])
		i++;
	h->bucket[i]++;
	h->count++;
	h->sum += seconds;
}

/* The row of status and format; rows beyond the table fall into its last one. */
static void count_request(struct srv_metrics *m, int status, const char *format)
{
	const unsigned most = sizeof m->request / sizeof m->request[0];
	unsigned i;

	for (i = 0; i < m->requests; i++)
		if (m->request[i].status == status && strcmp(m->request[i].format, format) == 0)
			break;
	if (i == m->requests) {
		if (i == most)
			i--;
		else
			m->requests++;
		m->request[i].status = status;
		(void)snprintf(m->request[i].format, sizeof m->request[i].format, "%s", format);
	}
	m->request[i].count++;
}

void srv_metrics_count(struct srv_metrics *m, const struct srv_exchange *ex)
{
	m->received += ex->received;
	if (!ex->sent) {
		m->aborted++;
		return;
	}
	m->sent += ex->reply.len;
	if (ex->endpoint != SRV_MASS_PROPERTIES && ex->endpoint != SRV_MESH) {
		count_request(m, ex->reply.status, "");
		return;
	}
	count_request(m, ex->reply.status, ex->has_result ? ex->result.format : "unknown");
	if (!ex->has_result)
		return;
	m->triangles += ex->result.triangles;
	observe(&m->stage[SRV_RECEIVE], ex->last_byte - ex->began);
	observe(&m->stage[SRV_QUEUE], ex->dispatched - ex->queued_at);
	observe(&m->stage[SRV_DECODE], 1e-3 * ex->result.decode_ms);
	observe(&m->stage[SRV_ANALYSE], 1e-3 * ex->result.analyse_ms);
}

void srv_metrics_lost(struct srv_metrics *m, enum srv_loss cause)
{
	m->lost[cause]++;
}

/* ---- the text ---- */

static void head(FILE *f, const char *name, const char *type, const char *help)
{
	(void)fprintf(f, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

static void single(FILE *f, const char *name, const char *type, const char *help, uint64_t value)
{
	head(f, name, type, help);
	(void)fprintf(f, "%s %llu\n", name, (unsigned long long)value);
}

static void histogram(FILE *f, const char *stage, const struct srv_histogram *h)
{
	static const char name[] = "masspropd_stage_seconds";
	unsigned long long sum = 0;

	for (int i = 0; i < SRV_BUCKETS; i++) {
		sum += h->bucket[i];
		(void)fprintf(f, "%s_bucket{stage=\"%s\",le=\"%g\"} %llu\n", name, stage, bound[i],
			      sum);
	}
	(void)fprintf(f, "%s_bucket{stage=\"%s\",le=\"+Inf\"} %llu\n", name, stage,
		      (unsigned long long)h->count);
	(void)fprintf(f, "%s_sum{stage=\"%s\"} %.9g\n", name, stage, h->sum);
	(void)fprintf(f, "%s_count{stage=\"%s\"} %llu\n", name, stage,
		      (unsigned long long)h->count);
}

static void counters(FILE *f, const struct srv_metrics *m)
{
	head(f, "masspropd_requests_total", "counter",
	     "Requests answered, by status and mesh format.");
	for (unsigned i = 0; i < m->requests; i++)
		(void)fprintf(f, "masspropd_requests_total{status=\"%d\",format=\"%s\"} %llu\n",
			      m->request[i].status, m->request[i].format,
			      (unsigned long long)m->request[i].count);
	single(f, "masspropd_requests_aborted_total", "counter",
	       "Requests whose connection ended before an answer.", m->aborted);
	single(f, "masspropd_received_bytes_total", "counter", "Bytes of request bodies.",
	       m->received);
	single(f, "masspropd_sent_bytes_total", "counter", "Bytes of answer bodies.", m->sent);
	single(f, "masspropd_triangles_total", "counter", "Triangles analysed.", m->triangles);
	head(f, "masspropd_workers_replaced_total", "counter", "Workers replaced, by cause.");
	for (int i = 0; i < SRV_LOSSES; i++)
		(void)fprintf(f, "masspropd_workers_replaced_total{cause=\"%s\"} %llu\n",
			      loss_name[i], (unsigned long long)m->lost[i]);
	head(f, "masspropd_stage_seconds", "histogram", "Time of a request by stage.");
	for (int i = 0; i < SRV_STAGES; i++)
		histogram(f, stage_name[i], &m->stage[i]);
}

static void gauges(FILE *f, const struct srv_front *front)
{
	unsigned busy = 0, there = 0;

	for (unsigned i = 0; i < front->pool.workers; i++) {
		busy += front->pool.worker[i].state == SRV_BUSY;
		there += front->pool.worker[i].state != SRV_ABSENT;
	}
	head(f, "masspropd_queue_depth", "gauge", "Requests that wait for a worker, by class.");
	(void)fprintf(f, "masspropd_queue_depth{class=\"small\"} %u\n",
		      srv_pool_waiting(&front->pool, true));
	(void)fprintf(f, "masspropd_queue_depth{class=\"large\"} %u\n",
		      srv_pool_waiting(&front->pool, false));
	single(f, "masspropd_workers", "gauge", "Workers that are there.", there);
	single(f, "masspropd_workers_busy", "gauge", "Workers at work.", busy);
	single(f, "masspropd_requests_in_flight", "gauge", "Requests between head and answer.",
	       front->in_flight);
	single(f, "masspropd_connections", "gauge", "Open client connections.",
	       srv_http_connections(front->http));
	single(f, "masspropd_waiting_body_bytes", "gauge",
	       "Memory of bodies that wait for a worker and of answers that wait for a client.",
	       front->budget.used);
	single(f, "masspropd_ready", "gauge", "1 while /readyz says 200.",
	       !front->draining && there > 0);
	head(f, "masspropd_build_info", "gauge", "The version that runs.");
	(void)fprintf(f, "masspropd_build_info{version=\"%s\"} 1\n", api_version);
}

char *srv_metrics_text(const struct srv_front *front, size_t *len)
{
	char *text = NULL;
	FILE *f = open_memstream(&text, len);

	if (f == NULL)
		return NULL;
	counters(f, &front->metrics);
	gauges(f, front);
	if (fclose(f) != 0) {
		free(text);
		return NULL;
	}
	return text;
}
