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

#define DISPOSITION        "Content-Disposition: form-data; "
#define PART(params, data) "--XX\r\n" DISPOSITION params "\r\n\r\n" data "\r\n"
#define END                "--XX--\r\n"

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
	reads_as("Not for you.\r\n--XX_\r\n --XX\r\nx--XX\r\n" PART("name=a", "1") "--XX--",
		 "[a|-|]1;");
	reads_as("\r\n" PART("name=a", "1") END "\r\n--XX\r\nwhat is this\n--XX--", "[a|-|]1;");
	reads_as(PART("name=a", "1") "--XX--anything", "[a|-|]1;");
	reads_as("--XX--", "");
}

static void blanks_may_follow_a_boundary(void **state)
{
	(void)state;
	reads_as("--XX \t\r\n" DISPOSITION "name=a\r\n\r\n1\r\n--XX\t\r\n" DISPOSITION
		 "name=b\r\n\r\n2\r\n--XX--",
		 "[a|-|]1;[b|-|]2;");
	is_bad("--XX x\r\n", "something else behind it");
	is_bad("--XX --", "something else behind it");
	is_bad("--XX \rx", "something else behind it");
	is_bad("--XX\t\n", "LF alone");
}

/* Everything that begins like a boundary and is none. */
static void data_may_look_like_a_boundary(void **state)
{
	static const char *const data[] = {"\r",
					   "\n",
					   "\r\n",
					   "\r\n\r\n",
					   "\r\r\n",
					   "\r\n-",
					   "\r\n--",
					   "\r\n--X",
					   "\r\n--X\r\n--X",
					   "\r\n--X\r\n--XY",
					   "\r\n--XX_",
					   "\r\n--XXY\r\n",
					   "\r\n--XX-",
					   "\r\n--XX-\r",
					   "\r\n--XX-X-",
					   "\r\n--XX\r",
					   "\r\n--XX\r\r\n--XX_",
					   "\r\n--XX\rX",
					   "\n--XX",
					   "\r--XX",
					   "--XX",
					   "\r\n --XX",
					   "\r\n--xx",
					   "\r\n\r\n--XX.",
					   "\r\n--XX\xff"};
	char text[300], log[100];

	(void)state;
	for (size_t i = 0; i < sizeof data / sizeof data[0]; i++) {
		/* behind a byte, as the last thing, and twice */
		(void)snprintf(text, sizeof text, PART("name=a", "_%s") END, data[i]);
		(void)snprintf(log, sizeof log, "[a|-|]_%s;", data[i]);
		reads_as(text, log);
		(void)snprintf(text, sizeof text, PART("name=a", "_%s%s_") END, data[i], data[i]);
		(void)snprintf(log, sizeof log, "[a|-|]_%s%s_;", data[i], data[i]);
		reads_as(text, log);
		if (data[i][0] == '-') /* an empty part: the next test */
			continue;
		(void)snprintf(text, sizeof text, PART("name=a", "%s") END, data[i]);
		(void)snprintf(log, sizeof log, "[a|-|]%s;", data[i]);
		reads_as(text, log);
	}
}

/* RFC 2046, 5.1.1: without a body the empty line is the delimiter's. */
static void a_part_may_have_no_body_at_all(void **state)
{
	(void)state;
	reads_as("--XX\r\n" DISPOSITION "name=a\r\n\r\n--XX\r\n" DISPOSITION "name=b\r\n\r\n--XX--",
		 "[a|-|];[b|-|];");
	reads_as("--XX\r\n" DISPOSITION "name=a\r\n\r\n--XY\r\n--XX--", "[a|-|]--XY;");
	reads_as("--XX\r\n" DISPOSITION "name=a\r\n\r\n--XX.\r\n--XX--", "[a|-|]--XX.;");
	reads_as("--XX\r\n" DISPOSITION "name=a\r\n\r\n-\r\n--XX--", "[a|-|]-;");
}

static void any_bytes_are_data(void **state)
{
	static const char head[] = PART("name=file; filename=a", ""), tail[] = "\r\n--XX--";
	char log[2000] = "[file|a|]";
	size_t n = strlen(log);

	(void)state;
	say(head);
	form_len -= 2;
	for (unsigned i = 0; i < 1024; i++, n++) /* each byte before and behind each CR, LF, - */
		log[n] = form[form_len++] = (char)(i % 2 == 0 ? i / 4 : (i / 2 % 2 ? '\r' : '-'));
	log[n++] = ';';
	memcpy(form + form_len, tail, sizeof tail - 1);
	form_len += sizeof tail - 1;
	read_whole("XX");
	assert_log(log, n);
	assert_any_split("XX");
}

static void boundaries_of_any_length(void **state)
{
	char boundary[API_BOUNDARY + 1], log[400];

	(void)state;
	for (size_t n = 1; n <= API_BOUNDARY; n++) {
		memset(boundary, '-', n); /* the most alike that there are */
		boundary[n] = '\0';
		boundary[n - 1] = 'b';
		form_len = (size_t)snprintf(form, ROOM,
					    "--%s\r\n" DISPOSITION "name=a\r\n\r\n\r\n--%.*s\r\n---"
					    "%s-\r\n--%s--",
					    boundary, (int)n - 1, boundary, boundary, boundary);
		(void)snprintf(log, sizeof log, "[a|-|]\r\n--%.*s\r\n---%s-;", (int)n - 1, boundary,
			       boundary);
		read_whole(boundary);
		assert_log(log, strlen(log));
		assert_any_split(boundary);
	}
}

static void a_form_has_to_end(void **state)
{
	static const char text[] = "preamble\r\n" PART("name=a", "123") PART("name=b", "") "--XX--";

	(void)state;
	for (size_t n = 0; n < sizeof text - 1; n++) {
		say_bytes(text, n);
		read_whole("XX");
		assert_int_equal(whole.problem.code, API_BAD_MULTIPART);
		assert_int_equal(whole.problem.byte, n);
		read_form(&split, "XX", form, n, 0, 1);
		assert_same();
	}
	is_bad("", "the body is empty");
	is_bad("solid\n", "does not occur");
	is_bad("\r\n--XY\r\n" DISPOSITION "name=a\r\n\r\n\r\n--XY--", "does not occur");
	is_bad(PART("name=a", "1"), "without a last boundary");
}

static void lines_end_with_crlf(void **state)
{
	(void)state;
	is_bad("--XX\n" DISPOSITION "name=a\n\n1\n--XX--\n", "LF alone");
	is_bad("--XX\r\n" DISPOSITION "name=a\n\n1\n--XX--\n", "does not end with CRLF");
	is_bad("--XX\r\n" DISPOSITION "name=a\r\r\n", "does not end with CRLF");
	is_bad("--XX\r\n" DISPOSITION "name=a\rb\r\n", "does not end with CRLF");
	is_bad(PART("name=a", "1\r\n--XX\n"), "LF alone");
}

static void names_are_read_in_all_their_forms(void **state)
{
	(void)state;
	reads_as(PART("name=\"a\\\"b\\\\c\\d\"", "") END, "[a\"b\\c\\d|-|];");
	reads_as(PART("name = \"a;b=c\" ; x=y; filename=\"\"", "") END, "[a;b=c||];");
	reads_as(PART(";;name=\"density[a b]\";", "") END, "[density[a b]|-|];");
	reads_as(PART("FileName=\"C:\\dir\\part 1.stl\"; NAME=file", "") END,
		 "[file|part 1.stl|];");
	reads_as(PART("name=file; filename=\"../../etc/passwd\"", "") END, "[file|passwd|];");
	reads_as(PART("name=file; filename=\"dir/\"", "") END, "[file||];");
	reads_as(PART("name=\"caf\xc3\xa9\"; filename=\"\xff.stl\"", "") END,
		 "[caf\xc3\xa9|\xff.stl|];");
	reads_as("--XX\r\ncontent-disposition:FORM-DATA;name=a\r\n\r\n\r\n--XX--", "[a|-|];");
	reads_as("--XX\r\nContent-Disposition:\tform-data \t; name=a \r\n\r\n\r\n--XX--",
		 "[a|-|];");
}

/* Forbidden by RFC 7578, sent all the same, instead of the plain one or beside it. */
static void extended_filenames_count_where_alone(void **state)
{
	(void)state;
	reads_as(PART("name=file; filename*=UTF-8''caf%C3%A9%20b.stl", "") END,
		 "[file|caf\xc3\xa9 b.stl|];");
	reads_as(PART("name=file; filename*=utf-8'en'a%2Fb%0a%zz%4", "") END, "[file|b%0a%zz%4|];");
	reads_as(PART("name=file; filename*=UTF-8''x.stl; filename=\"y.stl\"", "") END,
		 "[file|y.stl|];");
	reads_as(PART("name=file; filename*=plain", "") END, "[file|plain|];");
	is_bad(PART("name=file; filename*=a; filename*=b", "") END, "two filenames");
}

static void other_headers_are_read_or_passed_over(void **state)
{
	(void)state;
	reads_as(
	    "--XX\r\nContent-Type: Model/STL; x=y\r\nX-Any:\r\nContent-Length: 7\r\n" DISPOSITION
	    "name=a\r\nContent-Transfer-Encoding: Binary\r\n\r\n1\r\n--XX--",
	    "[a|-|model/stl]1;");
	is_bad("--XX\r\n" DISPOSITION "name=a\r\nContent-Transfer-Encoding: base64\r\n\r\n",
	       "Content-Transfer-Encoding is not read");
	is_bad("--XX\r\n" DISPOSITION "name=a\r\nContent-Type: multipart/mixed; boundary=Y\r\n\r\n",
	       "a form itself");
}

static void folded_headers_are_one(void **state)
{
	(void)state;
	reads_as("--XX\r\nContent-Disposition:\r\n form-data;\r\n\tname=\r\n \"a\";\r\n"
		 "  filename=\"b\r\n c\"\r\n\r\n1\r\n--XX--",
		 "[a|b   c|]1;");
	is_bad("--XX\r\n " DISPOSITION "name=a\r\n\r\n1\r\n--XX--", "no header");
}

static void bad_heads_are_refused(void **state)
{
	(void)state;
	is_bad("--XX\r\n\r\n1\r\n" END, "Part 1 of the form: it has no Content-Disposition");
	is_bad(PART("name=a", "") "--XX\r\nContent-Type: text/plain\r\n\r\n1\r\n" END,
	       "Part 2 of the form: it has no Content-Disposition");
	is_bad(PART("filename=a.stl", "") END, "no name");
	is_bad(PART("name=\"\"; filename=a.stl", "") END, "no name");
	is_bad(PART("name=a; name=b", "") END, "two names");
	is_bad(PART("name=a; filename=b; filename=c", "") END, "two filenames");
	is_bad(PART("name=\"a", "") END, "malformed");
	is_bad(PART("name=\"a\\\"", "") END, "malformed");
	is_bad(PART("name=\"a\"b", "") END, "malformed");
	is_bad(PART("name=\"a\"b=c", "") END, "malformed");
	is_bad(PART("name=", "") END, "malformed");
	is_bad(PART("name", "") END, "malformed");
	is_bad(PART("=a", "") END, "malformed");
	is_bad(PART("name=a b", "") END, "malformed");
	is_bad("--XX\r\nContent-Disposition: attachment; name=a\r\n\r\n" END, "not form-data");
	is_bad("--XX\r\nContent-Disposition: form-data\r\n\r\n" END, "no name");
	is_bad("--XX\r\n" DISPOSITION "name=a\r\n" DISPOSITION "name=a\r\n\r\n", "repeated");
	is_bad("--XX\r\n" DISPOSITION "name=a\r\nno colon\r\n\r\n", "no header");
	is_bad("--XX\r\nContent-Disposition : form-data; name=a\r\n\r\n", "no header");
	is_bad("--XX\r\n: x\r\n\r\n", "no header");
	is_bad("--XX\r\n" DISPOSITION "name=\"a\x01\"\r\n\r\n", "control character");
	is_bad("--XX\r\n" DISPOSITION "name=\"a\x7f\"\r\n\r\n", "control character");
	say_bytes("--XX\r\n" DISPOSITION "name=\"a\0b\"\r\n\r\n", 50);
	read_whole("XX");
	assert_int_equal(whole.problem.code, API_BAD_MULTIPART);
	assert_int_equal(whole.problem.byte, 6 + strlen(DISPOSITION "name=\"a"));
}

/* A part whose head is ${len} bytes long, by a header of no meaning. */
static void say_head(size_t len)
{
	static const char begin_head[] = "--XX\r\n" DISPOSITION "name=a\r\nX: ";
	size_t fill = len - (sizeof begin_head - 1 - 6) - 4;

	say(begin_head);
	memset(form + form_len, 'x', fill);
	form_len += fill;
	memcpy(form + form_len, "\r\n\r\n1\r\n--XX--", 13);
	form_len += 13;
}

static void heads_are_limited(void **state)
{
	char name[API_PART_FILENAME + 1];

	(void)state;
	say_head(API_MULTIPART_HEAD);
	read_whole("XX");
	assert_log("[a|-|]1;", 8);
	say_head(API_MULTIPART_HEAD + 1);
	read_whole("XX");
	assert_int_equal(whole.problem.code, API_BAD_MULTIPART);
	assert_int_equal(whole.problem.byte, 6 + API_MULTIPART_HEAD);
	for (size_t n = 60; n < 70; n++) {
		say("--XX\r\n" DISPOSITION "name=a\r\n");
		for (size_t i = 1; i < n; i++, form_len += 4)
			memcpy(form + form_len, "X:\r\n", 4);
		memcpy(form + form_len, "\r\n1\r\n--XX--", 11);
		form_len += 11;
		read_whole("XX");
		assert_int_equal(whole.ret == 0, n <= API_PART_LINES);
	}
	memset(name, 'n', sizeof name);
	for (int cut = 0; cut < 2; cut++) {
		form_len = (size_t)snprintf(form, ROOM, PART("name=%.*s; filename=%.*s", "") END,
					    API_PART_NAME - cut, name, API_PART_FILENAME - 1, name);
		read_whole("XX");
		assert_int_equal(whole.ret == 0, cut == 1);
		form_len = (size_t)snprintf(form, ROOM, PART("name=%.*s; filename=%.*s", "") END,
					    API_PART_NAME - 1, name, API_PART_FILENAME - cut, name);
		read_whole("XX");
		assert_int_equal(whole.ret == 0, cut == 1);
	}
}

static void parts_are_limited(void **state)
{
	static const char part[] = "--XX\r\n" DISPOSITION "name=a\r\n\r\n\r\n";

	(void)state;
	for (int more = 0; more < 2; more++) {
		form_len = 0;
		for (int i = 0; i < API_MULTIPART_PARTS + more; i++, form_len += sizeof part - 1)
			memcpy(form + form_len, part, sizeof part - 1);
		memcpy(form + form_len, "--XX--", 6);
		form_len += 6;
		read_whole("XX");
		assert_int_equal(whole.ret == 0, more == 0);
	}
	assert_int_equal(whole.problem.code, API_BAD_MULTIPART);
	assert_int_equal(whole.problem.limit, API_MULTIPART_PARTS);
	assert_int_equal(whole.problem.actual, API_MULTIPART_PARTS + 1);
}

static void the_sink_may_stop_it(void **state)
{
	static const char stops[] = "[=;";

	(void)state;
	say(PART("name=a", "1") PART("name=b", "2") END);
	for (size_t i = 0; i < 3; i++) {
		whole.stop = split.stop = stops[i];
		read_whole("XX");
		assert_int_equal(whole.problem.code, API_UNREADABLE);
		assert_any_split("XX");
	}
	whole.stop = split.stop = 0;
}

/* In one piece, data goes on in one piece: nothing is copied to look for boundaries. */
static void data_is_not_cut_up(void **state)
{
	(void)state;
	whole.stop = '=';
	say(PART("name=a", "1\r2\r\n3\r\n--X4\r\n-\r5") END);
	read_whole("XX");
	assert_int_equal(whole.len, strlen("[a|-|]1\r2\r\n3\r\n--X4\r\n-\r5"));
	whole.stop = 0;
}

static int media(const char *type, struct api_media *m)
{
	struct api_problem p = {.code = API_OK};

	(void)api_media_read(type, NULL, m, &p);
	return (int)p.code;
}

static void boundaries_are_read_from_the_header(void **state)
{
	static const char *const good[][2] = {
	    {"multipart/form-data; boundary=XX", "XX"},
	    {"Multipart/Form-Data;BOUNDARY=\"XX\"", "XX"},
	    {"multipart/form-data ; charset=utf-8 ; boundary = \"a b\" ", "a b"},
	    {"multipart/form-data; x=\"boundary=no; \\\"\"; boundary=yes;", "yes"},
	    {"multipart/form-data; boundary=----WebKitFormBoundary7MA4YWxkTrZu0gW",
	     "----WebKitFormBoundary7MA4YWxkTrZu0gW"},
	    {"multipart/form-data; boundary=\"0'()+_,-./:=?9\"", "0'()+_,-./:=?9"},
	    {"multipart/form-data; boundary=1234567890123456789012345678901234567890"
	     "123456789012345678901234567890",
	     "1234567890123456789012345678901234567890123456789012345678901234567890"},
	};
	static const char *const bad[] = {
	    "multipart/form-data",
	    "multipart/form-data;",
	    "multipart/form-data; charset=utf-8",
	    "multipart/form-data; boundary=",
	    "multipart/form-data; boundary=\"\"",
	    "multipart/form-data; boundary=\"a ",
	    "multipart/form-data; boundary=\"a \"",
	    "multipart/form-data; boundary=a b",
	    "multipart/form-data; boundary=a*b",
	    "multipart/form-data; boundary=\"a\\\"b\"",
	    "multipart/form-data; boundary=caf\xc3\xa9",
	    "multipart/form-data; boundary=a; boundary=a",
	    ("multipart/form-data; boundary=1234567890123456789012345678901234567890"
	     "1234567890123456789012345678901"),
	};
	struct api_media m;

	(void)state;
	for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
		assert_int_equal(media(good[i][0], &m), API_OK);
		assert_true(m.form);
		assert_string_equal(m.boundary, good[i][1]);
	}
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		if (media(bad[i], &m) != API_BAD_MULTIPART)
			fail_msg("%s is taken", bad[i]);
	assert_int_equal(media("multipart/mixed; boundary=x", &m), API_UNSUPPORTED_MEDIA_TYPE);
	assert_int_equal(media("model/stl; boundary", &m), API_OK);
	assert_false(m.form);
}

static void values_are_cut_to_their_room(void **state)
{
	static const char header[] = "; a=\"x\\\"y\"";
	const char *at = header;
	struct api_param param;
	char out[4] = "???";

	(void)state;
	assert_int_equal(api_param_next(&at, header + strlen(header), &param), 1);
	assert_true(api_param_is(&param, "A"));
	assert_int_equal(api_param_text(&param, out, 4), 3);
	assert_string_equal(out, "x\"y");
	assert_int_equal(api_param_text(&param, out, 3), 3);
	assert_string_equal(out, "x\"");
	assert_int_equal(api_param_text(&param, out, 1), 3);
	assert_string_equal(out, "");
	assert_int_equal(api_param_next(&at, header + strlen(header), &param), 0);
}

int main(void)
{
	const struct CMUnitTest multipart[] = {
	    cmocka_unit_test(parts_come_in_their_order),
	    cmocka_unit_test(what_stands_around_the_parts_is_passed_over),
	    cmocka_unit_test(blanks_may_follow_a_boundary),
	    cmocka_unit_test(data_may_look_like_a_boundary),
	    cmocka_unit_test(a_part_may_have_no_body_at_all),
	    cmocka_unit_test(any_bytes_are_data),
	    cmocka_unit_test(boundaries_of_any_length),
	    cmocka_unit_test(a_form_has_to_end),
	    cmocka_unit_test(lines_end_with_crlf),
	    cmocka_unit_test(names_are_read_in_all_their_forms),
	    cmocka_unit_test(extended_filenames_count_where_alone),
	    cmocka_unit_test(other_headers_are_read_or_passed_over),
	    cmocka_unit_test(folded_headers_are_one),
	    cmocka_unit_test(bad_heads_are_refused),
	    cmocka_unit_test(heads_are_limited),
	    cmocka_unit_test(parts_are_limited),
	    cmocka_unit_test(the_sink_may_stop_it),
	    cmocka_unit_test(data_is_not_cut_up),
	    cmocka_unit_test(boundaries_are_read_from_the_header),
	    cmocka_unit_test(values_are_cut_to_their_room),
	};

	return cmocka_run_group_tests(multipart, NULL, NULL);
}
