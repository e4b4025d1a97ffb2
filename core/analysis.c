#include <stdlib.h>
#include <string.h>

#include "core/analysis_state.h"
#include "core/bodies/named.h"
#include "core/geometry/predicates.h"
#include "core/memory/huge.h"
#include "core/notes.h"
#include "core/report/report_parts.h"

/* Triangle numbers are uint32_t and UINT32_MAX means none. */
#define MOST_TRIANGLES (UINT32_MAX - 1)

/* How many words mp_flat_mark() needs for so many triangles. */
static size_t flat_words(size_t triangles)
{
	return triangles / MP_FLAT_GROUP / 64 + 1;
}

static int reserve_flat(struct mp_analysis *a, size_t room, struct mp_error *err)
{
	size_t before = a->flat == NULL ? 0 : flat_words(a->room), after = flat_words(room);
	uint64_t *new = realloc(a->flat, after * sizeof *new);

	if (new == NULL)
		return mp_fail_nomem(err);
	memset(new + before, 0, (after - before) * sizeof *new);
	a->flat = new;
	return 0;
}

static int resize(struct mp_analysis *a, size_t room, struct mp_error *err)
{
	void *new;

	if (reserve_flat(a, room, err))
		return -1;
	if (room > SIZE_MAX / sizeof *a->tri ||
	    (new = realloc(a->tri, room * sizeof *a->tri)) == NULL)
		return mp_fail_nomem(err);
	a->tri = mp_huge(new, room * sizeof *a->tri);
	a->room = room;
	return 0;
}

static int reserve(struct mp_analysis *a, size_t count, struct mp_error *err)
{
	size_t need = a->triangles + count, room = a->room;

	if (need <= room)
		return 0;
	while (room < need)
		room = room < 1024 ? 1024 : 2 * room; /* need < 2^33: no overflow in 64 bits */
	return resize(a, room, err);
}

/* What is in memory will come: room for all of it.  Where there is none, it will be told. */
static void expect(void *self, uint64_t triangles, const struct mp_points *points)
{
	struct mp_analysis *a = self;
	struct mp_error ignored;

	if (triangles > a->request.limits.max_triangles || triangles > MOST_TRIANGLES)
		return;
	if (a->triangles + triangles > a->room)
		(void)resize(a, (size_t)(a->triangles + triangles), &ignored);
	if (points->count / 3 < triangles) /* not mostly points that nobody uses */
		mp_index_expect(&a->index, a->vertices, points);
}

/* Has some triangle three different corners?  The first one nearly always. */
static bool has_edges(const double (*tri)[9], size_t count)
{
	for (size_t i = 0; i < count; i++) {
		unsigned same = 0;

		for (size_t k = 0; k < 9; k += 3) {
			const double *p = tri[i] + k, *q = tri[i] + (k + 3) % 9;

			same += p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
		}
		if (same == 0)
			return true;
	}
	return false;
}

static bool has_edges_floats(const float (*xyz)[MP_BLOCK], size_t count)
{
	for (size_t i = 0; i < count; i++) {
		double t[1][9];

		for (size_t k = 0; k < 9; k++)
			t[0][k] = (double)xyz[k][i];
		if (has_edges((const double(*)[9])t, 1))
			return true;
	}
	return false;
}

static int count_streamed(struct mp_analysis *a, size_t count, struct mp_error *err)
{
	if (count > MP_FINGERPRINT_MOST - a->triangles)
		return mp_fail_limit(err, MP_NO_BYTE, MP_FINGERPRINT_MOST, a->triangles + count,
				     "more than %llu triangles",
				     (unsigned long long)MP_FINGERPRINT_MOST);
	a->triangles += count;
	return 0;
}

/* While the block is in the first-level cache: everything that is ever done with it. */
static int stream_block(void *self, const double (*tri)[9], size_t count, struct mp_error *err)
{
	struct mp_analysis *a = self;

	if (count_streamed(a, count, err))
		return -1;
	mp_moments_add(&a->moments, tri, count);
	mp_fingerprint_add(&a->fingerprint, tri, count);
	a->degenerate += mp_collinear_count(tri, count);
	a->edges = a->edges || has_edges(tri, count);
	return 0;
}

static int stream_floats(void *self, const float (*xyz)[MP_BLOCK], size_t count,
			 struct mp_error *err)
{
	struct mp_analysis *a = self;

	if (count_streamed(a, count, err))
		return -1;
	mp_moments_add_floats(&a->moments, xyz, count);
	mp_fingerprint_add_floats(&a->fingerprint, xyz, count);
	a->degenerate += mp_collinear_count_floats(xyz, count);
	a->edges = a->edges || has_edges_floats(xyz, count);
	return 0;
}

/* Find the vertices of a block, by the file's own numbers where they came before it. */
static int number_corners(struct mp_analysis *a, const double (*tri)[9], size_t count,
			  struct mp_error *err)
{
	const uint32_t(*numbers)[3] = a->numbers;

	a->numbers = NULL;
	if (numbers == NULL)
		return mp_vertices_add(a->vertices, tri, count, a->tri + a->triangles, err);
	return mp_index_add(&a->index, a->vertices, tri, numbers, count, a->tri + a->triangles,
			    err);
}

static int number_corners_floats(struct mp_analysis *a, const float (*xyz)[MP_BLOCK], size_t count,
				 struct mp_error *err)
{
	const uint32_t(*numbers)[3] = a->numbers;

	a->numbers = NULL;
	if (numbers == NULL)
		return mp_vertices_add_floats(a->vertices, xyz, count, a->tri + a->triangles, err);
	return mp_index_add_floats(&a->index, a->vertices, xyz, numbers, count,
				   a->tri + a->triangles, err);
}

static int make_room(struct mp_analysis *a, size_t count, struct mp_error *err)
{
	uint64_t most = a->request.limits.max_triangles;

	if (most > MOST_TRIANGLES)
		most = MOST_TRIANGLES;
	if (count > most - a->triangles)
		return mp_fail_limit(err, MP_NO_BYTE, most, a->triangles + count,
				     "more than %llu triangles", (unsigned long long)most);
	return reserve(a, count, err);
}

static int take_block(void *self, const double (*tri)[9], size_t count, struct mp_error *err)
{
	struct mp_analysis *a = self;

	if (make_room(a, count, err) || number_corners(a, tri, count, err))
		return -1;
	mp_moments_add(&a->moments, tri, count);
	mp_flat_mark(tri, count, a->triangles, a->flat);
	a->triangles += count;
	return 0;
}

static int take_floats(void *self, const float (*xyz)[MP_BLOCK], size_t count, struct mp_error *err)
{
	struct mp_analysis *a = self;

	if (make_room(a, count, err) || number_corners_floats(a, xyz, count, err))
		return -1;
	mp_moments_add_floats(&a->moments, xyz, count);
	mp_flat_mark_floats(xyz, count, a->triangles, a->flat);
	a->triangles += count;
	return 0;
}

static int take_part(void *self, uint64_t first, const char *name, size_t len, struct mp_error *err)
{
	struct mp_analysis *a = self;

	return mp_parts_add(&a->names.parts, a->first + first, name, len, err);
}

static int take_object(void *self, uint64_t first, const char *name, size_t len,
		       struct mp_error *err)
{
	struct mp_analysis *a = self;

	return mp_parts_add(&a->names.objects, a->first + first, name, len, err);
}

static int take_material(void *self, uint64_t first, const char *name, size_t len,
			 struct mp_error *err)
{
	struct mp_analysis *a = self;

	/* where a file has materials, the faces before the first one have none */
	if (!a->has_material && mp_parts_add(&a->names.materials, a->first, "", 0, err))
		return -1;
	a->has_material = true;
	return mp_parts_add(&a->names.materials, a->first + first, name, len, err);
}

static int take_indices(void *self, const uint32_t (*tri)[3], size_t count, struct mp_error *err)
{
	struct mp_analysis *a = self;

	(void)count;
	(void)err;
	a->numbers = tri; /* for the block that follows */
	return 0;
}

static int begin(struct mp_analysis *a, enum mp_format_wish format, struct mp_error *err)
{
	if (a->streamed && format != MP_WISH_STL) {
		(void)mp_report_no_stream(err);
		return -1;
	}
	a->not_stl = a->not_stl || format != MP_WISH_STL;
	a->decoder = mp_format_decoder(format);
	return a->decoder->begin(&a->state, &a->sink, &a->request.limits, &a->notes, err);
}

struct mp_analysis *mp_analysis_new(const struct mp_request *request, struct mp_error *err)
{
	struct mp_analysis *a = calloc(1, sizeof *a);

	if (a == NULL) {
		(void)mp_fail_nomem(err);
		return NULL;
	}
	a->request = *request;
	a->request.named = NULL;
	a->request.named_count = 0;
	a->sink = (struct mp_sink){.block = take_block,
				   .floats = take_floats,
				   .part = take_part,
				   .self = a,
				   .indices = take_indices,
				   .expect = expect,
				   .material = take_material,
				   .object = take_object};
	mp_moments_begin(&a->moments);
	a->streamed = request->checks == MP_CHECKS_CLOSED;
	if (a->streamed) {
		a->sink =
		    (struct mp_sink){.block = stream_block, .floats = stream_floats, .self = a};
		a->request.limits.max_triangles = MP_FINGERPRINT_MOST;
		mp_fingerprint_begin(&a->fingerprint, request->key);
	} else if ((a->vertices = mp_vertices_new(request->key, err)) == NULL) {
		goto err1;
	}
	if (request->format != MP_WISH_AUTO && begin(a, request->format, err))
		goto err1;
	return a;
err1:
	mp_analysis_free(a);
	return NULL;
}

/* The format is decided by the first MP_SNIFF_BYTES bytes, however they came. */
static int decide(struct mp_analysis *a, struct mp_error *err)
{
	if (begin(a, mp_format_sniff(a->head, a->head_len), err))
		return -1;
	return a->decoder->push(a->state, a->head, a->head_len, err);
}

int mp_analysis_push(struct mp_analysis *a, const uint8_t *bytes, size_t len, struct mp_error *err)
{
	if (a->decoder == NULL) {
		size_t take = sizeof a->head - a->head_len;

		if (take > len)
			take = len;
		if (take == 0)
			return 0;
		memcpy(a->head + a->head_len, bytes, take);
		a->head_len += take;
		bytes += take;
		len -= take;
		if (a->head_len < sizeof a->head)
			return 0;
		if (decide(a, err))
			return -1;
	}
	return len == 0 ? 0 : a->decoder->push(a->state, bytes, len, err);
}

static int end_file(struct mp_analysis *a, struct mp_error *err)
{
	if (a->decoder == NULL && decide(a, err))
		return -1;
	if (a->decoder->finish(a->state, err))
		return -1;
	if (a->triangles == a->first)
		return mp_fail(err, MP_NO_FACES, MP_NO_BYTE, "the file has no triangles");
	a->decoder->end(a->state);
	a->state = NULL;
	mp_notes_add(&a->before, &a->notes);
	mp_index_next(&a->index, a->triangles);
	return 0;
}

int mp_analysis_next(struct mp_analysis *a, struct mp_error *err)
{
	if (end_file(a, err))
		return -1;
	a->decoder = NULL;
	a->head_len = 0;
	a->first = a->triangles;
	a->has_material = false;
	/* what has a name ends here, whether or not the next file names any */
	if (mp_parts_end(&a->names.parts, a->first, err) ||
	    mp_parts_end(&a->names.objects, a->first, err) ||
	    mp_parts_end(&a->names.materials, a->first, err))
		return -1;
	return a->request.format == MP_WISH_AUTO ? 0 : begin(a, a->request.format, err);
}

int mp_analysis_end(struct mp_analysis *a, struct mp_error *err)
{
	if (end_file(a, err))
		return -1;
	a->notes = a->before;
	a->ended = true;
	if (a->streamed)
		return 0;
	mp_vertices_seal(a->vertices);
	return mp_index_find(&a->index, (const uint32_t(*)[3])a->tri,
			     mp_vertices_count(a->vertices), &a->by_index, err);
}

const char *mp_analysis_name(const struct mp_analysis *a, uint64_t t, bool other, size_t *len,
			     uint64_t *end)
{
	const char *name = mp_named_at(&a->names, t, other, len, end);

	if (*end > a->triangles)
		*end = a->triangles;
	return name;
}

bool mp_analysis_met_foreign_code(const struct mp_analysis *a)
{
	return a != NULL && (a->notes.foreign_code || a->before.foreign_code);
}

void mp_analysis_free(struct mp_analysis *a)
{
	if (a == NULL)
		return;
	if (a->decoder != NULL)
		a->decoder->end(a->state);
	mp_vertices_free(a->vertices);
	free(a->tri);
	free(a->flat);
	mp_parts_free(&a->names.parts);
	mp_parts_free(&a->names.objects);
	mp_parts_free(&a->names.materials);
	mp_index_free(&a->index);
	free(a);
}
