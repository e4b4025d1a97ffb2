#include "api/job.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/files.h"
#include "api/form.h"
#include "api/media.h"
#include "api/options.h"
#include "api/problem.h"
#include "api/report_extras.h"
#include "api/report_json.h"
#include "api/report_words.h"

struct api_job {
	struct api_job_head head; /* its strings stand behind the struct */
	struct api_options options;
	struct api_problem problem; /* API_OK: no verdict yet */
	struct api_problem held;    /* of what was decoded, while the rest is to be */
	bool encoded;               /* by more than identity */
	struct api_coding *coding;  /* bytes go through this, */
	struct api_form *form;      /* through this (NULL: the body is one file) */
	struct api_files files;     /* and in here */
	double decode_s;
};

/* For the case that not even an error can be put together; never written to. */
static char no_memory[] = "{\"type\":\"urn:masspropd:problem:too_expensive\","
			  "\"title\":\"The file takes too much time or memory\",\"status\":422,"
			  "\"detail\":\"The request needs more memory than one request may use.\","
			  "\"code\":\"too_expensive\",\"retryable\":false}";

static const char problem_type[] = "application/problem+json";
static const char report_type[] = "application/json";
static const char mesh_type[] = "model/stl";

static int too_expensive(struct api_problem *p)
{
	return api_problem_set(p, API_TOO_EXPENSIVE,
			       "The request needs more memory than one request may use.");
}

/* Whether the options fit together, and what is asked for. */
static int check_options(const struct api_job_head *head, const struct api_options *o,
			 struct api_problem *p)
{
	if (head->mesh && o->checks == MP_CHECKS_CLOSED)
		return api_problem_option(p, API_BAD_OPTION, "checks", strlen("checks"),
					  "checks=closed keeps no triangle, so there is no mesh to "
					  "answer.");
	return api_options_check(o, p);
}

/* What the head says; whether the options fit together is known when all of a form's are there. */
static int read_head(const struct api_job_head *head, struct api_options *o,
		     struct api_media *media, struct api_problem *p)
{
	api_options_init(o);
	if (api_media_read(head->content_type, head->content_encoding, media, p))
		return -1;
	if (api_options_query(o, head->query, head->query_len, p))
		return -1;
	return media->form ? 0 : check_options(head, o, p);
}

int api_job_precheck(const struct api_job_head *head, struct api_problem *p)
{
	struct api_options options;
	struct api_media media;
	int rc = read_head(head, &options, &media, p);

	api_options_free(&options);
	return rc;
}

bool api_job_streams(const struct api_job_head *head)
{
	struct api_options options;
	struct api_problem p;
	bool streams;

	api_options_init(&options);
	streams = api_options_query(&options, head->query, head->query_len, &p) == 0 &&
		  options.checks == MP_CHECKS_CLOSED;
	api_options_free(&options);
	return streams;
}

bool api_job_plain(const struct api_job_head *head)
{
	struct api_media media;
	struct api_problem p;

	return api_media_read(head->content_type, head->content_encoding, &media, &p) == 0 &&
	       !media.form && media.coding == API_CODING_IDENTITY;
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

static int pass_on(struct api_job *j, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	if (j->form != NULL)
		return api_form_push(j->form, bytes, len, p);
	return api_files_bytes(&j->files, bytes, len, p);
}

/*
 * Decoded bytes.  What is wrong with them waits until the coding itself was judged, so that a bomb
 * is too large and a damaged stream is damaged, whatever is in them.
 */
static int take_decoded(void *self, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	struct api_job *j = self;

	if (j->held.code != API_OK)
		return 0;
	if (pass_on(j, bytes, len, p) == 0)
		return 0;
	if (!j->encoded || p->code == API_TOO_EXPENSIVE || p->code == API_INTERNAL)
		return -1;
	j->held = *p;
	memset(p, 0, sizeof *p);
	return 0;
}

/* The way of the bytes, by what the head says of them. */
static int set_up(struct api_job *j, const struct api_media *media)
{
	const struct api_sink sink = {take_decoded, j};

	j->files.options = &j->options;
	j->files.several = j->head.several;
	memcpy(j->files.request.key, j->head.key, sizeof j->files.request.key);
	j->files.request.limits.max_triangles = j->head.limits.max_triangles;
	j->files.request.second = j->head.second;
	if (media->form) {
		j->form = api_form_new(media->boundary, &j->options, &j->files);
		if (j->form == NULL)
			return too_expensive(&j->problem);
	}
	j->encoded = media->coding != API_CODING_IDENTITY;
	j->coding = api_coding_new(media->coding, j->head.limits.max_decoded, &sink);
	if (j->coding == NULL)
		return too_expensive(&j->problem);
	return media->form ? 0 : api_files_begin(&j->files, j->head.filename, &j->problem);
}

struct api_job *api_job_new(const struct api_job_head *head)
{
	struct api_job *j = copy_head(head);
	struct api_media media;

	if (j != NULL && read_head(&j->head, &j->options, &media, &j->problem) == 0)
		(void)set_up(j, &media);
	return j;
}

static double now(const struct api_job *j)
{
	return j->head.now != NULL ? j->head.now() : 0;
}

int api_job_push(struct api_job *j, const uint8_t *bytes, size_t len)
{
	double start;
	int rc;

	if (j->problem.code != API_OK)
		return 1;
	start = now(j);
	rc = api_coding_push(j->coding, bytes, len, &j->problem);
	j->decode_s += now(j) - start;
	return rc ? 1 : 0;
}

int api_job_next_file(struct api_job *j, const char *filename)
{
	if (j->problem.code != API_OK)
		return 1;
	return api_files_begin(&j->files, filename, &j->problem) ? 1 : 0;
}

/* The body is over: so is everything that it went through. */
static int finish(struct api_job *j)
{
	struct api_problem *p = &j->problem;

	if (api_coding_finish(j->coding, p))
		return -1;
	if (j->held.code != API_OK) {
		*p = j->held;
		return -1;
	}
	if (j->form != NULL &&
	    (api_form_finish(j->form, p) || check_options(&j->head, &j->options, p)))
		return -1;
	if (api_files_end(&j->files, p))
		return -1;
	if (j->files.count > 1)
		j->options.sent.filenames = j->files.names.text;
	if (j->files.digest)
		j->options.sent.sha256 = j->files.sha256;
	if (j->files.digest && j->files.count > 1)
		j->options.sent.digests = j->files.digests.text;
	return 0;
}

/* What is not needed for the answer; a zstd window may take more than the mesh. */
static void drop_way(struct api_job *j)
{
	api_form_free(j->form);
	api_coding_free(j->coding);
	j->form = NULL;
	j->coding = NULL;
}

/* The sentence of a strict refusal: what is wrong, in the order in which one would mend it. */
static int not_a_solid(struct api_job *j, const struct mp_report *r)
{
	const struct mp_topology *t = &r->topology;
	const char *why = "it encloses no volume";

	if (r->streamed && !t->closed)
		return api_problem_set(&j->problem, API_NOT_A_SOLID,
				       "The mesh is not a solid: it is open, or its winding is not "
				       "consistent; checks=full says where.");
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

static int too_many_facets(struct api_job *j, const struct mp_report *r)
{
	(void)api_problem_option(&j->problem, API_TOO_MANY_TRIANGLES, "include", strlen("include"),
				 "A report lists the facets of at most %d triangles: leave facets "
				 "out of include, or send the mesh in parts.",
				 API_MOST_FACETS);
	j->problem.limit = API_MOST_FACETS;
	j->problem.actual = r->triangles;
	return -1;
}

/* The report as JSON or the mesh as STL, or NULL with the problem set. */
static char *make_report(struct api_job *j, struct api_answer *out)
{
	double start = now(j);
	struct mp_report report;
	char *body = NULL;

	memset(&report, 0, sizeof report);
	if (api_files_report(&j->files, &report, &j->problem))
		return NULL;
	out->format = api_format_word(report.notes.format);
	out->triangles = report.triangles;
	out->timing.analyse = (now(j) - start) * 1e3;
	if (j->options.strict && report.solid == MP_NO) {
		(void)not_a_solid(j, &report);
	} else if (j->head.mesh) {
		body = api_mesh_stl(&report, out->origin, &out->len, &j->problem);
	} else if ((j->options.include & API_INCLUDE_FACETS) != 0 &&
		   report.triangles > API_MOST_FACETS) {
		(void)too_many_facets(j, &report);
	} else {
		body =
		    api_report_json(&report, &j->options, j->files.first, &out->timing, &out->len);
		if (body == NULL)
			(void)too_expensive(&j->problem);
	}
	mp_report_free(&report);
	out->timing.analyse = (now(j) - start) * 1e3;
	return body;
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
	double start = now(j);

	memset(out, 0, sizeof *out);
	out->format = api_format_word(MP_FORMAT_UNKNOWN);
	if (j->problem.code == API_OK)
		(void)finish(j);
	out->bytes = j->coding != NULL ? api_coding_decoded(j->coding) : 0;
	drop_way(j);
	out->timing.receive = receive_ms;
	out->timing.queue = queue_ms;
	out->timing.decode = (j->decode_s + now(j) - start) * 1e3;
	if (j->problem.code == API_OK)
		out->body = make_report(j, out);
	out->retire = mp_analysis_met_foreign_code(j->files.analysis);
	/* whatever the mesh took is back before an error is put together */
	api_files_free(&j->files);
	if (j->problem.code != API_OK) {
		answer_problem(j, out);
		return;
	}
	out->status = 200;
	out->content_type = j->head.mesh ? mesh_type : report_type;
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
	drop_way(j);
	api_files_free(&j->files);
	api_options_free(&j->options);
	free(j);
}
