#ifndef MP_ERROR_H
#define MP_ERROR_H

#include <stdarg.h>
#include <stdint.h>

/* What the caller can do next; one table in api/ turns these into HTTP statuses. */
enum mp_code {
	MP_OK = 0,
	MP_SYNTAX,      /* the bytes are no mesh of this format */
	MP_TRUNCATED,   /* the file ends too early: send all of it */
	MP_EMPTY,       /* no bytes at all */
	MP_NO_FACES,    /* a well-formed file without a triangle */
	MP_POINT_CLOUD, /* points only */
	MP_BAD_INDEX,   /* a face names a vertex that does not exist */
	MP_NON_FINITE,  /* a coordinate is NaN or infinite */
	MP_UNSUPPORTED, /* a legal feature that is not read */
	MP_LIMIT,       /* more than the limits allow: limit and actual are set */
	MP_NOMEM,       /* an allocation failed */
	MP_BAD_NAME,    /* named densities do not fit the file: limit and actual are set */
	MP_BAD_MAP,     /* the request's affine map is singular or takes the mesh out of range */
	MP_BAD_CHECKS,  /* the checks that were asked for are not for files of this format */
	MP_BUG          /* our own fault */
};

#define MP_NO_BYTE UINT64_MAX

struct mp_error {
	enum mp_code code;
	uint64_t line; /* 1-based; 0 in binary formats or where no line is to blame */
	uint64_t byte; /* offset in the decoded file, MP_NO_BYTE where none is to blame */
	/*
	 * MP_LIMIT: what was allowed, and what came (at least).  MP_BAD_NAME: which of the
	 * request's names, UINT64_MAX for none of them; and a triangle it is about, or UINT64_MAX.
	 */
	uint64_t limit, actual;
	char text[160]; /* one clause in English, ASCII, never a copy of user bytes */
};

/*
 * mp_fail(err, code, byte, fmt, ...):
 * Fill ${err} (may be NULL) and return -1, so that callers write `return mp_fail(...)`.
 * line, limit and actual are set to 0.
 */
int mp_fail(struct mp_error *err, enum mp_code code, uint64_t byte, const char *fmt, ...)
    __attribute__((format(printf, 4, 5)));

/* The same for text formats: ${line} is 1-based. */
int mp_fail_line(struct mp_error *err, enum mp_code code, uint64_t byte, uint64_t line,
		 const char *fmt, ...) __attribute__((format(printf, 5, 6)));

/* MP_LIMIT with both figures; the text is made by the caller. */
int mp_fail_limit(struct mp_error *err, uint64_t byte, uint64_t limit, uint64_t actual,
		  const char *fmt, ...) __attribute__((format(printf, 5, 6)));

/* MP_NOMEM; always -1. */
int mp_fail_nomem(struct mp_error *err);

#endif
