#include "api/problem.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/json_build.h"
#include "api/utf8.h"

struct row {
	int status;
	bool retryable;
	const char *name, *title;
};

static const struct row rows[API_CODES] = {
    [API_OK] = {200, false, "ok", "All is well"},
    [API_BAD_REQUEST] = {400, false, "bad_request", "The request is malformed"},
    [API_BAD_OPTION] = {400, false, "bad_option", "An option has no valid value"},
    [API_UNKNOWN_OPTION] = {400, false, "unknown_option", "There is no such option"},
    [API_OPTION_NOT_SUPPORTED] = {400, false, "option_not_supported",
				  "This version does not have this option yet"},
    [API_BAD_MULTIPART] = {400, false, "bad_multipart", "The form data is malformed"},
    [API_BAD_ENCODING] = {400, false, "bad_encoding", "The content coding is damaged"},
    [API_TYPE_MISMATCH] = {400, false, "type_mismatch", "The bytes are of another format"},
    [API_UNAUTHORIZED] = {401, false, "unauthorized", "An API key is needed"},
    [API_NOT_FOUND] = {404, false, "not_found", "There is nothing here"},
    [API_METHOD_NOT_ALLOWED] = {405, false, "method_not_allowed", "The method does not apply"},
    [API_NOT_ACCEPTABLE] = {406, false, "not_acceptable", "No acceptable representation"},
    [API_TOO_SLOW] = {408, false, "too_slow", "The upload came too slowly"},
    [API_BODY_TOO_LARGE] = {413, false, "body_too_large", "The body is too large"},
    [API_DECODED_TOO_LARGE] = {413, false, "decoded_too_large", "The decoded body is too large"},
    [API_TOO_MANY_TRIANGLES] = {413, false, "too_many_triangles", "Too many triangles"},
    [API_UNSUPPORTED_MEDIA_TYPE] = {415, false, "unsupported_media_type",
				    "The media type is not supported"},
    [API_UNSUPPORTED_ENCODING] = {415, false, "unsupported_encoding",
				  "The content coding is not supported"},
    [API_UNREADABLE] = {422, false, "unreadable", "The file cannot be read"},
    [API_TRUNCATED] = {422, false, "truncated", "The file ends too early"},
    [API_EMPTY] = {422, false, "empty", "The file is empty"},
    [API_NO_FACES] = {422, false, "no_faces", "The file holds no triangles"},
    [API_POINT_CLOUD] = {422, false, "point_cloud", "The file holds points only"},
    [API_BAD_INDEX] = {422, false, "bad_index", "A face names a vertex that does not exist"},
    [API_NON_FINITE] = {422, false, "non_finite", "A coordinate is not a finite number"},
    [API_UNSUPPORTED_FEATURE] = {422, false, "unsupported_feature",
				 "The file uses a feature that is not supported"},
    [API_TRIMMED_SURFACE] = {422, false, "trimmed_surface", "Trimmed surfaces are not supported"},
    [API_NOT_A_SOLID] = {422, false, "not_a_solid", "The mesh is not a solid"},
    [API_TOO_EXPENSIVE] = {422, false, "too_expensive", "The file takes too much time or memory"},
    [API_DECODER_CRASHED] = {422, false, "decoder_crashed", "The file made its decoder crash"},
    [API_QUEUE_FULL] = {429, true, "queue_full", "The queue is full"},
    [API_MEMORY_FULL] = {429, true, "memory_full", "The memory budget is in use"},
    [API_DRAINING] = {503, true, "draining", "The service is shutting down"},
    [API_WORKER_LOST] = {503, true, "worker_lost", "A worker was lost"},
    [API_INTERNAL] = {500, false, "internal", "Internal error"},
};

static const struct row *row_of(enum api_code code)
{
	return &rows[(unsigned)code < API_CODES ? code : API_INTERNAL];
}

int api_problem_status(enum api_code code)
{
	return row_of(code)->status;
}

const char *api_problem_name(enum api_code code)
{
	return row_of(code)->name;
}

const char *api_problem_title(enum api_code code)
{
	return row_of(code)->title;
}

bool api_problem_retryable(enum api_code code)
{
	return row_of(code)->retryable;
}

static void fill(struct api_problem *p, enum api_code code, const char *fmt, va_list ap)
{
	memset(p, 0, sizeof *p);
	p->code = code;
	p->limit = p->actual = p->byte = API_NONE;
	(void)vsnprintf(p->detail, sizeof p->detail, fmt, ap);
}

int api_problem_set(struct api_problem *p, enum api_code code, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	fill(p, code, fmt, ap);
	va_end(ap);
	return -1;
}

int api_problem_option(struct api_problem *p, enum api_code code, const char *option, size_t len,
		       const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	fill(p, code, fmt, ap);
	va_end(ap);
	(void)api_utf8_copy(p->option, sizeof p->option, option, len);
	return -1;
}

static void add_figure(struct api_json *j, const char *name, uint64_t figure, uint64_t none)
{
	if (figure != none)
		api_json_count(j, j->root, name, figure);
}

char *api_problem_json(const struct api_problem *p, const char *instance, const char *request_id,
		       size_t *len)
{
	const struct row *row = row_of(p->code);
	struct api_json j;
	cJSON *root = api_json_begin(&j);
	char type[64];

	snprintf(type, sizeof type, "urn:masspropd:problem:%s", row->name);
	api_json_string(&j, root, "type", type);
	api_json_string(&j, root, "title", row->title);
	api_json_count(&j, root, "status", (uint64_t)row->status);
	api_json_string(&j, root, "detail", p->detail[0] != '\0' ? p->detail : row->title);
	if (instance != NULL)
		api_json_string(&j, root, "instance", instance);
	api_json_string(&j, root, "code", row->name);
	api_json_bool(&j, root, "retryable", row->retryable);
	if (request_id != NULL)
		api_json_string(&j, root, "request_id", request_id);
	if (p->option[0] != '\0')
		api_json_string(&j, root, "option", p->option);
	add_figure(&j, "limit", p->limit, API_NONE);
	add_figure(&j, "actual", p->actual, API_NONE);
	add_figure(&j, "byte", p->byte, API_NONE);
	add_figure(&j, "line", p->line, 0);
	return api_json_finish(&j, len);
}
