#ifndef MP_SIGNS_H
#define MP_SIGNS_H

#include <stdbool.h>
#include <stdint.h>

/*
 * Work that is counted rather than timed, so that the same mesh ends the same way everywhere.  A
 * step is at most some 5 ns: a box compared with another; the rest is charged by what it takes.
 */
struct mp_work {
	uint64_t left;
	uint32_t exact; /* what a sign costs that no filter can tell: MP_WORK_* */
};

enum {
	MP_WORK_SIGN = 4,
	MP_WORK_EXACT = 120,  /* floating-point expansions */
	MP_WORK_WIDE = 2500,  /* integers of thousands of bits: coordinates below or above 2^300 */
	MP_WORK_TRIANGLES = 8 /* two triangles fetched and compared */
};

static inline void mp_work_spend(struct mp_work *w, uint64_t steps)
{
	w->left = w->left > steps ? w->left - steps : 0;
}

/* mp_orient3d(), mp_orient2d() of the axes ${axis}[0] and [1]; right even where no work is left. */
int mp_sign3(struct mp_work *, const double a[3], const double b[3], const double c[3],
	     const double d[3]);
int mp_sign2(struct mp_work *, const uint8_t axis[2], const double a[3], const double b[3],
	     const double c[3]);

/*
 * Two axes on which the triangle has an area, whose sign is returned; 0: it is degenerate.  The
 * sign of any mp_sign2() in the triangle's plane times this one is that seen from where the
 * triangle runs counter-clockwise.
 */
int mp_sign_axes(struct mp_work *, const double tri[3][3], uint8_t axis[2]);

#endif
