#ifndef MP_SECOND_H
#define MP_SECOND_H

#include <stddef.h>

/*
 * A second thread, lent by the caller for the length of a call: core starts none.  What it is given
 * runs beside the caller's own work; both are such that the result is the same to the last bit
 * whether they do or one follows the other.
 */
struct mp_second {
	/* Begin work(arg) and return.  What was begun before must have been waited for. */
	void (*begin)(void *self, void (*work)(void *arg), void *arg);
	void (*wait)(void *self); /* until it is done; at once where there is nothing */
	void *self;
};

/* ${second} NULL: there is none, and the work is done here and now. */
static inline void mp_second_begin(const struct mp_second *second, void (*work)(void *arg),
				   void *arg)
{
	if (second != NULL)
		second->begin(second->self, work, arg);
	else
		work(arg);
}

static inline void mp_second_wait(const struct mp_second *second)
{
	if (second != NULL)
		second->wait(second->self);
}

/* work(one) here and work(other) by the second thread; without one, ${other} is not worked on. */
static inline void mp_second_share(const struct mp_second *second, void (*work)(void *arg),
				   void *one, void *other)
{
	if (second != NULL)
		second->begin(second->self, work, other);
	work(one);
	mp_second_wait(second);
}

#endif
