#ifndef MP_BALL_H
#define MP_BALL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

/*
 * A number with its error: the exact value lies within ${rad} of ${mid}.  Midpoint-radius
 * arithmetic (van der Hoeven, Ball arithmetic, 2009): mid is what plain long double arithmetic
 * gives, to the bit, so that asking for a bound changes no result; rad is rounded upwards and
 * takes in what mid's own operation lost, underflow too.  Correct for every long double that is a
 * binary floating-point type rounding to nearest, a plain double among them.
 */
struct mp_ball {
	long double mid, rad; /* rad >= 0; infinite: nothing is known; never NaN */
};

/*
 * Half a unit in the last place, relative: what one operation loses.  The double-double of PowerPC
 * calls 2^-1074 its epsilon and means nothing by it.
 */
#if LDBL_MANT_DIG == 106
#define MP_BALL_UNIT 0x1p-100L
#else
#define MP_BALL_UNIT (LDBL_EPSILON / 2)
#endif

/*
 * Take in the roundings and underflows of the six operations at most that make a radius.  TINY is
 * far more than underflow can lose, but a normal number: x87 takes its time over any other.
 */
#define MP_BALL_UPWARDS (1 + 16 * MP_BALL_UNIT)
#define MP_BALL_TINY    LDBL_MIN

static inline struct mp_ball mp_ball(long double mid, long double rad)
{
	struct mp_ball unknown = {0, INFINITY}, known = {mid, rad};

	return isnan(mid) || isnan(rad) ? unknown : known;
}

static inline struct mp_ball mp_ball_exact(long double x)
{
	return mp_ball(x, 0);
}

static inline bool mp_ball_is_zero(struct mp_ball a)
{
	return a.mid == 0 && a.rad == 0;
}

/* ${mid} was rounded; ${rad}: what came in with the operands. */
static inline struct mp_ball mp_ball_rounded(long double mid, long double rad)
{
	return mp_ball(mid, (rad + fabsl(mid) * MP_BALL_UNIT) * MP_BALL_UPWARDS + MP_BALL_TINY);
}

/* Where the sum is 0, nothing was rounded. */
static inline struct mp_ball mp_ball_add(struct mp_ball a, struct mp_ball b)
{
	struct mp_ball sum = {a.mid + b.mid, a.rad + b.rad};

	return mp_ball_is_zero(sum) ? sum : mp_ball_rounded(sum.mid, sum.rad);
}

static inline struct mp_ball mp_ball_neg(struct mp_ball a)
{
	return (struct mp_ball){-a.mid, a.rad};
}

static inline struct mp_ball mp_ball_sub(struct mp_ball a, struct mp_ball b)
{
	return mp_ball_add(a, mp_ball_neg(b));
}

static inline struct mp_ball mp_ball_mul(struct mp_ball a, struct mp_ball b)
{
	if (mp_ball_is_zero(a) || mp_ball_is_zero(b))
		return mp_ball_exact(0);
	return mp_ball_rounded(a.mid * b.mid,
			       fabsl(a.mid) * b.rad + (fabsl(b.mid) + b.rad) * a.rad);
}

static inline struct mp_ball mp_ball_abs(struct mp_ball a)
{
	return (struct mp_ball){fabsl(a.mid), a.rad};
}

/* The least that |exact value| may be, rounded downwards; and the most, upwards. */
static inline long double mp_ball_least(struct mp_ball a)
{
	long double least = fabsl(a.mid) - a.rad;

	return least > 0 ? least * (1 - 4 * MP_BALL_UNIT) : 0;
}
long double mp_ball_most(struct mp_ball a);

/* Infinite where b may be 0. */
static inline struct mp_ball mp_ball_div(struct mp_ball a, struct mp_ball b)
{
	long double mid = a.mid / b.mid, least = mp_ball_least(b);

	if (!(least > 0))
		return mp_ball(mid, INFINITY);
	if (mp_ball_is_zero(a))
		return mp_ball_exact(0);
	return mp_ball_rounded(mid, (a.rad + fabsl(mid) * MP_BALL_UPWARDS * b.rad) / least);
}

/* The exact value is known to be >= 0, whatever mid is. */
struct mp_ball mp_ball_sqrt(struct mp_ball a);

/* Is the exact value not 0 for certain, and the ball good to divide by? */
bool mp_ball_not_zero(struct mp_ball a);

/* |exact value - x| at most, rounded up to a double; may be infinite. */
double mp_ball_distance(struct mp_ball a, double x);

/* The next double that is not below ${x} >= 0. */
double mp_round_up(long double x);

#endif
