#include "api/json_build.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "api/json_number.h"
#include "api/utf8.h"

bool api_text_grow(struct api_text *t, size_t len)
{
	size_t cap = t->cap < 1024 ? 1024 : t->cap;
	char *p;

	while (cap - t->len <= len && cap <= SIZE_MAX / 2)
		cap *= 2;
	p = cap - t->len > len ? realloc(t->text, cap) : NULL;
	if (p == NULL) {
		t->failed = true;
		return false;
	}
	t->text = p;
	t->cap = cap;
	return true;
}

static inline void put_char(struct api_text *t, char c)
{
	if (!api_text_has_room(t, 1))
		return;
	t->text[t->len++] = c;
	t->text[t->len] = '\0';
}

void api_text_number(struct api_text *t, double x)
{
	if (api_text_has_room(t, API_NUMBER_SIZE))
		t->len += api_json_number(t->text + t->len, x);
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

/* Has one of the eight bytes, all of which are below 0x80, the value ${of}?  (Mycroft's trick.) */
static inline uint64_t any(uint64_t eight, uint64_t of)
{
	const uint64_t ones = UINT64_C(0x0101010101010101);

	return (eight ^ ones * of) - ones;
}

/* Printable ASCII that needs no backslash, as nearly all our words are. */
static bool is_plain(const char *bytes, size_t len)
{
	const uint64_t ones = UINT64_C(0x0101010101010101);
	uint64_t bad = 0, eight;
	size_t i = 0;

	for (; len - i >= sizeof eight; i += sizeof eight) {
		memcpy(&eight, bytes + i, sizeof eight);
		bad |= eight | (eight - ones * 0x20) | (eight + ones) | any(eight, '"') |
		       any(eight, '\\');
	}
	for (; i < len; i++)
		bad |= bytes[i] < 0x20 || bytes[i] > 0x7e || bytes[i] == '"' || bytes[i] == '\\'
			   ? 0x80
			   : 0;
	return (bad & ones * 0x80) == 0;
}

void api_text_string(struct api_text *t, const char *bytes, size_t len)
{
	char *clean;

	if (is_plain(bytes, len)) {
		put_char(t, '"');
		api_text_put(t, bytes, len);
		put_char(t, '"');
		return;
	}
	clean = api_utf8_dup(bytes, len);
	if (clean == NULL) {
		t->failed = true;
		return;
	}
	put_char(t, '"');
	for (const char *p = clean; *p != '\0';) { /* no control characters are left */
		size_t run = strcspn(p, "\"\\");

		api_text_put(t, p, run);
		p += run;
		if (*p != '\0') {
			put_char(t, '\\');
			api_text_put(t, p++, 1);
		}
	}
	put_char(t, '"');
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
		put_char(t, i > 0 ? ',' : '[');
		api_text_number(t, x[i]);
	}
	put_char(t, ']');
}

void api_text_matrix(struct api_text *t, const double m[3][3])
{
	if (!all_finite(m[0], 3) || !all_finite(m[1], 3) || !all_finite(m[2], 3)) {
		api_text_say(t, "null");
		return;
	}
	for (size_t i = 0; i < 3; i++) {
		put_char(t, i > 0 ? ',' : '[');
		api_text_vector(t, m[i], 3);
	}
	put_char(t, ']');
}

static void close_to(struct api_json *j, unsigned depth)
{
	for (; j->depth > depth; j->depth--)
		put_char(&j->text, '}');
}

/*
 * What has been written becomes a node.  It is a reference, for cJSON_CreateRaw() would copy, and a
 * report's lists may hold 100 MB.  The text may move until it is complete: so far its place in
 * there is the node's number.
 */
static void end_member(struct api_json *j)
{
	cJSON *item;

	if (j->name == NULL)
		return;
	close_to(j, 0);
	item = j->text.failed || j->text.len == j->at ? NULL : cJSON_CreateNull();
	if (item == NULL || !cJSON_AddItemToObjectCS(j->root, j->name, item)) {
		cJSON_Delete(item);
		j->failed = j->text.failed = true;
	} else {
		item->type = (item->type & cJSON_StringIsConst) | cJSON_Raw | cJSON_IsReference;
		item->valuedouble = (double)j->at;
		j->names += strlen(j->name) + 4;
		j->text.len++; /* the NUL stays */
	}
	j->name = NULL;
}

/* ,"name": or, where it is the first of its object, "name": */
static void put_name(struct api_text *t, const char *name)
{
	size_t len = strlen(name);
	char *p;

	if (!api_text_has_room(t, len + 4))
		return;
	p = t->text + t->len;
	if (t->len > 0 && p[-1] != '{')
		*p++ = ',';
	*p++ = '"';
	memcpy(p, name, len);
	p += len;
	*p++ = '"';
	*p++ = ':';
	*p = '\0';
	t->len = (size_t)(p - t->text);
}

/* Where the value of the new member goes, or NULL. */
static struct api_text *begin(struct api_json *j, const cJSON *parent, const char *name)
{
	unsigned depth = 0;

	if (parent == NULL) {
		j->failed = true;
		return NULL;
	}
	if (parent == j->root) {
		end_member(j);
		j->name = name;
		j->at = j->text.len;
		return &j->text;
	}
	while (depth < j->depth && parent != &j->open[depth])
		depth++;
	if (depth == j->depth) { /* it was complete */
		j->failed = true;
		return NULL;
	}
	close_to(j, depth + 1);
	put_name(&j->text, name);
	return &j->text;
}

cJSON *api_json_object(struct api_json *j, cJSON *parent, const char *name)
{
	struct api_text *t = begin(j, parent, name);

	if (t == NULL || j->depth == API_JSON_DEEPEST) {
		j->failed = true;
		return NULL;
	}
	put_char(t, '{');
	return &j->open[j->depth++];
}

void api_json_null(struct api_json *j, cJSON *parent, const char *name)
{
	struct api_text *t = begin(j, parent, name);

	if (t != NULL)
		api_text_put(t, "null", 4);
}

void api_json_bool(struct api_json *j, cJSON *parent, const char *name, bool b)
{
	struct api_text *t = begin(j, parent, name);

	if (t != NULL)
		api_text_bool(t, b);
}

void api_json_string(struct api_json *j, cJSON *parent, const char *name, const char *text)
{
	struct api_text *t = begin(j, parent, name);

	if (t != NULL)
		api_text_string(t, text, strlen(text));
}

void api_json_count(struct api_json *j, cJSON *parent, const char *name, uint64_t n)
{
	struct api_text *t = begin(j, parent, name);

	if (t != NULL)
		api_text_count(t, n);
}

void api_json_signed(struct api_json *j, cJSON *parent, const char *name, int64_t n)
{
	struct api_text *t = begin(j, parent, name);

	if (t == NULL)
		return;
	if (n < 0)
		put_char(t, '-');
	api_text_count(t, n < 0 ? -(uint64_t)n : (uint64_t)n);
}

void api_json_value(struct api_json *j, cJSON *parent, const char *name, bool defined, double x)
{
	struct api_text *t = begin(j, parent, name);

	if (t != NULL)
		api_text_number(t, defined ? x : NAN);
}

void api_json_vector(struct api_json *j, cJSON *parent, const char *name, bool defined,
		     const double *x, size_t count)
{
	struct api_text *t = begin(j, parent, name);

	if (t != NULL && defined)
		api_text_vector(t, x, count);
	else if (t != NULL)
		api_text_put(t, "null", 4);
}

void api_json_matrix(struct api_json *j, cJSON *parent, const char *name, bool defined,
		     const double m[3][3])
{
	struct api_text *t = begin(j, parent, name);

	if (t != NULL && defined)
		api_text_matrix(t, m);
	else if (t != NULL)
		api_text_put(t, "null", 4);
}

struct api_text *api_json_raw(struct api_json *j, cJSON *parent, const char *name)
{
	struct api_text *t = begin(j, parent, name);

	return t != NULL ? t : &j->text; /* in vain, for it has failed */
}

void api_json_text(struct api_json *j, cJSON *parent, const char *name, struct api_text *t)
{
	struct api_text *to = begin(j, parent, name);

	if (t->failed || t->text == NULL)
		j->failed = true;
	else if (to != NULL)
		api_text_put(to, t->text, t->len);
	free(t->text);
	memset(t, 0, sizeof *t);
}

cJSON *api_json_begin(struct api_json *j)
{
	memset(j, 0, sizeof *j);
	j->root = cJSON_CreateObject();
	j->failed = j->root == NULL;
	return j->root;
}

/* Nothing moves any more: the nodes get their texts. */
static void refer(struct api_json *j)
{
	for (cJSON *item = j->root->child; item != NULL; item = item->next)
		item->valuestring = j->text.text + (size_t)item->valuedouble;
}

char *api_json_finish(struct api_json *j, size_t *len)
{
	size_t size;
	char *text = NULL;

	if (j->root != NULL)
		end_member(j);
	size = j->text.len + j->names + 64;
	if (!j->failed && j->root != NULL) {
		refer(j);
		text = size < INT_MAX / 2 ? cJSON_PrintBuffered(j->root, (int)size, 0)
					  : cJSON_PrintUnformatted(j->root);
	}
	free(j->text.text);
	cJSON_Delete(j->root);
	memset(j, 0, sizeof *j);
	if (text != NULL)
		*len = strlen(text);
	return text;
}
