#ifndef MP_PREDICATES_EXACT_H
#define MP_PREDICATES_EXACT_H

/*
 * The exact halves of the predicates, private to predicates.c and its tests: floating-point
 * expansions where no product can leave the range of a double, wide integers elsewhere.  Any
 * finite doubles; nothing is allocated, nothing fails.
 */
int mp_exact_orient2d(const double a[2], const double b[2], const double c[2]);
int mp_exact_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/* The same by integers alone (wide.c). */
int mp_wide_orient2d(const double a[2], const double b[2], const double c[2]);
int mp_wide_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

#endif
