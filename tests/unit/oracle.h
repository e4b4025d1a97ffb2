#ifndef ORACLE_H
#define ORACLE_H

#include <gmp.h>
#include <stdbool.h>
#include <stddef.h>

/*
 * Mass properties as rational numbers, in the plainest way: signed tetrahedra from the origin to
 * every triangle, a.(b x c), coordinates as integers times 2^-1074.  Shares nothing with core/.
 */
struct oracle {
	mpq_t volume;                 /* signed */
	mpq_t centroid[3];            /* 0 where the volume is */
	mpq_t second[3][3];           /* integral of (x-cx)_i*(x-cx)_j, for the volume as signed */
	mpq_t first[3], square[3][3]; /* integral of x_i, of x_i*x_j */
};

void oracle_init(struct oracle *);
void oracle_clear(struct oracle *);
void oracle_find(struct oracle *, const double (*tri)[9], size_t count);

/*
 * The same of the vertices mapped by x -> row[i][0..2].x + row[i][3]; where that mirrors, every
 * triangle is wound the other way.  ${row} may be NULL.
 */
void oracle_find_mapped(struct oracle *, const double (*tri)[9], size_t count,
			const double (*row)[4]);

/* One coordinate of a mapped point. */
void oracle_coordinate(const double row[4], const double x[3], mpq_t out);

/* The determinant of the first three columns. */
void oracle_determinant(const double (*row)[4], mpq_t out);

/*
 * Tensor about ${about}, NULL for the centroid, times ${factor}, of the solid with a positive
 * volume; the volume must not be 0.
 */
void oracle_inertia(const struct oracle *, const double *about, const mpq_t factor,
		    mpq_t out[3][3]);

/* d.T.d/d.d of the tensor about ${origin}. */
void oracle_moment(const struct oracle *, const double origin[3], const double d[3],
		   const mpq_t factor, mpq_t out);

/* Is ${value} the double nearest to x, ties to even? */
bool oracle_is_nearest(const mpq_t x, double value);

/* Does x round to something beyond DBL_MAX, 1, or, not being 0, below DBL_MIN, -1?  Else 0. */
int oracle_range(const mpq_t x);

/* Is ${root} the double nearest to the square root of x >= 0? */
bool oracle_is_root(const mpq_t x, double root);

#endif
