#include <math.h>

#include "core/number/number_private.h"

const char *mp_number_scan_bytes(const char *p, const char *end, double *value)
{
	bool negative = p < end && *p == '-';
	uint64_t w = 0;
	int64_t q = 0;
	const char *first;
	ptrdiff_t digits;

	p += negative || (p < end && *p == '+');
	for (first = p; p < end && mp_is_digit(*p); p++)
		w = w * 10 + mp_digit(*p); /* may wrap, then there are over 19 digits */
	digits = p - first;
	if (p < end && *p == '.') {
		for (first = ++p; p < end && mp_is_digit(*p); p++)
			w = w * 10 + mp_digit(*p);
		q = first - p;
		digits += p - first;
	}
	if (digits < 1 || digits > 19)
		return NULL;
	if (p < end && (*p | 0x20) == 'e') {
		bool minus = ++p < end && *p == '-';
		int64_t e = 0;

		p += minus || (p < end && *p == '+');
		for (first = p; p < end && mp_is_digit(*p) && p - first < 5; p++)
			e = e * 10 + mp_digit(*p);
		if (p == first || p - first > 4)
			return NULL;
		q += minus ? -e : e;
	}
	*value = mp_number_compose(w, q, negative);
	return p;
}

/* Behind the point: the digits of ${*w} become more.  NULL: too many. */
static inline const char *scan_fraction(const char *p, uint64_t *w)
{
	static const uint32_t power[8] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000};
	uint64_t digit = mp_text8(p) ^ MP_ZEROS8, odd = mp_not_digits8(digit);
	int full;

	for (full = 0; odd == 0; full++) {
		if (full == 2)
			return NULL;
		*w = *w * 100000000 + mp_digits8(digit);
		digit = mp_text8(p += 8) ^ MP_ZEROS8;
		odd = mp_not_digits8(digit);
	}
	*w = *w * power[__builtin_ctzll(odd) >> 3] + mp_digits_below(digit, odd);
	return p + (__builtin_ctzll(odd) >> 3);
}

/* Behind the e: up to 4 digits. */
static inline const char *scan_exponent(const char *p, int64_t *q)
{
	bool minus = *p == '-';
	const char *first = p += minus || *p == '+';
	int64_t e = 0;

	for (; mp_is_digit(*p) && p - first < 5; p++)
		e = e * 10 + mp_digit(*p);
	*q += minus ? -e : e;
	return p == first || p - first > 4 ? NULL : p;
}

const char *mp_number_scan_text(const char *p, double *value)
{
	bool negative = *p == '-';
	const char *first;
	ptrdiff_t digits;
	uint64_t w = 0;
	int64_t q = 0;

	p += negative || *p == '+';
	for (first = p; mp_is_digit(*p) && p - first < 8; p++)
		w = w * 10 + mp_digit(*p);
	digits = p - first;
	if (*p == '.') {
		first = ++p;
		p = scan_fraction(p, &w); /* may wrap, then there are over 19 digits */
		if (p == NULL)
			return NULL;
		q = first - p;
		digits += p - first;
	}
	if (digits < 1 || digits > 19)
		return NULL;
	if ((*p | 0x20) == 'e') {
		p = scan_exponent(p + 1, &q);
		if (p == NULL)
			return NULL;
	}
	*value = mp_number_compose(w, q, negative);
	return isfinite(*value) ? p : NULL;
}
