#ifndef MP_UNCERTAINTY_KERNEL_H
#define MP_UNCERTAINTY_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/topology/topology.h"

/*
 * The inner loop of the uncertainty, in copies for what the processor can do.  Every copy does the
 * same operations in the same order, so all of them give the same bits.  Lanes are the coordinates
 * of a vertex that are moved, in the order z, x, y, in which cross products come out of vectors;
 * the last one is not used.
 */
enum { MP_DEVIATION_LANES = 4, MP_DEVIATION_ROWS = 3 };

/* By axis (x, y, z) or by lane (z, x, y), with a 0 behind. */
struct mp_deviation_frame {
	const float
	    *narrow; /* the coordinates as they are kept: one of these, with one more behind */
	const double *wide;
	double origin[4]; /* by axis: what the first moments are about */
	double scale[4];  /* by axis: powers of two by which the box is about 1 wide */
	double ulp[4];    /* by lane, scaled: half the step of float32 at 1 and above; 0 for none */
	double step[4];   /* by lane, scaled: half a step; 0 for none */
	bool turned;
	double turn[3][3]; /* if turned: from the three moments to those that are wanted */
};

/*
 * Sums over vertices of h^2 times: the square of the volume's derivative V; V times that of each
 * moment M; the square of each M.  In h, V and M lengths are scaled; V is 6 times what it is
 * called, M 24 times.
 */
struct mp_deviation_sums {
	double vv[MP_DEVIATION_LANES], vm[MP_DEVIATION_ROWS][MP_DEVIATION_LANES],
	    mm[MP_DEVIATION_ROWS][MP_DEVIATION_LANES];
};

struct mp_deviation_kernel {
	const char *name;
	void (*add)(struct mp_deviation_sums *, const struct mp_deviation_frame *,
		    const struct mp_links *);
};

/* The kernels that this machine can run, the plain one first, the best one last. */
size_t mp_deviation_kernel_count(void);
const struct mp_deviation_kernel *mp_deviation_kernel_get(size_t i);

#endif
