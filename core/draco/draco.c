#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/draco/draco_head.h"
#include "core/draco/draco_wrap.h"

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

enum { FIRST_ROOM = 4096 };

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

static size_t size_of(enum mp_draco_type type)
{
	switch (type) {
	case MP_DRACO_INT8:
	case MP_DRACO_UINT8:
		return 1;
	case MP_DRACO_INT16:
	case MP_DRACO_UINT16:
		return 2;
	case MP_DRACO_INT32:
	case MP_DRACO_UINT32:
	case MP_DRACO_FLOAT32:
		return 4;
	case MP_DRACO_FLOAT64:
		return 8;
	case MP_DRACO_OTHER:
		break;
	}
	return 0;
}

/* Are the positions there, of a kind that is read, and as many as they claim to be? */
static int check_shape(const struct mp_draco_shape *s, const struct mp_limits *limits,
		       struct mp_error *err)
{
	uint64_t most = limits->max_triangles, size = 3 * size_of(s->type);

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

/* One coordinate, in the byte order of this machine. */
static inline double number(enum mp_draco_type type, const uint8_t *p)
{
	union {
		int16_t i16;
		uint16_t u16;
		int32_t i32;
		uint32_t u32;
		float f32;
		double f64;
	} v;

	switch (type) {
	case MP_DRACO_INT8:
		return (int8_t)*p;
	case MP_DRACO_UINT8:
		return *p;
	case MP_DRACO_INT16:
		memcpy(&v.i16, p, sizeof v.i16);
		return v.i16;
	case MP_DRACO_UINT16:
		memcpy(&v.u16, p, sizeof v.u16);
		return v.u16;
	case MP_DRACO_INT32:
		memcpy(&v.i32, p, sizeof v.i32);
		return v.i32;
	case MP_DRACO_UINT32:
		memcpy(&v.u32, p, sizeof v.u32);
		return v.u32;
	case MP_DRACO_FLOAT32:
		memcpy(&v.f32, p, sizeof v.f32);
		return (double)v.f32;
	case MP_DRACO_FLOAT64:
		memcpy(&v.f64, p, sizeof v.f64);
		return v.f64;
	case MP_DRACO_OTHER:
		break;
	}
	return 0;
}

static bool all_below(const uint32_t *number, size_t count, uint64_t limit)
{
	uint32_t most = 0;

	for (size_t i = 0; i < count; i++)
		most = number[i] > most ? number[i] : most;
	return most < limit;
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

/* ${corner} names points; afterwards the values they have. */
static int find_values(const struct mp_draco_mesh *mesh, const struct mp_draco_shape *s,
		       uint64_t first, uint32_t *corner, size_t count, struct mp_error *err)
{
	uint64_t known = s->points < s->mapped ? s->points : s->mapped;

	if (!all_below(corner, count, known))
		return fail_index(s, corner, true, first, known, err);
	mp_draco_values(mesh, corner, count);
	if (!all_below(corner, count, s->values))
		return fail_index(s, corner, false, first, s->values, err);
	return 0;
}

static int load(const struct mp_draco_shape *s, uint64_t first, const uint32_t *corner,
		size_t count, double *out, struct mp_error *err)
{
	const size_t size = size_of(s->type);

	for (size_t i = 0; i < count; i++) {
		const uint8_t *p = s->data + s->offset + s->stride * corner[i];

		for (size_t k = 0; k < 3; k++, p += size) {
			double x = number(s->type, p);

			if (!isfinite(x))
				return mp_fail(err, MP_NON_FINITE, MP_NO_BYTE,
					       "face %" PRIu64 " (from 0): %c of position %" PRIu32
					       " is not finite",
					       first + i / 3, "xyz"[k], corner[i]);
			out[3 * i + k] = x;
		}
	}
	return 0;
}

/* The same of floats, quickly; false where some are not finite. */
static bool load_floats(const struct mp_draco_shape *s, const uint32_t *corner, size_t count,
			double *out)
{
	const uint8_t *data = s->data + s->offset;
	uint32_t bad = 0;

	for (size_t i = 0; i < count; i++) {
		uint32_t bits[3];
		float x[3];

		memcpy(bits, data + s->stride * corner[i], sizeof bits);
		memcpy(x, bits, sizeof x);
		for (size_t k = 0; k < 3; k++) { /* all bits of the exponent carry into the next */
			bad |= (bits[k] & 0x7f800000) + 0x00800000;
			out[3 * i + k] = (double)x[k];
		}
	}
	return bad >> 31 == 0;
}

static int send(struct draco *d, const struct mp_draco_mesh *mesh, const struct mp_draco_shape *s,
		struct mp_error *err)
{
	const struct mp_sink *sink = d->sink;
	uint32_t corner[MP_BLOCK][3];
	double tri[MP_BLOCK][9];

	for (uint64_t at = 0; at < s->faces; at += MP_BLOCK) {
		size_t n = s->faces - at < MP_BLOCK ? (size_t)(s->faces - at) : MP_BLOCK;

		mp_draco_faces(mesh, at, n, corner);
		if (find_values(mesh, s, at, corner[0], 3 * n, err))
			return -1;
		if ((s->type != MP_DRACO_FLOAT32 || !load_floats(s, corner[0], 3 * n, tri[0])) &&
		    load(s, at, corner[0], 3 * n, tri[0], err))
			return -1;
		if (sink->indices != NULL &&
		    sink->indices(sink->self, (const uint32_t(*)[3])corner, n, err))
			return -1;
		if (sink->block(sink->self, (const double(*)[9])tri, n, err))
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
