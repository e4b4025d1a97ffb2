#ifndef MP_PREDICATES_H
#define MP_PREDICATES_H

#include <stddef.h>

#include "core/decoder.h"

/*
 * Signs that are never wrong: a floating-point filter first, exact arithmetic where it cannot
 * decide (Shewchuk 1997, doi:10.1007/PL00009321; GMP rationals as the last resort).  Arguments are
 * finite.  Cannot fail by rounding, overflow or underflow: any finite doubles.
 */

/* Sign (-1, 0, 1) of twice the signed area of a, b, c in the plane: 1 = counter-clockwise. */
int mp_orient2d(const double a[2], const double b[2], const double c[2]);

/*
 * Sign of det(b-a, c-a, d-a): 1 where ${d} lies on the side to which the normal
 * (b-a)x(c-a) points, -1 on the other, 0 on the plane.
 */
int mp_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/*
 * The same by the filter alone, for callers who count what exact arithmetic costs: MP_UNSURE where
 * the filter cannot tell.
 */
enum { MP_UNSURE = 2 };
int mp_orient2d_filter(const double a[2], const double b[2], const double c[2]);
int mp_orient3d_filter(const double a[3], const double b[3], const double c[3], const double d[3]);

/* 1 if the three points lie on one line (or coincide), else 0. */
int mp_collinear(const double a[3], const double b[3], const double c[3]);

/* How many of ${count} triangles (struct mp_sink's form) have their corners on one line. */
size_t mp_collinear_count(const double (*tri)[9], size_t count);
size_t mp_collinear_count_floats(const float (*xyz)[MP_BLOCK], size_t count);

/* The same by one of the kernels that this machine can run: 0 the plain one, the best one last. */
size_t mp_collinear_kernels(void);
size_t mp_collinear_count_with(size_t kernel, const float (*xyz)[MP_BLOCK], size_t count);

#endif
