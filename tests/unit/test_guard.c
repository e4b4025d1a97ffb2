#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "server/route.h"

/* The head of a sound POST; tests spoil it. */
static struct srv_head sound(void)
{
	struct srv_head h = {.method = "POST",
			     .content_length = "684",
			     .lengths = 1,
			     .hosts = 1,
			     .types = 1,
			     .content_type = "model/stl",
			     .http11 = true};

	return h;
}

static void refused(struct srv_head h, const char *word)
{
	uint64_t length;
	const char *why = srv_guard_judge(&h, &length);

	assert_non_null(why);
	if (strstr(why, word) == NULL)
		fail_msg("\"%s\" says nothing of \"%s\"", why, word);
}

static void a_sound_head_passes_with_its_length(void **state)
{
	struct srv_head h = sound();
	uint64_t length = 0;

	(void)state;
	assert_null(srv_guard_judge(&h, &length));
	assert_true(length == 684);
	h.content_length = "0";
	assert_null(srv_guard_judge(&h, &length));
	assert_true(length == 0);
	h.content_length = "999999999999999999";
	assert_null(srv_guard_judge(&h, &length));
	assert_true(length == 999999999999999999u);
	h.content_length = NULL;
	h.lengths = 0;
	assert_null(srv_guard_judge(&h, &length));
	assert_true(length == API_NONE);
}

static void chunked_is_the_only_transfer_coding(void **state)
{
	static const char *const bad[] = {"gzip", "gzip, chunked", "chunked, chunked", "identity",
					  "",     "chunked;q=1",   "xchunked",         "chunked "};
	struct srv_head h = sound();
	uint64_t length;

	(void)state;
	h.lengths = 0;
	h.transfers = 1;
	h.transfer_encoding = "chunked";
	assert_null(srv_guard_judge(&h, &length));
	assert_true(length == API_NONE);
	h.transfer_encoding = "CHUNKED";
	assert_null(srv_guard_judge(&h, &length));
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		h.transfer_encoding = bad[i];
		refused(h, "Transfer-Encoding");
	}
}

static void two_ways_to_frame_a_body_are_one_too_many(void **state)
{
	struct srv_head h = sound();

	(void)state;
	h.transfers = 1;
	h.transfer_encoding = "chunked";
	refused(h, "both");
	h = sound();
	h.lengths = 2;
	refused(h, "Content-Length is repeated");
	h = sound();
	h.lengths = 0;
	h.transfers = 2;
	h.transfer_encoding = "chunked";
	refused(h, "Transfer-Encoding is repeated");
}

static void lengths_are_plain_digits_of_a_sane_size(void **state)
{
	static const char *const bad[] = {"",
					  "-1",
					  "+1",
					  "1 ",
					  " 1",
					  "0x10",
					  "1e3",
					  "1,1",
					  "1, 1",
					  "1.0",
					  "12a",
					  "\xb2",
					  "9999999999999999999",
					  "18446744073709551617"};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		struct srv_head h = sound();

		h.content_length = bad[i];
		refused(h, "Content-Length");
	}
}

static void a_host_is_given_exactly_once(void **state)
{
	struct srv_head h = sound();
	uint64_t length;

	(void)state;
	h.hosts = 2;
	refused(h, "Host is repeated");
	h.hosts = 0;
	refused(h, "Host is missing");
	h.http11 = false; /* HTTP/1.0 knows no Host */
	assert_null(srv_guard_judge(&h, &length));
	h.hosts = 2;
	refused(h, "Host is repeated");
}

static void what_describes_the_body_comes_once_and_clean(void **state)
{
	struct srv_head h = sound();

	(void)state;
	h.types = 2;
	refused(h, "Content-Type");
	h = sound();
	h.encodings = 2;
	refused(h, "Content-Encoding");
	h = sound();
	h.bad_bytes = true;
	refused(h, "malformed");
}

static void fields_are_tokens_with_clean_values(void **state)
{
	static const char *const names[] = {"",
					    "X A",
					    "X\t",
					    "X(",
					    "X:",
					    "caf\xe9",
					    "X\x7f",
					    "X\x01",
					    "Transfer-Encodingchunked", /* folded lines */
					    "content-length684",
					    "CONTENT-LENGTH-"};
	static const char *const values[] = {"a\x01", "\x7f", "a\rb", "a\nb", "\x0b"};

	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (srv_guard_field(names[i], "x"))
			fail_msg("%s", names[i]);
	for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
		assert_false(srv_guard_field("X", values[i]));
	assert_true(srv_guard_field("Content-Length", "684"));
	assert_true(srv_guard_field("transfer-encoding", "chunked"));
	assert_true(srv_guard_field("X_1.a!#$%&'*+-^`|~", "\t a \xff caf\xe9"));
	assert_true(srv_guard_field("X", ""));
}

static void origins_are_exact_or_below_a_suffix(void **state)
{
	static const struct {
		const char *origin;
		bool allowed;
	} cases[] = {
	    {"https://app.example.com", true},
	    {"https://app.example.com:8443", false},
	    {"http://app.example.com", false},
	    {"https://app.example.com.evil.test", false},
	    {"https://a.parts.test", true},
	    {"http://a.b.parts.test", true},
	    {"https://A.PARTS.test", true},
	    {"https://parts.test", false},
	    {"https://evilparts.test", false},
	    {"https://a.parts.test.evil", false},
	    {"https://a.parts.test:8443", false},
	    {".parts.test", false},
	    {"null", false},
	    {"", false},
	    {"*", false},
	};
	struct srv_config c = {.origin = {"https://app.example.com", "*.parts.test"}, .origins = 2};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		if (srv_cors_allows(&c, cases[i].origin) != cases[i].allowed)
			fail_msg("%s", cases[i].origin);
	c.origins = 0;
	assert_false(srv_cors_allows(&c, "https://app.example.com"));
	c.origin[0] = "*";
	c.origins = 1;
	assert_true(srv_cors_allows(&c, "https://anything.test"));
	assert_true(srv_cors_allows(&c, "null"));
	c.origin[0] = "null";
	assert_true(srv_cors_allows(&c, "null"));
	assert_false(srv_cors_allows(&c, "https://null"));
}

static void json_is_acceptable_where_a_range_covers_it(void **state)
{
	static const char *const good[] = {
	    "",
	    "*/*",
	    "application/json",
	    "APPLICATION/JSON",
	    "application/*",
	    "application/problem+json",
	    "text/html, application/json",
	    "text/html,application/json;q=0.1",
	    "application/json;q=1.0",
	    "application/json ; q=0.5",
	    "application/json; charset=utf-8",
	    "text/html, */*;q=0.01",
	    "text/html,,  application/json",
	    "application/json;q=0.001",
	};
	static const char *const bad[] = {
	    "text/html",
	    "application/xml, text/*",
	    "application/json;q=0",
	    "application/json; q=0.0",
	    "application/json;q=0.000, text/html",
	    "application/jsonx",
	    "xapplication/json",
	    "application/json2;q=1",
	    "*/*;q=0",
	    ",",
	    "application",
	};

	(void)state;
	assert_true(srv_accept_json(NULL));
	for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
		if (!srv_accept_json(good[i]))
			fail_msg("refused: %s", good[i]);
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		if (srv_accept_json(bad[i]))
			fail_msg("taken: %s", bad[i]);
}

/* RFC 9110, 12.5.1: the most specific range decides. */
static void a_refusal_by_name_outweighs_a_wildcard(void **state)
{
	(void)state;
	assert_false(srv_accept_json("application/json;q=0, */*"));
	assert_false(srv_accept_json("*/*, application/json;q=0"));
	assert_true(srv_accept_json("application/*;q=0, application/json"));
	assert_true(srv_accept_json("*/*;q=0, application/json"));
}

int main(void)
{
	const struct CMUnitTest guard[] = {
	    cmocka_unit_test(a_sound_head_passes_with_its_length),
	    cmocka_unit_test(chunked_is_the_only_transfer_coding),
	    cmocka_unit_test(two_ways_to_frame_a_body_are_one_too_many),
	    cmocka_unit_test(lengths_are_plain_digits_of_a_sane_size),
	    cmocka_unit_test(a_host_is_given_exactly_once),
	    cmocka_unit_test(fields_are_tokens_with_clean_values),
	    cmocka_unit_test(what_describes_the_body_comes_once_and_clean),
	    cmocka_unit_test(origins_are_exact_or_below_a_suffix),
	    cmocka_unit_test(json_is_acceptable_where_a_range_covers_it),
	    cmocka_unit_test(a_refusal_by_name_outweighs_a_wildcard),
	};

	return cmocka_run_group_tests(guard, NULL, NULL);
}
