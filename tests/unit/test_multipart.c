#include "api/multipart.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "api/header.h"

enum { ROOM = 1 << 17 };

/* What a form was read as: "[name|filename|type]data;" for each part. */
struct seen {
	int ret;
	struct api_problem problem;
	char log[ROOM];
	size_t len;
	char stop; /* the sink fails at this: '[', '=' (data) or ';', 0: never */
};

static struct seen whole, split;
static char form[ROOM];
static size_t form_len;

static int log_it(struct seen *s, char what, const void *bytes, size_t len, struct api_problem *p)
{
	assert_true(len <= ROOM - s->len);
	memcpy(s->log + s->len, bytes, len);
	s->len += len;
	return s->stop == what ? api_problem_set(p, API_UNREADABLE, "enough") : 0;
}

static int begin(void *self, const struct api_part *part, struct api_problem *p)
{
	char text[2000];
	int len = snprintf(text, sizeof text, "[%s|%s|%s]", part->name,
			   part->has_filename ? part->filename : "-", part->type);

	assert_int_equal(part->name_len, strlen(part->name));
	return log_it(self, '[', text, (size_t)len, p);
}

static int data(void *self, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	assert_true(len > 0);
	return log_it(self, '=', bytes, len, p);
}

static int end(void *self, struct api_problem *p)
{
	return log_it(self, ';', ";", 1, p);
}

static void read_form(struct seen *s, const char *boundary, const void *bytes, size_t len,
		      size_t first, size_t step)
{
	const struct api_multipart_sink sink = {begin, data, end, s};
	struct api_multipart *m = malloc(sizeof *m);

	assert_non_null(m);
	s->len = 0;
	s->ret = 0;
	memset(&s->problem, 0, sizeof s->problem);
	api_multipart_begin(m, boundary, &sink);
	for (size_t at = 0, n = first; at < len && s->ret == 0; at += n, n = step) {
		uint8_t *copy;

		n = n < len - at ? n : len - at;
		if (n == 0)
			continue;
		copy = malloc(n);
		assert_non_null(copy);
		memcpy(copy, (const char *)bytes + at, n);
		s->ret = api_multipart_push(m, copy, n, &s->problem);
		free(copy);
	}
	if (s->ret == 0)
		s->ret = api_multipart_finish(m, &s->problem);
	assert_int_equal(s->ret == 0, s->problem.code == API_OK);
	free(m);
}

static void read_whole(const char *boundary)
{
	read_form(&whole, boundary, form, form_len, form_len, 1);
}

static void assert_same(void)
{
	assert_int_equal(split.problem.code, whole.problem.code);
	assert_string_equal(split.problem.detail, whole.problem.detail);
	assert_true(split.problem.byte == whole.problem.byte);
	assert_int_equal(split.len, whole.len);
	assert_memory_equal(split.log, whole.log, whole.len);
}

/* Any pieces read as the whole does. */
static void assert_any_split(const char *boundary)
{
	for (size_t first = 0; first <= form_len; first++) {
		read_form(&split, boundary, form, form_len, first, form_len);
		assert_same();
		read_form(&split, boundary, form, form_len, first, 1 + first % 5);
		assert_same();
	}
}

static void say_bytes(const void *bytes, size_t len)
{
	memcpy(form, bytes, len);
	form_len = len;
}

static void say(const char *text)
{
	say_bytes(text, strlen(text));
}

static void assert_log(const void *log, size_t len)
{
	if (whole.ret)
		fail_msg("%s", whole.problem.detail);
	assert_int_equal(whole.len, len);
	assert_memory_equal(whole.log, log, len);
}

static void reads_as(const char *text, const char *log)
{
	say(text);
	read_whole("XX");
	assert_log(log, strlen(log));
	assert_any_split("XX");
}

static void is_bad(const char *text, const char *words)
{
	say(text);
	read_whole("XX");
	assert_int_equal(whole.problem.code, API_BAD_MULTIPART);
	if (strstr(whole.problem.detail, words) == NULL)
		fail_msg("no '%s' in '%s'", words, whole.problem.detail);
	assert_any_split("XX");
}

#define DISPOSITION "Content-Disposition: form-data; "
#define PART(params, data) "--XX\r\n" DISPOSITION params "\r\n\r\n" data "\r\n"
#define END "--XX--\r\n"

static void parts_come_in_their_order(void **state)
{
	(void)state;
	reads_as(PART("name=\"unit\"", "mm") PART("name=\"file\"; filename=\"a b.stl\"",
						  "\r\nsolid\r\n") PART("name=x", "") END,
		 "[unit|-|]mm;[file|a b.stl|]\r\nsolid\r\n;[x|-|];");
}

static void what_stands_around_the_parts_is_passed_over(void **state)
{
	(void)state;
	reads_as("Not for you.\r\n--XXX\r\n --XX\r\nx--XX\r\n" PART("name=a", "1") "--XX--", "[a|-|]1;");
	reads_as("\r\n" PART("name=a", "1") END "\r\n--XX\r\nwhat is this\n--XX--", "[a|-|]1;");
	reads_as(PART("name=a", "1") "--XX--anything", "[a|-|]1;");
	reads_as("--XX \t\r\n" DISPOSITION "name=a\r\n\r\n1\r\n--XX\t--XX\r\n--XX--" + 0, "");
}

int main(void)
{
	return 0;
}
