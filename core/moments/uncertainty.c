#include "core/moments/uncertainty.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"

/*
 * Rows: what is derived.  0: the volume, times 6; 1 to 3: its first moments about the centroid,
 * times
 * 24.  Coordinates are scaled by powers of two, each axis by its own, so that the box is
 * about 1 wide and float32 has room for every derivative; three digits of them would do.
 */
enum { ROWS = 4, AHEAD = 16 };
typedef float rows __attribute__((vector_size(ROWS * sizeof(float))));

/* Bytes that the other tables of a triangle took before, and gave back. */
enum { ROOM = 40 };

struct frame {
	double centre[3], scale[3]; /* q = (vertex - centre)*scale */
	double shift[ROWS];         /* -1, and four times the centroid as q */
	double turn[3][3];          /* from rows 1 to 3 to those of the map, each scaled: */
	double row_scale[3];        /* that of a row is its derivative times this */
	const struct mp_rounded_solid *solid;
};

/*
 * The centroid of the mapped solid moves as the map says, while the normals stay those of the file.
 * Powers of two keep the numbers near 1.
 */
static void set_turn(struct frame *f, const struct mp_affine *map)
{
	for (int i = 0; i < 3; i++) {
		long double row[3], largest = 0;

		f->row_scale[i] = f->scale[i];
		for (int k = 0; k < 3 && map != NULL; k++) {
			row[k] = (long double)map->row[i][k] / f->scale[k];
			largest = fmaxl(largest, fabsl(row[k]));
		}
		if (map == NULL)
			continue;
		f->row_scale[i] = ldexp(1, ilogbl(largest) < -1000 ? 1000 : -ilogbl(largest));
		for (int k = 0; k < 3; k++)
			f->turn[i][k] = (double)(row[k] * f->row_scale[i]);
	}
}

/* A box without an extent along an axis takes the factor of the others: nothing is scaled away. */
static void set_frame(struct frame *f, const struct mp_rounded_solid *s)
{
	int exponent[3], top = INT_MIN;

	for (int k = 0; k < 3; k++) {
		double half = s->max[k] / 2 - s->min[k] / 2;

		f->centre[k] = s->min[k] / 2 + s->max[k] / 2;
		exponent[k] = half > 0 ? -ilogb(half) - 1 : INT_MIN;
		if (exponent[k] > 1000)
			exponent[k] = 1000;
		if (exponent[k] > top)
			top = exponent[k];
	}
	for (int k = 0; k < 3; k++)
		f->scale[k] = ldexp(1, exponent[k] != INT_MIN ? exponent[k]
				       : top != INT_MIN       ? top
							      : 0);
	f->shift[0] = -1;
	for (int k = 0; k < 3; k++)
		f->shift[1 + k] =
		    s->volume != 0 ? 4 * (s->centroid[k] - f->centre[k]) * f->scale[k] : 0;
	f->solid = s;
	set_turn(f, s->map);
}

#define INLINE static inline __attribute__((always_inline))

/* Where the coordinates are: floats, or doubles where that is NULL. */
struct points {
	const float *narrow;
	const double *wide;
};

static struct points points_of(const struct frame *f)
{
	struct points p;

	mp_vertices_all(f->solid->mesh->vertices, &p.narrow, &p.wide);
	return p;
}

/* q of the corners, each behind a 0, so that q and what is made of it fit the rows. */
INLINE void find_corners(const struct frame *f, struct points p, const uint32_t v[3],
			 double q[3][ROWS])
{
	for (int c = 0; c < 3; c++) {
		size_t at = (size_t)3 * v[c];

		q[c][0] = 0;
		for (size_t k = 0; k < 3; k++) {
			double x = p.narrow != NULL ? (double)p.narrow[at + k] : p.wide[at + k];

			q[c][1 + k] = (x - f->centre[k]) * f->scale[k];
		}
	}
}

INLINE void prefetch_corners(struct points p, const uint32_t v[3])
{
	for (int c = 0; c < 3; c++)
		if (p.narrow != NULL)
			__builtin_prefetch(p.narrow + (size_t)3 * v[c]);
		else
			__builtin_prefetch(p.wide + (size_t)3 * v[c]);
}

/* Twice the area vector of a triangle. */
INLINE void normal(double (*q)[ROWS], float n[3])
{
	double e[3], f[3];

	for (int k = 0; k < 3; k++) {
		e[k] = q[1][1 + k] - q[0][1 + k];
		f[k] = q[2][1 + k] - q[0][1 + k];
	}
	n[0] = (float)(e[1] * f[2] - e[2] * f[1]);
	n[1] = (float)(e[2] * f[0] - e[0] * f[2]);
	n[2] = (float)(e[0] * f[1] - e[1] * f[0]);
}

/* The rows of the derivatives by n_k, for each corner. */
INLINE void find_rows(const struct frame *f, double (*q)[ROWS], rows out[3])
{
	rows s = {0};

	for (int r = 0; r < ROWS; r++)
		s[r] = (float)(q[0][r] + q[1][r] + q[2][r] - f->shift[r]);
	for (int c = 0; c < 3; c++) {
		const rows own = {(float)q[c][0], (float)q[c][1], (float)q[c][2], (float)q[c][3]};

		out[c] = s + own;
	}
	for (int c = 0; c < 3 && f->solid->map != NULL; c++) {
		const rows from = out[c];

		for (int i = 0; i < 3; i++)
			out[c][1 + i] = (float)(f->turn[i][0] * (double)from[1] +
						f->turn[i][1] * (double)from[2] +
						f->turn[i][2] * (double)from[3]);
	}
}

INLINE void find_triangle(const struct frame *f, struct points p, const uint32_t v[3], float n[3],
			  rows w[3])
{
	double q[3][ROWS];

	find_corners(f, p, v, q);
	normal(q, n);
	find_rows(f, q, w);
}

INLINE void add_triangles(const struct frame *frame, struct points p, rows *restrict sums)
{
	const struct mp_mesh *m = frame->solid->mesh;
	const struct frame f = *frame; /* where no store can reach it */

	for (uint32_t t = 0; t < m->triangles; t++) {
		const uint32_t *v = m->tri[t],
			       *next = m->tri[t + AHEAD < m->triangles ? t + AHEAD : t];
		float n[3];
		rows w[3];

		prefetch_corners(p, next);
		for (int c = 0; c < 3; c++)
			__builtin_prefetch(sums + (size_t)3 * next[c], 1);
		find_triangle(&f, p, v, n, w);
		for (int c = 0; c < 3; c++) {
			rows *sum = sums + (size_t)3 * v[c];

			for (int k = 0; k < 3; k++)
				sum[k] += n[k] * w[c];
		}
	}
}

/* sums: 3 of each vertex, one for each coordinate. */
static void add_all(const struct frame *f, rows *sums)
{
	struct points p = points_of(f);

	if (p.narrow != NULL)
		add_triangles(f, (struct points){.narrow = p.narrow}, sums);
	else
		add_triangles(f, (struct points){.wide = p.wide}, sums);
}

/* The same of one row alone. */
static void add_row(const struct frame *f, int row, float (*sums)[3])
{
	const struct mp_mesh *m = f->solid->mesh;
	const struct points p = points_of(f);

	for (uint32_t t = 0; t < m->triangles; t++) {
		float n[3];
		rows w[3];

		find_triangle(f, p, m->tri[t], n, w);
		for (int c = 0; c < 3; c++)
			for (int k = 0; k < 3; k++)
				sums[m->tri[t][c]][k] += n[k] * w[c][row];
	}
}

/* Half the distance between float32 numbers of the size of x: 2^-150 at 0. */
static inline double half_ulp(double x)
{
	uint64_t bits, exponent;

	memcpy(&bits, &x, sizeof bits);
	exponent = bits >> 52 & 0x7ff;
	bits = (exponent > 1023 - 126 ? exponent - 24 : 1023 - 126 - 24) << 52;
	memcpy(&x, &bits, sizeof x);
	return x;
}

/* Squares of the scaled half steps of the three coordinates of a vertex. */
static inline void find_steps(const struct frame *f, uint32_t vertex, double h2[3])
{
	double x[3];

	mp_vertices_get(f->solid->mesh->vertices, vertex, x);
	for (int k = 0; k < 3; k++) {
		double ulp = f->solid->float32 ? half_ulp(x[k]) * f->scale[k] : 0;
		double step = f->solid->step / 2 * f->scale[k];

		h2[k] = ulp * ulp + step * step;
	}
}

/* Sums of the squares of (derivative times half step), a row each. */
static void square_all(const struct frame *f, const rows *sums, double out[ROWS])
{
	uint32_t count = mp_vertices_count(f->solid->mesh->vertices);

	for (uint32_t v = 0; v < count; v++) {
		double h2[3];

		find_steps(f, v, h2);
		for (int k = 0; k < 3; k++, sums++)
			for (int r = 0; r < ROWS; r++)
				out[r] += (double)(*sums)[r] * (double)(*sums)[r] * h2[k];
	}
}

static double square_row(const struct frame *f, float (*sums)[3])
{
	uint32_t count = mp_vertices_count(f->solid->mesh->vertices);
	double out = 0;

	for (uint32_t v = 0; v < count; v++) {
		double h2[3];

		find_steps(f, v, h2);
		for (int k = 0; k < 3; k++)
			out += (double)sums[v][k] * (double)sums[v][k] * h2[k];
	}
	return out;
}

static int find_at_once(const struct frame *f, size_t vertices, double squares[ROWS],
			struct mp_error *err)
{
	const size_t size = 3 * sizeof(rows) * (vertices + 1);
	rows *sums = mp_huge(calloc(1, size), size);

	if (sums == NULL)
		return mp_fail_nomem(err);
	add_all(f, sums);
	square_all(f, sums, squares);
	free(sums);
	return 0;
}

static int find_by_rows(const struct frame *f, size_t vertices, double squares[ROWS],
			struct mp_error *err)
{
	const size_t size = (vertices + 1) * sizeof(float[3]);
	float(*sums)[3] = mp_huge(malloc(size), size);

	if (sums == NULL)
		return mp_fail_nomem(err);
	for (int r = 0; r < ROWS; r++) {
		memset(sums, 0, size);
		add_row(f, r, sums);
		squares[r] = square_row(f, sums);
	}
	free(sums);
	return 0;
}

static void set_deviation(const struct frame *f, const double squares[ROWS],
			  struct mp_deviation *out)
{
	long double product = (long double)f->scale[0] * f->scale[1] * f->scale[2];
	long double volume = fabsl(f->solid->volume * product);

	out->volume = sqrtl(squares[0] / 3.0L) / 6 / product;
	if (f->solid->map != NULL)
		out->volume *= f->solid->map->size.mid;
	for (int k = 0; k < 3; k++)
		out->centroid[k] =
		    volume > 0 ? sqrtl(squares[1 + k] / 3.0L) / 24 / volume / f->row_scale[k] : 0;
}

int mp_uncertainty_find(const struct mp_rounded_solid *s, struct mp_deviation *out,
			struct mp_error *err)
{
	size_t vertices = mp_vertices_count(s->mesh->vertices);
	bool many = 3 * sizeof(rows) * vertices > (size_t)ROOM * s->mesh->triangles;
	double squares[ROWS] = {0};
	struct frame frame;

	set_frame(&frame, s);
	if (many ? find_by_rows(&frame, vertices, squares, err)
		 : find_at_once(&frame, vertices, squares, err))
		return -1;
	set_deviation(&frame, squares, out);
	return 0;
}
