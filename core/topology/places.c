#include "core/topology/places.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/topology/vertex_table.h"

enum {
	BITS_A_POINT =
	    16,         /* or up to twice as many: one point in 32 to 64 meets a bit that is set */
	LEAST_BITS = 6, /* of a word */
	BATCH = 64,     /* points in work at a time */
	AHEAD = 16      /* what to prefetch for: about the latency of a cache */
};

/* Points whose bit others have, too; and, while they are compared, how many are different. */
struct suspects {
	uint32_t *number;
	size_t count, room;
};

/* ${n} points from ${at} on, without -0. */
static void load(const struct mp_points *p, size_t at, size_t n, float (*xyz)[3])
{
	const unsigned char *from = p->data + p->stride * at;
	float *to = xyz[0];

	if (p->stride == sizeof *xyz)
		memcpy(to, from, n * sizeof *xyz);
	else
		for (size_t i = 0; i < n; i++)
			memcpy(xyz[i], from + p->stride * i, sizeof *xyz);
	for (size_t i = 0; i < 3 * n; i++)
		to[i] += 0.0F; /* -0 + 0 is +0 */
}

static unsigned bits_for(uint64_t points)
{
	unsigned bits = LEAST_BITS;

	while (bits < 32 && (uint64_t)1 << bits < BITS_A_POINT * points)
		bits++;
	return bits;
}

static void find_tags(const struct mp_vertices *v, const struct mp_points *p, uint32_t *tag)
{
	uint64_t key[6];

	memcpy(key, v->key, sizeof key);
	for (size_t at = 0; at < p->count; at += BATCH) {
		size_t n = p->count - at < BATCH ? p->count - at : BATCH;
		float xyz[BATCH][3];

		load(p, at, n, xyz);
		for (size_t i = 0; i < n; i++)
			tag[at + i] = hash(key, false, xyz[i]);
	}
}

/* Which bits the tags have, and which of these more than one of them has. */
static void mark(const uint32_t *tag, size_t count, unsigned bits, uint64_t *some, uint64_t *more)
{
	for (size_t i = 0; i < count; i++) {
		uint32_t at = tag[i] >> (32 - bits);
		uint64_t bit = (uint64_t)1 << at % 64, before = some[at / 64];

		if (i + AHEAD < count)
			__builtin_prefetch(&some[(tag[i + AHEAD] >> (32 - bits)) / 64], 1);
		some[at / 64] = before | bit;
		if ((before & bit) != 0)
			more[at / 64] |= bit;
	}
}

static bool keep(struct suspects *s, uint32_t number)
{
	if (s->count == s->room) {
		size_t room = s->room == 0 ? 1024 : 2 * s->room;
		uint32_t *new = realloc(s->number, room * sizeof *new);

		if (new == NULL)
			return false;
		s->number = new;
		s->room = room;
	}
	s->number[s->count++] = number;
	return true;
}

static bool gather(const uint32_t *tag, size_t count, unsigned bits, const uint64_t *more,
		   struct suspects *s)
{
	for (size_t i = 0; i < count; i++) {
		uint32_t at = tag[i] >> (32 - bits);

		if ((more[at / 64] >> at % 64 & 1) != 0 && !keep(s, (uint32_t)i))
			return false;
	}
	return true;
}

static bool find_suspects(const struct mp_vertices *v, const struct mp_points *p,
			  struct suspects *s)
{
	const unsigned bits = bits_for(p->count);
	const size_t words = (size_t)1 << (bits - LEAST_BITS);
	uint64_t *some = calloc(2 * words, sizeof *some);
	uint32_t *tag = malloc(p->count * sizeof *tag);
	bool done = some != NULL && tag != NULL;

	if (done) {
		find_tags(v, p, tag);
		mark(tag, p->count, bits, some, some + words);
		done = gather(tag, p->count, bits, some + words, s);
	}
	free(tag);
	free(some);
	return done;
}

/* In ${set}, a table of their own; ${number}: of each suspect. */
static bool number_suspects(struct mp_vertices *set, const struct mp_points *p,
			    const struct suspects *s, uint32_t *number)
{
	struct mp_error ignored;

	for (size_t at = 0; at < s->count; at += BATCH) {
		size_t n = s->count - at < BATCH ? s->count - at : BATCH;
		float point[BATCH][3];

		for (size_t i = 0; i < n; i++)
			load(p, s->number[at + i], 1, point + i);
		if (mp_vertices_add_float_points(set, (const float(*)[3])point, n, number + at,
						 &ignored))
			return false;
	}
	return true;
}

/* ${number}: which of ${count} < s->count places each suspect is. */
static bool join(struct mp_places *places, size_t points, const struct suspects *s,
		 const uint32_t *number, uint32_t count)
{
	uint32_t *first = malloc(points * sizeof *first),
		 *vertex = calloc(points + 1, sizeof *vertex);

	places->first = mp_huge(first, points * sizeof *first);
	places->vertex = mp_huge(vertex, points * sizeof *vertex);
	if (first == NULL || vertex == NULL)
		return false;
	for (size_t i = 0; i < points; i++)
		first[i] = (uint32_t)i;
	for (size_t i = 0, met = 0; i < s->count; i++) { /* places are numbered as they come */
		if (number[i] == met)
			vertex[met++] = s->number[i];
		first[s->number[i]] = vertex[number[i]];
	}
	memset(vertex, 0, count * sizeof *vertex);
	return true;
}

static bool compare(struct mp_places *places, const struct mp_vertices *v,
		    const struct mp_points *p, const struct suspects *s)
{
	struct mp_error ignored;
	struct mp_vertices *set = mp_vertices_new_like(v, &ignored);
	uint32_t *number = malloc(s->count * sizeof *number);
	bool done = set != NULL && number != NULL && number_suspects(set, p, s, number);

	if (done && mp_vertices_count(set) < s->count)
		done = join(places, p->count, s, number, mp_vertices_count(set));
	free(number);
	mp_vertices_free(set);
	return done;
}

void mp_places_find(struct mp_places *places, const struct mp_vertices *v,
		    const struct mp_points *points)
{
	struct suspects s = {0};

	memset(places, 0, sizeof *places);
	places->known =
	    find_suspects(v, points, &s) && (s.count == 0 || compare(places, v, points, &s));
	free(s.number);
	if (!places->known)
		mp_places_free(places);
}

int mp_places_add(struct mp_places *places, struct mp_vertices *v, const uint32_t *number,
		  float (*point)[3], size_t count, uint32_t *out, struct mp_error *err)
{
	const uint32_t begin = mp_vertices_count(v);
	uint32_t new = 0;

	if (places->first == NULL) {
		for (size_t i = 0; i < count; i++)
			out[i] = begin + (uint32_t)i;
		return mp_vertices_append(v, (const float(*)[3])point, count, err);
	}
	for (size_t i = 0; i < count; i++) {
		uint32_t *vertex = &places->vertex[places->first[number[i]]];

		memmove(point[new], point[i], sizeof *point);
		if (*vertex == 0)
			*vertex = begin + ++new;
		out[i] = *vertex - 1;
	}
	return mp_vertices_append(v, (const float(*)[3])point, new, err);
}

void mp_places_free(struct mp_places *places)
{
	free(places->first);
	free(places->vertex);
	memset(places, 0, sizeof *places);
}
