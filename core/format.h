#ifndef MP_FORMAT_H
#define MP_FORMAT_H

#include "core/analysis.h"

/* Which decoder a file goes to, judged from its first bytes alone, never from a name or a length.
 */

enum { MP_SNIFF_BYTES = 4096 }; /* collected before judging; a shorter file is judged whole */

/*
 * Draco by its magic and a version that exists, OBJ where the first line that says something is an
 * OBJ statement or where there are only comments; everything else is for the STL decoder, which
 * refuses what it does not know.  ${len} is
 * MP_SNIFF_BYTES, or the whole file.
 */
enum mp_format_wish mp_format_sniff(const uint8_t *head, size_t len);

/* The decoder of a format; not of MP_WISH_AUTO. */
const struct mp_decoder_ops *mp_format_decoder(enum mp_format_wish format);

#endif
