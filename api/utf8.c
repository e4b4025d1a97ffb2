#include "api/utf8.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Continuation bytes behind a lead byte; the first one's range keeps out overlong forms,
 * surrogates and what lies above U+10FFFF (Unicode 15, table 3-7). */
static int follow(uint8_t lead, uint8_t *low, uint8_t *high)
{
	*low = lead == 0xe0 ? 0xa0 : lead == 0xf0 ? 0x90 : 0x80;
	*high = lead == 0xed ? 0x9f : lead == 0xf4 ? 0x8f : 0xbf;
	if (lead >= 0xc2 && lead <= 0xdf)
		return 1;
	if (lead >= 0xe0 && lead <= 0xef)
		return 2;
	return lead >= 0xf0 && lead <= 0xf4 ? 3 : -1;
}

/* Length (at least 1) of the character or maximal bad sequence at ${s}. */
static size_t step(const uint8_t *s, size_t len, bool *good)
{
	uint8_t low, high;
	int more;
	size_t n = 1;

	if (s[0] < 0x80) {
		*good = s[0] >= 0x20 && s[0] != 0x7f;
		return 1;
	}
	*good = false;
	more = follow(s[0], &low, &high);
	for (; more > 0 && n < len && s[n] >= low && s[n] <= high; n++) {
		low = 0x80;
		high = 0xbf;
		more--;
	}
	*good = more == 0 && !(s[0] == 0xc2 && s[1] < 0xa0); /* U+0080 to U+009F are controls */
	return n;
}

bool api_utf8_clean(const char *text, size_t len)
{
	bool good = true;

	for (size_t i = 0; i < len && good;)
		i += step((const uint8_t *)text + i, len - i, &good);
	return good;
}

size_t api_utf8_copy(char *out, size_t cap, const char *text, size_t len)
{
	size_t n = 0;

	for (size_t i = 0; i < len;) {
		bool good;
		size_t in = step((const uint8_t *)text + i, len - i, &good);
		size_t put = good ? in : 3;

		if (put >= cap - n)
			break;
		memcpy(out + n, good ? text + i : "\xef\xbf\xbd", put);
		n += put;
		i += in;
	}
	out[n] = '\0';
	return n;
}

char *api_utf8_dup(const char *text, size_t len)
{
	char *out = len < SIZE_MAX / 4 ? malloc(3 * len + 1) : NULL;

	if (out != NULL)
		(void)api_utf8_copy(out, 3 * len + 1, text, len);
	return out;
}
