#ifndef API_JOB_H
#define API_JOB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "api/mesh_stl.h"
#include "api/problem.h"
#include "core/second.h"

/*
 * One request for mass properties, from its words and bytes to its answer: content coding,
 * multipart, decoding, analysis, JSON.  Used by the service's workers and by the command line.
 * No clocks, no sockets: the caller gives a clock and sends the answer on.
 */
struct api_job_limits {
	uint64_t max_decoded; /* bytes after content decoding */
	uint64_t max_triangles;
};

struct api_job_head {
	const char *query; /* raw, NULL for none */
	size_t query_len;
	const char *content_type;     /* header value, NULL for none */
	const char *content_encoding; /* header value, NULL for none */
	const char *filename;         /* for the report, NULL for none (a raw body) */
	bool mesh;                    /* the answer is the mesh as analysed, not the report */
	bool several;                 /* api_job_next_file() may follow */
	const char *instance;         /* path, for problems */
	const char *request_id;       /* for problems */
	uint8_t key[16];              /* secret, fresh random bytes */
	struct api_job_limits limits;
	const struct mp_second *second; /* as in struct mp_request, until api_job_free() */
	double (*now)(void);            /* monotonic seconds */
};

struct api_timing { /* milliseconds */
	double receive, queue, decode, analyse;
};

struct api_answer {
	int status; /* HTTP */
	enum api_code code;
	char detail[API_DETAIL]; /* of a problem, "" for a report */
	const char *content_type;
	char *body; /* heap */
	size_t len;
	char origin[API_MESH_ORIGIN]; /* of a mesh, "" for anything else */
	const char *format;           /* "stl-binary", ..., "unknown": for logs and metrics */
	uint64_t triangles, bytes;    /* decoded */
	struct api_timing timing;
	bool retire; /* the process may be damaged where nothing shows it: let it serve nobody else
		      */
};

struct api_job;

/*
 * Verdict from the head alone, for an early refusal: options, media type, content coding.
 * 0, or -1 with ${p}.  The same checks run again inside the job.
 */
int api_job_precheck(const struct api_job_head *, struct api_problem *p);

/*
 * Whether the query asks for work in constant memory (checks=closed), so that a body need not be
 * kept anywhere.  What a form's fields ask for shows only later.  Of a head that has been checked.
 */
bool api_job_streams(const struct api_job_head *);

/* Whether the body is one file as it is: neither encoded nor a form. Of a checked head. */
bool api_job_plain(const struct api_job_head *);

/* Strings of ${head} are copied.  NULL: memory is out. */
struct api_job *api_job_new(const struct api_job_head *head);

/*
 * Take body bytes.  Returns 0: go on; 1: the verdict is known, further bytes change nothing.  A
 * compressed body is judged from the outside in: all of it is decoded, up to the limit, before
 * anything is said of what is in it.
 */
int api_job_push(struct api_job *, const uint8_t *bytes, size_t len);

/*
 * The file in work is over and another one follows, which belongs to the same solid; for bodies
 * that are no form, and where the head said so.  ${filename} may be NULL.  Returns as
 * api_job_push().
 */
int api_job_next_file(struct api_job *, const char *filename);

/*
 * The body is over (or the verdict is known): make the answer.  ${receive_ms}, ${queue_ms} are
 * for the report's timing.  Never fails: where memory is out the answer is a static problem with
 * body != NULL all the same (api_answer_free knows).
 */
void api_job_answer(struct api_job *, double receive_ms, double queue_ms, struct api_answer *out);

void api_answer_free(struct api_answer *);
void api_job_free(struct api_job *);

/* Media types and codings for Accept-Post and Accept-Encoding. */
extern const char api_accept_post[];
extern const char api_accept_encoding[];

#endif
