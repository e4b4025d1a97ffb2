#ifndef MP_NUMBER_PRIVATE_H
#define MP_NUMBER_PRIVATE_H

#include <float.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

/* Eight bytes of text, the first one lowest. */
static inline uint64_t mp_text8(const char *p)
{
	uint64_t v;

	memcpy(&v, p, sizeof v);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
	v = __builtin_bswap64(v);
#endif
	return v;
}

/* Four of them. */
static inline uint32_t mp_text4(const char *p)
{
	uint32_t v;

	memcpy(&v, p, sizeof v);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
	v = __builtin_bswap32(v);
#endif
	return v;
}

/* Digit values to the number they spell: pairs, then fours, then all eight. */
static inline uint64_t mp_digits8(uint64_t digit)
{
	const uint64_t fours = UINT64_C(0x000000ff000000ff);

	digit = digit * 10 + (digit >> 8);
	return (((digit & fours) * (100 + (UINT64_C(1000000) << 32))) +
		((digit >> 16 & fours) * (1 + (UINT64_C(10000) << 32)))) >>
	       32;
}

/*
 * ${digit}: text as of mp_text8() xor MP_ZEROS8, so that digits have become their values.  The
 * lowest bit set is bit 7 of the first byte that was no digit; what is above means nothing.  0: all
 * are digits.
 */
#define MP_ZEROS8 UINT64_C(0x3030303030303030)
static inline uint64_t mp_not_digits8(uint64_t digit)
{
	return ((digit + UINT64_C(0x7676767676767676)) | digit) & UINT64_C(0x8080808080808080);
}

/* mp_digits8() of those below the bit that mp_not_digits8() found: the others move out at the top.
 */
static inline uint64_t mp_digits_below(uint64_t digit, uint64_t odd)
{
	return mp_digits8(digit << (__builtin_ctzll(odd) ^ 63) << 8);
}

/* The same of the first ${n} of them, 0 to 8. */
static inline uint64_t mp_digits_of(uint64_t digit, unsigned n)
{
	return mp_digits8(digit << (32 - 4 * n) << (32 - 4 * n));
}

#ifdef __SSE2__
/* Sixteen bytes of text; what comparing them gives; a bit for each byte that is not 0 of that. */
typedef unsigned char mp_text16 __attribute__((vector_size(16)));
typedef char mp_found16 __attribute__((vector_size(16)));

static inline mp_text16 mp_load16(const char *p)
{
	mp_text16 v;

	memcpy(&v, p, sizeof v);
	return v;
}

static inline unsigned mp_bits16(mp_found16 found)
{
	return (unsigned)__builtin_ia32_pmovmskb128(found);
}
#endif

/* Bit i is set where p[i] is no digit, of 64 bytes. */
static inline uint64_t mp_not_digits64(const char *p)
{
	uint64_t bits = 0;

#ifdef __SSE2__
	for (int i = 0; i < 4; i++)
		bits |= (uint64_t)mp_bits16((mp_found16)(mp_load16(p + 16 * i) - '0' <= 9))
			<< 16 * i;
	return ~bits;
#else
	for (int i = 0; i < 8; i++) {
		const uint64_t low = UINT64_C(0x7f7f7f7f7f7f7f7f);
		uint64_t digit = mp_text8(p + 8 * i) ^ MP_ZEROS8;
		uint64_t not = (((digit & low) + UINT64_C(0x7676767676767676)) | digit) & ~low;

		bits |= (not >> 7) * UINT64_C(0x0102040810204080) >> 56 << 8 * i;
	}
	return bits;
#endif
}

/*
 * mp_number_scan_bytes(p, end, value):
 * Read the common kind of number at the start of [p, end): at most 19 digits, an exponent of at
 * most 4.  Returns where it ends, so that the caller can see what follows, or NULL for
 * anything else, which mp_number_parse() is then asked about.
 */
const char *mp_number_scan_bytes(const char *p, const char *end, double *value);

/* The same where MP_NUMBER_ROOM bytes can be read; NULL for what is not finite, too. */
enum { MP_NUMBER_ROOM = 1 + 8 + 1 + 24 + 7 }; /* sign, whole, point, fraction, exponent */
const char *mp_number_scan_text(const char *p, double *value);

/*
 * What printf prints for %e, behind the sign: d.dddddde+dd and a blank, 13 bytes.  The places of
 * all bytes are known, so that nothing behind has to wait for them.
 */
enum { MP_NUMBER_E = 12 };
static inline __attribute__((always_inline)) bool mp_number_scan_e(const char *p, bool negative,
								   double *value)
{
	/* Digits become their values, the point and e+ become 0. */
	uint64_t digit = mp_text8(p) ^ UINT64_C(0x3030303030302e30), w;
	uint32_t tail = mp_text4(p + 8) ^ UINT32_C(0x30302b65), e;
	uint32_t sign = (uint32_t)(uint8_t)p[9] - '+'; /* 2 for a minus */
	int64_t q;

	if (((digit + UINT64_C(0x7676767676767f76)) | digit) & UINT64_C(0x8080808080808080))
		return false;
	if (((tail | (tail + UINT32_C(0x06060000))) & UINT32_C(0xf0f000df)) |
	    (sign & ~UINT32_C(2)) | ((uint8_t)p[12] > ' '))
		return false;
	w = mp_digits8(digit + 255 * (digit & 15)); /* the first one over the point */
	e = (tail >> 16 & 15) * 10 + (tail >> 24);
	q = (sign ? -(int64_t)e : (int64_t)e) - 6;
	*value = mp_number_compose(w, q, negative);
	return true;
}

/* mp_number_scan_text(), with the most frequent kind of number in an STL inline. */
static inline __attribute__((always_inline)) const char *mp_number_scan(const char *p,
									double *value)
{
	bool negative = *p == '-';

	if (!mp_number_scan_e(p + negative, negative, value))
		return mp_number_scan_text(p, value);
	return p + negative + MP_NUMBER_E;
}

#endif
