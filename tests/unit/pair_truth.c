#include "tests/unit/pair_truth.h"

#include <gmp.h>
#include <string.h>

/* Sums of many products: GMP's C interface made bearable by an arena of fractions. */
enum { ARENA = 20000, MOST = 16 };
struct arena {
	mpq_t q[ARENA];
	unsigned used;
};

typedef mpq_t *num;
struct vec {
	num x[3];
};
struct polygon {
	struct vec p[MOST];
	unsigned n;
};

static num fresh(struct arena *a)
{
	mpq_init(a->q[a->used]);
	return &a->q[a->used++];
}

static num sub(struct arena *a, num x, num y)
{
	num r = fresh(a);

	mpq_sub(*r, *x, *y);
	return r;
}

static num add(struct arena *a, num x, num y)
{
	num r = fresh(a);

	mpq_add(*r, *x, *y);
	return r;
}

static num mul(struct arena *a, num x, num y)
{
	num r = fresh(a);

	mpq_mul(*r, *x, *y);
	return r;
}

static struct vec less(struct arena *a, struct vec x, struct vec y)
{
	return (struct vec){
	    {sub(a, x.x[0], y.x[0]), sub(a, x.x[1], y.x[1]), sub(a, x.x[2], y.x[2])}};
}

static struct vec cross(struct arena *a, struct vec x, struct vec y)
{
	struct vec r;

	for (unsigned k = 0; k < 3; k++) {
		unsigned i = (k + 1) % 3, j = (k + 2) % 3;

		r.x[k] = sub(a, mul(a, x.x[i], y.x[j]), mul(a, x.x[j], y.x[i]));
	}
	return r;
}

static num dot(struct arena *a, struct vec x, struct vec y)
{
	return add(a, add(a, mul(a, x.x[0], y.x[0]), mul(a, x.x[1], y.x[1])),
		   mul(a, x.x[2], y.x[2]));
}

static bool same(struct vec x, struct vec y)
{
	return mpq_equal(*x.x[0], *y.x[0]) && mpq_equal(*x.x[1], *y.x[1]) &&
	       mpq_equal(*x.x[2], *y.x[2]);
}

static struct vec corner(struct arena *a, const double p[3])
{
	struct vec r;

	for (unsigned k = 0; k < 3; k++) {
		r.x[k] = fresh(a);
		mpq_set_d(*r.x[k], p[k]);
	}
	return r;
}

static struct polygon triangle(struct arena *a, const struct mp_tri *t)
{
	return (struct polygon){{corner(a, t->p[0]), corner(a, t->p[1]), corner(a, t->p[2])}, 3};
}

static void push(struct polygon *p, struct vec x)
{
	for (unsigned i = 0; i < p->n; i++)
		if (same(p->p[i], x))
			return;
	p->p[p->n++] = x;
}

/* Where ${sign} * normal . (x - origin) >= 0. */
static struct polygon clip(struct arena *a, const struct polygon *in, struct vec origin,
			   struct vec normal, int sign)
{
	struct polygon out = {.n = 0};

	for (unsigned i = 0; i < in->n; i++) {
		struct vec p = in->p[i], q = in->p[(i + 1) % in->n], x;
		num dp = dot(a, normal, less(a, p, origin)),
		    dq = dot(a, normal, less(a, q, origin));
		num part;

		if (sign * mpq_sgn(*dp) >= 0)
			push(&out, p);
		if (mpq_sgn(*dp) * mpq_sgn(*dq) >= 0)
			continue;
		part = fresh(a);
		mpq_div(*part, *dp, *sub(a, dp, dq));
		for (unsigned k = 0; k < 3; k++)
			x.x[k] = add(a, p.x[k], mul(a, part, sub(a, q.x[k], p.x[k])));
		push(&out, x);
	}
	return out;
}

static struct vec normal_of(struct arena *a, const struct polygon *t)
{
	return cross(a, less(a, t->p[1], t->p[0]), less(a, t->p[2], t->p[0]));
}

static struct polygon common(struct arena *a, struct polygon p, const struct polygon *tri)
{
	struct vec n = normal_of(a, tri);

	p = clip(a, &p, tri->p[0], n, 1);
	p = clip(a, &p, tri->p[0], n, -1);
	for (unsigned k = 0; k < 3; k++)
		p = clip(a, &p, tri->p[k], cross(a, n, less(a, tri->p[(k + 1) % 3], tri->p[k])), 1);
	return p;
}

static struct vec middle(struct arena *a, const struct polygon *p)
{
	struct vec m = p->p[0];
	num n = fresh(a);

	mpq_set_ui(*n, p->n, 1);
	mpq_inv(*n, *n);
	for (unsigned i = 1; i < p->n; i++)
		for (unsigned k = 0; k < 3; k++)
			m.x[k] = add(a, m.x[k], p->p[i].x[k]);
	for (unsigned k = 0; k < 3; k++)
		m.x[k] = mul(a, m.x[k], n);
	return m;
}

/* A point of the triangle: how many of its sides it is on, and the last of them. */
static unsigned sides(struct arena *a, const struct polygon *tri, struct vec x, unsigned *which)
{
	unsigned count = 0;

	for (unsigned k = 0; k < 3; k++) {
		struct vec c =
		    cross(a, less(a, tri->p[(k + 1) % 3], tri->p[k]), less(a, x, tri->p[k]));

		if (mpq_sgn(*c.x[0]) == 0 && mpq_sgn(*c.x[1]) == 0 && mpq_sgn(*c.x[2]) == 0) {
			count++;
			*which = k;
		}
	}
	return count;
}

static uint8_t along(struct arena *a, const struct polygon *t, unsigned k, const struct polygon *u)
{
	struct polygon edge = {{t->p[k], t->p[(k + 1) % 3]}, 2};
	unsigned which = 0;

	edge = common(a, edge, u);
	if (edge.n < 2)
		return MP_ALONG_NO;
	return sides(a, u, middle(a, &edge), &which) == 0 ? MP_ALONG_FACE
							  : (uint8_t)(MP_ALONG_EDGE + which);
}

/* Whether the two have more in common than corners and sides that they share. */
static bool beyond_shared(struct arena *a, const struct mp_tri *t, const struct mp_tri *u,
			  const struct polygon *p, const struct polygon *in)
{
	struct vec shared[3];
	unsigned n = 0;

	for (unsigned i = 0; i < 3; i++)
		for (unsigned j = 0; j < 3; j++)
			if (t->v[i] == u->v[j])
				shared[n++] = p->p[i];
	for (unsigned i = 0; i < in->n; i++) {
		struct vec c;

		if (n == 0 || (n == 1 && !same(shared[0], in->p[i])))
			return true;
		if (n == 1)
			continue;
		c = cross(a, less(a, shared[1], shared[0]), less(a, in->p[i], shared[0]));
		if (mpq_sgn(*c.x[0]) != 0 || mpq_sgn(*c.x[1]) != 0 || mpq_sgn(*c.x[2]) != 0)
			return true;
	}
	return false;
}

static void judge(struct arena *a, const struct mp_tri *t, const struct mp_tri *u,
		  struct pair_truth *out)
{
	struct polygon p = triangle(a, t), q = triangle(a, u), in = common(a, p, &q);
	struct vec c = cross(a, normal_of(a, &p), normal_of(a, &q)), m;
	unsigned on_t, on_u, which = 0;

	out->coplanar = mpq_sgn(*c.x[0]) == 0 && mpq_sgn(*c.x[1]) == 0 && mpq_sgn(*c.x[2]) == 0 &&
			mpq_sgn(*dot(a, normal_of(a, &p), less(a, q.p[0], p.p[0]))) == 0;
	out->points = in.n;
	for (unsigned i = 0; i < in.n; i++)
		for (unsigned k = 0; k < 3; k++)
			out->point[i][k] = mpq_get_d(*in.p[i].x[k]);
	out->touches = beyond_shared(a, t, u, &p, &in);
	if (!out->touches)
		return;
	m = middle(a, &in);
	on_t = sides(a, &p, m, &which);
	on_u = sides(a, &q, m, &which);
	out->intersects = on_t == 0 || on_u == 0 || (in.n == 1 && on_t == 1 && on_u == 1);
	out->crosses = !out->coplanar && on_t == 0 && on_u == 0;
	for (unsigned k = 0; k < 3; k++) {
		out->along[0][k] = along(a, &p, k, &q);
		out->along[1][k] = along(a, &q, k, &p);
	}
}

void pair_truth_find(const struct mp_tri *t, const struct mp_tri *u, struct pair_truth *out)
{
	static struct arena arena;

	arena.used = 0;
	memset(out, 0, sizeof *out);
	judge(&arena, t, u, out);
	for (unsigned i = 0; i < arena.used; i++)
		mpq_clear(arena.q[i]);
}
