#include "core/topology/vertices.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/topology/recent.h"
#include "core/topology/vertex_bits.h"
#include "core/topology/vertex_slots.h"

struct mp_vertices {
	uint64_t key[6];
	void *memory;   /* where slot lies */
	uint64_t *slot; /* 1 << bits of them, from the begin of a line */
	unsigned bits;
	uint32_t count;
	uint64_t room; /* vertices that xyz has memory for */
	bool wide;     /* xyz holds doubles, else floats */
	void *xyz;     /* 3 * count coordinates */
	struct mp_recent recent;
};

enum {
	FIRST_BITS = 10,    /* slots to begin with: 8 kB, so that small parts stay cheap */
	RECENT_FROM = 8192, /* vertices that make it worth while to remember recent ones */
	BATCH =
	    MP_RECENT_BATCH / 3, /* triangles looked up together, to hide the memory's latency */
	CORNERS = 3 * BATCH
};

#define MOST_VERTICES (UINT32_MAX - 1) /* number + 1 fits 32 bits; UINT32_MAX names none */

struct mp_vertices *mp_vertices_new(const uint8_t key[16], struct mp_error *err)
{
	struct mp_vertices *v = calloc(1, sizeof *v);

	if (v == NULL)
		goto err0;
	expand_key(key, v->key);
	v->bits = FIRST_BITS;
	v->slot = new_slots(v->bits, &v->memory);
	if (v->slot == NULL)
		goto err1;
	return v;
err1:
	free(v);
err0:
	mp_fail_nomem(err);
	return NULL;
}

void mp_vertices_free(struct mp_vertices *v)
{
	if (v == NULL)
		return;
	free(v->memory);
	free(v->xyz);
	mp_recent_free(&v->recent);
	free(v);
}

static int grow_slots(struct mp_vertices *v, struct mp_error *err)
{
	uint64_t old = (uint64_t)1 << v->bits, mask = 2 * old - 1;
	void *memory;
	uint64_t *slot = new_slots(v->bits + 1, &memory);

	if (slot == NULL)
		return mp_fail_nomem(err);
	for (uint64_t i = 0; i < old; i++) {
		uint64_t at;

		if (v->slot[i] == 0)
			continue;
		at = home((uint32_t)(v->slot[i] >> 32), v->bits + 1);
		while (slot[at] != 0)
			at = (at + 1) & mask;
		slot[at] = v->slot[i];
	}
	free(v->memory);
	v->memory = memory;
	v->slot = slot;
	v->bits++;
	return 0;
}

static int resize_xyz(struct mp_vertices *v, uint64_t room, bool wide, struct mp_error *err)
{
	uint64_t each = 3 * (wide ? sizeof(double) : sizeof(float));
	void *p;

	if (room > SIZE_MAX / each)
		return mp_fail_nomem(err);
	p = mp_huge(realloc(v->xyz, (size_t)(room * each)), (size_t)(room * each));
	if (p == NULL)
		return mp_fail_nomem(err);
	v->xyz = p;
	v->room = room;
	return 0;
}

/* From floats to doubles, in place from the end.  Numbers and slots stay as they are. */
static int widen(struct mp_vertices *v, struct mp_error *err)
{
	unsigned char *bytes;

	if (v->room > 0 && resize_xyz(v, v->room, true, err))
		return -1;
	bytes = v->xyz;
	for (size_t i = 3 * (size_t)v->count; i-- > 0;) {
		float narrow;
		double x;

		memcpy(&narrow, bytes + i * sizeof narrow, sizeof narrow);
		x = (double)narrow;
		memcpy(bytes + i * sizeof x, &x, sizeof x);
	}
	v->wide = true;
	return 0;
}

/* Make room for ${extra} more vertices, so that nothing moves while a batch is looked up. */
static int reserve(struct mp_vertices *v, unsigned extra, struct mp_error *err)
{
	uint64_t want = (uint64_t)v->count + extra;

	/* At most 5 of 8 slots are taken: a miss looks at 4 slots on average, a hit at 2. */
	while (want > ((uint64_t)5 << v->bits) / 8)
		if (grow_slots(v, err))
			return -1;
	if (want > v->room)
		return resize_xyz(v, want + want / 2, v->wide, err);
	return 0;
}

static bool equal(const struct mp_vertices *v, uint32_t number, const double p[3])
{
	size_t at = 3 * (size_t)number;

	if (v->wide) {
		const double *q = (const double *)v->xyz + at;

		return q[0] == p[0] && q[1] == p[1] && q[2] == p[2];
	} else {
		const float *q = (const float *)v->xyz + at;

		return (double)q[0] == p[0] && (double)q[1] == p[1] && (double)q[2] == p[2];
	}
}

static void store(struct mp_vertices *v, uint32_t number, const double p[3])
{
	size_t at = 3 * (size_t)number;

	for (unsigned k = 0; k < 3; k++) {
		if (v->wide)
			((double *)v->xyz)[at + k] = p[k];
		else
			((float *)v->xyz)[at + k] = (float)p[k];
	}
}

static int find_or_add(struct mp_vertices *v, const uint64_t word[3], struct mp_slot_corner *c,
		       struct mp_error *err)
{
	uint64_t mask = ((uint64_t)1 << v->bits) - 1;
	uint64_t at = c->at;
	double p[3];

	memcpy(p, word, sizeof p);
	for (; v->slot[at] != 0; at = (at + 1) & mask) {
		c->number = (uint32_t)v->slot[at] - 1;
		if (v->slot[at] >> 32 == c->tag && equal(v, c->number, p))
			return 0;
	}
	if (v->count >= MOST_VERTICES)
		return mp_fail_limit(err, MP_NO_BYTE, MOST_VERTICES, (uint64_t)v->count + 1,
				     "more than 4294967294 different vertices");
	c->number = v->count++;
	store(v, c->number, p);
	v->slot[at] = (uint64_t)c->tag << 32 | v->count;
	return 0;
}

/* ${count} coordinates without -0; returns whether floats may not hold them. */
static bool load(const double *x, unsigned count, uint64_t *word)
{
	struct float_doubt doubt = {0, 0};

	for (unsigned i = 0; i < count; i++) {
		uint64_t w = bits_of(x[i] + 0.0); /* -0 + 0 is +0 */

		doubt_float(&doubt, w);
		word[i] = w;
	}
	return is_doubtful(&doubt);
}

static bool all_fit(const double (*tri)[9], unsigned count)
{
	for (unsigned i = 0; i < 9 * count; i++)
		if (!fits_float(tri[i / 9][i % 9]))
			return false;
	return true;
}

/* Hash the corners and ask memory for their slots. */
static void hash_all(const struct mp_vertices *v, const uint64_t (*word)[3],
		     struct mp_slot_corner *c, unsigned n)
{
	const uint64_t *slot = v->slot;
	unsigned bits = v->bits;
	uint64_t key[6];

	memcpy(key, v->key, sizeof key);
	for (unsigned i = 0; i < n; i++) {
		c[i].tag = hash(key, word[i]);
		__builtin_prefetch(&slot[home(c[i].tag, bits)]);
	}
}

/* The numbers of ${n} corners, in this order. */
static int look_up(struct mp_vertices *v, const uint64_t (*word)[3], struct mp_slot_corner *c,
		   unsigned n, struct mp_error *err)
{
	hash_all(v, word, c, n);
	mp_slots_find(v->slot, v->bits, v->xyz, 3 * (v->wide ? sizeof(double) : sizeof(float)), c,
		      n);
	for (unsigned i = 0; i < n; i++)
		if (find_or_add(v, word[i], &c[i], err))
			return -1;
	return 0;
}

/* The same, but only for those that are none of the recent ones. */
static int look_up_rest(struct mp_vertices *v, uint64_t (*word)[3], struct mp_slot_corner *c,
			unsigned n, uint32_t (*out)[3], struct mp_error *err)
{
	struct mp_recent_batch batch;
	uint32_t number[CORNERS];

	mp_recent_look(&v->recent, word, n, &batch); /* leaves the others in front */
	if (look_up(v, (const uint64_t(*)[3])word, c, batch.missing, err))
		return -1;
	for (unsigned i = 0; i < batch.missing; i++)
		number[i] = c[i].number;
	mp_recent_learn(&v->recent, &batch, number, n, (uint32_t *)out);
	return 0;
}

static int add_batch(struct mp_vertices *v, const double (*tri)[9], unsigned count,
		     uint32_t (*out)[3], struct mp_error *err)
{
	uint64_t word[CORNERS][3];
	struct mp_slot_corner c[CORNERS];

	if (reserve(v, 3 * count, err))
		return -1;
	if (load(tri[0], 9 * count, word[0]) && !v->wide && !all_fit(tri, count) && widen(v, err))
		return -1;
	if (v->count >= RECENT_FROM && mp_recent_wanted(&v->recent))
		return look_up_rest(v, word, c, 3 * count, out, err);
	if (look_up(v, (const uint64_t(*)[3])word, c, 3 * count, err))
		return -1;
	for (unsigned i = 0; i < 3 * count; i++)
		out[i / 3][i % 3] = c[i].number;
	return 0;
}

int mp_vertices_add(struct mp_vertices *v, const double (*tri)[9], size_t count, uint32_t (*out)[3],
		    struct mp_error *err)
{
	assert(v->slot != NULL); /* not sealed */
	for (size_t done = 0; done < count;) {
		unsigned n = count - done < BATCH ? (unsigned)(count - done) : BATCH;

		if (add_batch(v, tri + done, n, out + done, err))
			return -1;
		done += n;
	}
	return 0;
}

uint32_t mp_vertices_count(const struct mp_vertices *v)
{
	return v->count;
}

void mp_vertices_get(const struct mp_vertices *v, uint32_t number, double xyz[3])
{
	const double *wide = (const double *)v->xyz + 3 * (size_t)number;
	const float *narrow = (const float *)v->xyz + 3 * (size_t)number;

	if (v->wide) {
		memcpy(xyz, wide, 3 * sizeof *wide);
		return;
	}
	xyz[0] = (double)narrow[0];
	xyz[1] = (double)narrow[1];
	xyz[2] = (double)narrow[2];
}

void mp_vertices_corners(const struct mp_vertices *v, const uint32_t number[3], double xyz[3][3])
{
	for (int c = 0; c < 3; c++)
		mp_vertices_get(v, number[c], xyz[c]);
}

void mp_vertices_all(const struct mp_vertices *v, const float **narrow, const double **wide)
{
	*narrow = v->wide ? NULL : v->xyz;
	*wide = v->wide ? v->xyz : NULL;
}

void mp_vertices_prefetch(const struct mp_vertices *v, uint32_t number)
{
	size_t each = 3 * (v->wide ? sizeof(double) : sizeof(float));

	__builtin_prefetch((const char *)v->xyz + number * each);
}

void mp_vertices_prefetch_corners(const struct mp_vertices *v, const uint32_t number[3])
{
	for (int c = 0; c < 3; c++)
		mp_vertices_prefetch(v, number[c]);
}

void mp_vertices_seal(struct mp_vertices *v)
{
	struct mp_error ignored;

	free(v->memory);
	v->memory = v->slot = NULL;
	mp_recent_free(&v->recent);
	if (v->count > 0) /* what was in reserve; keeping it is no error */
		(void)resize_xyz(v, v->count, v->wide, &ignored);
}
