#include "core/moments/bounds.h"

#include <math.h>

#define QUARTER_TURN 1.5707963267948968 /* not below pi/2 */

/* Where cov has the entry of row i, column j. */
static const int COV[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/* Second moment over mass, about the centroid or the origin. */
static struct mp_ball spread(const struct mp_solid *s, int i, int j, bool origin)
{
	struct mp_ball cov = mp_ball(s->cov[COV[i][j]], s->cov_bound[COV[i][j]]);

	if (!origin)
		return cov;
	return mp_ball_add(cov, mp_ball_mul(mp_ball(s->centroid[i], s->centroid_bound[i]),
					    mp_ball(s->centroid[j], s->centroid_bound[j])));
}

static struct mp_ball entry(const struct mp_solid *s, struct mp_ball mass, int i, int j,
			    bool origin)
{
	int p = (i + 1) % 3, q = (i + 2) % 3;

	if (i != j)
		return mp_ball_neg(mp_ball_mul(mass, spread(s, i, j, origin)));
	return mp_ball_mul(mass, mp_ball_add(spread(s, p, p, origin), spread(s, q, q, origin)));
}

static double farthest(const struct mp_solid *s, struct mp_ball mass, const double tensor[3][3],
		       bool origin)
{
	double most = 0;

	for (int i = 0; i < 9; i++)
		most = fmax(most, mp_ball_distance(entry(s, mass, i / 3, i % 3, origin),
						   tensor[i / 3][i % 3]));
	return most;
}

double mp_bounds_of_tensor(const struct mp_solid *s, struct mp_ball mass,
			   const double inertia[3][3])
{
	double largest = 0;

	for (int i = 0; i < 3; i++) { /* of a symmetric matrix no row sum is below the norm */
		struct mp_ball row = mp_ball_exact(0);

		for (int j = 0; j < 3; j++)
			row = mp_ball_add(row, mp_ball_exact(mp_ball_distance(
						   entry(s, mass, i, j, false), inertia[i][j])));
		largest = fmax(largest, mp_round_up(mp_ball_most(row)));
	}
	return largest;
}

/* Davis and Kahan: the sine is at most the residual over the distance of the other moments. */
static double turn(const struct mp_principal *p, int k, double tensor, double moments)
{
	long double sine, gap = INFINITY;

	for (int j = 0; j < 3; j++) {
		struct mp_ball apart = mp_ball_abs(
		    mp_ball_sub(mp_ball_exact(p->moments[j]), mp_ball_exact(p->moments[k])));

		apart = mp_ball_sub(apart, mp_ball_exact(moments));
		if (j != k)
			gap = fminl(gap, apart.mid > 0 ? mp_ball_least(apart) : 0);
	}
	if (!(gap > 0))
		return QUARTER_TURN;
	sine = (p->residual[k] + (long double)tensor) / gap * (1 + 0x1p-30L);
	return sine < 1 ? mp_round_up(asinl(sine) * (1 + 0x1p-30L)) : QUARTER_TURN;
}

static double farthest_axis(const struct mp_principal *p, double tensor, double moments)
{
	bool low = p->moments[1] - p->moments[0] < p->moments[2] - p->moments[1];
	double most = 0;

	if (p->symmetry == MP_SYMMETRY_SPHERICAL)
		return QUARTER_TURN;
	if (p->symmetry == MP_SYMMETRY_AXIAL)
		return turn(p, low ? 2 : 0, tensor, moments);
	for (int k = 0; k < 3; k++)
		most = fmax(most, turn(p, k, tensor, moments));
	return most;
}

void mp_bounds_of_principal(double tensor, struct mp_ball mass, struct mp_report *r)
{
	struct mp_bounds *b = &r->bounds;

	b->radii = 0;
	b->moments = mp_round_up(
	    mp_ball_most(mp_ball_add(mp_ball_exact(tensor), mp_ball_exact(r->principal.error))));
	b->axes = farthest_axis(&r->principal, tensor, b->moments);
	for (int k = 0; k < 3 && r->radii_defined; k++) {
		struct mp_ball square =
		    mp_ball_div(mp_ball(r->principal.moments[k], b->moments), mass);

		b->radii =
		    fmax(b->radii, mp_ball_distance(mp_ball_sqrt(square), r->radii_of_gyration[k]));
	}
}

void mp_bounds_find(const struct mp_solid *whole, const struct mp_solid *heavy, struct mp_ball mass,
		    struct mp_report *r)
{
	const struct mp_mass *m = &r->total;
	struct mp_bounds *b = &r->bounds;

	if (m->area_defined)
		b->area = mp_ball_distance(mp_ball(whole->area, whole->area_bound), m->area);
	if (m->volume_defined)
		b->volume =
		    mp_ball_distance(mp_ball(whole->volume, whole->volume_bound), m->volume);
	if (m->mass_defined)
		b->mass = mp_ball_distance(mass, m->mass);
	for (int k = 0; k < 3 && m->centroid_defined; k++)
		b->centroid =
		    fmax(b->centroid,
			 mp_ball_distance(mp_ball(heavy->centroid[k], heavy->centroid_bound[k]),
					  m->centroid[k]));
	if (r->inertia_origin_defined)
		b->inertia_origin =
		    farthest(heavy, mass, (const double(*)[3])r->inertia_origin, true);
	if (!m->inertia_defined)
		return;
	b->inertia = farthest(heavy, mass, (const double(*)[3])m->inertia, false);
	mp_bounds_of_principal(mp_bounds_of_tensor(heavy, mass, (const double(*)[3])m->inertia),
			       mass, r);
}
