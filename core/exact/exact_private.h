#ifndef MP_EXACT_PRIVATE_H
#define MP_EXACT_PRIVATE_H

#include "core/exact/exact.h"
#include "core/exact/exact_big.h"
#include "core/exact/wideint.h"

/* The algorithms behind exact.h, one a file, and what its tests look at. */

enum { MP_EXACT_BLOCK = 128 }; /* triangles at a time, so that the work stays in the L1 cache */

/*
 * exact_fixed.c: add ${count} <= MP_EXACT_BLOCK triangles, corners as q of struct mp_exact_axis
 * with |q| <= 2^(bits - 1), 1 <= bits <= 62, to the sums.
 */
void mp_exact_fixed_add(struct mp_fixed sum[MP_EXACT_SUMS], unsigned bits, const int64_t (*tri)[9],
			size_t count);

/*
 * exact_digits.c: add a triangle whose coordinates lie on a grid 2^54 times as fine; false if they
 * do not.  The sums are digits of 60 bits, sum[...][i] counting 2^(60*i) of the finer units.
 */
enum { MP_EXACT_COLUMNS = 10 };

bool mp_exact_digits_add(mp_i128 sum[MP_EXACT_SUMS][MP_EXACT_COLUMNS], const struct mp_exact_grid *,
			 const double tri[9]);

/* Such a sum of products of ${coordinates} coordinates; ${unit}: exponent on the grid itself. */
void mp_exact_digits_get(const mp_i128 sum[MP_EXACT_COLUMNS], int unit, int coordinates,
			 struct mp_big *out);

/* exact_gmp.c: add a triangle of finite doubles, any. */
void mp_exact_gmp_add(struct mp_big sum[MP_EXACT_SUMS], const struct mp_exact_axis axis[3],
		      const double tri[9]);

/* exact.c: sum number ${i} of ${from}. */
void mp_exact_get(const struct mp_exact *from, int i, struct mp_big *out);

/* exact.c: the coordinate on axis ${k} of the point that the sums are about. */
void mp_exact_get_origin(const struct mp_exact *from, int k, struct mp_big *out);

/*
 * exact.c: give the ten sums, and behind them the point that they are about if ${mapped}, their
 * memory; what ${out} had before is not looked at.  -1: ${out} is unchanged.
 */
int mp_exact_pack(const struct mp_exact_axis axis[3], bool mapped,
		  const struct mp_big sum[MP_EXACT_SUMS + 3], struct mp_exact *out,
		  struct mp_error *err);

/*
 * exact_round.c: num/den, and its square root, rounded to nearest, ties to even; den > 0.
 * ${tiny}: may be subnormal or 0 though the exact value is not 0; else that is not defined.
 */
void mp_exact_round_quotient(const struct mp_big *num, const struct mp_big *den, bool tiny,
			     struct mp_exact_value *out);
void mp_exact_round_root(const struct mp_big *num, const struct mp_big *den,
			 struct mp_exact_value *out); /* not defined if negative */

#endif
