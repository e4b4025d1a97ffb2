#include "core/draco/draco_head.h"

#include <string.h>

enum {
	POINT_CLOUD = 0, /* kinds */
	MESH = 1,
	SEQUENTIAL = 0, /* methods of meshes */
	EDGEBREAKER = 1,
	STANDARD = 0, /* traversals of edgebreaker */
	HAS_METADATA = 0x80,
	V13 = 0x103,
	V20 = 0x200,
	V22 = 0x202
};

/*
 * Faces that a byte may stand for where symbols are entropy coded, so that regular meshes cost
 * next to nothing: the flat grid of 2 * 512 * 512 triangles takes 1582 bytes, 331 to a byte, and
 * the ratio grows as the root of the count.  One of 10^9 triangles would stay below this.
 */
static const uint64_t faces_a_byte = 16384;

struct reader {
	const uint8_t *file;
	size_t len, at;
	bool over; /* something beyond the end was asked for */
};

static uint64_t left(const struct reader *r)
{
	return r->len - r->at;
}

static uint8_t u8(struct reader *r)
{
	if (r->at == r->len) {
		r->over = true;
		return 0;
	}
	return r->file[r->at++];
}

static void skip(struct reader *r, uint64_t bytes)
{
	r->over = r->over || bytes > left(r);
	r->at = r->over ? r->len : r->at + (size_t)bytes;
}

static uint32_t u32(struct reader *r)
{
	uint32_t v = u8(r);

	v |= (uint32_t)u8(r) << 8;
	v |= (uint32_t)u8(r) << 16;
	return v | (uint32_t)u8(r) << 24;
}

/* Seven bits a byte, the lowest first; what goes beyond 32 bits is dropped as libdraco drops it. */
static uint32_t varint(struct reader *r)
{
	uint32_t v = 0;

	for (unsigned shift = 0; shift < 35; shift += 7) {
		uint8_t byte = u8(r);

		v |= (uint32_t)((uint64_t)(byte & 0x7f) << shift);
		if ((byte & 0x80) == 0)
			break;
	}
	return v;
}

/* Counts became varints in different versions. */
static uint32_t count(struct reader *r, bool is_varint)
{
	return is_varint ? varint(r) : u32(r);
}

static void skip_entries(struct reader *r)
{
	for (uint32_t n = varint(r); n > 0 && !r->over; n--) {
		skip(r, u8(r));
		skip(r, varint(r));
	}
}

/* One tree of entries; how deep its branches are does not show in the order of their bytes. */
static void skip_metadata(struct reader *r)
{
	uint64_t branches;

	skip_entries(r);
	for (branches = varint(r); branches > 0 && !r->over; branches--) {
		skip(r, u8(r)); /* its name */
		skip_entries(r);
		branches += varint(r);
	}
}

static void skip_all_metadata(struct reader *r)
{
	for (uint32_t n = varint(r); n > 0 && !r->over; n--) {
		(void)varint(r); /* the attribute's number */
		skip_metadata(r);
	}
	skip_metadata(r);
}

int mp_draco_check_kind(const uint8_t file[MP_DRACO_KIND], struct mp_error *err)
{
	const unsigned major = file[5], minor = file[6], kind = file[7], method = file[8];

	if (memcmp(file, "DRACO", 5) != 0)
		return mp_fail(err, MP_SYNTAX, 0, "no Draco file: it does not begin with DRACO");
	if (kind > MESH)
		return mp_fail(err, MP_SYNTAX, 7, "a Draco file of kind %u, which does not exist",
			       kind);
	/* point clouds are one version ahead of meshes */
	if (major < 1 || major > 2 || (major == 2 && minor > (kind == POINT_CLOUD ? 3 : 2)))
		return mp_fail(err, MP_UNSUPPORTED, 5,
			       "Draco bitstream %u.%u: versions 1.0 to 2.2 are read", major, minor);
	if (kind == POINT_CLOUD)
		return mp_fail(err, MP_POINT_CLOUD, 7, "a Draco point cloud has no faces");
	if (method > EDGEBREAKER)
		return mp_fail(err, MP_SYNTAX, 8, "a Draco mesh of method %u, which does not exist",
			       method);
	return 0;
}

/* The fewest bytes behind ${r} that the declared faces take. */
static uint64_t read_sequential(struct reader *r, unsigned version, uint32_t *faces)
{
	uint32_t points;
	uint64_t each = 4;

	*faces = count(r, version >= V22);
	points = count(r, version >= V22);
	if (u8(r) == 0) /* compressed: libdraco compares faces and bytes by itself */
		return 0;
	if (points < 1 << 8 || (points >= 1 << 16 && points < 1 << 21 && version >= V22))
		each = 1;
	else if (points < 1 << 16)
		each = 2;
	return 3 * each * *faces;
}

static uint64_t read_edgebreaker(struct reader *r, unsigned version, uint32_t *faces)
{
	bool is_varint = version >= V20;
	uint8_t traversal = u8(r);
	uint64_t symbols;

	if (version < V22)
		(void)count(r, is_varint); /* vertices added by splits */
	(void)count(r, is_varint);         /* vertices */
	*faces = count(r, is_varint);
	(void)u8(r); /* sets of other attributes */
	symbols = count(r, is_varint);
	(void)count(r, is_varint); /* symbols that split */
	if (traversal == STANDARD) /* a bit or three each */
		return (symbols + 7) / 8;
	return *faces / faces_a_byte;
}

int mp_draco_check_counts(const uint8_t *file, size_t len, const struct mp_limits *limits,
			  struct mp_error *err)
{
	struct reader r = {file, len, MP_DRACO_HEAD, false};
	const unsigned version = file[5] * 256u + file[6];
	uint64_t most = limits->max_triangles, need;
	uint32_t faces = 0;

	if (len < MP_DRACO_HEAD)
		return mp_fail(err, MP_TRUNCATED, len, "the file ends inside its header");
	if (version >= V13 && (file[10] & HAS_METADATA))
		skip_all_metadata(&r);
	need = file[8] == SEQUENTIAL ? read_sequential(&r, version, &faces)
				     : read_edgebreaker(&r, version, &faces);
	if (r.over)
		return mp_fail(err, MP_TRUNCATED, len, "the file ends inside its header");
	if (need > left(&r))
		return mp_fail(err, MP_TRUNCATED, len,
			       "%lu faces are declared, for which %zu bytes are too few",
			       (unsigned long)faces, len);
	if (faces == 0)
		return mp_fail(err, MP_NO_FACES, MP_NO_BYTE, "a Draco mesh with 0 faces");
	if (faces > most)
		return mp_fail_limit(err, MP_NO_BYTE, most, faces, "more than %llu triangles",
				     (unsigned long long)most);
	return 0;
}
