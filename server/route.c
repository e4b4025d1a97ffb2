#include "server/route.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>

#include "api/openapi.h"
#include "server/clock.h"
#include "server/front_private.h"

/* ---- identity ---- */

static bool good_id(const char *s)
{
	size_t len = strlen(s);

	if (len < 1 || len > SRV_ID_MAX)
		return false;
	for (; *s != '\0'; s++)
		if (!isalnum((unsigned char)*s) && strchr("_.-", *s) == NULL)
			return false;
	return true;
}

enum { IDS = 16 };

static void set_id(struct srv_exchange *ex, const char *wish)
{
	static const char hex[] = "0123456789abcdef";
	static uint64_t drawn[IDS][2]; /* one system call for several */
	static unsigned left;
	const uint64_t *r;

	if (wish != NULL && good_id(wish)) {
		(void)snprintf(ex->id, sizeof ex->id, "%s", wish);
		return;
	}
	if (left == 0) {
		(void)!getrandom(drawn, sizeof drawn, GRND_NONBLOCK);
		left = IDS;
	}
	r = drawn[--left];
	for (unsigned i = 0; i < 24; i++)
		ex->id[i] = hex[r[i / 16] >> (i % 16 * 4) & 15];
	ex->id[24] = '\0';
}

/* ---- answers known from the head ---- */

static void refuse(struct srv_exchange *ex, enum api_code code, const char *detail)
{
	struct api_problem p;

	(void)api_problem_set(&p, code, "%s", detail);
	srv_exchange_problem(ex, &p);
}

static void refuse_limit(struct srv_exchange *ex, enum api_code code, const char *detail,
			 uint64_t limit, uint64_t actual)
{
	struct api_problem p;

	(void)api_problem_set(&p, code, "%s", detail);
	p.limit = limit;
	p.actual = actual;
	srv_exchange_problem(ex, &p);
}

static void say_text(struct srv_exchange *ex, int status, const char *text)
{
	srv_exchange_say(ex, status, "text/plain; charset=utf-8", text, strlen(text));
}

static bool verbose(const struct srv_exchange *ex)
{
	return (ex->query_len == 7 || (ex->query_len > 7 && ex->query[7] == '=')) &&
	       memcmp(ex->query, "verbose", 7) == 0;
}

static void readyz(struct srv_exchange *ex)
{
	const struct srv_front *f = ex->front;
	unsigned there = 0;
	char text[400];

	for (unsigned i = 0; i < f->pool.workers; i++)
		there += f->pool.worker[i].state != SRV_ABSENT;
	if (verbose(ex))
		(void)snprintf(text, sizeof text,
			       "%s\nworkers: %u of %u\nqueue: %u small, %u large\nin flight: %u\n"
			       "waiting bodies: %llu of %llu bytes\n",
			       f->draining  ? "draining"
			       : there == 0 ? "starting"
					    : "ready",
			       there, f->pool.workers, srv_pool_waiting(&f->pool, true),
			       srv_pool_waiting(&f->pool, false), f->in_flight,
			       (unsigned long long)f->budget.used,
			       (unsigned long long)f->budget.most);
	else
		(void)snprintf(text, sizeof text, "%s\n",
			       f->draining  ? "draining"
			       : there == 0 ? "starting"
					    : "ready");
	say_text(ex, f->draining || there == 0 ? 503 : 200, text);
	ex->reply.retry_after = f->draining || there == 0;
}

static void metrics(struct srv_exchange *ex)
{
	size_t len = 0;
	char *text = srv_metrics_text(ex->front, &len);

	if (text == NULL)
		refuse(ex, API_MEMORY_FULL, "there is no memory for an answer");
	else
		srv_exchange_say(ex, 200, "text/plain; version=0.0.4; charset=utf-8", text, len);
	free(text);
}

/* ---- POST /v1/mass-properties, POST /v1/mesh ---- */

static void copy_header(const char *value, char *out, bool *has)
{
	*has = value != NULL;
	(void)snprintf(out, SRV_HEADER_MAX, "%s", value != NULL ? value : "");
}

static int words_fit(struct srv_exchange *ex, const struct srv_head *h)
{
	if (ex->query_len > SRV_QUERY_MAX) {
		refuse_limit(ex, API_BAD_REQUEST, "the query is too long", SRV_QUERY_MAX,
			     ex->query_len);
		return -1;
	}
	if ((h->content_type != NULL && strlen(h->content_type) >= SRV_HEADER_MAX) ||
	    (h->content_encoding != NULL && strlen(h->content_encoding) >= SRV_HEADER_MAX)) {
		refuse(ex, API_BAD_REQUEST, "Content-Type or Content-Encoding is too long");
		return -1;
	}
	copy_header(h->content_type, ex->content_type, &ex->has_content_type);
	copy_header(h->content_encoding, ex->content_encoding, &ex->has_content_encoding);
	return 0;
}

/* Can what this endpoint answers be taken? */
static bool acceptable(struct srv_exchange *ex, const struct srv_head *h)
{
	if (ex->endpoint == SRV_MESH ? srv_accept_stl(h->accept) : srv_accept_json(h->accept))
		return true;
	refuse(ex, API_NOT_ACCEPTABLE,
	       ex->endpoint == SRV_MESH ? "only model/stl can be answered"
					: "only application/json can be answered");
	return false;
}

static void take_mesh(struct srv_exchange *ex, const struct srv_head *h, uint64_t length)
{
	struct srv_front *f = ex->front;
	struct api_job_head head = {.limits = {f->config->max_decoded, f->config->max_triangles},
				    .now = srv_now};
	struct api_problem p;

	if (words_fit(ex, h) != 0)
		return;
	if (f->refusing) {
		refuse(ex, API_DRAINING, "the service is being shut down; ask another replica");
		return;
	}
	if (!acceptable(ex, h))
		return;
	head.mesh = ex->endpoint == SRV_MESH;
	if (length != API_NONE && length > f->config->max_body) {
		refuse_limit(ex, API_BODY_TOO_LARGE, "the body is too large", f->config->max_body,
			     length);
		return;
	}
	head.query = ex->query;
	head.query_len = ex->query_len;
	head.content_type = ex->has_content_type ? ex->content_type : NULL;
	head.content_encoding = ex->has_content_encoding ? ex->content_encoding : NULL;
	if (api_job_precheck(&head, &p) != 0) {
		srv_exchange_problem(ex, &p);
		return;
	}
	ex->streams = api_job_streams(&head);
	ex->plain = api_job_plain(&head);
	ex->intake.length = length != API_NONE ? length : 0;
	if (length != API_NONE && !srv_pool_accepts(&f->pool, length <= SRV_BODY_SMALL)) {
		ex->small = length <= SRV_BODY_SMALL;
		refuse(ex, API_QUEUE_FULL, "as many requests are waiting as may wait");
	}
}

/* ---- the table of endpoints ---- */

static const struct route {
	const char *path;
	enum srv_endpoint endpoint;
	bool post; /* POST, otherwise GET and HEAD */
} routes[] = {
    {"/livez", SRV_LIVEZ, false},
    {"/readyz", SRV_READYZ, false},
    {"/metrics", SRV_METRICS, false},
    {"/openapi.json", SRV_OPENAPI, false},
    {"/v1/capabilities", SRV_CAPABILITIES, false},
    {"/v1/mass-properties", SRV_MASS_PROPERTIES, true},
    {"/v1/mesh", SRV_MESH, true},
};

static const struct route *find(const char *path)
{
	for (size_t i = 0; i < sizeof routes / sizeof routes[0]; i++)
		if (strcmp(routes[i].path, path) == 0)
			return &routes[i];
	return NULL;
}

static const char *allow(const struct route *r)
{
	return r->post ? "POST, OPTIONS" : "GET, HEAD, OPTIONS";
}

static void options(struct srv_exchange *ex, const struct srv_head *h, const struct route *r)
{
	srv_exchange_say(ex, 204, NULL, "", 0);
	ex->reply.allow = r != NULL ? allow(r) : "GET, HEAD, POST, OPTIONS";
	ex->reply.preflight = ex->origin[0] != '\0' && h->preflight_method != NULL;
	ex->reply.preflight_private = ex->reply.preflight && h->preflight_private != NULL;
}

/* Probes answer everybody, and so does the listener that is kept for those who look after us. */
static bool may_ask(const struct srv_exchange *ex, const struct srv_head *h, const struct route *r)
{
	const struct srv_keys *keys = &ex->front->keys;

	return !keys->in_force || ex->inside ||
	       (r != NULL && (r->endpoint == SRV_LIVEZ || r->endpoint == SRV_READYZ)) ||
	       (h->authorizations == 1 && srv_keys_fit(keys, h->authorization));
}

static void ask_for_key(struct srv_exchange *ex, const struct srv_head *h)
{
	refuse(ex, API_UNAUTHORIZED,
	       h->authorizations == 0
		   ? "send one of the service's API keys: Authorization: Bearer KEY"
	       : h->authorizations > 1 ? "more than one Authorization header came"
				       : "no API key in force fits the one that came");
	ex->reply.authenticate = h->authorizations == 0
				     ? "Bearer realm=\"masspropd\""
				     : "Bearer realm=\"masspropd\", error=\"invalid_token\"";
}

/* With a listener of its own /metrics is there alone, and little else is. */
static const struct route *find_at(const struct srv_exchange *ex)
{
	const struct route *r = find(ex->path);

	if (r != NULL && r->endpoint == SRV_METRICS && ex->front->gift->metrics_apart &&
	    !ex->inside)
		return NULL;
	if (r != NULL && ex->inside && r->endpoint != SRV_METRICS && r->endpoint != SRV_LIVEZ &&
	    r->endpoint != SRV_READYZ)
		return NULL;
	return r;
}

static void dispatch(struct srv_exchange *ex, const struct srv_head *h, uint64_t length)
{
	const struct route *r = find_at(ex);
	bool get = strcmp(ex->method, "GET") == 0 || strcmp(ex->method, "HEAD") == 0;
	bool post = strcmp(ex->method, "POST") == 0;

	if (strcmp(ex->method, "OPTIONS") == 0 && (r != NULL || strcmp(ex->path, "*") == 0)) {
		options(ex, h, r);
	} else if (!may_ask(ex, h, r)) {
		ask_for_key(ex, h);
	} else if (r == NULL) {
		refuse(ex, API_NOT_FOUND, "there is nothing at this path");
	} else if (r->post ? !post : !get) {
		refuse(ex, API_METHOD_NOT_ALLOWED, r->post ? "use POST here" : "use GET here");
		ex->reply.allow = allow(r);
	} else if (r->endpoint == SRV_LIVEZ) {
		say_text(ex, 200, "alive\n");
	} else if (r->endpoint == SRV_READYZ) {
		readyz(ex);
	} else if (r->endpoint == SRV_METRICS) {
		metrics(ex);
	} else if (r->endpoint == SRV_OPENAPI) {
		srv_exchange_say(ex, 200, "application/json", api_openapi, api_openapi_len);
	} else if (r->endpoint == SRV_CAPABILITIES) {
		srv_exchange_say(ex, 200, "application/json", ex->front->capabilities,
				 ex->front->capabilities_len);
	} else {
		ex->endpoint = r->endpoint;
		take_mesh(ex, h, length);
	}
}

void srv_route_head(struct srv_exchange *ex, const struct srv_head *h)
{
	const char *wrong;
	uint64_t length;

	set_id(ex, h->request_id);
	(void)snprintf(ex->method, sizeof ex->method, "%s", h->method);
	if (h->origin != NULL && strlen(h->origin) < sizeof ex->origin &&
	    srv_cors_allows(ex->front->config, h->origin))
		(void)snprintf(ex->origin, sizeof ex->origin, "%s", h->origin);
	wrong = srv_guard_judge(h, &length);
	ex->expects_body = h->transfers > 0 || (length != API_NONE && length > 0);
	ex->expects_continue = h->expect != NULL && strcasecmp(h->expect, "100-continue") == 0;
	if (wrong != NULL) {
		refuse(ex, API_BAD_REQUEST, wrong);
		ex->reply.close = true;
		ex->distrusted = true;
		return;
	}
	dispatch(ex, h, length);
	if (ex->front->draining)
		ex->reply.close = true;
}
