#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/json_build.h"

enum { LONGEST = 20 };

static void prints(const char *bytes, size_t len, const char *want)
{
	struct api_text t = {0};
	char *exact = malloc(len > 0 ? len : 1); /* so that reading beyond it is seen */

	memcpy(exact, bytes, len);
	api_text_string(&t, exact, len);
	assert_false(t.failed);
	assert_string_equal(t.text, want);
	assert_int_equal(t.len, strlen(want));
	free(t.text);
	free(exact);
}

/* Eight bytes are looked at in one go: what is not plain is seen wherever it stands. */
static void every_place_is_looked_at(void **state)
{
	static const char *const out[] = {
	    ['"'] = "\\\"", ['\\'] = "\\\\", ['!'] = "!", [' '] = " ", ['~'] = "~"};

	(void)state;
	for (size_t len = 1; len <= LONGEST; len++) {
		for (size_t at = 0; at < len; at++) {
			for (size_t c = 1; c < sizeof out / sizeof out[0]; c++) {
				char text[LONGEST], want[2 * LONGEST + 3];

				if (out[c] == NULL)
					continue;
				memset(text, 'a', sizeof text);
				text[at] = (char)c;
				(void)snprintf(want, sizeof want, "\"%.*s%s%.*s\"", (int)at, text,
					       out[c], (int)(len - at - 1), text + at + 1);
				prints(text, len, want);
			}
		}
	}
}

/* What is no printable ASCII must not get through as it is. */
static void bytes_beyond_ascii_are_cleaned(void **state)
{
	(void)state;
	for (unsigned c = 0; c < 256; c++) {
		for (size_t at = 0; at < LONGEST; at++) {
			struct api_text t = {0};
			char text[LONGEST];

			if (c >= 0x20 && c < 0x7f)
				continue;
			memset(text, 'b', sizeof text);
			text[at] = (char)c;
			api_text_string(&t, text, sizeof text);
			assert_false(t.failed);
			if (c < 0x80)
				assert_null(memchr(t.text, (int)c, t.len));
			else /* no UTF-8: the replacement character */
				assert_non_null(strstr(t.text, "\xef\xbf\xbd"));
			free(t.text);
		}
	}
}

static void members_close_what_is_open(void **state)
{
	struct api_json j;
	cJSON *root = api_json_begin(&j), *a, *b;
	size_t len;
	char *text;

	(void)state;
	a = api_json_object(&j, root, "a");
	b = api_json_object(&j, a, "b");
	api_json_count(&j, b, "n", 7);
	api_text_say(api_json_raw(&j, a, "list"), "[1,2]");
	api_text_say(api_json_raw(&j, root, "words"), "\"so\"");
	(void)api_json_object(&j, root, "empty");
	api_json_null(&j, root, "none");
	text = api_json_finish(&j, &len);
	assert_string_equal(text, "{\"a\":{\"b\":{\"n\":7},\"list\":[1,2]},\"words\":\"so\","
				  "\"empty\":{},\"none\":null}");
	assert_int_equal(len, strlen(text));
	free(text);
}

/* The text moves while it grows, whatever refers to it. */
static void long_texts_stay_in_their_places(void **state)
{
	enum { MEMBERS = 50 };
	static char name[MEMBERS][8];
	struct api_json j;
	cJSON *root = api_json_begin(&j), *read;
	size_t len;
	char *text;

	(void)state;
	for (int i = 0; i < MEMBERS; i++) {
		struct api_text *t;

		(void)snprintf(name[i], sizeof name[i], "m%d", i);
		t = api_json_raw(&j, root, name[i]);
		api_text_say(t, "\"");
		for (int k = 0; k < 100 * i; k++)
			api_text_put(t, i % 2 == 0 ? "x" : "y", 1);
		api_text_say(t, "\"");
	}
	text = api_json_finish(&j, &len);
	read = cJSON_Parse(text);
	assert_int_equal(cJSON_GetArraySize(read), MEMBERS);
	for (int i = 0; i < MEMBERS; i++) {
		const char *value = cJSON_GetStringValue(cJSON_GetArrayItem(read, i));

		assert_int_equal(strlen(value), 100 * i);
		assert_int_equal(strspn(value, i % 2 == 0 ? "x" : "y"), 100 * i);
	}
	cJSON_Delete(read);
	free(text);
}

static void misuse_gives_no_document(void **state)
{
	struct api_json j;
	cJSON *root = api_json_begin(&j), *a = api_json_object(&j, root, "a");
	size_t len;

	(void)state;
	api_json_null(&j, root, "b");
	api_json_null(&j, a, "c"); /* it was complete */
	api_text_say(api_json_raw(&j, NULL, "d"), "1");
	assert_null(api_json_finish(&j, &len));
	root = api_json_begin(&j);
	(void)api_json_raw(&j, root, "nothing"); /* no value */
	api_json_null(&j, root, "e");
	assert_null(api_json_finish(&j, &len));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_place_is_looked_at),
	    cmocka_unit_test(bytes_beyond_ascii_are_cleaned),
	    cmocka_unit_test(members_close_what_is_open),
	    cmocka_unit_test(long_texts_stay_in_their_places),
	    cmocka_unit_test(misuse_gives_no_document),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
