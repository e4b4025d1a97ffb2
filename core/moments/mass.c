#include "core/moments/mass.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Where cov has the entry of row i, column j. */
static const int COV[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

struct mp_ball mp_density_ball(double density, double divisor, double error)
{
	struct mp_ball d = mp_ball(density, fabsl((long double)density * error));

	return mp_ball_div(d, mp_ball_exact(divisor != 0 ? divisor : 1));
}

struct mp_ball mp_mass_ball(const struct mp_solid *solid, const struct mp_density *density)
{
	struct mp_ball volume = mp_ball_abs(mp_ball(solid->volume, solid->volume_bound));

	if (density->weighed)
		return mp_ball_exact(density->mass);
	return mp_ball_mul(mp_ball(density->value, density->bound), volume);
}

/* Of a solid without a volume it is not known how it is meant: its moments may have either sign. */
static struct mp_ball either_way(struct mp_ball x)
{
	return mp_ball(0, mp_ball_most(x));
}

void mp_mass_weigh(struct mp_solid *solid, struct mp_ball density)
{
	struct mp_ball mass =
	    mp_ball_mul(density, mp_ball_abs(mp_ball(solid->volume, solid->volume_bound)));

	solid->volume = mass.mid;
	solid->volume_bound = mass.rad;
	for (int k = 0; k < 3; k++)
		solid->first[k] = either_way(mp_ball_mul(density, solid->first[k]));
	for (int k = 0; k < 6; k++)
		solid->second[k] = either_way(mp_ball_mul(density, solid->second[k]));
}

bool mp_in_range(long double x, double *out)
{
	*out = 0;
	if (!(fabsl(x) <= DBL_MAX) || (x != 0 && fabsl(x) < DBL_MIN))
		return false;
	*out = (double)x + 0.0; /* no -0 */
	return true;
}

/* Coordinates may be as near to 0 as they like. */
static bool vector_in_range(const long double x[3], double out[3])
{
	bool fits = fabsl(x[0]) <= DBL_MAX && fabsl(x[1]) <= DBL_MAX && fabsl(x[2]) <= DBL_MAX;

	for (int k = 0; k < 3; k++)
		out[k] = fits ? (double)x[k] + 0.0 : 0;
	return fits;
}

bool mp_mass_inertia(const struct mp_solid *solid, long double mass, const long double r[3],
		     double out[3][3])
{
	long double e[3][3], x;
	bool fits = true;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			e[i][j] = solid->cov[COV[i][j]] + r[i] * r[j];
	for (int i = 0; i < 3; i++) {
		x = mass * (e[(i + 1) % 3][(i + 1) % 3] + e[(i + 2) % 3][(i + 2) % 3]);
		fits = mp_in_range(x, &out[i][i]) && fits;
		for (int j = 0; j < 3; j++) {
			if (j == i)
				continue;
			x = -mass * e[i][j]; /* beside the diagonal, tiny is nothing */
			if (!mp_in_range(x, &out[i][j]) && !(fabsl(x) < DBL_MIN))
				fits = false;
		}
	}
	if (!fits)
		memset(out, 0, 9 * sizeof out[0][0]);
	return fits;
}

bool mp_mass_axis(const struct mp_solid *solid, long double mass, const double origin[3],
		  const double direction[3], struct mp_axis_moment *out)
{
	long double d[3], r[3], length = 0, square = 0;

	memset(out, 0, sizeof *out);
	for (int k = 0; k < 3; k++)
		length += (long double)direction[k] * direction[k];
	length = sqrtl(length);
	for (int k = 0; k < 3; k++) {
		d[k] = direction[k] / length;
		r[k] = solid->centroid[k] - origin[k];
		out->origin[k] = origin[k];
		out->direction[k] = (double)d[k];
	}
	for (int k = 0; k < 3; k++) { /* tr(cov) - d cov d + |r x d|^2 */
		long double cross =
		    r[(k + 1) % 3] * d[(k + 2) % 3] - r[(k + 2) % 3] * d[(k + 1) % 3];

		square += solid->cov[k] + cross * cross;
		for (int j = 0; j < 3; j++)
			square -= d[k] * solid->cov[COV[k][j]] * d[j];
	}
	out->radius_defined = square >= 0 && mp_in_range(sqrtl(square), &out->radius_of_gyration);
	return mp_in_range(mass * square, &out->moment);
}

bool mp_mass_fill(struct mp_mass *out, const struct mp_solid *solid, bool closed,
		  const struct mp_density *density)
{
	static const long double AT_CENTROID[3] = {0, 0, 0};
	bool fits = true, mass = closed && (!density->asked || density->defined);
	long double amount = density->value * fabsl(solid->volume);

	memset(out, 0, sizeof *out);
	fits = out->area_defined = solid->area_in_range && mp_in_range(solid->area, &out->area);
	if (!closed)
		return fits;
	if (!solid->in_range)
		return false;
	out->volume_defined = mp_in_range(solid->volume, &out->volume);
	out->mass_defined = mass && mp_in_range(amount, &out->mass);
	fits = fits && out->volume_defined && out->mass_defined == mass;
	if (!solid->has_centroid)
		return fits;
	out->centroid_defined = vector_in_range(solid->centroid, out->centroid);
	out->inertia_defined = mass && mp_mass_inertia(solid, amount, AT_CENTROID, out->inertia);
	return fits && out->centroid_defined && out->inertia_defined == mass;
}
