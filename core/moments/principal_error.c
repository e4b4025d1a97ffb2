#include "core/moments/principal_error.h"

#include <math.h>

#include "core/moments/ball.h"

/* Sum of squares, of balls. */
static struct mp_ball square_sum(struct mp_ball sum, struct mp_ball x)
{
	return mp_ball_add(sum, mp_ball_mul(x, x));
}

static long double norm(struct mp_ball squares)
{
	return mp_ball_most(mp_ball_sqrt(squares));
}

/* Entry ${i} of inertia*axis - moment*axis. */
static struct mp_ball residual(const double inertia[3][3], const double axis[3], double moment,
			       int i)
{
	struct mp_ball x = mp_ball_exact(0);

	for (int j = 0; j < 3; j++)
		x = mp_ball_add(x,
				mp_ball_mul(mp_ball_exact(inertia[i][j]), mp_ball_exact(axis[j])));
	return mp_ball_sub(x, mp_ball_mul(mp_ball_exact(moment), mp_ball_exact(axis[i])));
}

static struct mp_ball dot(const double a[3], const double b[3])
{
	struct mp_ball x = mp_ball_exact(0);

	for (int k = 0; k < 3; k++)
		x = mp_ball_add(x, mp_ball_mul(mp_ball_exact(a[k]), mp_ball_exact(b[k])));
	return x;
}

/* Norm of (axes axes^T - 1): no less than how far the axes are from orthonormal ones. */
static long double skew(const double axes[3][3])
{
	struct mp_ball sum = mp_ball_exact(0);

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			sum = square_sum(
			    sum, mp_ball_sub(dot(axes[i], axes[j]), mp_ball_exact(i == j ? 1 : 0)));
	return norm(sum);
}

long double mp_principal_residual(const double inertia[3][3], const double axis[3], double moment)
{
	struct mp_ball sum = mp_ball_exact(0);

	for (int i = 0; i < 3; i++)
		sum = square_sum(sum, residual(inertia, axis, moment, i));
	return norm(sum);
}

/*
 * With axes V = Q + dV, Q orthogonal, |dV| <= skew, and R = A V^T - V^T L:
 * |A Q^T - Q^T L| <= |R| + skew*(|A| + |L|), and what it is at most, the eigenvalues are off by.
 */
long double mp_principal_error(const double inertia[3][3], const double axes[3][3],
			       const double moments[3])
{
	struct mp_ball r = mp_ball_exact(0), a = r, l = r;

	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 3; i++) {
			r = square_sum(r, residual(inertia, axes[k], moments[k], i));
			a = square_sum(a, mp_ball_exact(inertia[k][i]));
		}
		l = square_sum(l, mp_ball_exact(moments[k]));
	}
	return mp_ball_most(
	    mp_ball_add(mp_ball_exact(norm(r)),
			mp_ball_mul(mp_ball_exact(skew(axes)),
				    mp_ball_add(mp_ball_exact(norm(a)), mp_ball_exact(norm(l))))));
}
