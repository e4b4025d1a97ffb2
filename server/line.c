#include "server/line.h"

#include <string.h>

static void put(struct srv_line *l, const char *bytes, size_t len)
{
	size_t room = l->size - l->len - 1;

	if (len > room)
		len = room;
	memcpy(l->text + l->len, bytes, len);
	l->len += len;
	l->text[l->len] = '\0';
}

void srv_line_say(struct srv_line *l, const char *text)
{
	put(l, text, strlen(text));
}

void srv_line_digits(struct srv_line *l, uint64_t n, unsigned digits)
{
	char buf[20], *p = buf + sizeof buf;

	while (n > 0 || digits > 0) {
		*--p = (char)('0' + n % 10);
		n /= 10;
		digits -= digits > 0;
	}
	put(l, p, (size_t)(buf + sizeof buf - p));
}

void srv_line_count(struct srv_line *l, uint64_t n)
{
	srv_line_digits(l, n, 1);
}

void srv_line_thousandths(struct srv_line *l, double x)
{
	uint64_t n = x > 0 ? (x < 1e15 ? (uint64_t)(x * 1000 + 0.5) : UINT64_C(1) << 60) : 0;

	srv_line_digits(l, n / 1000, 1);
	srv_line_say(l, ".");
	srv_line_digits(l, n % 1000, 3);
}
