/* Any text: read whole, in pieces and in place it is the same number, and strtod agrees. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/number/number.h"
#include "core/number/number_private.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int same(double a, double b)
{
	return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

/* What is scanned in place, blanks behind it, is what is parsed. */
static void scan(const char *text, size_t size)
{
	char *room = malloc(size + MP_NUMBER_ROOM);
	double scanned, parsed;

	if (room == NULL)
		return;
	memcpy(room, text, size);
	memset(room + size, ' ', MP_NUMBER_ROOM);
	if (mp_number_scan(room, &scanned) == room + size &&
	    (mp_number_parse(text, size, &parsed) != 0 || !same(scanned, parsed)))
		abort();
	free(room);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	char *text = malloc(size + 1), *end;
	struct mp_decimal d;
	double whole = 7.0, fed = 7.0, other;
	int word;

	if (text == NULL)
		return 0;
	memcpy(text, data, size);
	text[size] = '\0';
	scan(text, size);
	mp_decimal_begin(&d);
	for (size_t i = 0; i < size; i++)
		mp_decimal_feed(&d, text + i, 1);
	word = mp_decimal_finish(&d, &fed);
	if (mp_number_parse(text, size, &whole) != 0) {
		if (word == 0 || whole != 7.0)
			abort();
	} else if (word == 0 ? !same(whole, fed) : isfinite(whole)) {
		abort();
	} else if (strlen(text) == size && strpbrk(text, "dD#") == NULL) {
		other = strtod(text, &end);
		if (*end != '\0' || !same(whole, other))
			abort();
	}
	free(text);
	return 0;
}
