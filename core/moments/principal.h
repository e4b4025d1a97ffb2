#ifndef MP_PRINCIPAL_H
#define MP_PRINCIPAL_H

enum mp_symmetry { MP_SYMMETRY_NONE, MP_SYMMETRY_AXIAL, MP_SYMMETRY_SPHERICAL };

struct mp_principal {
	double moments[3];    /* ascending */
	double axes[3][3];    /* unit rows, right-handed */
	double quaternion[4]; /* w x y z, w >= 0: rotates world axes onto the principal ones */
	enum mp_symmetry symmetry;
	double error;       /* the eigenvalues are within this of ${moments}; may be infinite */
	double residual[3]; /* norm of inertia*axis - moment*axis at most; may be infinite */
};

/*
 * mp_principal_find(inertia, tolerance, out):
 * Eigenvalues and axes of the symmetric 3x3 tensor ${inertia} by Jacobi rotations.  e1 and e2 are
 * signed so that their component of largest magnitude is positive, e3 = e1 x e2.  Where a gap
 * between moments is at most ${tolerance} (same unit), the class is axial or spherical and the free
 * axes are chosen by projecting world X, then Y.  Quaternion: Shepperd 1978.
 * Any finite input; scaled inside, so nothing overflows.
 * The errors are found afterwards from what came out (Weyl): they do not rest on how it came about.
 */
void mp_principal_find(const double inertia[3][3], double tolerance, struct mp_principal *out);

#endif
