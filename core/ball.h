#ifndef MP_BALL_H
#define MP_BALL_H

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

struct mp_ball mp_ball(long double mid, long double rad);
struct mp_ball mp_ball_exact(long double x);

struct mp_ball mp_ball_add(struct mp_ball a, struct mp_ball b);
struct mp_ball mp_ball_sub(struct mp_ball a, struct mp_ball b);
struct mp_ball mp_ball_mul(struct mp_ball a, struct mp_ball b);
struct mp_ball mp_ball_div(struct mp_ball a, struct mp_ball b); /* infinite rad: b may be 0 */
struct mp_ball mp_ball_neg(struct mp_ball a);
struct mp_ball mp_ball_abs(struct mp_ball a);
/* The exact value is known to be >= 0, whatever mid is. */
struct mp_ball mp_ball_sqrt(struct mp_ball a);

/* The least and the most that |exact value| may be, rounded downwards and upwards. */
long double mp_ball_least(struct mp_ball a);
long double mp_ball_most(struct mp_ball a);

/* Is the exact value not 0 for certain, and the ball good to divide by? */
bool mp_ball_not_zero(struct mp_ball a);

/* |exact value - x| at most, rounded up to a double; may be infinite. */
double mp_ball_distance(struct mp_ball a, double x);

/* The next double that is not below ${x} >= 0. */
double mp_round_up(long double x);

#endif
