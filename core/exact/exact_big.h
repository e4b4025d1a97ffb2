#ifndef MP_EXACT_BIG_H
#define MP_EXACT_BIG_H

#include <gmp.h>
#include <stdint.h>

/*
 * Binary numbers of any length that a computation on doubles needs: sign * integer * 2^exponent,
 * exactly.  GMP's mpn layer does the work in place: nothing is allocated, so nothing can fail or
 * abort, as GMP's own mpz would when memory is out.
 *
 * How long they get, all finite doubles being integers of 2098 bits times 2^-1074 at most:
 * differences 2100 bits, A0 6335, A1 8437, A2 10539 with 2^32 triangles; numerators of second
 * moments (see exact_solve.c) 16880; those of a moment about an axis, with two components of its
 * direction, 21080; times a factor of 53 bits or 6335 + 9 in numerators or denominators of at most
 * 17000: 21200.  To be divided, either number is shifted to 116 bits more than the other.
 *
 * An affine map (exact_map.c) multiplies by its determinant, 6300 bits, and its entries, 2100 each:
 * A0 12640, A1 16840, A2 21040; numerators of second moments 33790; about an axis 38100, and the
 * denominator of a radius 29700.  Only what is in use costs time.
 */
enum { MP_BIG_LIMBS = 640 };

struct mp_big {
	int sign; /* -1, 0, 1 */
	int exponent;
	int n;                     /* limbs in use, the top one not zero; 0 for zero */
	mp_limb_t d[MP_BIG_LIMBS]; /* lowest first */
};

void mp_big_set(struct mp_big *, int sign, uint64_t size, int exponent);
void mp_big_set_i64(struct mp_big *, int64_t x, int exponent);
void mp_big_set_double(struct mp_big *, double x); /* finite */
/* From ${n} limbs, of which the top ones may be zero. */
void mp_big_set_limbs(struct mp_big *, int sign, const uint64_t *limb, int n, int exponent);
void mp_big_copy(struct mp_big *out, const struct mp_big *);

/* out = a + side*b, side -1 or 1; ${out} may be ${a} or ${b}. */
void mp_big_add(const struct mp_big *a, const struct mp_big *b, int side, struct mp_big *out);
/* out = a*b; ${out} is neither. */
void mp_big_mul(const struct mp_big *a, const struct mp_big *b, struct mp_big *out);
/* io *= factor > 0 */
void mp_big_scale(struct mp_big *io, unsigned factor);

/* Of the integer: 0 for 0, else 1 + floor of its binary logarithm. */
int mp_big_bits(const struct mp_big *);

/* The ${n} limbs ${a} << shift; returns their number, the top one not zero.  Room: see above. */
int mp_big_shift(const mp_limb_t *a, int n, unsigned shift, mp_limb_t *out);

#endif
