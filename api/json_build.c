#include "api/json_build.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/json_number.h"
#include "api/utf8.h"

void api_text_put(struct api_text *t, const char *bytes, size_t len)
{
	if (t->failed)
		return;
	if (len >= t->cap - t->len || t->text == NULL) { /* one byte is the NUL's */
		size_t cap = t->cap < 256 ? 256 : t->cap;
		char *p;

		while (cap - t->len <= len && cap <= SIZE_MAX / 2)
			cap *= 2;
		p = cap - t->len > len ? realloc(t->text, cap) : NULL;
		if (p == NULL) {
			t->failed = true;
			return;
		}
		t->text = p;
		t->cap = cap;
	}
	memcpy(t->text + t->len, bytes, len);
	t->len += len;
	t->text[t->len] = '\0';
}

void api_text_say(struct api_text *t, const char *words)
{
	api_text_put(t, words, strlen(words));
}

void api_text_number(struct api_text *t, double x)
{
	char buf[API_NUMBER_SIZE];

	api_text_put(t, buf, api_json_number(buf, x));
}

void api_text_count(struct api_text *t, uint64_t n)
{
	char buf[24], *p = buf + sizeof buf;

	do
		*--p = (char)('0' + n % 10);
	while ((n /= 10) > 0);
	api_text_put(t, p, (size_t)(buf + sizeof buf - p));
}

void api_text_bool(struct api_text *t, bool b)
{
	api_text_say(t, b ? "true" : "false");
}

void api_text_string(struct api_text *t, const char *bytes, size_t len)
{
	char *clean = api_utf8_dup(bytes, len);

	if (clean == NULL) {
		t->failed = true;
		return;
	}
	api_text_put(t, "\"", 1);
	for (const char *p = clean; *p != '\0';) { /* no control characters are left */
		size_t run = strcspn(p, "\"\\");

		api_text_put(t, p, run);
		p += run;
		if (*p != '\0') {
			api_text_put(t, "\\", 1);
			api_text_put(t, p++, 1);
		}
	}
	api_text_put(t, "\"", 1);
	free(clean);
}

static bool all_finite(const double *x, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!isfinite(x[i]))
			return false;
	return true;
}

void api_text_vector(struct api_text *t, const double *x, size_t count)
{
	if (!all_finite(x, count)) {
		api_text_say(t, "null");
		return;
	}
	for (size_t i = 0; i < count; i++) {
		api_text_put(t, i > 0 ? "," : "[", 1);
		api_text_number(t, x[i]);
	}
	api_text_put(t, "]", 1);
}

void api_text_matrix(struct api_text *t, const double m[3][3])
{
	if (!all_finite(m[0], 3) || !all_finite(m[1], 3) || !all_finite(m[2], 3)) {
		api_text_say(t, "null");
		return;
	}
	for (size_t i = 0; i < 3; i++) {
		api_text_put(t, i > 0 ? "," : "[", 1);
		api_text_vector(t, m[i], 3);
	}
	api_text_put(t, "]", 1);
}

static cJSON *add(struct api_json *j, cJSON *parent, const char *name, cJSON *item)
{
	if (parent == NULL || item == NULL || !cJSON_AddItemToObjectCS(parent, name, item)) {
		cJSON_Delete(item);
		j->failed = true;
		return NULL;
	}
	return item;
}

cJSON *api_json_object(struct api_json *j, cJSON *parent, const char *name)
{
	return add(j, parent, name, cJSON_CreateObject());
}

void api_json_null(struct api_json *j, cJSON *parent, const char *name)
{
	(void)add(j, parent, name, cJSON_CreateNull());
}

void api_json_bool(struct api_json *j, cJSON *parent, const char *name, bool b)
{
	(void)add(j, parent, name, cJSON_CreateBool(b));
}

void api_json_string(struct api_json *j, cJSON *parent, const char *name, const char *text)
{
	char *clean = api_utf8_dup(text, strlen(text));

	(void)add(j, parent, name, clean != NULL ? cJSON_CreateString(clean) : NULL);
	free(clean);
}

void api_json_count(struct api_json *j, cJSON *parent, const char *name, uint64_t n)
{
	char buf[24];

	snprintf(buf, sizeof buf, "%" PRIu64, n);
	(void)add(j, parent, name, cJSON_CreateRaw(buf));
}

void api_json_signed(struct api_json *j, cJSON *parent, const char *name, int64_t n)
{
	char buf[24];

	snprintf(buf, sizeof buf, "%" PRId64, n);
	(void)add(j, parent, name, cJSON_CreateRaw(buf));
}

void api_json_value(struct api_json *j, cJSON *parent, const char *name, bool defined, double x)
{
	char buf[API_NUMBER_SIZE];

	(void)api_json_number(buf, defined ? x : NAN);
	(void)add(j, parent, name, cJSON_CreateRaw(buf));
}

void api_json_vector(struct api_json *j, cJSON *parent, const char *name, bool defined,
		     const double *x, size_t count)
{
	struct api_text t = {0};

	if (defined)
		api_text_vector(&t, x, count);
	else
		api_text_say(&t, "null");
	api_json_text(j, parent, name, &t);
}

void api_json_matrix(struct api_json *j, cJSON *parent, const char *name, bool defined,
		     const double m[3][3])
{
	struct api_text t = {0};

	if (defined)
		api_text_matrix(&t, m);
	else
		api_text_say(&t, "null");
	api_json_text(j, parent, name, &t);
}

/* cJSON_CreateRaw() would copy; a report's lists may hold 100 MB, so the text is handed over. */
void api_json_text(struct api_json *j, cJSON *parent, const char *name, struct api_text *t)
{
	cJSON *item = t->failed || t->text == NULL ? NULL : cJSON_CreateNull();

	if (item == NULL) {
		free(t->text);
		j->failed = true;
	} else {
		item->type = cJSON_Raw;
		item->valuestring = t->text; /* given back by cJSON_Delete() */
		(void)add(j, parent, name, item);
	}
	memset(t, 0, sizeof *t);
}

cJSON *api_json_begin(struct api_json *j)
{
	j->root = cJSON_CreateObject();
	j->failed = j->root == NULL;
	return j->root;
}

char *api_json_finish(struct api_json *j, size_t *len)
{
	char *text = j->failed ? NULL : cJSON_PrintUnformatted(j->root);

	cJSON_Delete(j->root);
	j->root = NULL;
	if (text != NULL)
		*len = strlen(text);
	return text;
}
