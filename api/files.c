#include "api/files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/named.h"
#include "api/utf8.h"

enum { SHOWN = 128 }; /* bytes of a name in a sentence */

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
	case MP_BAD_NAME:
	case MP_BAD_MAP:
	case MP_BAD_CHECKS:
		return API_BAD_OPTION;
	case MP_OK:
	case MP_BUG:
		break;
	}
	return API_INTERNAL;
}

/* What the bytes of the file in work look like. */
static enum mp_format_wish looks_like(const struct api_files *f)
{
	size_t len = f->bytes < sizeof f->start ? (size_t)f->bytes : sizeof f->start;

	return mp_format_sniff(f->start, len);
}

/*
 * A forced format is taken at its word until the file cannot be read: the header of a binary STL
 * may say anything, DRACO too.
 */
static bool is_mismatch(const struct api_files *f, enum mp_code code)
{
	return f->request.format == MP_WISH_STL && (code == MP_SYNTAX || code == MP_TRUNCATED) &&
	       looks_like(f) != MP_WISH_STL;
}

/* "File 2 (lid.stl): ", where it is not plain which file is meant. */
static void say_which(const struct api_files *f, char *out, size_t cap)
{
	char name[SHOWN] = "";

	out[0] = '\0';
	if (!f->several)
		return;
	if (f->current != NULL)
		(void)api_utf8_copy(name, sizeof name, f->current, strlen(f->current));
	if (name[0] != '\0')
		(void)snprintf(out, cap, "File %zu (%s): ", f->count, name);
	else
		(void)snprintf(out, cap, "File %zu: ", f->count);
}

/* What core said, as the answer's problem. */
static int refuse(const struct api_files *f, const struct mp_error *err, struct api_problem *p)
{
	enum api_code code = code_of(err->code);
	char which[SHOWN + 40];

	if (code == API_TOO_EXPENSIVE)
		return too_expensive(p);
	if (is_mismatch(f, err->code))
		return api_problem_option(p, API_TYPE_MISMATCH, "format", strlen("format"),
					  "The option format=stl was given, but this seems to be "
					  "a file of another format.");
	say_which(f, which, sizeof which);
	if (err->code == MP_BAD_CHECKS)
		return api_problem_option(p, code, "checks", strlen("checks"), "%s%s.", which,
					  err->text);
	(void)api_problem_set(p, code, "%s%s: %s.", which, api_problem_title(code), err->text);
	if (err->byte != MP_NO_BYTE)
		p->byte = err->byte;
	p->line = err->line;
	if (code == API_TOO_MANY_TRIANGLES) {
		p->limit = err->limit;
		p->actual = err->actual;
	}
	return -1;
}

static void settle_digest(struct api_files *f)
{
	char hex[API_DIGEST_SIZE];

	api_digest_end(&f->sha, hex);
	if (f->count == 1)
		memcpy(f->sha256, hex, sizeof hex);
	api_text_say(&f->digests, f->count == 1 ? "[\"" : ",\"");
	api_text_say(&f->digests, hex);
	api_text_say(&f->digests, "\"");
}

/* What the file that ends looked like. */
static void settle(struct api_files *f)
{
	enum mp_format_wish wish = looks_like(f);

	if (f->digest)
		settle_digest(f);

	if (f->count == 1)
		f->found = wish;
	f->differ = f->differ || f->found != wish;
}

static int take_name(struct api_files *f, const char *name)
{
	char *clean = NULL;

	if (name != NULL && name[0] != '\0') {
		clean = api_utf8_dup(name, strlen(name));
		if (clean == NULL)
			return -1;
	}
	api_text_say(&f->names, f->count == 0 ? "[" : ",");
	if (clean != NULL)
		api_text_string(&f->names, clean, strlen(clean));
	else
		api_text_say(&f->names, "null");
	if (f->current != f->first)
		free(f->current);
	f->current = clean;
	if (f->count == 0)
		f->first = clean;
	return f->names.failed ? -1 : 0;
}

int api_files_begin(struct api_files *f, const char *name, struct api_problem *p)
{
	struct mp_error err = {0};

	if (f->count == 0) {
		f->digest = (f->options->include & API_INCLUDE_DIGEST) != 0;
		api_digest_begin(&f->sha);
		api_options_request(f->options, &f->request);
		f->analysis = mp_analysis_new(&f->request, &err);
		if (f->analysis == NULL)
			return refuse(f, &err, p);
	} else {
		if (mp_analysis_next(f->analysis, &err))
			return refuse(f, &err, p);
		settle(f);
	}
	if (take_name(f, name))
		return too_expensive(p);
	f->count++;
	f->bytes = 0;
	return 0;
}

int api_files_bytes(struct api_files *f, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	struct mp_error err = {0};

	if (f->bytes < sizeof f->start) {
		size_t left = sizeof f->start - (size_t)f->bytes;

		memcpy(f->start + f->bytes, bytes, len < left ? len : left);
	}
	f->bytes += len;
	if (f->digest)
		api_digest_add(&f->sha, bytes, len);
	return mp_analysis_push(f->analysis, bytes, len, &err) ? refuse(f, &err, p) : 0;
}

int api_files_end(struct api_files *f, struct api_problem *p)
{
	enum mp_format_wish wish = f->options->format;
	struct mp_error err = {0};

	if (mp_analysis_end(f->analysis, &err))
		return refuse(f, &err, p);
	settle(f);
	api_text_say(&f->names, "]");
	api_text_say(&f->digests, "]");
	if (f->names.failed || f->digests.failed)
		return too_expensive(p);
	if ((f->options->include & API_INCLUDE_DIGEST) != 0 && !f->digest)
		return api_problem_option(p, API_BAD_OPTION, "include", strlen("include"),
					  "The option asks for a digest behind the file, whose "
					  "bytes are gone: send it before the files.");
	if (f->format_late && wish != MP_WISH_AUTO && (f->differ || wish != f->found))
		return api_problem_option(p, API_BAD_OPTION, "format", strlen("format"),
					  "The option comes behind a file of another format: to "
					  "force a format, send it before the files.");
	return 0;
}

int api_files_report(struct api_files *f, struct mp_report *out, struct api_problem *p)
{
	struct mp_error err = {0};

	api_options_request(f->options, &f->request);
	if (mp_analysis_report(f->analysis, &f->request, out, &err) == 0)
		return 0;
	if (err.code == MP_BAD_NAME)
		return api_named_refuse(&f->options->named, f->analysis, &err, p);
	if (err.code == MP_BAD_MAP) /* a singular one was refused when it came */
		return api_problem_option(
		    p, API_BAD_OPTION, "transform", strlen("transform"),
		    "The transform takes the mesh beyond the range of a double.");
	return refuse(f, &err, p);
}

void api_files_free(struct api_files *f)
{
	mp_analysis_free(f->analysis);
	if (f->current != f->first)
		free(f->current);
	free(f->first);
	free(f->names.text);
	free(f->digests.text);
	memset(f, 0, sizeof *f);
}
