#include "api/job.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/media.h"
#include "api/options.h"
#include "api/problem.h"
#include "api/report_json.h"
#include "api/report_words.h"
#include "core/analysis.h"
#include "core/format.h"

struct api_job {
	struct api_job_head head; /* its strings stand behind the struct */
	struct api_options options;
	struct mp_request request;
	struct mp_analysis *analysis;
	struct api_problem problem; /* API_OK: no verdict yet */
	uint64_t bytes;             /* taken, up to the verdict */
	double decode_s;
	uint8_t start[MP_SNIFF_BYTES]; /* of the file */
};

/* For the case that not even an error can be put together; never written to. */
static char no_memory[] = "{\"type\":\"urn:masspropd:problem:too_expensive\","
			  "\"title\":\"The file takes too much time or memory\",\"status\":422,"
			  "\"detail\":\"The request needs more memory than one request may use.\","
			  "\"code\":\"too_expensive\",\"retryable\":false}";

static const char problem_type[] = "application/problem+json";
static const char report_type[] = "application/json";

static size_t min(size_t a, size_t b)
{
	return a < b ? a : b;
}

static int too_expensive(struct api_problem *p)
{
	return api_problem_set(p, API_TOO_EXPENSIVE,
			       "The request needs more memory than one request may use.");
}

static enum api_code code_of(enum mp_code code)
{
	switch (code) {
	case MP_SYNTAX:
		return API_UNREADABLE;
	case MP_TRUNCATED:
		return API_TRUNCATED;
	case MP_EMPTY:
		return API_EMPTY;
	case MP_NO_FACES:
		return API_NO_FACES;
	case MP_POINT_CLOUD:
		return API_POINT_CLOUD;
	case MP_BAD_INDEX:
		return API_BAD_INDEX;
	case MP_NON_FINITE:
		return API_NON_FINITE;
	case MP_UNSUPPORTED:
		return API_UNSUPPORTED_FEATURE;
	case MP_LIMIT:
		return API_TOO_MANY_TRIANGLES;
	case MP_NOMEM:
		return API_TOO_EXPENSIVE;
	case MP_OK:
	case MP_BUG:
		break;
	}
	return API_INTERNAL;
}

/*
 * A forced format is taken at its word until the file cannot be read: the header of a binary STL
 * may say anything, DRACO too.
 */
static bool is_mismatch(const struct api_job *j, enum mp_code code)
{
	size_t len = j->bytes < sizeof j->start ? (size_t)j->bytes : sizeof j->start;

	return j->options.format == MP_WISH_STL && (code == MP_SYNTAX || code == MP_TRUNCATED) &&
	       mp_format_sniff(j->start, len) != MP_WISH_STL;
}

/* What core said, as the answer's problem. */
static int refuse(struct api_job *j, const struct mp_error *err)
{
	struct api_problem *p = &j->problem;
	enum api_code code = code_of(err->code);

	if (code == API_TOO_EXPENSIVE)
		return too_expensive(p);
	if (is_mismatch(j, err->code))
		return api_problem_option(p, API_TYPE_MISMATCH, "format", strlen("format"),
					  "The option format=stl was given, but this seems to be "
					  "a file of another format.");
	(void)api_problem_set(p, code, "%s: %s.", api_problem_title(code), err->text);
	if (err->byte != MP_NO_BYTE)
		p->byte = err->byte;
	p->line = err->line;
	if (code == API_TOO_MANY_TRIANGLES) {
		p->limit = err->limit;
		p->actual = err->actual;
	}
	return -1;
}

static int read_head(const struct api_job_head *head, struct api_options *o, struct api_problem *p)
{
	api_options_init(o);
	if (api_media_check(head->content_type, head->content_encoding, p))
		return -1;
	if (api_options_query(o, head->query, head->query_len, p))
		return -1;
	return api_options_check(o, p);
}

int api_job_precheck(const struct api_job_head *head, struct api_problem *p)
{
	struct api_options options;

	return read_head(head, &options, p);
}

/* Move one string of the head to ${*room}, which is large enough. */
static void keep(const char **string, size_t len, char **room)
{
	if (*string == NULL)
		return;
	memcpy(*room, *string, len);
	(*room)[len] = '\0';
	*string = *room;
	*room += len + 1;
}

static size_t length(const char *string)
{
	return string != NULL ? strlen(string) : 0;
}

static struct api_job *copy_head(const struct api_job_head *head)
{
	const size_t query_len = head->query != NULL ? head->query_len : 0;
	size_t room = query_len + length(head->content_type) + length(head->content_encoding) +
		      length(head->filename) + length(head->instance) + length(head->request_id) +
		      6;
	struct api_job *j = calloc(1, sizeof *j + room);
	char *p;

	if (j == NULL)
		return NULL;
	j->head = *head;
	p = (char *)(j + 1);
	keep(&j->head.query, query_len, &p);
	keep(&j->head.content_type, length(head->content_type), &p);
	keep(&j->head.content_encoding, length(head->content_encoding), &p);
	keep(&j->head.filename, length(head->filename), &p);
	keep(&j->head.instance, length(head->instance), &p);
	keep(&j->head.request_id, length(head->request_id), &p);
	return j;
}

struct api_job *api_job_new(const struct api_job_head *head)
{
	struct api_job *j = copy_head(head);
	struct mp_error err = {0};

	if (j == NULL || read_head(&j->head, &j->options, &j->problem))
		return j;
	memcpy(j->request.key, head->key, sizeof j->request.key);
	j->request.limits.max_triangles = head->limits.max_triangles;
	api_options_request(&j->options, &j->request);
	j->analysis = mp_analysis_new(&j->request, &err);
	if (j->analysis == NULL)
		(void)refuse(j, &err);
	return j;
}

static double now(const struct api_job *j)
{
	return j->head.now != NULL ? j->head.now() : 0;
}

static int too_large(struct api_job *j, size_t len)
{
	(void)api_problem_set(&j->problem, API_DECODED_TOO_LARGE,
			      "The file is larger than the limit of %" PRIu64 " bytes.",
			      j->head.limits.max_decoded);
	j->problem.limit = j->head.limits.max_decoded;
	j->problem.actual = j->bytes + len; /* so far */
	return 1;
}

int api_job_push(struct api_job *j, const uint8_t *bytes, size_t len)
{
	struct mp_error err = {0};
	double start;
	int rc;

	if (j->problem.code != API_OK)
		return 1;
	if (len > j->head.limits.max_decoded - j->bytes)
		return too_large(j, len);
	if (j->bytes < sizeof j->start)
		memcpy(j->start + j->bytes, bytes, min(len, sizeof j->start - (size_t)j->bytes));
	j->bytes += len;
	start = now(j);
	rc = mp_analysis_push(j->analysis, bytes, len, &err);
	j->decode_s += now(j) - start;
	if (rc)
		(void)refuse(j, &err);
	return rc ? 1 : 0;
}

/* The sentence of a strict refusal: what is wrong, in the order in which one would mend it. */
static int not_a_solid(struct api_job *j, const struct mp_report *r)
{
	const struct mp_topology *t = &r->topology;
	const char *why = "it encloses no volume";

	if (t->boundary_edges > 0)
		return api_problem_set(&j->problem, API_NOT_A_SOLID,
				       "The mesh is not a solid: it is open, with %" PRIu64
				       " boundary edges in %" PRIu64 " places.",
				       t->boundary_edges, t->boundary_loops);
	if (!t->closed)
		return api_problem_set(&j->problem, API_NOT_A_SOLID,
				       "The mesh is not a solid: its winding is not consistent "
				       "(%" PRIu64 " misoriented and %" PRIu64
				       " non-manifold edges).",
				       t->misoriented_edges, t->non_manifold_edges);
	if (r->orientation == MP_ORIENTATION_INWARD)
		why = "it is closed, but wound inside out";
	else if (r->orientation == MP_ORIENTATION_MIXED)
		why = "some of its bodies are wound the wrong way";
	else if (r->overlapping == MP_YES)
		why = "some of its bodies overlap";
	return api_problem_set(&j->problem, API_NOT_A_SOLID, "The mesh is not a solid: %s.", why);
}

/* The report as JSON, or NULL with the problem set. */
static char *make_report(struct api_job *j, struct api_answer *out)
{
	double start = now(j);
	struct mp_report report;
	struct mp_error err = {0};
	char *json = NULL;

	memset(&report, 0, sizeof report);
	if (mp_analysis_report(j->analysis, &j->request, &report, &err)) {
		(void)refuse(j, &err);
		return NULL;
	}
	out->format = api_format_word(report.notes.format);
	out->triangles = report.triangles;
	out->timing.analyse = (now(j) - start) * 1e3;
	if (j->options.strict && report.solid == MP_NO) {
		(void)not_a_solid(j, &report);
	} else {
		json = api_report_json(&report, &j->options, j->head.filename, &out->timing,
				       &out->len);
		if (json == NULL)
			(void)too_expensive(&j->problem);
	}
	mp_report_free(&report);
	out->timing.analyse = (now(j) - start) * 1e3;
	return json;
}

static void answer_problem(struct api_job *j, struct api_answer *out)
{
	out->code = j->problem.code;
	(void)snprintf(out->detail, sizeof out->detail, "%s", j->problem.detail);
	out->content_type = problem_type;
	out->body = api_problem_json(&j->problem, j->head.instance, j->head.request_id, &out->len);
	if (out->body == NULL) {
		out->code = API_TOO_EXPENSIVE;
		out->body = no_memory;
		out->len = sizeof no_memory - 1;
	}
	out->status = api_problem_status(out->code);
}

void api_job_answer(struct api_job *j, double receive_ms, double queue_ms, struct api_answer *out)
{
	struct mp_error err = {0};
	double start = now(j);

	memset(out, 0, sizeof *out);
	out->format = api_format_word(MP_FORMAT_UNKNOWN);
	out->bytes = j->bytes;
	if (j->problem.code == API_OK && mp_analysis_end(j->analysis, &err))
		(void)refuse(j, &err);
	out->timing.receive = receive_ms;
	out->timing.queue = queue_ms;
	out->timing.decode = (j->decode_s + now(j) - start) * 1e3;
	if (j->problem.code == API_OK)
		out->body = make_report(j, out);
	/* whatever the mesh took is back before an error is put together */
	mp_analysis_free(j->analysis);
	j->analysis = NULL;
	if (j->problem.code != API_OK) {
		answer_problem(j, out);
		return;
	}
	out->status = 200;
	out->content_type = report_type;
}

void api_answer_free(struct api_answer *answer)
{
	if (answer->body != no_memory)
		free(answer->body);
	answer->body = NULL;
	answer->len = 0;
}

void api_job_free(struct api_job *j)
{
	if (j == NULL)
		return;
	mp_analysis_free(j->analysis);
	free(j);
}
