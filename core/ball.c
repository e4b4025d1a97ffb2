#include "core/ball.h"

#include <float.h>
#include <math.h>

/*
 * Half a unit in the last place, relative: what one operation loses.  The double-double of PowerPC
 * calls 2^-1074 its epsilon and means nothing by it.
 */
#if LDBL_MANT_DIG == 106
#define UNIT 0x1p-100L
#else
#define UNIT (LDBL_EPSILON / 2)
#endif

/* Takes in the roundings and underflows of the six operations at most that make a radius. */
#define UPWARDS (1 + 16 * UNIT)
#define TINY    (8 * LDBL_TRUE_MIN)

struct mp_ball mp_ball(long double mid, long double rad)
{
	struct mp_ball b = {mid, rad};

	if (isnan(mid) || isnan(rad)) {
		b.mid = isnan(mid) ? 0 : mid;
		b.rad = INFINITY;
	}
	return b;
}

struct mp_ball mp_ball_exact(long double x)
{
	return mp_ball(x, 0);
}

/* ${mid} was rounded; ${rad}: what came in with the operands. */
static struct mp_ball rounded(long double mid, long double rad)
{
	return mp_ball(mid, (rad + fabsl(mid) * UNIT) * UPWARDS + TINY);
}

static bool is_zero(struct mp_ball a)
{
	return a.mid == 0 && a.rad == 0;
}

struct mp_ball mp_ball_add(struct mp_ball a, struct mp_ball b)
{
	if (is_zero(b))
		return mp_ball(a.mid + b.mid, a.rad);
	if (is_zero(a))
		return mp_ball(a.mid + b.mid, b.rad);
	if (a.mid + b.mid == 0) /* nothing was rounded */
		return mp_ball(0, (a.rad + b.rad) * UPWARDS);
	return rounded(a.mid + b.mid, a.rad + b.rad);
}

struct mp_ball mp_ball_sub(struct mp_ball a, struct mp_ball b)
{
	return mp_ball_add(a, mp_ball_neg(b));
}

struct mp_ball mp_ball_mul(struct mp_ball a, struct mp_ball b)
{
	if (is_zero(a) || is_zero(b))
		return mp_ball_exact(0);
	return rounded(a.mid * b.mid, fabsl(a.mid) * b.rad + fabsl(b.mid) * a.rad + a.rad * b.rad);
}

struct mp_ball mp_ball_div(struct mp_ball a, struct mp_ball b)
{
	long double mid = a.mid / b.mid, least = mp_ball_least(b);

	if (!(least > 0))
		return mp_ball(mid, INFINITY);
	if (is_zero(a))
		return mp_ball_exact(0);
	return rounded(mid, (a.rad + fabsl(mid) * UPWARDS * b.rad) / least);
}

struct mp_ball mp_ball_neg(struct mp_ball a)
{
	return mp_ball(-a.mid, a.rad);
}

struct mp_ball mp_ball_abs(struct mp_ball a)
{
	return mp_ball(fabsl(a.mid), a.rad);
}

/* |sqrt(x) - sqrt(y)| <= sqrt(|x - y|), and = |x - y|/(sqrt(x) + sqrt(y)) */
struct mp_ball mp_ball_sqrt(struct mp_ball a)
{
	long double mid, rad = a.rad;

	if (is_zero(a))
		return a;
	if (a.mid < 0) {
		rad -= a.mid;
		a.mid = 0;
	}
	mid = sqrtl(a.mid);
	return rounded(mid, fminl(sqrtl(rad), mid > 0 ? rad / mid : INFINITY) * UPWARDS);
}

long double mp_ball_least(struct mp_ball a)
{
	long double least = fabsl(a.mid) - a.rad;

	return least > 0 ? least * (1 - 4 * UNIT) : 0;
}

long double mp_ball_most(struct mp_ball a)
{
	return (fabsl(a.mid) + a.rad) * UPWARDS;
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

	if (is_zero(d))
		return 0;
	return mp_round_up((fabsl(d.mid) + d.rad) * UPWARDS);
}
