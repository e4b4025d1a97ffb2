#ifndef MP_NUMBER_H
#define MP_NUMBER_H

#include <stddef.h>
#include <stdint.h>

/*
 * mp_number_parse(text, len, value):
 * Read the whole of ${text} as one decimal number: [+-] digits [. digits] [(e|E|d|D) [+-] digits],
 * at least one digit in the significand.  Also, in any case and with a sign, nan, nan(...), inf,
 * infinity and the Microsoft library's 1.#IND, 1.#QNAN, 1.#SNAN, 1.#INF, so that the caller can
 * refuse them by name.  ${*value} is the double nearest to the decimal (ties to even);
 * too large gives +-inf, too small +-0 or a subnormal.  Any length, bounded time: O(len).
 * Locale-free.  Return 0, or -1 with ${*value} as it was where the text is no number (empty,
 * blanks, a letter behind it, hexadecimal, ...).
 *
 * Clinger 1990 (fast path), Lemire 2021 doi:10.1002/spe.2984 (Eisel-Lemire), exact comparison of
 * big integers where those two cannot decide.  Allocates nothing, thread-safe.
 */
int mp_number_parse(const char *text, size_t len, double *value);

/*
 * mp_number_power(q, top):
 * 10^${q}, -342 <= q <= 308, is about (2^64*top[0] + top[1]) * 2^e, where e is returned and the
 * highest bit of top[0] is set: off by less than one unit of top[1], exact for 0 <= q <= 55.
 */
int mp_number_power(int q, uint64_t top[2]);

#endif
