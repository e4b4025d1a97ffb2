#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/draco/draco_head.h"
#include "core/draco/draco_load.h"
#include "core/draco/draco_wrap.h"
#include "core/memory/huge.h"

/*
 * Draco meshes.  The format is read backwards in places, so the whole file is collected; what can
 * be refused without libdraco is refused before it, and what it delivers is checked before anything
 * is done with it.
 *
 * Positions are three numbers of a type that doubles hold.  Quantised ones are the floats that
 * libdraco makes of them, as every viewer shows them; integers are taken as the coordinates they
 * are (normalised ones are refused: their scale is not in the file).
 */
struct draco {
	const struct mp_sink *sink;
	const struct mp_limits *limits;
	struct mp_notes *notes;
	uint8_t *file;
	size_t len, room;
};

/*
 * Whoever decodes Draco is a fresh process (core/draco/draco_wrap.h), for which fresh pages are a
 * third of the work.  The smallest files of compression level 10 take 170 bytes of memory a byte.
 */
enum {
	FIRST_ROOM = 4096,
	LARGE = 1 << 17, /* bytes of a file */
	HEAP_A_BYTE = 170,
	MOST_HEAP = 256 << 20
};

static int draco_begin(void **state, const struct mp_sink *sink, const struct mp_limits *limits,
		       struct mp_notes *notes, struct mp_error *err)
{
	struct draco *d = malloc(sizeof *d);

	*state = d;
	if (d == NULL)
		return mp_fail_nomem(err);
	memset(notes, 0, sizeof *notes);
	*d = (struct draco){.sink = sink, .limits = limits, .notes = notes};
	return 0;
}

static int reserve(struct draco *d, size_t len, struct mp_error *err)
{
	size_t room = d->room == 0 ? FIRST_ROOM : d->room;
	uint8_t *grown;

	if (len <= d->room - d->len)
		return 0;
	if (len > SIZE_MAX / 2 - d->len)
		return mp_fail_nomem(err);
	while (room < d->len + len)
		room *= 2;
	if (room >= LARGE)
		mp_huge_heap(room < MOST_HEAP / HEAP_A_BYTE ? HEAP_A_BYTE * room : MOST_HEAP);
	grown = realloc(d->file, room);
	if (grown == NULL)
		return mp_fail_nomem(err);
	d->file = grown;
	d->room = room;
	return 0;
}

static int draco_push(void *state, const uint8_t *chunk, size_t len, struct mp_error *err)
{
	struct draco *d = state;
	size_t before = d->len;

	if (len == 0)
		return 0;
	if (reserve(d, len, err))
		return -1;
	memcpy(d->file + d->len, chunk, len);
	d->len += len;
	d->notes->bytes = d->len;
	if (before >= MP_DRACO_KIND || d->len < MP_DRACO_KIND)
		return 0;
	if (mp_draco_check_kind(d->file, err))
		return -1;
	d->notes->format = MP_FORMAT_DRACO;
	return 0;
}

static void release(struct draco *d)
{
	free(d->file);
	d->file = NULL;
	d->len = d->room = 0;
}

/* Are the positions there, of a kind that is read, and as many as they claim to be? */
static int check_shape(const struct mp_draco_shape *s, const struct mp_limits *limits,
		       struct mp_error *err)
{
	uint64_t most = limits->max_triangles, size = 3 * mp_draco_size_of(s->type);

	if (s->faces == 0)
		return mp_fail(err, MP_NO_FACES, MP_NO_BYTE, "a Draco mesh with 0 faces");
	if (s->faces > most)
		return mp_fail_limit(err, MP_NO_BYTE, most, s->faces, "more than %llu triangles",
				     (unsigned long long)most);
	if (!s->has_positions)
		return mp_fail(err, MP_SYNTAX, MP_NO_BYTE, "a Draco mesh without positions");
	if (s->components != 3)
		return mp_fail(err, MP_UNSUPPORTED, MP_NO_BYTE,
			       "positions of %u numbers: 3 are needed", s->components);
	if (size == 0 || (s->normalised && s->type < MP_DRACO_FLOAT32))
		return mp_fail(err, MP_UNSUPPORTED, MP_NO_BYTE,
			       "positions that are neither floats nor plain integers of up to 32 "
			       "bits");
	if (s->stride < size || s->offset > s->size || s->size - s->offset < size ||
	    s->values == 0 || s->values - 1 > (s->size - s->offset - size) / s->stride)
		return mp_fail(err, MP_SYNTAX, MP_NO_BYTE,
			       "the positions are fewer than they claim to be");
	return 0;
}

static uint32_t largest(const uint32_t *number, size_t count)
{
	uint32_t most = 0;

	for (size_t i = 0; i < count; i++)
		most = number[i] > most ? number[i] : most;
	return most;
}

/* The face (from 0) of the first of ${number} that is not below ${limit}, and that one. */
static int fail_index(const struct mp_draco_shape *s, const uint32_t *number, bool points,
		      uint64_t first, uint64_t limit, struct mp_error *err)
{
	size_t i = 0;

	while (number[i] < limit)
		i++;
	return mp_fail(err, MP_BAD_INDEX, MP_NO_BYTE,
		       "face %" PRIu64 " (from 0) names %s %" PRIu32 " of %" PRIu64, first + i / 3,
		       points ? "point" : "position", number[i], points ? s->points : s->values);
}

/* Some faces on their way to the sink. */
struct faces {
	const uint32_t (*corner)[3]; /* the values of their corners: libdraco's, or these: */
	uint32_t value[MP_BLOCK][3];
	uint32_t most; /* of them */
	union {
		float columns[9][MP_BLOCK];
		double tri[MP_BLOCK][9];
	} xyz;
};

static int find_values(const struct mp_draco_mesh *mesh, const struct mp_draco_shape *s,
		       uint64_t first, size_t count, struct faces *f, struct mp_error *err)
{
	const uint32_t(*point)[3] = mp_draco_faces(mesh) + first;
	uint64_t known = s->points < s->mapped ? s->points : s->mapped;

	f->corner = point;
	f->most = largest(point[0], 3 * count);
	if (f->most >= known)
		return fail_index(s, point[0], true, first, known, err);
	if (mp_draco_values(mesh, point, count, f->value)) {
		f->corner = (const uint32_t(*)[3])f->value;
		f->most = largest(f->value[0], 3 * count);
	}
	if (f->most >= s->values)
		return fail_index(s, f->corner[0], false, first, s->values, err);
	return 0;
}

static int send_block(struct draco *d, const struct mp_draco_shape *s, bool floats, size_t count,
		      struct faces *f, struct mp_error *err)
{
	const struct mp_sink *sink = d->sink;

	if (floats)
		mp_draco_load_floats(s, f->corner, count, f->most, f->xyz.columns);
	else if (mp_draco_load(s, d->notes->triangles, f->corner, count, f->xyz.tri, err))
		return -1;
	if (sink->indices != NULL && sink->indices(sink->self, f->corner, count, err))
		return -1;
	return floats
		   ? sink->floats(sink->self, (const float(*)[MP_BLOCK])f->xyz.columns, count, err)
		   : sink->block(sink->self, (const double(*)[9])f->xyz.tri, count, err);
}

static int send(struct draco *d, const struct mp_draco_mesh *mesh, const struct mp_draco_shape *s,
		struct mp_error *err)
{
	const struct mp_points points = {s->data + s->offset, s->stride, s->values};
	bool floats = d->sink->floats != NULL && mp_draco_are_floats(s);
	struct faces f;

	if (floats && d->sink->expect != NULL)
		d->sink->expect(d->sink->self, s->faces, &points);
	for (uint64_t at = 0; at < s->faces; at += MP_BLOCK) {
		size_t n = s->faces - at < MP_BLOCK ? (size_t)(s->faces - at) : MP_BLOCK;

		if (find_values(mesh, s, at, n, &f, err) || send_block(d, s, floats, n, &f, err))
			return -1;
		d->notes->triangles += n;
	}
	return 0;
}

static int decode(struct draco *d, struct mp_draco_mesh **mesh, struct mp_draco_shape *shape,
		  struct mp_error *err)
{
	enum mp_draco_verdict verdict;
	char why[64] = "";

	d->notes->foreign_code = true;
	verdict = mp_draco_decode(d->file, d->len, mesh, shape, why, sizeof why);
	release(d);
	if (verdict == MP_DRACO_NO_MEMORY)
		return mp_fail_nomem(err);
	if (verdict == MP_DRACO_REFUSED)
		return mp_fail(
		    err, MP_SYNTAX, MP_NO_BYTE, "the Draco file is damaged or incomplete%s%s%s",
		    why[0] != '\0' ? " (libdraco: " : "", why, why[0] != '\0' ? ")" : "");
	return 0;
}

/* Bitstreams before 2.0 do not let it be seen whether they were quantised. */
static void note_rounding(struct mp_notes *notes, const struct mp_draco_shape *shape,
			  unsigned version)
{
	if (shape->step > 0 && isfinite(shape->step)) {
		notes->quantisation_step = shape->step;
		notes->rounding = MP_ROUNDING_QUANTISED;
	} else if (shape->step == 0 && shape->type == MP_DRACO_FLOAT32 && version >= 2) {
		notes->rounding = MP_ROUNDING_FLOAT32;
	}
}

static int draco_finish(void *state, struct mp_error *err)
{
	struct draco *d = state;
	struct mp_draco_mesh *mesh = NULL;
	struct mp_draco_shape shape;
	unsigned version;
	int ret;

	if (d->len == 0)
		return mp_fail(err, MP_EMPTY, MP_NO_BYTE, "it has 0 bytes");
	if (memcmp(d->file, "DRACO", d->len < 5 ? d->len : 5) != 0)
		return mp_fail(err, MP_SYNTAX, 0, "no Draco file: it does not begin with DRACO");
	if (d->len < MP_DRACO_KIND)
		return mp_fail(err, MP_TRUNCATED, d->len, "the file ends inside its header");
	version = d->file[MP_DRACO_MAJOR];
	if (mp_draco_check_counts(d->file, d->len, d->limits, err) || decode(d, &mesh, &shape, err))
		return -1;
	ret = check_shape(&shape, d->limits, err);
	if (ret == 0) {
		if (shape.used < d->notes->bytes)
			d->notes->trailing_bytes = d->notes->bytes - shape.used;
		note_rounding(d->notes, &shape, version);
		ret = send(d, mesh, &shape, err);
	}
	mp_draco_free(mesh);
	return ret;
}

static void draco_end(void *state)
{
	struct draco *d = state;

	if (d != NULL)
		release(d);
	free(d);
}

const struct mp_decoder_ops mp_draco_decoder = {"draco", draco_begin, draco_push, draco_finish,
						draco_end};
