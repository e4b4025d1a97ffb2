#include "core/topology/vertices.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/topology/recent.h"
#include "core/topology/vertex_load.h"
#include "core/topology/vertex_table.h"

enum {
	FIRST_BITS = 10,          /* slots to begin with: 8 kB, so that small parts stay cheap */
	RECENT_FROM = 8192,       /* vertices that make it worth while to remember recent ones */
	CORNERS = MP_RECENT_BATCH /* looked up together, to hide the memory's latency */
};
#define RECENT_UP_TO (MP_RECENT_MISSING - CORNERS) /* vertices, so that no number is beyond */

#define MOST_VERTICES (UINT32_MAX - 1) /* number + 1 fits 32 bits; UINT32_MAX names none */

static struct mp_vertices *new_empty(const uint64_t key[6], struct mp_error *err)
{
	struct mp_vertices *v = calloc(1, sizeof *v);

	if (v == NULL)
		goto err0;
	memcpy(v->key, key, sizeof v->key);
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

struct mp_vertices *mp_vertices_new(const uint8_t key[16], struct mp_error *err)
{
	uint64_t words[6];

	expand_key(key, words);
	return new_empty(words, err);
}

struct mp_vertices *mp_vertices_new_like(const struct mp_vertices *v, struct mp_error *err)
{
	return new_empty(v->key, err);
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

/* The corners of a batch, without -0, as the table keeps them: equal ones have equal bits. */
struct batch {
	union {
		float narrow[CORNERS][3];
		uint64_t wide[CORNERS][3];
	} key;
	struct mp_slot_corner corner[CORNERS];
};

/* Whether doubles are kept is known where these are called: two copies of the loops. */
#define INLINE static inline __attribute__((always_inline))

INLINE size_t bytes_of(bool wide)
{
	return 3 * (wide ? sizeof(double) : sizeof(float));
}

INLINE const void *key_of(const struct batch *b, bool wide, unsigned i)
{
	return wide ? (const void *)b->key.wide[i] : (const void *)b->key.narrow[i];
}

static int fail_most(const struct mp_vertices *v, struct mp_error *err)
{
	return mp_fail_limit(err, MP_NO_BYTE, MOST_VERTICES, (uint64_t)v->count + 1,
			     "more than 4294967294 different vertices");
}

INLINE int find_or_add(struct mp_vertices *v, bool wide, const void *key, struct mp_slot_corner *c,
		       struct mp_error *err)
{
	uint64_t mask = ((uint64_t)1 << v->bits) - 1;
	size_t each = bytes_of(wide);
	uint64_t at = c->at;
	char *xyz = v->xyz;

	for (; v->slot[at] != 0; at = (at + 1) & mask) {
		c->number = (uint32_t)v->slot[at] - 1;
		if (v->slot[at] >> 32 == c->tag && same_words(wide, xyz + c->number * each, key))
			return 0;
	}
	if (v->count >= MOST_VERTICES)
		return fail_most(v, err);
	c->number = v->count++;
	memcpy(xyz + c->number * each, key, each);
	v->slot[at] = (uint64_t)c->tag << 32 | v->count;
	return 0;
}

/* Hash the corners and ask memory for their slots. */
INLINE void hash_all(const struct mp_vertices *v, bool wide, struct batch *b, unsigned n)
{
	const uint64_t *slot = v->slot;
	unsigned bits = v->bits;
	uint64_t key[6];

	memcpy(key, v->key, sizeof key);
	for (unsigned i = 0; i < n; i++) {
		b->corner[i].tag = hash(key, wide, key_of(b, wide, i));
		__builtin_prefetch(&slot[home(b->corner[i].tag, bits)]);
	}
}

INLINE int look_up_as(struct mp_vertices *v, bool wide, struct batch *b, unsigned n,
		      struct mp_error *err)
{
	hash_all(v, wide, b, n);
	mp_slots_find(v->slot, v->bits, v->xyz, bytes_of(wide), b->corner, n);
	for (unsigned i = 0; i < n; i++)
		if (find_or_add(v, wide, key_of(b, wide, i), &b->corner[i], err))
			return -1;
	v->hashed = v->count;
	return 0;
}

/* The numbers of ${n} corners, in this order. */
static int look_up(struct mp_vertices *v, struct batch *b, unsigned n, struct mp_error *err)
{
	return v->wide ? look_up_as(v, true, b, n, err) : look_up_as(v, false, b, n, err);
}

/* The same, but only for those that are none of the recent ones. */
static int look_up_rest(struct mp_vertices *v, struct batch *b, unsigned n, uint32_t *out,
			struct mp_error *err)
{
	struct mp_recent_batch recent;
	uint32_t number[CORNERS];

	if (v->wide) /* leaves the others in front */
		mp_recent_look_wide(&v->recent, b->key.wide, n, &recent);
	else
		mp_recent_look_narrow(&v->recent, b->key.narrow, n, &recent);
	if (look_up(v, b, recent.missing, err))
		return -1;
	for (unsigned i = 0; i < recent.missing; i++)
		number[i] = b->corner[i].number;
	mp_recent_learn(&v->recent, &recent, number, n, out);
	return 0;
}

/* One of the three: corners, or all of a block. */
struct source {
	const double (*point)[3];
	const float (*narrow)[3];
	const float (*xyz)[MP_BLOCK];
};

/* ${n} corners from ${done} on, of floats. */
static void load_floats(const struct source *from, size_t done, unsigned n, bool wide,
			struct batch *b)
{
	float held[CORNERS][3] = {{0}}, (*narrow)[3] = wide ? held : b->key.narrow;

	if (from->xyz != NULL)
		load_columns(from->xyz, done / 3, n / 3, narrow[0]);
	else
		for (unsigned i = 0; i < 3 * n; i++)
			narrow[i / 3][i % 3] = from->narrow[done + i / 3][i % 3] + 0.0F;
	for (unsigned i = 0; wide && i < 3 * n; i++)
		b->key.wide[i / 3][i % 3] = bits_of((double)held[i / 3][i % 3]);
}

/* ${n} corners from ${done} on. */
static int load(struct mp_vertices *v, const struct source *from, size_t done, unsigned n,
		struct batch *b, struct mp_error *err)
{
	const double *x;

	if (from->point == NULL) {
		load_floats(from, done, n, v->wide, b);
		return 0;
	}
	x = from->point[done];
	if (!v->wide && load_narrow(x, 3 * n, b->key.narrow[0]) && mp_table_widen(v, err))
		return -1;
	if (v->wide)
		load_wide(x, 3 * n, b->key.wide[0]);
	return 0;
}

static int add_batch(struct mp_vertices *v, const struct source *from, size_t done, unsigned n,
		     bool recent, uint32_t *out, struct mp_error *err)
{
	struct batch b;

	if (mp_table_reserve(v, n, err) || load(v, from, done, n, &b, err))
		return -1;
	if (recent && v->count >= RECENT_FROM && v->count < RECENT_UP_TO &&
	    mp_recent_wanted(&v->recent, v->wide))
		return look_up_rest(v, &b, n, out, err);
	if (look_up(v, &b, n, err))
		return -1;
	for (unsigned i = 0; i < n; i++)
		out[i] = b.corner[i].number;
	return 0;
}

static int add_all(struct mp_vertices *v, const struct source *from, size_t count, bool recent,
		   uint32_t *out, struct mp_error *err)
{
	assert(v->slot != NULL); /* not sealed */
	for (size_t done = 0; done < count;) {
		unsigned n = count - done < CORNERS ? (unsigned)(count - done) : CORNERS;

		if (add_batch(v, from, done, n, recent, out + done, err))
			return -1;
		done += n;
	}
	return 0;
}

int mp_vertices_add(struct mp_vertices *v, const double (*tri)[9], size_t count, uint32_t (*out)[3],
		    struct mp_error *err)
{
	const struct source from = {.point = (const double(*)[3])(const void *)tri};

	return add_all(v, &from, 3 * count, true, (uint32_t *)(void *)out, err);
}

int mp_vertices_add_floats(struct mp_vertices *v, const float (*xyz)[MP_BLOCK], size_t count,
			   uint32_t (*out)[3], struct mp_error *err)
{
	const struct source from = {.xyz = xyz};

	return add_all(v, &from, 3 * count, true, (uint32_t *)(void *)out, err);
}

int mp_vertices_add_points(struct mp_vertices *v, const double (*point)[3], size_t count,
			   uint32_t *out, struct mp_error *err)
{
	const struct source from = {.point = point};

	return add_all(v, &from, count, false, out, err);
}

int mp_vertices_add_float_points(struct mp_vertices *v, const float (*point)[3], size_t count,
				 uint32_t *out, struct mp_error *err)
{
	const struct source from = {.narrow = point};

	return add_all(v, &from, count, false, out, err);
}

int mp_vertices_append(struct mp_vertices *v, const float (*point)[3], size_t count,
		       struct mp_error *err)
{
	const float *from = (const float *)(const void *)point;
	size_t at = 3 * (size_t)v->count;

	if (count > MOST_VERTICES - v->count)
		return fail_most(v, err);
	if (mp_table_reserve_xyz(v, v->count + (uint64_t)count, err))
		return -1;
	for (size_t i = 0; i < 3 * count && !v->wide; i++)
		((float *)v->xyz)[at + i] = from[i] + 0.0F;
	for (size_t i = 0; i < 3 * count && v->wide; i++)
		((double *)v->xyz)[at + i] = (double)from[i] + 0.0;
	v->count += (uint32_t)count;
	return 0;
}

void mp_vertices_expect(struct mp_vertices *v, uint64_t count, bool look_up)
{
	struct mp_error ignored;
	uint64_t all = v->count + count + CORNERS;

	if (count >= MOST_VERTICES - v->count || (look_up && mp_table_expect(v, all, &ignored)))
		return;
	if (all > v->room)
		(void)mp_table_resize(v, all, v->wide, &ignored);
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
		(void)mp_table_resize(v, v->count, v->wide, &ignored);
}
