#include "server/worker.h"

#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "server/channel.h"
#include "server/clock.h"
#include "server/io.h"
#include "server/second.h"

/*
 * Fresh pages cost more than anything that is done with them, so what was touched stays, mapped and
 * warm, for the next job.  If none comes for a while, or none that is large, all but KEEP bytes are
 * given back.
 */
enum { KEEP = 64 << 20, REST_S = 1, LARGE = 4 << 20 /* bytes of a body */ };

enum { KEYS = 16, KEY_BYTES = sizeof((struct api_job_head *)0)->key };
enum { PIECE = 1 << 20 }; /* bytes of a large answer that are there twice */

/* Waking the front costs as much as a small job: while there are more, it hears of several. */
static const double most_unsaid_s = 100e-6;

struct worker {
	const struct srv_config *config;
	int sock, file; /* file: came along with the last message, -1: none */
	struct srv_desk *desk;
	struct srv_segment *segment; /* of the job in work */
	uint32_t done;               /* jobs behind it */
	uint32_t said;               /* of which the front may have heard */
	double unsaid_since;
	double
	    large_at; /* when a large job ended, as long as its memory was not given back; or 0 */
	uint8_t key[KEYS][KEY_BYTES];
	unsigned keys;
	struct mp_second *second; /* NULL: none */
};

static void tell(struct worker *w, enum srv_message what, const int *fd, size_t fds)
{
	char byte = (char)what;

	if (srv_channel_send(w->sock, &byte, 1, fd, fds) != 0)
		_exit(errno == EPIPE || errno == ECONNRESET ? 0 : 3);
}

static void drop_file(struct worker *w)
{
	if (w->file >= 0)
		close(w->file);
	w->file = -1;
}

/*
 * Sleep until a message comes: something has changed.  False where none has come for REST_S.  Exits
 * where the front is gone.
 */
static bool heard(struct worker *w)
{
	size_t fds = 1;
	char byte;
	int fd;
	ssize_t n = srv_channel_receive(w->sock, &byte, 1, &fd, &fds);

	if (n < 0 && errno == EAGAIN)
		return false;
	if (n <= 0)
		_exit(0);
	if (fds == 0)
		return true;
	drop_file(w);
	w->file = fd;
	return true;
}

static void hear(struct worker *w)
{
	while (!heard(w))
		;
}

static void give_back(struct worker *w)
{
	(void)malloc_trim(KEEP);
	w->large_at = 0;
}

static void rest(struct worker *w)
{
	struct pollfd next = {.fd = w->sock, .events = POLLIN};

	if (heard(w))
		return;
	give_back(w);
	(void)poll(&next, 1, -1); /* for however long it takes */
	hear(w);
}

/* Receiving ends by itself after REST_S: poll() before it, with a timeout, would be one call more.
 */
static void limit_sleep(int sock)
{
	const struct timeval most = {.tv_sec = REST_S};

	(void)setsockopt(sock, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof most);
}

static bool cancelled(const struct worker *w)
{
	return atomic_load(&w->segment->cancelled) != 0;
}

/* The bytes that were spooled before this worker was free.  False: cancelled or unreadable. */
static bool feed_spooled(struct worker *w, struct api_job *job)
{
	static uint8_t chunk[256 << 10];
	uint64_t left = w->segment->words.spooled, at = 0;

	while (w->file < 0) /* it is on its way */
		hear(w);
	while (left > 0) {
		size_t want = left < sizeof chunk ? (size_t)left : sizeof chunk;
		ssize_t n = cancelled(w) ? 0 : pread(w->file, chunk, want, (off_t)at);

		if (n <= 0)
			return false;
		if (api_job_push(job, chunk, (size_t)n) != 0)
			return true;
		at += (uint64_t)n;
		left -= (uint64_t)n;
	}
	return true;
}

/* The bytes that flow through the ring, until their end or a verdict.  False: cancelled. */
static bool feed_ring(struct worker *w, struct api_job *job)
{
	for (;;) {
		const uint8_t *bytes;
		bool ended;
		size_t n = srv_ring_peek(w->segment, &bytes, &ended);

		if (cancelled(w))
			return false;
		if (n > 0) {
			int verdict = api_job_push(job, bytes, n);

			if (srv_ring_take(w->segment, n))
				tell(w, SRV_MSG_ROOM, NULL, 0);
			if (verdict != 0)
				return true;
		} else if (ended) {
			return true;
		} else if (srv_ring_sleep(w->segment)) {
			hear(w);
		}
	}
}

/*
 * Give the whole pages of what lies between the two back to the system, though it stays allocated:
 * nobody reads it any more.
 */
static void drop_pages(char *from, const char *to)
{
	size_t page = (size_t)sysconf(_SC_PAGESIZE);
	size_t skip = (page - (uintptr_t)from % page) % page, len = (size_t)(to - from);

	if (len >= skip + page)
		(void)madvise(from + skip, (len - skip) / page * page, MADV_DONTNEED);
}

/* Moves the answer into the file piece by piece, so that there is never all of it twice. */
static int move_all(int fd, char *bytes, size_t len)
{
	while (len > 0) {
		size_t piece = len < PIECE ? len : PIECE;

		if (srv_write_all(fd, bytes, piece) != 0)
			return -1;
		drop_pages(bytes, bytes + piece);
		bytes += piece;
		len -= piece;
	}
	return fcntl(fd, F_ADD_SEALS, SRV_ANSWER_SEALS);
}

static void copy_text(char *to, size_t size, const char *from)
{
	size_t n = strnlen(from, size - 1);

	memcpy(to, from, n);
	to[n] = '\0';
}

/* Put the answer where the front will look; the descriptor to send along, or -1. */
static int place_answer(struct worker *w, const struct api_answer *a)
{
	struct srv_result *r = &w->segment->result;
	int fd = -1;

	memset(r, 0, sizeof *r);
	r->status = a->status;
	r->code = (int32_t)a->code;
	r->len = a->len;
	r->retire = a->retire;
	r->triangles = a->triangles;
	r->bytes = a->bytes;
	r->decode_ms = a->timing.decode;
	r->analyse_ms = a->timing.analyse;
	copy_text(r->format, sizeof r->format, a->format);
	copy_text(r->content_type, sizeof r->content_type, a->content_type);
	copy_text(r->origin, sizeof r->origin, a->origin);
	if (a->len <= SRV_ANSWER) {
		memcpy(w->segment->answer, a->body, a->len);
	} else {
		fd = memfd_create("answer", MFD_CLOEXEC | MFD_ALLOW_SEALING);
		if (fd < 0 || move_all(fd, a->body, a->len) != 0)
			_exit(SRV_EXIT_NO_MEMORY); /* the front answers for us */
	}
	return fd;
}

/*
 * The last of a job.  Its memory is given back before the front hears of it: where the file has
 * damaged the heap, it is this request that pays and not the next one.
 */
static void answer(struct worker *w, struct api_job *job, double queue_ms)
{
	struct api_answer a;
	int fd;

	api_job_answer(job, w->segment->receive_ms, queue_ms, &a);
	if (a.bytes >= LARGE)
		w->large_at = srv_now();
	fd = place_answer(w, &a);
	if (!a.retire) {
		api_answer_free(&a);
		api_job_free(job);
	}
	if (fd >= 0) {
		tell(w, SRV_MSG_FILE, &fd, 1);
		close(fd);
	}
	if (!a.retire)
		return;
	srv_desk_done(w->desk, w->done + 1);
	tell(w, SRV_MSG_DONE, NULL, 0);
	_exit(SRV_EXIT_RETIRED); /* whatever the file did ends with it */
}

/* A key that no other job has had, nor can guess: drawn in advance, one system call for several. */
static void take_key(struct worker *w, uint8_t key[KEY_BYTES])
{
	if (w->keys == 0) {
		if (getrandom(w->key, sizeof w->key, 0) != (ssize_t)sizeof w->key)
			_exit(5);
		w->keys = KEYS;
	}
	memcpy(key, w->key[--w->keys], KEY_BYTES);
	memset(w->key[w->keys], 0, KEY_BYTES);
}

static struct api_job *begin(struct worker *w)
{
	struct srv_words *words = &w->segment->words;
	struct api_job_head head = {
	    .query = words->query,
	    .query_len = words->query_len,
	    .content_type = words->has_content_type ? words->content_type : NULL,
	    .content_encoding = words->has_content_encoding ? words->content_encoding : NULL,
	    .instance = words->instance,
	    .request_id = words->request_id,
	    .mesh = words->mesh,
	    .limits = {w->config->max_decoded, w->config->max_triangles},
	    .second = w->second,
	    .now = srv_now};

	take_key(w, head.key);
	return api_job_new(&head);
}

/* Closes the spooled file once it is read: what comes behind it may take its time. */
static void work(struct worker *w)
{
	double queue_ms = 1e3 * (srv_now() - w->segment->queued_at);
	struct api_job *job = begin(w);
	bool fed;

	if (job == NULL)
		_exit(SRV_EXIT_NO_MEMORY); /* a fresh process is the best answer */
	fed = w->segment->words.spooled == 0 || feed_spooled(w, job);
	drop_file(w);
	if (fed && feed_ring(w, job)) {
		answer(w, job, queue_ms);
	} else {
		api_job_free(job);
		if (w->large_at == 0)
			w->large_at = srv_now(); /* or so it may have been */
	}
}

/* One more job is over.  Who waits for its answer hears of it at once, or soon. */
static void say_done(struct worker *w)
{
	double now = srv_now();

	srv_desk_done(w->desk, ++w->done);
	if (w->done - w->said == 1)
		w->unsaid_since = now;
	if (srv_desk_job(w->desk, w->done) != NULL && now - w->unsaid_since < most_unsaid_s)
		return;
	w->said = w->done;
	if (srv_desk_must_tell_front(w->desk))
		tell(w, SRV_MSG_DONE, NULL, 0);
	if (w->large_at > 0 && now - w->large_at > REST_S)
		give_back(w);
}

/*
 * What is mapped apart is unmapped when it is freed, and is cold the next time.  In the heap large
 * tables stay warm, but leave holes between them that count against the limit too: only where that
 * is far away, so that no file fails for those before it.
 */
static void set_heap(const struct srv_config *config)
{
	enum { PLENTY = 100 }; /* bytes for each triangle: twice of what meshes of millions take */
	struct rlimit most;

	mallopt(M_ARENA_MAX, 1); /* what one thread frees serves the other */
	if (getrlimit(RLIMIT_DATA, &most) == 0 && most.rlim_cur / PLENTY >= config->max_triangles)
		mallopt(M_MMAP_MAX, 0);
	else
		mallopt(M_MMAP_THRESHOLD, 32 << 20); /* the largest there is */
	mallopt(M_TRIM_THRESHOLD, -1);               /* only where give_back() says so */
}

void srv_worker_run(const struct srv_config *config, int sock, struct srv_desk *desk, bool large)
{
	struct worker w = {.config = config, .sock = sock, .file = -1, .desk = desk};
	struct srv_second second;
	char why[200];
	int seconds;

	limit_sleep(sock);
	set_heap(config);
	seconds = large ? srv_second_start(&second, config->sandbox) : 0;
	if (seconds < 0 ||
	    srv_sandbox_obey(config->sandbox, SRV_SANDBOX_WORKER, why, sizeof why) != 0)
		_exit(7); /* the front said why and has not begun either */
	w.second = seconds > 0 ? &second.lent : NULL;

	hear(&w); /* until then the desk may be the last worker's */
	for (;;) {
		w.segment = srv_desk_job(desk, w.done);
		if (w.segment != NULL) {
			if (srv_desk_begin(w.segment))
				work(&w);
			say_done(&w);
		} else if (srv_desk_worker_sleeps(desk, w.done)) {
			rest(&w);
		}
	}
}
