#ifndef MP_NUMBER_PRIVATE_H
#define MP_NUMBER_PRIVATE_H

#include <float.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The pieces of core/number/number.h, for text decoders that read numbers in place. */

enum { MP_NUMBER_WORD = 64 }; /* a longer word is never one for NaN or infinity */

/* The double nearest to w * 10^q, ties to even; inf or 0 where it leaves the range. */
double mp_number_scale(uint64_t w, int64_t q);

/*
 * A decimal of any length, fed in pieces of any size, in constant memory.  A double is decided by
 * its first 768 significant digits and whether anything but zeros follows.
 */
enum { MP_DECIMAL_DIGITS = 800 };

enum mp_decimal_state { /* what has been read so far */
			MP_DECIMAL_BEGIN,
			MP_DECIMAL_SIGN,
			MP_DECIMAL_WHOLE,
			MP_DECIMAL_POINT, /* no digit yet */
			MP_DECIMAL_FRACTION,
			MP_DECIMAL_E,
			MP_DECIMAL_E_SIGN,
			MP_DECIMAL_EXPONENT,
			MP_DECIMAL_BAD
};

struct mp_decimal { /* 0.d1 d2 d3 ... * 10^(point + exponent) */
	enum mp_decimal_state state;
	bool negative, negative_exponent;
	bool sticky;    /* a digit behind the kept ones was not 0 */
	uint32_t count; /* digits kept; the first is not 0 */
	int64_t point, exponent;
	uint8_t digit[MP_DECIMAL_DIGITS]; /* 0..9 */
};

void mp_decimal_begin(struct mp_decimal *);
void mp_decimal_feed(struct mp_decimal *, const char *text, size_t len);
/* 0 and the double nearest to all that was fed, or -1 where that is no number. */
int mp_decimal_finish(const struct mp_decimal *, double *value);

static inline bool mp_is_digit(char c)
{
	return (unsigned)(unsigned char)c - '0' < 10;
}

static inline unsigned mp_digit(char c)
{
	return (unsigned)(unsigned char)c - '0';
}

/* Clinger's fast path: both factors and so, but for one rounding, the result are exact. */
static inline double mp_number_compose(uint64_t w, int64_t q, bool negative)
{
	static const double power[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
					 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
					 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
	static const double sign[2] = {1.0, -1.0}; /* signs cannot be foreseen: no branch */
	double v;

	if (FLT_EVAL_METHOD == 0 && w <= (uint64_t)1 << 53 && q >= -22 && q <= 22)
		v = q < 0 ? (double)w / power[-q] : (double)w * power[q];
	else
		v = mp_number_scale(w, q);
	return v * sign[negative];
}

/*
 * mp_number_scan(p, end, stopped, value):
 * Read the common kind of number at the start of [p, end): at most 19 digits, an exponent of at
 * most 4.  Returns where it ends, so that the caller can see what follows, or NULL for
 * anything else, which mp_number_parse() is then asked about.  ${stopped}, a constant: *end may
 * be read and is a blank, which saves looking for the end at every byte.
 */
static inline __attribute__((always_inline)) const char *
mp_number_scan(const char *p, const char *end, bool stopped, double *value)
{
	bool negative = (stopped || p < end) && *p == '-';
	uint64_t w = 0;
	int64_t q = 0;
	const char *first;
	ptrdiff_t digits;

	p += negative || ((stopped || p < end) && *p == '+');
	for (first = p; (stopped || p < end) && mp_is_digit(*p); p++)
		w = w * 10 + mp_digit(*p); /* may wrap, then there are over 19 digits */
	digits = p - first;
	if ((stopped || p < end) && *p == '.') {
		for (first = ++p; (stopped || p < end) && mp_is_digit(*p); p++)
			w = w * 10 + mp_digit(*p);
		q = first - p;
		digits += p - first;
	}
	if (digits < 1 || digits > 19)
		return NULL;
	if ((stopped || p < end) && (*p | 0x20) == 'e') {
		bool minus = (++p, stopped || p < end) && *p == '-';
		int64_t e = 0;

		p += minus || ((stopped || p < end) && *p == '+');
		for (first = p; (stopped || p < end) && mp_is_digit(*p) && p - first < 5; p++)
			e = e * 10 + mp_digit(*p);
		if (p == first || p - first > 4)
			return NULL;
		q += minus ? -e : e;
	}
	*value = mp_number_compose(w, q, negative);
	return p;
}

#endif
