#ifndef MP_MOMENTS_KERNEL_H
#define MP_MOMENTS_KERNEL_H

#include <stddef.h>

#include "core/decoder.h"

/*
 * The inner loop of the moment sums, in copies for what the processor can do.  Eight lanes side by
 * side: lane j takes triangles j, j + 8, ...  Every copy does the same operations in the same
 * order, so all of them give the same bits; none may use a fused multiply-add.
 */
enum { MP_LANES = 8 };

/* Sums of a block, a lane each; the meaning of the members is that of struct mp_moments. */
struct mp_lanes {
	double a0[MP_LANES], a1[3][MP_LANES], a2[6][MP_LANES];
	double doubt[MP_LANES], doubt2[3][MP_LANES];
	double n[3][MP_LANES], area2[MP_LANES], area_s[3][MP_LANES], area_doubt[MP_LANES];
};

struct mp_frame {
	double scale[3];  /* powers of two */
	double origin[3]; /* scaled */
	double weight[3]; /* of n_k for areas */
};

struct mp_kernel {
	const char *name;
	/*
	 * Add ${count} triangles to ${sums} (zeroed before) and widen the boxes ${min} and ${max}
	 * of each lane by them.
	 */
	void (*add)(struct mp_lanes *sums, double min[3][MP_LANES], double max[3][MP_LANES],
		    const struct mp_frame *frame, const double (*tri)[9], size_t count);
	/* The same of coordinates that are floats, xyz[k][i] being that of tri[i][k]. */
	void (*add_floats)(struct mp_lanes *sums, double min[3][MP_LANES], double max[3][MP_LANES],
			   const struct mp_frame *frame, const float (*xyz)[MP_BLOCK],
			   size_t count);
};

/* The kernels that this machine can run, the plain one first, the best one last. */
size_t mp_kernel_count(void);
const struct mp_kernel *mp_kernel_get(size_t i);

struct mp_moments;

/* mp_moments_add() with a kernel of one's choice, for tests and benchmarks. */
void mp_moments_add_with(struct mp_moments *, const double (*tri)[9], size_t count,
			 const struct mp_kernel *kernel);
void mp_moments_add_floats_with(struct mp_moments *, const float (*xyz)[MP_BLOCK], size_t count,
				const struct mp_kernel *kernel);

#endif
