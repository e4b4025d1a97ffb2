#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "server/route.h"

static int parse_length(const char *text, uint64_t *out)
{
	uint64_t v = 0;

	if (*text == '\0' || strlen(text) > 18 || strspn(text, "0123456789") != strlen(text))
		return -1;
	for (; *text != '\0'; text++)
		v = 10 * v + (uint64_t)(*text - '0');
	*out = v;
	return 0;
}

const char *srv_guard_judge(const struct srv_head *h, uint64_t *length)
{
	*length = API_NONE;
	if (h->bad_bytes)
		return "a header holds a control byte";
	if (h->lengths > 1)
		return "Content-Length is repeated";
	if (h->transfers > 1)
		return "Transfer-Encoding is repeated";
	if (h->hosts > 1)
		return "Host is repeated";
	if (h->hosts == 0 && h->http11)
		return "Host is missing";
	if (h->types > 1)
		return "Content-Type is repeated";
	if (h->encodings > 1)
		return "Content-Encoding is repeated: send one list";
	if (h->lengths > 0 && h->transfers > 0)
		return "both Content-Length and Transfer-Encoding";
	if (h->transfers > 0 && strcasecmp(h->transfer_encoding, "chunked") != 0)
		return "a Transfer-Encoding other than chunked";
	if (h->lengths > 0 && parse_length(h->content_length, length) != 0)
		return "Content-Length is not a sane number";
	return NULL;
}

bool srv_cors_allows(const struct srv_config *config, const char *origin)
{
	size_t len = strlen(origin);

	for (unsigned i = 0; i < config->origins; i++) {
		const char *o = config->origin[i];
		size_t tail = strlen(o) - (*o == '*');

		if (strcmp(o, "*") == 0 || strcmp(o, origin) == 0)
			return true;
		/* *.example.org covers https://a.example.org, not https://evilexample.org */
		if (o[0] == '*' && o[1] == '.' && len > tail + 3 &&
		    strcasecmp(origin + len - tail, o + 1) == 0)
			return true;
	}
	return false;
}

/* One range of an Accept header, blanks skipped: does it take JSON with q > 0? */
static bool range_takes(const char *range, size_t len)
{
	static const char *const good[] = {"*/*", "application/*", "application/json",
					   "application/problem+json"};
	const char *params = memchr(range, ';', len);
	size_t name = params != NULL ? (size_t)(params - range) : len;
	const char *end = range + len;

	while (name > 0 && isspace((unsigned char)range[name - 1]))
		name--;
	for (; params != NULL && params < end;
	     params = memchr(params, ';', (size_t)(end - params))) {
		params++;
		while (params < end && isspace((unsigned char)*params))
			params++;
		if (end - params >= 3 && strncasecmp(params, "q=0", 3) == 0 &&
		    strspn(params + 3, ".0") >= strcspn(params + 3, ",; \t"))
			return false;
	}
	for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
		if (strlen(good[i]) == name && strncasecmp(range, good[i], name) == 0)
			return true;
	return false;
}

bool srv_accept_json(const char *accept)
{
	if (accept == NULL || *accept == '\0')
		return true;
	while (*accept != '\0') {
		size_t len;

		accept += strspn(accept, " \t,");
		len = strcspn(accept, ",");
		if (len > 0 && range_takes(accept, len))
			return true;
		accept += len;
	}
	return false;
}
