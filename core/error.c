#include "core/error.h"

#include <stdio.h>
#include <string.h>

static int fill(struct mp_error *err, enum mp_code code, uint64_t byte, const char *fmt, va_list ap)
{
	if (err == NULL)
		return -1;
	memset(err, 0, sizeof *err);
	err->code = code;
	err->byte = byte;
	(void)vsnprintf(err->text, sizeof err->text, fmt, ap);
	return -1;
}

int mp_fail(struct mp_error *err, enum mp_code code, uint64_t byte, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	(void)fill(err, code, byte, fmt, ap);
	va_end(ap);
	return -1;
}

int mp_fail_line(struct mp_error *err, enum mp_code code, uint64_t byte, uint64_t line,
		 const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	(void)fill(err, code, byte, fmt, ap);
	va_end(ap);
	if (err != NULL)
		err->line = line;
	return -1;
}

int mp_fail_limit(struct mp_error *err, uint64_t byte, uint64_t limit, uint64_t actual,
		  const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	(void)fill(err, MP_LIMIT, byte, fmt, ap);
	va_end(ap);
	if (err != NULL) {
		err->limit = limit;
		err->actual = actual;
	}
	return -1;
}

int mp_fail_nomem(struct mp_error *err)
{
	return mp_fail(err, MP_NOMEM, MP_NO_BYTE, "out of memory");
}
