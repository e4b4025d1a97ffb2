#ifndef MP_EXACT_H
#define MP_EXACT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/error.h"
#include "core/topology/topology.h"

/*
 * Volume, centroid and inertia of the stored mesh as exact rational numbers, rounded once: every
 * result is the double nearest to the true value, ties to even.  The sums are integers, so neither
 * the order of triangles or corners nor chunks, workers, compilers or their flags can change a bit.
 *
 * A finite double is an integer times a power of two, and so are the sums of
 * core/moments/moments.h: A0 = sum d, A1 = sum d*s, A2ij = sum d*((a+b)i*(a+b)j + (b+c)i*(b+c)j +
 * (c+a)i*(c+a)j) with d = a.((b-a)x(c-a)), s = a+b+c and corners about a common origin.  Triangles
 * whose coordinates lie on a grid of 62 bits an axis go through integers of fixed width
 * (exact_fixed.c), those on one of 116 bits through integers of twice that width (exact_digits.c),
 * the others through GMP (exact_gmp.c); one mesh may need them all.  For a mesh that is closed the
 * results do not depend on the origin; for any other they mean nothing.
 */

/* On the axis, a coordinate x is (origin + q)*2^exponent, |q| <= 2^(bits - 1). */
struct mp_exact_axis {
	int exponent;
	int64_t origin;
};

#define MP_EXACT_OFF INT64_MIN /* as first coordinate: the vertex is not on the grid */

struct mp_exact_grid {
	struct mp_exact_axis axis[3];
	/*
	 * 1..62: of the widest axis; up to 30 and up to 50 are faster.  0: no fixed width, every
	 * triangle goes through GMP; never found, for tests to set.
	 */
	unsigned bits;
	bool lossless;      /* no vertex is off the grid */
	double scale[3][2]; /* 2^-exponent in two factors, either of which a double holds */
	int64_t (*q)[3];    /* per vertex */
};

/*
 * mp_exact_grid_find(mesh, out, err):
 * The grid for ${mesh} and any of its bodies, and where on it every vertex is; 24 bytes a vertex.
 * -1: memory is out, nothing to free.
 */
int mp_exact_grid_find(const struct mp_mesh *mesh, struct mp_exact_grid *out, struct mp_error *err);
void mp_exact_grid_free(struct mp_exact_grid *); /* legal on a zeroed struct; zeroes it */

/* The sums A0; A1 x y z; A2 xx yy zz xy yz zx: sign * limbs * 2^exponent [L^3, L^4, L^5]. */
enum { MP_EXACT_SUMS = 10 };

struct mp_exact {
	struct mp_exact_axis axis[3]; /* the sums are about the origin of the grid */
	bool mapped;                  /* they are not: about a point that follows them */
	struct {
		int sign;         /* -1, 0, 1 */
		int exponent;     /* of the lowest limb */
		uint32_t at, end; /* limb[at .. end), lowest first */
	} sum[MP_EXACT_SUMS + 3];
	uint64_t *limb; /* about 400 bytes for ten sums; 14 kB if coordinates span all doubles */
};

/*
 * mp_exact_find(mesh, grid, order, count, out, err):
 * The sums over the triangles order[0..count) of ${mesh}, or 0..count where ${order} is NULL.
 * O(count) time, no memory but the result.  -1: memory is out, nothing to free.
 */
int mp_exact_find(const struct mp_mesh *mesh, const struct mp_exact_grid *grid,
		  const uint32_t *order, uint32_t count, struct mp_exact *out,
		  struct mp_error *err);

/*
 * ${io} += ${part}, found on the same grid and mapped alike: the whole from its bodies.  -1: ${io}
 * is unchanged.
 */
int mp_exact_add(struct mp_exact *io, const struct mp_exact *part, struct mp_error *err);

/*
 * The sums of the mesh as mapped by x -> row[i][0..2].x + row[i][3], its triangles wound the other
 * way where that mirrors, so that the sign of the volume stays.  -1: ${io} is unchanged.
 */
int mp_exact_map(struct mp_exact *io, const double row[3][4], struct mp_error *err);

void mp_exact_free(struct mp_exact *); /* legal on a zeroed struct; zeroes it */

/* -1, 0, 1: whether the volume is negative, exactly 0 or positive. */
int mp_exact_sign(const struct mp_exact *);

/*
 * Results.  A value is the double nearest to the exact one, never -0; it is not defined, and 0,
 * where the exact value is not or a double cannot hold it: beyond DBL_MAX, or not 0 and below
 * DBL_MIN.  Nothing below fails otherwise or allocates; each call takes a few microseconds.
 */
struct mp_exact_value {
	double value;
	double bound; /* |value - exact value| at most: 0, or half a unit in the last place */
	bool defined;
};

/* Of which mass?  A NULL pointer stands for density 1: masses are volumes. */
struct mp_exact_density {
	double value, divisor; /* density = value/divisor [M/L^3]; a divisor of 0 counts as 1 */
	const struct mp_exact *over; /* not NULL: density = value/divisor/|volume of this solid| */
};

/* Signed [L^3]. */
void mp_exact_volume(const struct mp_exact *, struct mp_exact_value *out);
/* [M/L^3]; not defined over a solid of volume 0. */
void mp_exact_density(const struct mp_exact_density *, struct mp_exact_value *out);
/* density*|volume| [M] */
void mp_exact_mass(const struct mp_exact *, const struct mp_exact_density *,
		   struct mp_exact_value *out);

/*
 * Those below are not defined where the volume is 0.  Coordinates and what stands beside the
 * diagonal of a tensor may be as near to 0 as they like: below DBL_MIN they are rounded to the
 * subnormal doubles.
 */

/* [L]; true if all three are defined. */
bool mp_exact_centroid(const struct mp_exact *, struct mp_exact_value out[3]);

/*
 * Central second moments of the volume as signed, integral of (x-cx)_i*(x-cx)_j [L^5], xx yy zz
 * xy yz zx; true if all are defined.
 */
bool mp_exact_second(const struct mp_exact *, struct mp_exact_value out[6]);

struct mp_exact_tensor {
	double value[3][3]; /* [0][1] = -integral of density*x*y [M L^2] */
	double bound;       /* the largest of all entries */
	bool defined;       /* else all 0 */
};

/*
 * Inertia tensor about the point ${about} [L], NULL for the centroid, of the solid that the mesh
 * means: as though its volume were positive.
 */
void mp_exact_inertia(const struct mp_exact *, const struct mp_exact_density *,
		      const double about[3], struct mp_exact_tensor *out);
/* Two at once, which takes less time: about the centroid and about ${about}; either may be NULL. */
void mp_exact_inertias(const struct mp_exact *, const struct mp_exact_density *,
		       const double about[3], struct mp_exact_tensor *central,
		       struct mp_exact_tensor *moved);

/*
 * Moment of inertia [M L^2] about the line through ${origin} [L] along ${direction} (finite, of
 * any length but 0), and the radius of gyration [L], which is not defined if the moment is
 * negative (bodies of mixed winding).  Either may be NULL.
 */
void mp_exact_axis_moment(const struct mp_exact *, const struct mp_exact_density *,
			  const double origin[3], const double direction[3],
			  struct mp_exact_value *moment, struct mp_exact_value *radius);

/* row[0..2].x + row[3] for finite doubles; as a coordinate, it may be subnormal. */
void mp_exact_coordinate(const double row[4], const double x[3], struct mp_exact_value *out);

/*
 * The determinant of the first three columns: its sign, and |determinant| in
 * [size, size + more)*2^exponent, more 0 where it is exactly that, else 1.
 */
struct mp_exact_determinant {
	int sign, exponent;
	uint64_t size; /* >= 2^63, or 0 */
	unsigned more;
};
void mp_exact_determinant(const double row[3][4], struct mp_exact_determinant *out);

#endif
