#ifndef TEST_SECOND_THREAD_H
#define TEST_SECOND_THREAD_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/second.h"

/* A second thread to lend: ${second}.lent, between begin() and end(). */
struct second_thread {
	struct mp_second lent;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t change;
	void (*work)(void *arg); /* NULL: done */
	void *arg;
	bool over;
	unsigned begun; /* how often it was given work */
};

static inline void *second_thread_run(void *self)
{
	struct second_thread *s = self;

	pthread_mutex_lock(&s->lock);
	while (!s->over) {
		if (s->work == NULL) {
			pthread_cond_wait(&s->change, &s->lock);
			continue;
		}
		pthread_mutex_unlock(&s->lock);
		s->work(s->arg);
		pthread_mutex_lock(&s->lock);
		s->work = NULL;
		pthread_cond_broadcast(&s->change);
	}
	pthread_mutex_unlock(&s->lock);
	return NULL;
}

static inline void second_thread_give(void *self, void (*work)(void *arg), void *arg)
{
	struct second_thread *s = self;

	pthread_mutex_lock(&s->lock);
	s->arg = arg;
	s->work = work;
	s->begun++;
	pthread_cond_broadcast(&s->change);
	pthread_mutex_unlock(&s->lock);
}

static inline void second_thread_wait(void *self)
{
	struct second_thread *s = self;

	pthread_mutex_lock(&s->lock);
	while (s->work != NULL)
		pthread_cond_wait(&s->change, &s->lock);
	pthread_mutex_unlock(&s->lock);
}

/* Whether it runs. */
static inline bool second_thread_begin(struct second_thread *s)
{
	*s = (struct second_thread){.lent = {second_thread_give, second_thread_wait, s}};
	pthread_mutex_init(&s->lock, NULL);
	pthread_cond_init(&s->change, NULL);
	return pthread_create(&s->thread, NULL, second_thread_run, s) == 0;
}

static inline void second_thread_end(struct second_thread *s)
{
	second_thread_wait(s);
	pthread_mutex_lock(&s->lock);
	s->over = true;
	pthread_cond_broadcast(&s->change);
	pthread_mutex_unlock(&s->lock);
	pthread_join(s->thread, NULL);
	pthread_cond_destroy(&s->change);
	pthread_mutex_destroy(&s->lock);
}

#endif
