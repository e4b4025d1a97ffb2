#include "api/media.h"

#include <stdbool.h>
#include <string.h>
#include <strings.h>

#include "api/job.h"

const char *const api_media_types[] = {
    "model/stl",          "model/obj",
    "model/x-draco",      "application/octet-stream",
    "text/plain",         "application/x-www-form-urlencoded", /* what curl's --data-binary says */
    "application/sla",    "application/vnd.ms-pki.stl",
    "model/x.stl-binary", "model/x.stl-ascii",
    "application/x-tgif", NULL,
};

const char api_accept_post[] = "model/stl, application/octet-stream, text/plain, model/obj, "
			       "model/x-draco, application/sla, application/vnd.ms-pki.stl, "
			       "model/x.stl-binary, model/x.stl-ascii, application/x-tgif, "
			       "application/x-www-form-urlencoded";
const char api_accept_encoding[] = "identity";

/* The first word of a header value: up to ${end} characters, blanks around it cut. */
static size_t first_word(const char **value, const char *end)
{
	size_t len;

	*value += strspn(*value, " \t");
	len = strcspn(*value, end);
	while (len > 0 && ((*value)[len - 1] == ' ' || (*value)[len - 1] == '\t'))
		len--;
	return len;
}

static bool same(const char *text, size_t len, const char *word)
{
	return strlen(word) == len && strncasecmp(text, word, len) == 0;
}

static int check_type(const char *type, struct api_problem *p)
{
	size_t len = first_word(&type, ";");

	if (len == 0)
		return 0;
	for (size_t i = 0; api_media_types[i] != NULL; i++)
		if (same(type, len, api_media_types[i]))
			return 0;
	if (same(type, len, "multipart/form-data"))
		return api_problem_set(p, API_UNSUPPORTED_MEDIA_TYPE,
				       "Forms come in a later version: send the file itself as the "
				       "body (curl --data-binary @part.stl) and the options in the "
				       "URL.");
	return api_problem_set(p, API_UNSUPPORTED_MEDIA_TYPE,
			       "The body must be a mesh file: model/stl, or "
			       "application/octet-stream where its type is not known.");
}

int api_media_check(const char *content_type, const char *content_encoding, struct api_problem *p)
{
	if (content_type != NULL && check_type(content_type, p))
		return -1;
	while (content_encoding != NULL && *content_encoding != '\0') { /* a list of codings */
		size_t len = first_word(&content_encoding, ",");

		if (len > 0 && !same(content_encoding, len, "identity"))
			return api_problem_set(
			    p, API_UNSUPPORTED_ENCODING,
			    "Compressed bodies come in a later version: send the "
			    "file without Content-Encoding.");
		content_encoding += strcspn(content_encoding, ",");
		content_encoding += *content_encoding == ',';
	}
	return 0;
}
