#ifndef SRV_EXCHANGE_H
#define SRV_EXCHANGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "api/problem.h"
#include "server/body.h"
#include "server/intake.h"
#include "server/segment.h"

/* One request from its head to the end of its answer.  No HTTP library here: http.c calls this. */

struct srv_front;
struct srv_worker;

struct srv_head { /* header values live as long as the call that passes them */
	const char *method, *content_length, *transfer_encoding, *content_type, *content_encoding;
	const char *expect, *origin, *accept, *request_id, *authorization;
	const char *preflight_method, *preflight_private;
	/* how many of each came */
	unsigned lengths, transfers, hosts, types, encodings, authorizations;
	bool bad_bytes; /* control bytes in a name or value */
	bool http11;
};

struct srv_reply {
	int status;
	enum api_code code;
	const char *content_type; /* static, or result.content_type */
	char *body;               /* heap, owned; NULL with len 0 or where fd is used */
	size_t len;
	int fd;            /* -1, or where the body lies (owned until handed to the library) */
	const char *allow; /* 405, OPTIONS */
	const char *accept_post, *accept_encoding;
	const char *authenticate; /* 401: how */
	unsigned retry_after;     /* seconds, 0: none */
	bool preflight, preflight_private;
	bool close; /* the connection cannot be used any further */
};

enum srv_endpoint {
	SRV_NOWHERE,
	SRV_LIVEZ,
	SRV_READYZ,
	SRV_METRICS,
	SRV_OPENAPI,
	SRV_CAPABILITIES,
	SRV_MASS_PROPERTIES,
	SRV_MESH
};

struct srv_exchange {
	struct srv_exchange *previous, *next; /* all of the front's */
	struct srv_exchange *behind;          /* next in its queue */
	struct srv_front *front;
	void *connection; /* http.c's */
	char *uri;        /* raw, as on the request line: owned */
	const char *path; /* into uri, ended */
	const char *query;
	size_t query_len;
	char method[12], id[SRV_ID_MAX + 1], client[48];
	char origin[256]; /* allowed origin, "" for none */
	enum srv_endpoint endpoint;
	bool head_seen, expects_body, expects_continue;
	bool inside;     /* from the listener for /metrics and the probes */
	bool streams;    /* its worker keeps nothing of it, so a body larger than memory may come */
	bool distrusted; /* nobody knows where its body ends: it is not read */

	struct srv_body body;
	struct srv_intake intake;
	char content_type[SRV_HEADER_MAX], content_encoding[SRV_HEADER_MAX];
	bool has_content_type, has_content_encoding;
	uint64_t received;       /* body bytes so far */
	uint64_t answered_bytes; /* received when the verdict fell: what comes later is discarded */
	bool body_ended, suspended, queued, small, answered, sent, gone, half_closed;
	struct srv_worker *worker;
	struct srv_segment *segment; /* of its job, while it has a worker */
	bool plain;                  /* neither encoded nor a form: the body is a file as it is */
	bool put_back; /* its worker was dead when it came, and it may have one other */

	double began, first_byte, last_byte, queued_at, dispatched, answered_at, sent_at;
	double blocked,
	    blocked_since;   /* time the sender waited for the worker; since 0: it does not */
	double rate_at;      /* when the window of the minimum rate began */
	uint64_t rate_bytes; /* received at that time */

	struct srv_reply reply;
	uint64_t charged;         /* to the budget, for the answer */
	struct srv_result result; /* of the worker, where has_result */
	bool has_result;
};

/* The beginning of ${uri} is copied. NULL: out of memory. */
struct srv_exchange *srv_exchange_new(struct srv_front *, const char *uri);

/* The head is there: decide what can be decided.  answered is set where a verdict is known. */
void srv_exchange_head(struct srv_exchange *, const struct srv_head *head);

/*
 * Body bytes, the first intake.told of which are in the ring already: returns how many were taken
 * (less than ${len}: suspended is wanted until srv_http_resume() is called), or -1 where the
 * connection must be closed.
 */
ssize_t srv_exchange_bytes(struct srv_exchange *, const uint8_t *bytes, size_t len);

/* The body is complete.  Unless answered, a later srv_http_resume() brings the answer. */
void srv_exchange_end(struct srv_exchange *);

/* The connection ended or the answer is out: give everything back.  Frees ${ex}. */
void srv_exchange_free(struct srv_exchange *);

/* Answer with ${len} bytes of ${text} (copied) / with a problem / with what the worker found;
 * resumes the connection if need be. */
void srv_exchange_say(struct srv_exchange *, int status, const char *type, const char *text,
		      size_t len);
void srv_exchange_problem(struct srv_exchange *, const struct api_problem *problem);
void srv_exchange_result(struct srv_exchange *, struct srv_segment *segment, int fd);

/* The client cannot be answered any more: drop the work, close the connection. */
void srv_exchange_abort(struct srv_exchange *);

/* Called several times a second: deadlines of body, work and writing. */
void srv_exchange_tick(struct srv_exchange *, double now);

#endif
