#ifndef MP_MOMENTS_H
#define MP_MOMENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/decoder.h"
#include "core/moments/ball.h"

/*
 * Moment sums over the triangles of a mesh, edge form about a reference near the mesh:
 * q = (vertex - reference)*scale, n = (b-a)x(c-a), d = a.n, s = a+b+c,
 * A0 = sum d, A1 = sum d*s, A2ij = sum d*(ai*aj + bi*bj + ci*cj + si*sj), the last computed as
 * (a+b)i*(a+b)j + (b+c)i*(b+c)j + (c+a)i*(c+a)j, which is the same and shorter.
 * Divergence theorem over signed tetrahedra (Eberly, Polyhedral Mass Properties; Kallay 2006,
 * doi:10.1080/2151237X.2006.10129220).  Compensated (TwoSum) over blocks of MP_BLOCK
 * triangles; within a block rounds of 64 in eight interleaved lanes (lane j takes triangles j,
 * j+8, ...), folded in a fixed order, so that every kernel gives the same bits.
 * The doubts are sums of magnitudes from which bounds.h derives what rounding can have done.
 */
struct mp_sum {
	double hi, lo; /* the value is hi + lo */
};

struct mp_moments {
	double reference[3]; /* the first vertex that came, unless given */
	double scale[3];     /* powers of two; of an axis, so that a needle fills its box too */
	bool started;        /* reference is set */
	uint64_t triangles, blocks;
	struct mp_sum a0, a1[3], a2[6]; /* a2: xx yy zz xy yz zx */
	struct mp_sum doubt;            /* sum of g = 8*|a_k|*(|products in n_k|) + 24*|d| */
	struct mp_sum doubt2[3];        /* sum of g*(ai*ai + bi*bi + ci*ci + si*si) */
	struct mp_sum vector_area[3];   /* sum n */
	struct mp_sum area2, area_s[3]; /* sum |m|, sum |m|*s; m_k = n_k*scale_k/largest scale */
	struct mp_sum area_doubt;       /* sum of (|products in n_k|)*scale_k/largest scale */
	double min[3], max[3];          /* box of the vertices, file units; -0 is given as 0 */
};

/* Start about the first vertex, unscaled: what nearly every mesh needs. */
void mp_moments_begin(struct mp_moments *);

/*
 * Start the second pass over a mesh whose first one, ${first}, asked for it: about the centroid
 * of the surface, which no stray vertex pulls away, and with every axis of the box scaled to
 * about 1, so that no product leaves the range of a double.
 */
void mp_moments_begin_again(struct mp_moments *, const struct mp_moments *first);

/* Add ${count} <= MP_BLOCK triangles as one block (struct mp_sink's form).  Cannot fail. */
void mp_moments_add(struct mp_moments *, const double (*tri)[9], size_t count);
void mp_moments_add_floats(struct mp_moments *, const float (*xyz)[MP_BLOCK], size_t count);

/* As though every triangle had been wound the other way. */
void mp_moments_flip(struct mp_moments *);

/*
 * What the sums say of the solid, density 1, in file units.  long double for its range (a volume
 * of 1e500 is still a number here; what a double can hold is judged where one is written) and so
 * that the digits of the result are those of the sums.
 */
struct mp_solid {
	long double volume;      /* signed [L^3]; 0 where it is not proven to differ from 0 */
	long double centroid[3]; /* [L]; 0 unless has_centroid */
	long double cov[6];      /* central second moments over volume [L^2] xx yy zz xy yz zx */
	long double area;        /* [L^2] */
	/* how far each is from the exact value of these very triangles at most, in its unit */
	long double volume_bound, centroid_bound[3], cov_bound[6], area_bound;
	/*
	 * Without a centroid: its integrals of x and of x*x about ${reference} [L^4, L^5], for the
	 * whole of which it is a part.  They need not be 0: two parts wound against each other.
	 */
	long double reference[3];
	struct mp_ball first[3], second[6];
	long double surface_centroid[3]; /* [L]; 0 unless has_surface_centroid */
	long double vector_area[3];      /* sum of n/2 [L^2]; 0 where it is within rounding of 0 */
	bool has_centroid;               /* volume is not 0 */
	bool has_surface_centroid;       /* area is not 0 */
	bool in_range; /* false: some product left the range of a double; only area may be used */
	bool area_in_range;
	bool area_again; /* the area wants a second pass */
	bool again;      /* that, or the volume does: out of range, or a reference far away */
};

/*
 * mp_moments_solve(moments, out):
 * Quotients are formed before products.  The volume counts as 0 where the sums cannot tell it from
 * 0 by their own error bound.  So a sheet with two sides has volume 0 exactly, tilted or not.
 */
void mp_moments_solve(const struct mp_moments *, struct mp_solid *out);

/*
 * Solids merged into the one they make together, each summed about its own reference, so that
 * small parts far apart lose nothing.  ${origin}: a point near them [L].
 */
struct mp_merge {
	long double origin[3];
	struct mp_ball volume, first[3], second[6];
};
void mp_merge_begin(struct mp_merge *, const long double origin[3]);
void mp_merge_add(struct mp_merge *, const struct mp_solid *part);
void mp_merge_solve(const struct mp_merge *, struct mp_solid *io); /* volume, centroid, cov */

#endif
