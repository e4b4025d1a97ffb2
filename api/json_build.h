#ifndef API_JSON_BUILD_H
#define API_JSON_BUILD_H

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/*
 * Building JSON: the members of the document are a cJSON tree, what is within them is one growing
 * text, so that neither a list of 100,000 defects nor 150 numbers are nodes of their own: a tree
 * of all of them took longer than the analysis of a small part.  Failure (memory is out) is
 * remembered and asked for once, at the end.
 */

/* A growing text.  Zeroed is empty; a NUL stands behind ${text} once it is not NULL. */
struct api_text {
	char *text; /* heap, the owner's */
	size_t len, cap;
	bool failed;
};

/* Make room for ${len} bytes and the NUL behind them: false where memory is out. */
bool api_text_grow(struct api_text *, size_t len);

static inline bool api_text_has_room(struct api_text *t, size_t len)
{
	return !t->failed && (len < t->cap - t->len || api_text_grow(t, len));
}

static inline void api_text_put(struct api_text *t, const char *bytes, size_t len)
{
	if (!api_text_has_room(t, len))
		return;
	memcpy(t->text + t->len, bytes, len);
	t->len += len;
	t->text[t->len] = '\0';
}

/* ,"name": with a literal for the name: behind the first member of an object. */
#define API_TEXT_MEMBER(t, name) api_text_put(t, ",\"" name "\":", sizeof name + 3)

static inline void api_text_say(struct api_text *t, const char *words)
{
	api_text_put(t, words, strlen(words));
}

void api_text_number(struct api_text *, double x); /* null where not finite */
void api_text_count(struct api_text *, uint64_t n);
void api_text_bool(struct api_text *, bool b);
void api_text_string(struct api_text *, const char *bytes, size_t len); /* quoted and cleaned */

/* [x,y,z]; one number that is not finite makes it null. */
void api_text_vector(struct api_text *, const double *x, size_t count);
/* [[..],[..],[..]], rows; the same. */
void api_text_matrix(struct api_text *, const double m[3][3]);

enum { API_JSON_DEEPEST = 8 };

struct api_json {
	cJSON *root;
	struct api_text text; /* the values of all members of root, each ended by a NUL */
	const char *name;     /* of the member of root that is being written, NULL: of none */
	size_t at;            /* where its value begins in text */
	unsigned depth;       /* objects open in it */
	cJSON open[API_JSON_DEEPEST]; /* only their addresses are used: what object() returned */
	size_t names;                 /* of members of root: about how much room they take */
	bool failed;
};

/*
 * Add a member to ${parent}: the root or the object that was begun last or one around it; all
 * objects within ${parent} are complete thereby.  ${name} is kept by pointer (a literal).  A NULL
 * ${parent} is a failure that was noticed before.
 */
cJSON *api_json_object(struct api_json *, cJSON *parent, const char *name);
void api_json_null(struct api_json *, cJSON *parent, const char *name);
void api_json_bool(struct api_json *, cJSON *parent, const char *name, bool b);
void api_json_string(struct api_json *, cJSON *parent, const char *name, const char *text);
void api_json_count(struct api_json *, cJSON *parent, const char *name, uint64_t n);
void api_json_signed(struct api_json *, cJSON *parent, const char *name, int64_t n);

/* Those that print null where ${defined} is false or a number is not finite. */
void api_json_value(struct api_json *, cJSON *parent, const char *name, bool defined, double x);
void api_json_vector(struct api_json *, cJSON *parent, const char *name, bool defined,
		     const double *x, size_t count);
void api_json_matrix(struct api_json *, cJSON *parent, const char *name, bool defined,
		     const double m[3][3]);

/* The value of the member is what the caller puts behind this text, in JSON, before anything else.
 */
struct api_text *api_json_raw(struct api_json *, cJSON *parent, const char *name);
/* ${text}, which is JSON already, becomes the member and is taken over (zeroed). */
void api_json_text(struct api_json *, cJSON *parent, const char *name, struct api_text *text);

/* Begin with an object as the root; print it and give the tree back: heap string or NULL. */
cJSON *api_json_begin(struct api_json *);
char *api_json_finish(struct api_json *, size_t *len);

#endif
