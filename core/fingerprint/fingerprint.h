#ifndef MP_FINGERPRINT_H
#define MP_FINGERPRINT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/decoder.h"
#include "core/fingerprint/aes.h"

/*
 * Is a mesh closed and consistently oriented, that is, is every edge used equally often in both
 * directions?  In one pass over its triangles, in any order, in constant memory.
 *
 * f||g, 64 bits each, is a keyed pseudo-random function of a corner's coordinates (-0 = +0), and
 *   S = sum over the triangles of (f1-f0)(g2-g0) - (f2-f0)(g1-g0)  mod 2^64.
 * Each term is w(0,1) + w(1,2) + w(2,0) with w(a,b) = f_a*g_b - f_b*g_a = -w(b,a), so S is the sum
 * over the undirected edges of n(a,b)*w(a,b), n the uses one way less those the other way.  A
 * triangle that names a corner twice adds 0.
 *
 * S != 0 proves that the mesh is not closed and oriented.  If it is not, S = 0 all the same has,
 * for f and g random, a probability of at most 1.5*2^t/2^64, 2^t the highest power of two that
 * divides all n: S is the sum of F_b*g_b with F_b = sum of n(a,b)*f_a; modulo 2 the matrix n/2^t is
 * alternating and not 0, so its rank is at least 2, two of the F_b/2^t are uniform and independent,
 * and P(S = 0) = E(gcd(F, 2^64))/2^64 <= 2^t*(sum of 2^k*(4^-k - 4^-(k+1)))/2^64.  There are two
 * sums with two keys: 2.25*4^t/2^128, which is 2^-126 where some edge is used an odd number of
 * times more one way than the other, as edges of holes and of single reversed triangles are; and as
 * an n of 2^t takes 2^t triangles, never more than 2.25*(triangles/2^64)^2: 2^-64 for the 2^31
 * triangles that may come.
 *
 * The function is AES-128: of x||y||z||tag as floats where all three are exact as such, else twice,
 * CBC-MAC, of the doubles.  No first block of the one kind can be one of the other (the tag would
 * be the high half of a NaN), so it is a pseudo-random function as far as AES is (Petrank and
 * Rackoff 2000, doi:10.1007/s001450010009): beside the above, two of v vertices with the same
 * values in both sums, (v^2/2^128)^2.  The bounds hold for a mesh that was made without knowing the
 * key: it has to be secret and fresh for every mesh, and the sums may not be told.
 */
#define MP_FINGERPRINT_MOST (UINT64_C(1) << 31) /* triangles */

struct mp_fingerprint_kernel;

struct mp_fingerprint {
	/* for this machine; asking it is slow where a hypervisor answers */
	const struct mp_fingerprint_kernel *kernel;
	struct mp_aes key[2];
	uint64_t sum[2];
};

void mp_fingerprint_begin(struct mp_fingerprint *, const uint8_t key[16]);

/* Add ${count} <= MP_BLOCK triangles of finite coordinates (struct mp_sink's form). */
void mp_fingerprint_add(struct mp_fingerprint *, const double (*tri)[9], size_t count);
void mp_fingerprint_add_floats(struct mp_fingerprint *, const float (*xyz)[MP_BLOCK], size_t count);

/* Closed and consistently oriented, but for the probability above? */
bool mp_fingerprint_closed(const struct mp_fingerprint *);

#endif
