#include "api/media.h"

#include <string.h>
#include <strings.h>

#include "api/header.h"
#include "api/job.h"

static const char form_type[] = "multipart/form-data";

const char *const api_media_types[] = {
    "model/stl",
    "model/obj",
    "model/x-draco",
    "application/octet-stream",
    "text/plain",
    "application/x-www-form-urlencoded", /* what curl's --data-binary says */
    "application/sla",
    "application/vnd.ms-pki.stl",
    "model/x.stl-binary",
    "model/x.stl-ascii",
    "application/x-tgif",
    form_type,
    NULL,
};

const char api_accept_post[] = "model/stl, application/octet-stream, text/plain, model/obj, "
			       "model/x-draco, application/sla, application/vnd.ms-pki.stl, "
			       "model/x.stl-binary, model/x.stl-ascii, application/x-tgif, "
			       "application/x-www-form-urlencoded, multipart/form-data";
const char api_accept_encoding[] = "gzip, zstd, identity";

/* The characters that RFC 2046 gives a boundary; a blank cannot be the last. */
static bool is_boundary(const char *text, size_t len)
{
	for (size_t i = 0; i < len; i++) {
		char c = text[i];

		if (!((c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
		      (c != '\0' && strchr("'()+_,-./:=? ", c) != NULL)))
			return false;
	}
	return len > 0 && text[len - 1] != ' ';
}

static int bad(struct api_problem *p, const char *detail)
{
	return api_problem_set(p, API_BAD_MULTIPART, "%s", detail);
}

/* The parameters behind the media type. */
static int read_boundary(const char *at, struct api_media *out, struct api_problem *p)
{
	const char *end = at + strlen(at);
	struct api_param param;
	bool seen = false;
	int rc;

	while ((rc = api_param_next(&at, end, &param)) > 0) {
		size_t len;

		if (!api_param_is(&param, "boundary"))
			continue;
		if (seen)
			return bad(p, "Content-Type has more than one boundary.");
		seen = true;
		len = api_param_text(&param, out->boundary, sizeof out->boundary);
		if (len >= sizeof out->boundary || !is_boundary(out->boundary, len))
			return bad(p, "The boundary in Content-Type is malformed: it has 1 to 70 "
				      "letters, digits or characters of '()+_,-./:=? .");
	}
	if (rc < 0)
		return bad(p, "The parameters of Content-Type are malformed.");
	return seen ? 0 : bad(p, "Content-Type multipart/form-data has no boundary.");
}

static int read_type(const char *type, struct api_media *out, struct api_problem *p)
{
	size_t len = api_header_word(&type, ";");

	if (len == 0)
		return 0;
	for (size_t i = 0; api_media_types[i] != NULL; i++) {
		if (strlen(api_media_types[i]) != len ||
		    strncasecmp(type, api_media_types[i], len) != 0)
			continue;
		out->form = api_media_types[i] == form_type;
		return out->form ? read_boundary(type + len, out, p) : 0;
	}
	return api_problem_set(p, API_UNSUPPORTED_MEDIA_TYPE,
			       "The body must be a mesh file (model/stl, or "
			       "application/octet-stream where its type is not known) or a form "
			       "with one (multipart/form-data).");
}

int api_media_read(const char *content_type, const char *content_encoding, struct api_media *out,
		   struct api_problem *p)
{
	memset(out, 0, sizeof *out);
	if (content_type != NULL && read_type(content_type, out, p))
		return -1;
	return api_coding_read(content_encoding, &out->coding, p);
}
