#ifndef SRV_SEGMENT_H
#define SRV_SEGMENT_H

#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/uio.h>

#include "api/job.h"

/*
 * The shared memory for one job of a worker: the words of the request, a ring through which its
 * body flows, and the answer.  The front trusts nothing that it reads from it: the
 * worker on the other side has met the uploader's bytes.
 */
enum {
	SRV_RING = 1 << 20,       /* bytes, a power of two */
	SRV_ANSWER = 256 << 10,   /* a longer answer travels as a descriptor */
	SRV_QUERY_MAX = 16 << 10, /* longest query that is taken */
	SRV_HEADER_MAX = 512,     /* longest Content-Type or Content-Encoding */
	SRV_ID_MAX = 64,
	SRV_FORMAT_NAME = 16
};

struct srv_words { /* front to worker */
	char query[SRV_QUERY_MAX];
	uint32_t query_len;
	bool has_content_type, has_content_encoding;
	char content_type[SRV_HEADER_MAX], content_encoding[SRV_HEADER_MAX];
	bool mesh; /* the mesh is wanted, not the report */
	char instance[32], request_id[SRV_ID_MAX + 1];
	uint64_t spooled; /* bytes of the body that come first, from the descriptor sent along */
};

struct srv_result {           /* worker to front */
	int32_t status, code; /* HTTP, enum api_code */
	int32_t retire;       /* not 0: it exits by itself now and takes no further job */
	uint64_t len, triangles, bytes;
	double decode_ms, analyse_ms;
	char format[SRV_FORMAT_NAME];
	char content_type[64];
	char origin[API_MESH_ORIGIN];
};

enum srv_job_state { SRV_JOB_WAITS, SRV_JOB_BEGUN, SRV_JOB_WITHDRAWN };

struct srv_segment {
	_Atomic uint64_t head;         /* bytes that the front has put in, ever */
	_Atomic uint64_t tail;         /* bytes that the worker has taken out, ever */
	_Atomic uint32_t ended;        /* no more bytes behind head */
	_Atomic uint32_t cancelled;    /* nobody wants the answer any more */
	_Atomic uint32_t front_waits;  /* tell the front when there is room */
	_Atomic uint32_t worker_waits; /* tell the worker when there are bytes */
	_Atomic uint32_t begun;        /* enum srv_job_state; see desk.h */
	double receive_ms;             /* set before ended */
	double queued_at;              /* srv_now() when it began to wait for a worker */
	struct srv_words words;
	struct srv_result result;
	uint8_t ring[SRV_RING];
	char answer[SRV_ANSWER];
};

/*
 * What a worker does to the file of a large answer, and the front insists on: it stays as it was
 * measured and charged, whatever becomes of the worker.  A file that shrinks while it is being
 * sent would never end, one that can be written could show another client's answer.
 */
enum { SRV_ANSWER_SEALS = F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE };

/*
 * Messages on the socket pair, one byte each.  What they are about is in memory: they wake who
 * sleeps, and FILE brings the descriptor of a spooled body or of a large answer along, before the
 * memory says that there is one.
 */
enum srv_message {
	SRV_MSG_BEGIN = 'B', /* front: the desk is in order, the worker may begin */
	SRV_MSG_WAKE = 'W',  /* front: a job, bytes, the end of a body, or a cancellation */
	SRV_MSG_ROOM = 'R',  /* worker: the ring has room again */
	SRV_MSG_DONE = 'D',  /* worker: jobs are over */
	SRV_MSG_FILE = 'F'   /* both */
};

/* Front: empty the ring for the next job. Legal only while the worker has nothing to do with it. */
void srv_ring_reset(struct srv_segment *);

/*
 * Front: put up to ${len} bytes in; returns how many fitted.  Sets ${*wake} where the worker
 * sleeps and must be told, which it need not be for less than SRV_RING / 4 bytes: whoever puts so
 * few asks srv_ring_wake() when more is not coming at once.  Less than ${len}: front_waits is set,
 * a ROOM message will come.
 */
size_t srv_ring_put(struct srv_segment *, const uint8_t *bytes, size_t len, bool *wake);

/*
 * Front: the room that there is, in two pieces (the second one may be empty), for others to write
 * to; then how many bytes have been written there, with ${*wake} as above.
 */
size_t srv_ring_room(struct srv_segment *, struct iovec room[2]);
void srv_ring_filled(struct srv_segment *, size_t len, bool *wake);

/* Front: does the worker sleep over bytes, and must be told? */
bool srv_ring_wake(struct srv_segment *);

/* Front: no more bytes will come.  Sets ${*wake} as above. */
void srv_ring_end(struct srv_segment *, bool *wake);

/*
 * Worker: the next contiguous bytes (at most SRV_RING / 8, so that room is made early), 0 if none
 * are there; ${*ended} tells whether more can come.  srv_ring_take() gives them back and returns
 * true where the front waits and must be told.
 */
size_t srv_ring_peek(struct srv_segment *, const uint8_t **bytes, bool *ended);
bool srv_ring_take(struct srv_segment *, size_t len);

/* Worker: about to sleep; false where bytes, the end or a cancellation came meanwhile. */
bool srv_ring_sleep(struct srv_segment *);

#endif
