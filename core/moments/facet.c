#include "core/moments/facet.h"

#include <math.h>
#include <string.h>

#include "core/geometry/predicates.h"

/* hi + lo, |lo| at most half an ulp of hi.  Dekker 1971, doi:10.1007/BF01397083. */
struct pair {
	double hi, lo;
};

/* Where the longest component of a cross product is less, the predicate is asked. */
#define SLIVER 0x1p-50

/* From here on sums of coordinates may leave the range. */
enum { TOP = 1000 };

static struct pair sum_of(double a, double b) /* exact: TwoSum, Knuth */
{
	double s = a + b, part = s - a;

	return (struct pair){s, (a - (s - part)) + (b - part)};
}

static struct pair product_of(double a, double b) /* exact, but for underflow */
{
	double p = a * b;

	return (struct pair){p, fma(a, b, -p)};
}

static struct pair add(struct pair a, struct pair b)
{
	struct pair s = sum_of(a.hi, b.hi), t = sum_of(a.lo, b.lo);

	s = sum_of(s.hi, s.lo + t.hi);
	return sum_of(s.hi, s.lo + t.lo);
}

static struct pair multiply(struct pair a, struct pair b)
{
	struct pair p = product_of(a.hi, b.hi);

	return sum_of(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

static struct pair negative(struct pair a)
{
	return (struct pair){-a.hi, -a.lo};
}

static double size_of(const double x[3])
{
	return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

static int exponent_of(const double x[3])
{
	double most = size_of(x);

	return most > 0 ? ilogb(most) : 0;
}

/* to - from, scaled so that its longest component is about 1; returns the exponent taken out. */
static int find_edge(const double from[3], const double to[3], struct pair edge[3])
{
	double hi[3];
	int exponent;

	for (int k = 0; k < 3; k++) {
		edge[k] = sum_of(to[k], -from[k]);
		hi[k] = edge[k].hi;
	}
	exponent = exponent_of(hi);
	for (int k = 0; k < 3; k++) {
		edge[k].hi = ldexp(edge[k].hi, -exponent);
		edge[k].lo = ldexp(edge[k].lo, -exponent);
	}
	return exponent;
}

/* The corner nearest to the origin: its product with the normal cancels least. */
static int find_nearest(const double p[3][3])
{
	int nearest = size_of(p[1]) < size_of(p[0]) ? 1 : 0;

	return size_of(p[2]) < size_of(p[nearest]) ? 2 : nearest;
}

/* The corner between the two shorter edges: their product cancels least. */
static int find_base(const double p[3][3])
{
	double longest = -1;
	int base = 0;

	for (int a = 0; a < 3; a++) {
		const double *b = p[(a + 1) % 3], *c = p[(a + 2) % 3];
		double length = size_of((const double[3]){b[0] - c[0], b[1] - c[1], b[2] - c[2]});

		if (length > longest) {
			longest = length;
			base = a;
		}
	}
	return base;
}

static void cross(const struct pair e[3], const struct pair f[3], struct pair n[3])
{
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		n[k] = add(multiply(e[i], f[j]), negative(multiply(e[j], f[i])));
	}
}

/* 0 where the corners lie on one line. */
static double length_of(const struct pair n[3], const double p[3][3])
{
	double longest = fmax(fabs(n[0].hi), fmax(fabs(n[1].hi), fabs(n[2].hi))), square = 0;

	if (longest == 0 || (longest < SLIVER && mp_collinear(p[0], p[1], p[2])))
		return 0;
	for (int k = 0; k < 3; k++) {
		double x = n[k].hi / longest;

		square += x * x;
	}
	return longest * sqrt(square);
}

/* ${scale}: p is the corners times 2^-scale; ${twice}: n is 2^-twice of what they make. */
static void set_plane(const struct pair n[3], const double p[3], double length, int twice,
		      int scale, struct mp_facet *out)
{
	struct pair dot = {0, 0};

	for (int k = 0; k < 3; k++) {
		dot = add(dot, multiply((struct pair){p[k], 0}, n[k]));
		out->normal[k] = n[k].hi / length + 0.0; /* no -0 */
	}
	out->area = ldexp(length / 2, twice + 2 * scale);
	out->height = ldexp(dot.hi / length, scale) + 0.0;
	out->volume = ldexp(dot.hi / 6, twice + 3 * scale) + 0.0;
}

void mp_facet_find(const double corner[3][3], struct mp_facet *out)
{
	struct pair e[3], f[3], n[3];
	double p[3][3], length;
	int scale, twice, a, b, c;

	memset(out, 0, sizeof *out);
	scale =
	    (int)fmax(exponent_of(corner[0]), fmax(exponent_of(corner[1]), exponent_of(corner[2])));
	scale = scale > TOP ? scale - TOP : 0;
	for (int i = 0; i < 9; i++)
		p[i / 3][i % 3] = ldexp(corner[i / 3][i % 3], -scale);
	for (int k = 0; k < 3; k++)
		out->centroid[k] =
		    (double)(((long double)corner[0][k] + corner[1][k] + corner[2][k]) / 3) + 0.0;
	a = find_base((const double(*)[3])p);
	b = (a + 1) % 3;
	c = (a + 2) % 3;
	twice = find_edge(p[a], p[b], e) + find_edge(p[a], p[c], f);
	cross((const struct pair *)e, (const struct pair *)f, n);
	length = length_of(n, corner);
	out->degenerate = !(length > 0);
	if (!out->degenerate)
		set_plane(n, p[find_nearest((const double(*)[3])p)], length, twice, scale, out);
}
