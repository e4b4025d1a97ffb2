#include <string.h>
#include <strings.h>

#include "server/channel.h"
#include "server/clock.h"
#include "server/front_private.h"
#include "server/http.h"
#include "server/pool_private.h"

/* What a worker is given, and when. */

/*
 * Bodies of which a worker may have several: some 600 facets.  They take less than a millisecond,
 * nearly all; behind one that has taken TURN nobody has to wait.
 */
enum { BRIEF = 32 << 10 };
static const double turn_s = 5e-3;
enum { TURN_MS = 5 };

/*
 * What work costs, in the time that a byte of binary STL takes, some 6 ns: the smallest report is
 * EACH.  Where less than WORTH_WAKING stands before it, a request comes to its turn about as soon
 * as another worker would be awake.
 */
enum { EACH = 3000, WORTH_WAKING = 30000 };

/* The front tells a worker of so many at the latest; else when it has seen to all connections. */
enum { MOST_UNTOLD = 4 };

/*
 * May ${ex} stand behind another request?  Not where libdraco could come to see it: who has met
 * that code sees no other request's bytes.  A Draco file that is no part of a form and not encoded
 * begins with DRACO, or is refused before libdraco is asked.
 */
static bool is_brief(const struct srv_exchange *ex)
{
	return ex->small && ex->plain && ex->body_ended && ex->body.fd < 0 && ex->body.len > 0 &&
	       ex->body.len <= BRIEF && ex->body.bytes[0] != 'D';
}

unsigned srv_pool_waiting(const struct srv_pool *p, bool small)
{
	unsigned behind = 0;

	for (unsigned i = 0; small && i < p->workers; i++)
		for (unsigned k = 1; k < p->worker[i].posts; k++)
			behind += p->worker[i].post[k].exchange != NULL;
	return behind + (small ? p->small.length : p->large.length);
}

bool srv_pool_accepts(const struct srv_pool *p, bool small)
{
	const struct srv_queue *q = small ? &p->small : &p->large;

	return srv_pool_waiting(p, small) < q->most || srv_pool_idle(p, false) != NULL ||
	       (small && srv_pool_idle(p, true) != NULL);
}

int srv_pool_enqueue(struct srv_pool *p, struct srv_exchange *ex)
{
	struct srv_queue *q = ex->small ? &p->small : &p->large;

	if (!srv_pool_accepts(p, ex->small))
		return -1;
	srv_queue_add(q, ex);
	return 0;
}

static void set_words(struct srv_words *words, const struct srv_exchange *ex)
{
	words->query_len = (uint32_t)ex->query_len;
	if (ex->query_len > 0)
		memcpy(words->query, ex->query, ex->query_len);
	words->has_content_type = ex->has_content_type;
	words->has_content_encoding = ex->has_content_encoding;
	memcpy(words->content_type, ex->content_type, sizeof words->content_type);
	memcpy(words->content_encoding, ex->content_encoding, sizeof words->content_encoding);
	strncpy(words->instance, ex->path, sizeof words->instance - 1);
	memcpy(words->request_id, ex->id, sizeof words->request_id);
	words->mesh = ex->endpoint == SRV_MESH;
	words->spooled = ex->body.spooled;
}

/* What has come of the body goes over, the rest will follow. */
static void fill(struct srv_segment *s, const struct srv_exchange *ex)
{
	bool wake;

	srv_ring_reset(s);
	set_words(&s->words, ex);
	memset(&s->result, 0, sizeof s->result);
	s->queued_at = ex->queued_at;
	if (ex->body.fd < 0)
		(void)srv_ring_put(s, ex->body.bytes, ex->body.len, &wake);
	if (ex->body_ended) {
		s->receive_ms = 1e3 * (ex->last_byte - ex->began);
		srv_ring_end(s, &wake);
	}
}

static unsigned free_berth(const struct srv_worker *w)
{
	unsigned taken = 0, berth = 0;

	for (unsigned i = 0; i < w->posts; i++)
		taken |= 1u << w->post[i].berth;
	while ((taken >> berth & 1) != 0)
		berth++;
	return berth;
}

/* False: it is dead, and what it was given is back in the queue. */
static bool tell_of_posts(struct srv_pool *p, struct srv_worker *w)
{
	struct srv_exchange *first;

	w->untold = false;
	if (!srv_desk_must_tell_worker(w->desk) || srv_pool_tell(w, SRV_MSG_WAKE, -1) == 0)
		return true;
	srv_pool_bury(p, w);
	first = w->post[0].exchange;
	if (first != NULL && !first->put_back) /* once: it may be the one that kills */
		first->put_back = true;
	else
		first = NULL;
	srv_pool_take_back(p, w, first == NULL, false);
	return false;
}

static void add_post(struct srv_worker *w, struct srv_exchange *ex)
{
	struct srv_post *post = &w->post[w->posts];

	post->exchange = ex;
	post->berth = free_berth(w);
	post->cost = EACH + ex->body.len;
	ex->worker = w;
	ex->segment = &w->desk->berth[post->berth];
	ex->dispatched = srv_now();
	fill(ex->segment, ex);
	srv_desk_post(w->desk, w->posted++, post->berth);
	w->cost += post->cost;
	w->posts++;
}

/* Nobody has given it anything, and yet it says that jobs are over: the next one would be. */
static bool is_ahead(struct srv_worker *w)
{
	return w->posts == 0 && !srv_desk_is_at(w->desk, w->heard);
}

/*
 * ${w} gets ${ex}, which is in no queue.  What is brief may come back and keeps its body here.
 * False where the worker died just now or cannot be trusted; ${ex} is as it was.
 */
static bool post(struct srv_pool *p, struct srv_worker *w, struct srv_exchange *ex)
{
	bool brief = is_brief(ex);

	if (is_ahead(w) || (ex->body.fd >= 0 && srv_pool_tell(w, SRV_MSG_FILE, ex->body.fd) != 0)) {
		srv_pool_bury(p, w);
		return false;
	}
	add_post(w, ex);
	w->untold = true;
	if (w->posts == 1) {
		w->state = SRV_BUSY;
		w->since = ex->dispatched;
		w->brief = brief;
	}
	if (brief && w->posts < MOST_UNTOLD)
		return true;
	if (!tell_of_posts(p, w) || brief)
		return true;
	srv_body_clear(&ex->body);
	if (!ex->body_ended)
		srv_http_resume(ex);
	return true;
}

/* A worker at brief work that may have ${ex}, which is brief, behind it: the one with the least. */
static struct srv_worker *busy(const struct srv_pool *p, const struct srv_exchange *ex, double now)
{
	struct srv_worker *best = NULL;

	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];
		bool due =
		    !w->lane && p->large.first != NULL && p->large.first->queued_at < ex->queued_at;

		if (w->state == SRV_BUSY && w->brief && !w->ended && w->posts < SRV_BERTHS &&
		    !due && now - w->since < turn_s && (best == NULL || w->posts < best->posts))
			best = w;
	}
	return best;
}

/* Who is to have ${ex}, the first of the small ones: somebody idle, or the end of a short line. */
static struct srv_worker *find_for_small(const struct srv_pool *p, const struct srv_exchange *ex,
					 bool any)
{
	struct srv_worker *line = is_brief(ex) ? busy(p, ex, srv_now()) : NULL, *w;

	if (line != NULL && line->cost <= WORTH_WAKING &&
	    srv_pool_waiting(p, true) <= p->small.most)
		return line;
	w = srv_pool_idle(p, true);
	if (w == NULL && any)
		w = srv_pool_idle(p, false);
	return w != NULL ? w : line;
}

void srv_pool_dispatch(struct srv_pool *p)
{
	for (;;) {
		struct srv_exchange *small = p->small.first, *large = p->large.first;
		bool older =
		    large != NULL && (small == NULL || large->queued_at < small->queued_at);
		struct srv_worker *w = small != NULL ? find_for_small(p, small, !older) : NULL;
		struct srv_exchange *ex = small;
		struct srv_queue *q;

		if (w == NULL) {
			w = large != NULL ? srv_pool_idle(p, false) : NULL;
			ex = large;
		}
		if (w == NULL)
			return;
		q = ex->small ? &p->small : &p->large;
		srv_queue_remove(q, ex);
		if (!post(p, w, ex))
			srv_queue_put_back(q, ex);
	}
}

void srv_pool_take_back(struct srv_pool *p, struct srv_worker *w, unsigned from, bool dead)
{
	w->brief = false;
	for (unsigned i = w->posts; i-- > from;) {
		struct srv_exchange *ex = w->post[i].exchange;

		if (!srv_desk_withdraw(&w->desk->berth[w->post[i].berth]) && !dead)
			return;
		if (ex == NULL)
			continue;
		w->post[i].exchange = NULL;
		ex->worker = NULL;
		ex->segment = NULL;
		srv_queue_put_back(ex->small ? &p->small : &p->large, ex);
	}
}

/* Nobody waits longer than for his turn where the first one takes its time. */
static bool take_turns(struct srv_pool *p)
{
	bool behind = false;
	double now = 0;

	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];

		if (w->state != SRV_BUSY || w->posts < 2 || !w->brief)
			continue;
		now = now == 0 ? srv_now() : now;
		if (now - w->since >= turn_s)
			srv_pool_take_back(p, w, 1, false);
		else
			behind = true;
	}
	return behind;
}

int srv_pool_before_sleep(struct srv_pool *p, int ms)
{
	if (take_turns(p) && ms > TURN_MS)
		ms = TURN_MS;
	srv_pool_dispatch(p);
	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];

		if (w->state != SRV_BUSY)
			continue;
		if ((w->untold && !tell_of_posts(p, w)) ||
		    !srv_desk_front_sleeps(w->desk, w->heard))
			ms = 0;
	}
	return ms;
}

void srv_pool_after_sleep(struct srv_pool *p)
{
	for (unsigned i = 0; i < p->workers; i++) {
		struct srv_worker *w = &p->worker[i];

		if (w->state != SRV_BUSY)
			continue;
		srv_desk_front_woke(w->desk);
		srv_pool_collect(p, w);
	}
	srv_pool_dispatch(p);
}
