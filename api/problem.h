#ifndef API_PROBLEM_H
#define API_PROBLEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Every error the service answers (RFC 9457); the table in problem.c is the only one. */
enum api_code {
	API_OK = 0,
	API_BAD_REQUEST,
	API_BAD_OPTION,
	API_UNKNOWN_OPTION,
	API_OPTION_NOT_SUPPORTED,
	API_BAD_MULTIPART,
	API_BAD_ENCODING,
	API_TYPE_MISMATCH,
	API_UNAUTHORIZED,
	API_NOT_FOUND,
	API_METHOD_NOT_ALLOWED,
	API_NOT_ACCEPTABLE,
	API_TOO_SLOW,
	API_BODY_TOO_LARGE,
	API_DECODED_TOO_LARGE,
	API_TOO_MANY_TRIANGLES,
	API_UNSUPPORTED_MEDIA_TYPE,
	API_UNSUPPORTED_ENCODING,
	API_UNREADABLE,
	API_TRUNCATED,
	API_EMPTY,
	API_NO_FACES,
	API_POINT_CLOUD,
	API_BAD_INDEX,
	API_NON_FINITE,
	API_UNSUPPORTED_FEATURE,
	API_TRIMMED_SURFACE,
	API_NOT_A_SOLID,
	API_TOO_EXPENSIVE,
	API_DECODER_CRASHED,
	API_QUEUE_FULL,
	API_MEMORY_FULL,
	API_DRAINING,
	API_WORKER_LOST,
	API_INTERNAL,
	API_CODES
};

#define API_NONE UINT64_MAX

enum { API_DETAIL = 512 };

struct api_problem {
	enum api_code code;
	char detail[API_DETAIL];      /* one sentence, clean UTF-8 (a file name may be in it) */
	char option[64];              /* the option to blame, "" for none; UTF-8 after sanitising */
	uint64_t limit, actual, byte; /* API_NONE where they do not apply */
	uint64_t line;                /* 0 where it does not apply */
};

/* Fill ${p} (everything that does not apply is cleared); always returns -1. */
int api_problem_set(struct api_problem *p, enum api_code code, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));
int api_problem_option(struct api_problem *p, enum api_code code, const char *option, size_t len,
		       const char *fmt, ...) __attribute__((format(printf, 5, 6)));

int api_problem_status(enum api_code code);        /* HTTP status */
const char *api_problem_name(enum api_code code);  /* "queue_full" */
const char *api_problem_title(enum api_code code); /* "The queue is full" */

/*
 * Would the same request have a chance later?  Only where the cause lies with us (429, 503).  Not
 * 408: the same line would be as slow again, and a whole upload would be spent on finding out.
 */
bool api_problem_retryable(enum api_code code);

/*
 * The application/problem+json text; ${instance} is the request's path, ${request_id} its id
 * (NULL: left out).  "type" is urn:masspropd:problem:CODE, stable, not to be fetched.
 * Heap string of ${*len} bytes (NUL behind it), or NULL when memory is out.
 */
char *api_problem_json(const struct api_problem *p, const char *instance, const char *request_id,
		       size_t *len);

#endif
