#ifndef MP_BOUNDS_H
#define MP_BOUNDS_H

#include "core/moments/ball.h"
#include "core/moments/moments.h"
#include "core/report/report.h"

/*
 * Rigorous a-posteriori bounds of the arithmetic: how far a result is at most from the exact value
 * of the mesh as stored.  Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapters 3
 * and 4.  u = 2^-53; d, e, n, q, s and so on as in moments.h.
 *
 * 1. One triangle.  Every operation loses at most u of its result, so of
 *      d = sum a_k n_k, n = e x f, p = sum |a_k|(|products in n_k|)
 *    edges lose u each, a product u, the difference u, a_k u, its product u, the sum 2u: in all
 *    |dd| <= 8u p.  s = a + (b + c) and m = uu + ww + vv (u = a + b, w = c + a, v = b + c)
 *    are within 3u sqrt(W_i) and 9u sqrt(W_i W_j), where
 *      W_i = ai ai + bi bi + ci ci + si si = ui ui + wi wi + vi vi,
 *    by Cauchy and Schwarz: |si| and the norm of (ui, vi, wi) are at most sqrt(W_i), the norm of
 *    (|ai|+|bi|, |bi|+|ci|, |ci|+|ai|) at most 2 sqrt(W_i).  With the product's own u:
 *      |d(d s_i)| <= u (8p + 4|d|) sqrt(W_i), |d(d m_ij)| <= u (8p + 10|d|) sqrt(W_i W_j).
 * 2. A block.  A term takes part in 13 additions that round (8 to a lane, 4 rounds, 3 folds; the
 *    first to a lane and to a round is exact): 13u of the sum of |terms|.  So with
 *    g = 8p + 24|d| the error of a block is u times sum g, sum g sqrt(W_i), sum g sqrt(W_i W_j).
 * 3. n blocks.  TwoSum loses nothing but the rounding of the sum of its errors, each of which is at
 *    most u of a partial sum: n^2 u^2 of the sum of |terms|.
 * 4. The sums of g sqrt(W_i W_j) are not formed: sqrt(sum g W_i * sum g W_j) is not less, again by
 *    Cauchy and Schwarz.  Rounding in the doubts themselves and terms of second order are less
 *    than 2^-20 of them.
 * 5. Area.  n_k is within 4u of t_k = (|products in n_k|), its length of that and 3u more, and 13u
 *    for the block: 4u sum t + 16u sum |n|.
 * 6. Underflow.  A product loses at most h/2, h = 2^-1074, scaling a vertex too.  With everything
 *    within B >= 1 (q, e, f), a triangle loses 32 h B^2, 128 h B^3, 1024 h B^4, and in the area
 *    sqrt(3/2 h) + 16 h B.
 * From the sums on, quotients, the shift to the centroid, merging and the change to mass units are
 * done in balls (ball.h), the last rounding to a double included.
 *
 * Each result is compared with the ball that holds its exact value, however it was computed.
 *
 * 7. Principal moments: an eigenvalue moves by at most the norm of what its tensor moved by
 *    (Weyl), plus what the Jacobi rotations left (mp_principal_find()).  Axes: the sine of the
 *    angle is at most the norm of the residual over the gap (Davis and Kahan 1970,
 *    doi:10.1137/0707001).
 */
struct mp_sum_errors {
	long double a0, a1[3], a2[6], area2; /* of the sums of struct mp_moments, scaled as they */
};
void mp_bounds_of_sums(const struct mp_moments *, struct mp_sum_errors *out);

/*
 * How far (in norm) ${inertia} is at most from the exact tensor about the centroid of a mass of
 * ${mass} that is spread like ${solid}.
 */
double mp_bounds_of_tensor(const struct mp_solid *solid, struct mp_ball mass,
			   const double inertia[3][3]);

/* The bounds of principal moments, axes and radii for a tensor that is ${tensor} (in norm) off. */
void mp_bounds_of_principal(double tensor, struct mp_ball mass, struct mp_report *report);

/*
 * Fill report->bounds for what the report holds.  ${whole}: the solid; ${heavy}: the same with the
 * mass in the place of the volume where densities differ, else ${whole}; ${mass}: its mass.
 */
void mp_bounds_find(const struct mp_solid *whole, const struct mp_solid *heavy, struct mp_ball mass,
		    struct mp_report *report);

#endif
