#include "server/segment.h"

#include <string.h>

/*
 * One producer, one consumer, positions that only grow.  Sleeping is Dekker's pattern: set the
 * flag, then look again; the other side moves its position, then looks at the flag.  Sequentially
 * consistent accesses on both make sure that one of the two sees the other.
 */

void srv_ring_reset(struct srv_segment *s)
{
	atomic_store(&s->head, 0);
	atomic_store(&s->tail, 0);
	atomic_store(&s->ended, 0);
	atomic_store(&s->cancelled, 0);
	atomic_store(&s->front_waits, 0);
	atomic_store(&s->worker_waits, 0);
	s->receive_ms = s->queued_at = 0;
}

/* The worker owns tail: what it says is clamped, so that no lie leads outside the ring. */
static size_t room(struct srv_segment *s, uint64_t head)
{
	uint64_t used = head - atomic_load(&s->tail);

	return used > SRV_RING ? 0 : (size_t)(SRV_RING - used);
}

static void copy_in(struct srv_segment *s, uint64_t head, const uint8_t *bytes, size_t len)
{
	size_t at = (size_t)(head & (SRV_RING - 1)), first = SRV_RING - at;

	if (len == 0) /* bytes may be NULL then */
		return;
	if (first > len)
		first = len;
	memcpy(s->ring + at, bytes, first);
	memcpy(s->ring, bytes + first, len - first);
}

static bool take_flag(_Atomic uint32_t *flag)
{
	return atomic_load(flag) != 0 && atomic_exchange(flag, 0) != 0;
}

size_t srv_ring_put(struct srv_segment *s, const uint8_t *bytes, size_t len, bool *wake)
{
	uint64_t head = atomic_load_explicit(&s->head, memory_order_relaxed);
	size_t n = room(s, head);

	if (n < len) {
		atomic_store(&s->front_waits, 1);
		n = room(s, head);
	}
	if (n >= len) {
		n = len;
		atomic_store(&s->front_waits, 0);
	}
	copy_in(s, head, bytes, n);
	srv_ring_filled(s, n, wake);
	return n;
}

size_t srv_ring_room(struct srv_segment *s, struct iovec room_at[2])
{
	uint64_t head = atomic_load_explicit(&s->head, memory_order_relaxed);
	size_t n = room(s, head), at = (size_t)(head & (SRV_RING - 1)), first = SRV_RING - at;

	if (first > n)
		first = n;
	room_at[0] = (struct iovec){s->ring + at, first};
	room_at[1] = (struct iovec){s->ring, n - first};
	return n;
}

void srv_ring_filled(struct srv_segment *s, size_t len, bool *wake)
{
	uint64_t head = atomic_load_explicit(&s->head, memory_order_relaxed) + len;

	atomic_store(&s->head, head);
	*wake = len > 0 && SRV_RING - room(s, head) >= SRV_RING / 4 && take_flag(&s->worker_waits);
}

bool srv_ring_wake(struct srv_segment *s)
{
	return room(s, atomic_load_explicit(&s->head, memory_order_relaxed)) < SRV_RING &&
	       take_flag(&s->worker_waits);
}

void srv_ring_end(struct srv_segment *s, bool *wake)
{
	atomic_store(&s->ended, 1);
	*wake = take_flag(&s->worker_waits);
}

size_t srv_ring_peek(struct srv_segment *s, const uint8_t **bytes, bool *ended)
{
	bool last = atomic_load(&s->ended) != 0; /* before head: what it ends is in */
	uint64_t tail = atomic_load_explicit(&s->tail, memory_order_relaxed);
	uint64_t used = atomic_load(&s->head) - tail;
	size_t at = (size_t)(tail & (SRV_RING - 1));
	size_t n = used > SRV_RING / 8 ? SRV_RING / 8 : (size_t)used;

	*bytes = s->ring + at;
	*ended = last;
	return n < SRV_RING - at ? n : SRV_RING - at;
}

/* The front is woken once half of the ring is free: a wake-up for every chunk would cost more. */
bool srv_ring_take(struct srv_segment *s, size_t len)
{
	uint64_t tail = atomic_load_explicit(&s->tail, memory_order_relaxed) + len;

	atomic_store(&s->tail, tail);
	return atomic_load(&s->head) - tail <= SRV_RING / 2 && take_flag(&s->front_waits);
}

bool srv_ring_sleep(struct srv_segment *s)
{
	atomic_store(&s->worker_waits, 1);
	if (atomic_load(&s->head) == atomic_load(&s->tail) && atomic_load(&s->ended) == 0 &&
	    atomic_load(&s->cancelled) == 0)
		return true;
	atomic_store(&s->worker_waits, 0);
	return false;
}
