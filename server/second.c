#include "server/second.h"

#include <sched.h>
#include <signal.h>
#include <string.h>

#include "server/sandbox.h"

enum { STACK = 1 << 20 }; /* address space; a few pages of it are used */

static void begin(void *self, void (*work)(void *arg), void *arg)
{
	struct srv_second *s = self;

	pthread_mutex_lock(&s->lock);
	s->work = work;
	s->arg = arg;
	pthread_cond_signal(&s->given);
	pthread_mutex_unlock(&s->lock);
}

static void wait_for_it(void *self)
{
	struct srv_second *s = self;

	pthread_mutex_lock(&s->lock);
	while (s->work != NULL)
		pthread_cond_wait(&s->done, &s->lock);
	pthread_mutex_unlock(&s->lock);
}

/* The lock is held whenever this returns. */
static void serve(struct srv_second *s)
{
	while (s->work == NULL)
		pthread_cond_wait(&s->given, &s->lock);
	pthread_mutex_unlock(&s->lock);
	s->work(s->arg);
	pthread_mutex_lock(&s->lock);
	s->work = NULL;
	pthread_cond_signal(&s->done);
}

static void *run(void *self)
{
	struct srv_second *s = self;
	char why[200];
	bool refused = srv_sandbox_obey(s->sandbox, SRV_SANDBOX_WORKER, why, sizeof why) != 0;

	pthread_mutex_lock(&s->lock);
	s->refused = refused;
	s->started = true;
	pthread_cond_signal(&s->done);
	if (!refused)
		for (;;)
			serve(s);
	pthread_mutex_unlock(&s->lock);
	return NULL;
}

static bool has_processors(void)
{
	cpu_set_t set;

	return sched_getaffinity(0, sizeof set, &set) != 0 || CPU_COUNT(&set) > 1;
}

/* Signals are for the first thread. */
static int create(struct srv_second *s)
{
	pthread_attr_t attr;
	sigset_t all, before;
	int rc;

	if (pthread_attr_init(&attr) != 0)
		return -1;
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	rc = pthread_attr_setstacksize(&attr, STACK);
	rc = rc != 0 ? rc : pthread_create(&s->thread, &attr, run, s);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	pthread_attr_destroy(&attr);
	return rc;
}

int srv_second_start(struct srv_second *s, enum srv_sandbox_mode sandbox)
{
	memset(s, 0, sizeof *s);
	s->lent = (struct mp_second){.begin = begin, .wait = wait_for_it, .self = s};
	s->sandbox = sandbox;
	pthread_mutex_init(&s->lock, NULL);
	pthread_cond_init(&s->given, NULL);
	pthread_cond_init(&s->done, NULL);
	if (!has_processors() || create(s) != 0)
		return 0;
	pthread_mutex_lock(&s->lock);
	while (!s->started)
		pthread_cond_wait(&s->done, &s->lock);
	pthread_mutex_unlock(&s->lock);
	return s->refused ? -1 : 1;
}
