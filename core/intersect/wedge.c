#include "core/intersect/wedge.h"

/* The half-planes by their angle from the first one, which is 0. */
struct fan {
	struct mp_work *work;
	const double *p, *q;
	const double *ray[4];
	int turn[4]; /* 0: angle 0; 1: below a half turn; 2: a half turn; 3: above */
	uint8_t axis[2];
	int sign;
};

static bool place(struct fan *f, unsigned i)
{
	int s = mp_sign3(f->work, f->p, f->q, f->ray[0], f->ray[i]);

	if (s != 0) {
		f->turn[i] = s > 0 ? 1 : 3;
		return true;
	}
	s = f->sign * mp_sign2(f->work, f->axis, f->p, f->q, f->ray[i]);
	f->turn[i] = s > 0 ? 0 : 2;
	return s != 0;
}

/* Is the angle of ${i} smaller than that of ${j}? */
static bool before(const struct fan *f, unsigned i, unsigned j)
{
	if (f->turn[i] != f->turn[j])
		return f->turn[i] < f->turn[j];
	if (f->turn[i] % 2 == 0)
		return false;
	return mp_sign3(f->work, f->p, f->q, f->ray[i], f->ray[j]) > 0;
}

/* Whether the part of a turn behind rank ${at} is between ${from} and ${to}. */
static bool within(unsigned at, unsigned from, unsigned to)
{
	return from < to ? from <= at && at < to : from <= at || at < to;
}

unsigned mp_wedge_compare(struct mp_work *w, const double p[3], const double q[3],
			  const struct mp_wedge *first, const struct mp_wedge *second)
{
	struct fan f = {
	    .work = w, .p = p, .q = q, .ray = {first->from, first->to, second->from, second->to}};
	unsigned rank[4] = {0}, flags = 0;
	double tri[3][3];

	for (unsigned k = 0; k < 3; k++) {
		tri[0][k] = p[k];
		tri[1][k] = q[k];
		tri[2][k] = first->from[k];
	}
	f.sign = mp_sign_axes(w, (const double(*)[3])tri, f.axis);
	for (unsigned i = 0; i < 4; i++)
		if (f.sign == 0 || !place(&f, i))
			return 0;
	/* Equal angles have equal ranks: how many half-planes come before. */
	for (unsigned i = 0; i < 4; i++)
		for (unsigned j = 0; j < 4; j++)
			rank[i] += before(&f, j, i);
	if (rank[0] == rank[1] || rank[2] == rank[3])
		return 0;
	for (unsigned i = 0; i < 4; i++) { /* the sector behind half-plane i */
		bool a = within(rank[i], rank[0], rank[1]), b = within(rank[i], rank[2], rank[3]);

		flags |= a && b ? MP_WEDGE_BOTH : a ? MP_WEDGE_FIRST : b ? MP_WEDGE_SECOND : 0;
	}
	return flags;
}
