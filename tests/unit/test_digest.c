#include "api/digest.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* FIPS 180-4, the examples of the NIST. */
static const struct {
	const char *text, *hex;
} known[] = {
    {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
    {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
    {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
     "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
};

static void known_texts_have_their_digests(void **state)
{
	struct api_digest d;
	char hex[API_DIGEST_SIZE];

	(void)state;
	api_digest_begin(&d);
	for (int round = 0; round < 2; round++) /* it begins anew by itself */
		for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
			api_digest_add(&d, (const uint8_t *)known[i].text, strlen(known[i].text));
			api_digest_end(&d, hex);
			assert_string_equal(hex, known[i].hex);
		}
}

static void where_a_chunk_ends_never_shows(void **state)
{
	const char *text = known[2].text;
	size_t len = strlen(text);
	char hex[API_DIGEST_SIZE];

	(void)state;
	for (size_t step = 1; step <= len; step++) {
		struct api_digest d;

		api_digest_begin(&d);
		for (size_t at = 0; at < len; at += step)
			api_digest_add(&d, (const uint8_t *)text + at,
				       len - at < step ? len - at : step);
		api_digest_end(&d, hex);
		assert_string_equal(hex, known[2].hex);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(known_texts_have_their_digests),
	    cmocka_unit_test(where_a_chunk_ends_never_shows),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
