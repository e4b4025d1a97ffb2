#include "core/moments/ball.h"

/* |sqrt(x) - sqrt(y)| <= sqrt(|x - y|), and = |x - y|/(sqrt(x) + sqrt(y)) */
struct mp_ball mp_ball_sqrt(struct mp_ball a)
{
	long double mid, rad = a.rad;

	if (mp_ball_is_zero(a))
		return a;
	if (a.mid < 0) {
		rad -= a.mid;
		a.mid = 0;
	}
	mid = sqrtl(a.mid);
	return mp_ball_rounded(mid,
			       fminl(sqrtl(rad), mid > 0 ? rad / mid : INFINITY) * MP_BALL_UPWARDS);
}

long double mp_ball_most(struct mp_ball a)
{
	return (fabsl(a.mid) + a.rad) * MP_BALL_UPWARDS;
}

bool mp_ball_not_zero(struct mp_ball a)
{
	return isfinite(a.mid) && fabsl(a.mid) > a.rad * (1 + 0x1p-10L);
}

double mp_round_up(long double x)
{
	double d = (double)x;

	return (long double)d < x ? nextafter(d, INFINITY) : d;
}

double mp_ball_distance(struct mp_ball a, double x)
{
	struct mp_ball d = mp_ball_sub(a, mp_ball_exact(x));

	return mp_ball_is_zero(d) ? 0 : mp_round_up((fabsl(d.mid) + d.rad) * MP_BALL_UPWARDS);
}
