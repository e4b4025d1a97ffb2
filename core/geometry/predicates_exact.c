#include "core/geometry/predicates_exact.h"

#include <math.h>
#include <stdbool.h>

/*
 * Shewchuk 1997, doi:10.1007/PL00009321.  An expansion is a sum of doubles that do not overlap,
 * by ascending magnitude, here always without zeros: where the differences of the coordinates are
 * exact (most meshes) it stays as short as the numbers are.  Needs round-to-even and
 * -ffp-contract=off.
 */
struct expansion {
	int n;         /* 0: the number zero */
	double c[192]; /* 3 * (16 * 2 * 2): as long as mp_exact_orient3d() makes them */
};

struct pair {
	double hi, lo; /* the value is hi + lo, exactly */
};

static struct pair two_sum(double a, double b)
{
	double s = a + b, bb = s - a;

	return (struct pair){s, (a - (s - bb)) + (b - bb)};
}

static struct pair two_difference(double a, double b)
{
	return two_sum(a, -b);
}

/* Dekker's product; 2^27 + 1 splits a double into halves of 26 bits. */
static struct pair two_product(double a, double b)
{
	const double split = 0x1p27 + 1;
	double p = a * b, ca = split * a, cb = split * b;
	double ah = ca - (ca - a), bh = cb - (cb - b);
	double al = a - ah, bl = b - bh;

	return (struct pair){p, al * bl - (((p - ah * bh) - al * bh) - ah * bl)};
}

static void append(struct expansion *e, double x)
{
	if (x != 0)
		e->c[e->n++] = x;
}

/* FAST-EXPANSION-SUM: merge by magnitude.  ${h} is neither ${e} nor ${f}. */
static void add(const struct expansion *e, const struct expansion *f, struct expansion *h)
{
	double q = 0;

	h->n = 0;
	for (int i = 0, j = 0; i < e->n || j < f->n;) {
		bool first = j == f->n || (i < e->n && fabs(e->c[i]) < fabs(f->c[j]));
		struct pair s = two_sum(q, first ? e->c[i++] : f->c[j++]);

		append(h, s.lo);
		q = s.hi;
	}
	append(h, q);
}

/* SCALE-EXPANSION. */
static void scale(const struct expansion *e, double b, struct expansion *h)
{
	double q = 0;

	h->n = 0;
	for (int i = 0; i < e->n; i++) {
		struct pair t = two_product(e->c[i], b);
		struct pair s = two_sum(q, t.lo);
		struct pair r = two_sum(t.hi, s.hi);

		append(h, s.lo);
		append(h, r.lo);
		q = r.hi;
	}
	append(h, q);
}

/* h = e * (b.hi + b.lo) */
static void multiply(const struct expansion *e, struct pair b, struct expansion *h)
{
	struct expansion low, high;

	if (b.lo == 0) {
		scale(e, b.hi, h);
		return;
	}
	scale(e, b.lo, &low);
	scale(e, b.hi, &high);
	add(&low, &high, h);
}

/* h = ax * by - ay * bx, at most 16 long */
static void cross(struct pair ax, struct pair ay, struct pair bx, struct pair by,
		  struct expansion *h)
{
	struct expansion x = {.n = 0}, y = {.n = 0}, left, right;

	append(&x, ax.lo);
	append(&x, ax.hi);
	append(&y, -ay.lo);
	append(&y, -ay.hi);
	multiply(&x, by, &left);
	multiply(&y, bx, &right);
	add(&left, &right, h);
}

static int sign(const struct expansion *e)
{
	double top = e->n > 0 ? e->c[e->n - 1] : 0;

	return (top > 0) - (top < 0);
}

/*
 * Coordinates of which threefold products neither overflow (901 + 28 bits for the split) nor lose
 * bits below 2^-1074: the lowest bit of a difference is no lower than 2^-352.
 */
static bool in_range(const double *p, int n)
{
	for (int i = 0; i < n; i++)
		if (p[i] != 0 && !(fabs(p[i]) >= 0x1p-300 && fabs(p[i]) <= 0x1p300))
			return false;
	return true;
}

int mp_exact_orient2d(const double a[2], const double b[2], const double c[2])
{
	struct expansion det;

	if (!in_range(a, 2) || !in_range(b, 2) || !in_range(c, 2))
		return mp_wide_orient2d(a, b, c);
	cross(two_difference(b[0], a[0]), two_difference(b[1], a[1]), two_difference(c[0], a[0]),
	      two_difference(c[1], a[1]), &det);
	return sign(&det);
}

int mp_exact_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
	struct pair u[3], v[3], w[3];
	struct expansion minor, term[3], sum;

	if (!in_range(a, 3) || !in_range(b, 3) || !in_range(c, 3) || !in_range(d, 3))
		return mp_wide_orient3d(a, b, c, d);
	for (int k = 0; k < 3; k++) {
		u[k] = two_difference(b[k], a[k]);
		v[k] = two_difference(c[k], a[k]);
		w[k] = two_difference(d[k], a[k]);
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		cross(u[i], u[j], v[i], v[j], &minor);
		multiply(&minor, w[k], &term[k]);
	}
	add(&term[0], &term[1], &sum);
	add(&sum, &term[2], &minor);
	return sign(&minor);
}
