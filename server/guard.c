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

static bool begins_like(const char *name, const char *framing)
{
	size_t len = strlen(framing);

	return strlen(name) > len && strncasecmp(name, framing, len) == 0;
}

bool srv_guard_field(const char *name, const char *value)
{
	static const char marks[] = "!#$%&'*+-.^_`|~";

	if (*name == '\0' || begins_like(name, "content-length") ||
	    begins_like(name, "transfer-encoding"))
		return false;
	for (; *name != '\0'; name++)
		if (!isalnum((unsigned char)*name) && strchr(marks, *name) == NULL)
			return false;
	for (; *value != '\0'; value++)
		if (((unsigned char)*value < 0x20 && *value != '\t') || *value == 0x7f)
			return false;
	return true;
}

const char *srv_guard_judge(const struct srv_head *h, uint64_t *length)
{
	*length = API_NONE;
	if (h->bad_bytes)
		return "a header is malformed";
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

/* Does the range refuse with q=0? */
static bool refuses(const char *params, const char *end)
{
	for (; params != NULL && params < end;
	     params = memchr(params, ';', (size_t)(end - params))) {
		params++;
		while (params < end && isspace((unsigned char)*params))
			params++;
		if (end - params >= 3 && strncasecmp(params, "q=0", 3) == 0 &&
		    strspn(params + 3, ".0") >= strcspn(params + 3, ",; \t"))
			return true;
	}
	return false;
}

struct closeness {
	const char *name; /* of a media range */
	int close;        /* 1 covers everything, 3 is the type by its name */
};

static const struct closeness json[] = {{"*/*", 1},
					{"application/*", 2},
					{"application/json", 3},
					{"application/problem+json", 3},
					{NULL, 0}};
static const struct closeness stl[] = {
    {"*/*", 1}, {"model/*", 2}, {"model/stl", 3}, {"application/octet-stream", 3}, {NULL, 0}};

/* How closely one range of an Accept header names what is ${good}: 0 not at all. */
static int closeness(const struct closeness *good, const char *range, size_t len)
{

	while (len > 0 && isspace((unsigned char)range[len - 1]))
		len--;
	for (size_t i = 0; good[i].name != NULL; i++)
		if (strlen(good[i].name) == len && strncasecmp(range, good[i].name, len) == 0)
			return good[i].close;
	return 0;
}

/* The closest range decides (RFC 9110, 12.5.1). */
static bool accepts(const struct closeness *good, const char *accept)
{
	int closest = 0;
	bool taken = false;

	if (accept == NULL || *accept == '\0')
		return true;
	while (*accept != '\0') {
		const char *params;
		size_t len;
		int close;

		accept += strspn(accept, " \t,");
		len = strcspn(accept, ",");
		params = memchr(accept, ';', len);
		close = closeness(good, accept, params != NULL ? (size_t)(params - accept) : len);
		if (close > 0 && close >= closest) {
			taken = !refuses(params, accept + len) || (close == closest && taken);
			closest = close;
		}
		accept += len;
	}
	return taken;
}

bool srv_accept_json(const char *accept)
{
	return accepts(json, accept);
}

bool srv_accept_stl(const char *accept)
{
	return accepts(stl, accept);
}
