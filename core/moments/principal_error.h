#ifndef MP_PRINCIPAL_ERROR_H
#define MP_PRINCIPAL_ERROR_H

/* What an eigenvalue decomposition may be off by, judged from its result alone; rounded upwards. */

/* The norm of inertia*axis - moment*axis. */
long double mp_principal_residual(const double inertia[3][3], const double axis[3], double moment);

/*
 * How far the eigenvalues, in ascending order, are from ${moments}, ascending too.  ${axes}: rows,
 * nearly orthonormal.
 */
long double mp_principal_error(const double inertia[3][3], const double axes[3][3],
			       const double moments[3]);

#endif
