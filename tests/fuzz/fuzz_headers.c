/*
 * Any head: lines "Name: value", taken in as server/http.c takes them from the library.  A head
 * that the guard lets pass has one meaning; what is read from single values is within its bounds.
 */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "api/header.h"
#include "api/media.h"
#include "server/config.h"
#include "server/keys.h"
#include "server/route.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void must(int truth)
{
	if (!truth)
		abort();
}

static bool has_control(const char *s)
{
	for (; *s != '\0'; s++)
		if (((unsigned char)*s < 0x20 && *s != '\t') || *s == 0x7f)
			return true;
	return false;
}

static void take(struct srv_head *h, const char *name, const char *value)
{
	const struct {
		const char *name, **value;
		unsigned *count;
	} known[] = {{"content-length", &h->content_length, &h->lengths},
		     {"transfer-encoding", &h->transfer_encoding, &h->transfers},
		     {"host", NULL, &h->hosts},
		     {"content-type", &h->content_type, &h->types},
		     {"content-encoding", &h->content_encoding, &h->encodings},
		     {"authorization", &h->authorization, &h->authorizations},
		     {"origin", &h->origin, NULL},
		     {"accept", &h->accept, NULL}};
	bool good = srv_guard_field(name, value);

	must(!good || (!has_control(name) && !has_control(value) && *name != '\0' &&
		       strpbrk(name, " \t:") == NULL));
	if (!good)
		h->bad_bytes = true;
	for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
		if (strcasecmp(name, known[i].name) != 0)
			continue;
		if (known[i].value != NULL)
			*known[i].value = value;
		if (known[i].count != NULL)
			++*known[i].count;
	}
}

static void judge_params(const char *value)
{
	const char *at = value, *end = value + strlen(value);
	size_t word = api_header_word(&at, ";,");
	struct api_param p;
	char text[40];
	int more;

	must(at >= value && at + word <= end);
	at += word;
	while ((more = api_param_next(&at, end, &p)) == 1) {
		size_t len = api_param_text(&p, text, sizeof text);

		must(p.name >= value && p.name + p.name_len <= end);
		must(p.value >= value && p.value + p.value_len <= end && len <= p.value_len);
		must(memchr(text, '\0', sizeof text) != NULL);
		must(!p.quoted || p.value[-1] == '"');
	}
	must(more == 0 || more == -1);
}

static void judge_body(const struct srv_head *h)
{
	struct api_problem p;
	struct api_media media;

	if (api_media_read(h->content_type, h->content_encoding, &media, &p) != 0)
		must(p.code == API_UNSUPPORTED_MEDIA_TYPE || p.code == API_UNSUPPORTED_ENCODING ||
		     p.code == API_BAD_MULTIPART);
	else
		must(!media.form ||
		     (strlen(media.boundary) > 0 && strlen(media.boundary) <= API_BOUNDARY));
}

static void judge(const struct srv_head *h)
{
	static char alpha[] = "alpha", wide[] = "*.example.org", exact[] = "https://cad.test";
	static const struct srv_config config = {.origin = {wide, exact}, .origins = 2};
	static char key[1][SRV_KEY_MAX + 1] = {"alpha"};
	const struct srv_keys keys = {.in_force = true, .key = key, .count = 1};
	uint64_t length;

	if (srv_guard_judge(h, &length) == NULL) {
		must(h->lengths <= 1 && h->transfers <= 1 && h->lengths + h->transfers <= 1);
		must(h->hosts <= 1 && h->types <= 1 && h->encodings <= 1 && !h->bad_bytes);
		must((length == API_NONE) == (h->lengths == 0));
		must(length == API_NONE || length == strtoull(h->content_length, NULL, 10));
	}
	(void)srv_accept_json(h->accept);
	if (h->origin != NULL && srv_cors_allows(&config, h->origin))
		must(strcmp(h->origin, exact) == 0 || strlen(h->origin) > strlen(wide) + 2);
	if (srv_keys_fit(&keys, h->authorization))
		must(strcmp(h->authorization + strlen(h->authorization) - 5, alpha) == 0);
	if (h->content_type != NULL)
		judge_params(h->content_type);
	judge_body(h);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	char *text = malloc(size + 1), *line, *next;
	struct srv_head h = {.http11 = size % 2 == 0};

	must(text != NULL);
	memcpy(text, data, size);
	text[size] = '\0';
	for (line = text; line < text + size; line = next) {
		char *end = memchr(line, '\n', (size_t)(text + size - line)), *colon;

		next = end != NULL ? end + 1 : text + size;
		if (end != NULL)
			*end = '\0';
		colon = strchr(line, ':');
		if (colon == NULL) {
			take(&h, line, "");
			continue;
		}
		*colon++ = '\0';
		take(&h, line, colon + strspn(colon, " "));
	}
	judge(&h);
	free(text);
	return 0;
}
