#ifndef MP_AFFINE_H
#define MP_AFFINE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/bodies/nesting.h"
#include "core/error.h"
#include "core/moments/moments.h"
#include "core/topology/topology.h"

/*
 * The request's affine map x -> L x + t, its numbers taken as exact.  An invertible map changes
 * neither which vertices are one nor which edges are used how often nor what lies in what, so
 * everything up to the sums is done on the file's coordinates and loses nothing; only what is
 * measured or shown is mapped.  Where the determinant is negative every triangle counts as wound
 * the other way (its second and third corner change places), so that a mirrored solid stays
 * outward; the sign of volumes is that of the file.
 */
struct mp_affine {
	double row[3][4]; /* L and behind it t [L], -0 as 0 */
	bool mirrors;     /* the determinant is negative */
	/*
	 * L is a change of axes and signs times ${factor} > 0 (0 otherwise): it keeps the ratio of
	 * all areas.
	 */
	double factor;
	struct mp_ball size; /* |determinant| */
};

/* Finite ${row}.  false: the determinant is 0, exactly, and there is no such map. */
bool mp_affine_set(struct mp_affine *, const double row[3][4]);

/* L 1, t 0. */
bool mp_affine_is_identity(const struct mp_affine *);

/*
 * The image of ${x}: each coordinate is the double nearest to the exact one.  false: one is beyond
 * DBL_MAX.  ${out} may be ${x}.
 */
bool mp_affine_point(const struct mp_affine *, const double x[3], double out[3]);

/*
 * The box of the images of all corners of the triangles order[0 .. count), or 0 .. count where
 * ${order} is NULL; each number is the double nearest to the exact one.  false as above.
 */
bool mp_affine_box(const struct mp_affine *, const struct mp_mesh *mesh, const uint32_t *order,
		   uint32_t count, struct mp_box *out);

/* The same of all vertices that there are. */
bool mp_affine_box_of_all(const struct mp_affine *, const struct mp_vertices *vertices,
			  struct mp_box *out);

/*
 * Volume, centroid and cov of ${io} as of the mapped solid, with their bounds; the volume may be a
 * mass.  What it has instead of a centroid (first, second, reference) is left in the file's frame.
 */
void mp_affine_solid(const struct mp_affine *, struct mp_solid *io);

/*
 * Area with its bound, surface centroid and vector area of ${io} as of the triangles
 * order[0 .. count) of ${mesh}, or 0 .. count where ${order} is NULL, mapped.  ${box}: theirs in
 * the file.  Goes through the triangles again unless the map has a factor.
 *
 * The bound, u = 2^-53, terms of second order within 2^-20 of the others: normals n = e x f come
 * with 4u t, t_k = (|products in n_k|), as in bounds.h.  They are mapped by W = |det L| L^-T, whose
 * elements are doubles within w of the exact ones; three products and two sums lose 3u of
 * |W| |n| at most, so |dm_i| <= sum_k (7u |W_ik| + w_ik) t_k and the length loses that and 3u more.
 * The sums are compensated: u for each block and u for the whole.  Underflow: as in bounds.h, in
 * axes scaled to 1.
 */
void mp_affine_area(const struct mp_affine *, const struct mp_mesh *mesh, const uint32_t *order,
		    uint32_t count, const struct mp_box *box, struct mp_solid *io);

#endif
