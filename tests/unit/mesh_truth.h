#ifndef MESH_TRUTH_H
#define MESH_TRUTH_H

#include <gmp.h>

#include "tests/unit/mesh_make.h"

/*
 * What a closed mesh is, in whole numbers: each coordinate is one times a power of two, so the sums
 * are exact, and every result is a quotient of two of them.  Of square roots and eigenvalues as
 * many digits as anybody may want.
 */
struct truth_quotient {
	mpf_t num, den; /* exact; den > 0 */
};

struct truth {
	int sign; /* of the volume; the fields below but volume and area are set only if not 0 */
	struct truth_quotient volume, mass;
	struct truth_quotient centroid[3];
	struct truth_quotient central[3][3], about_origin[3][3]; /* tensors of inertia */
	mpf_t area;
	mpf_t moment[3], radius[3]; /* ascending; a radius whose square is negative is 0 */
	mpf_t axis[3][3];           /* rows, of length 1 */
};

/* Of what density?  All exact; a mass of 0: not weighed. */
struct truth_density {
	double value, divisor, mass;
};

void truth_init(struct truth *);
void truth_clear(struct truth *);
void truth_find(struct truth *, const struct mesh *, const struct truth_density *);

/* Of the mesh mapped by x -> row[i][0..2].x + row[i][3]; mirrored, it is wound the other way. */
void truth_find_mapped(struct truth *, const struct mesh *, const double row[3][4],
		       const struct truth_density *);

/* Moments, radii and axes from the central tensor and the mass; truth_find() calls it. */
void truth_find_principal(struct truth *);

/*
 * |x - exact| over ${bound}, above 1 if and only if it is; 0 where x is exact, else infinite where
 * the bound is 0.
 */
double truth_over(const mpf_t error, const mpf_t most);
double truth_ratio(const struct truth_quotient *exact, double x, double bound);
double truth_ratio_root(const mpf_t exact, double x, double bound);

/* The sine of the angle between two lines. */
double truth_sine(mpf_t axis[3], const double other[3]);

#endif
