#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "alloc_fail.h"
#include "core/draco/draco_head.h"
#include "draco_seen.h"

/* With libdraco.  What it could deliver but hardly can be made to: test_draco_shape.c. */

static const size_t all = SIZE_MAX; /* one chunk */
static const uint64_t roomy = 1000000;
static struct draco_seen whole, other = {.as_floats = true};
static struct draco_file file;

/* The tetrahedron of (0,0,0), (2,0,0), (0,3,0), (0,0,4), wound outward. */
static const uint8_t tetra[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
static const float point[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
static const struct draco_attribute floats = {0, D_F32, 3, 0, 0};
static const struct draco_attribute normals = {1, D_F32, 3, 0, 0};

static void put_points(struct draco_file *f)
{
	for (size_t i = 0; i < 12; i++)
		draco_f32(f, point[i / 3][i % 3]);
}

static void make_version(unsigned version)
{
	draco_head(&file, version, 1, 0, 0);
	draco_faces(&file, 4, 4, tetra[0]);
	draco_attributes(&file, &floats, 1);
	put_points(&file);
}

static void make(void)
{
	make_version(0x202);
}

static void check_tetra(void)
{
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	if (whole.ret != 0)
		fail_msg("refused: %s", whole.err.text);
	assert_false(whole.wrong);
	assert_int_equal(whole.count, 4);
	for (size_t t = 0; t < 4; t++)
		for (size_t k = 0; k < 9; k++)
			assert_true(whole.tri[t][k] == (double)point[tetra[t][k / 3]][k % 3]);
	assert_true(whole.notes.foreign_code);
}

static void check_refused(enum mp_code code, const char *word)
{
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	if (whole.ret == 0 || whole.wrong || whole.err.code != code ||
	    strstr(whole.err.text, word) == NULL)
		fail_msg("%d, code %d, byte %llu: %s", whole.ret, whole.err.code,
			 (unsigned long long)whole.err.byte, whole.err.text);
	assert_int_equal(whole.count, 0);
	draco_decode(&other, file.bytes, file.len, 3, 1, roomy);
	assert_true(draco_same(&whole, &other));
}

static void reads_what_was_written(void **state)
{
	(void)state;
	make();
	check_tetra();
	for (size_t t = 0; t < 4; t++)
		for (size_t k = 0; k < 3; k++)
			assert_int_equal(whole.index[t][k], tetra[t][k]);
	assert_true(whole.notes.quantisation_step == 0);
	assert_int_equal(whole.notes.rounding, MP_ROUNDING_FLOAT32);
	assert_int_equal(whole.notes.trailing_bytes, 0);
}

static void old_bitstreams_are_read(void **state)
{
	static const unsigned versions[] = {0x100, 0x101, 0x102, 0x103, 0x200, 0x201, 0x202};

	(void)state;
	for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
		make_version(versions[i]);
		check_tetra();
	}
}

static void where_a_chunk_ends_never_matters(void **state)
{
	(void)state;
	make();
	check_tetra();
	for (size_t first = 0; first <= file.len; first++)
		for (size_t step = 1; step < 20; step += 6) {
			draco_decode(&other, file.bytes, file.len, first, step, roomy);
			assert_true(draco_same(&whole, &other));
		}
}

static void every_prefix_is_refused(void **state)
{
	(void)state;
	make();
	for (size_t n = 0; n < file.len; n++) {
		enum mp_code code = n == 0   ? MP_EMPTY
				    : n < 26 ? MP_TRUNCATED /* in the head or the faces */
					     : MP_SYNTAX;

		draco_decode(&whole, file.bytes, n, all, all, roomy);
		if (whole.ret != -1 || whole.wrong || whole.err.code != code)
			fail_msg("%zu bytes: %d, %d: %s", n, whole.ret, whole.err.code,
				 whole.err.text);
		assert_int_equal(whole.count, 0);
		if (code == MP_TRUNCATED)
			assert_int_equal(whole.err.byte, n);
	}
}

static void bytes_behind_the_mesh_are_counted(void **state)
{
	(void)state;
	make();
	draco_put(&file, "padding", 7);
	check_tetra();
	assert_int_equal(whole.notes.trailing_bytes, 7);
}

static void positions_are_found_at_any_place(void **state)
{
	const struct draco_attribute both[] = {normals, floats};

	(void)state;
	draco_head(&file, 0x202, 1, 0, 0);
	draco_faces(&file, 4, 4, tetra[0]);
	draco_attributes(&file, both, 2);
	for (size_t i = 0; i < 12; i++)
		draco_f32(&file, 77);
	put_points(&file);
	check_tetra();
}

static void metadata_are_passed_over(void **state)
{
	(void)state;
	draco_head(&file, 0x202, 1, 0, 0x8000);
	draco_varint(&file, 1);             /* metadata of one attribute: */
	draco_varint(&file, 0);             /* number 0 */
	draco_varint(&file, 1);             /* one entry */
	draco_put(&file, "\4name", 5);      /* its name */
	draco_put(&file, "\5value", 6);     /* and value */
	draco_varint(&file, 0);             /* no branches */
	draco_varint(&file, 0);             /* of the mesh: no entry */
	draco_varint(&file, 2);             /* two branches: */
	draco_put(&file, "\1b", 2);         /* a name, */
	draco_varint(&file, 0);             /* no entry */
	draco_varint(&file, 1);             /* one branch: */
	draco_put(&file, "\0\0\0", 3);      /* empty */
	draco_put(&file, "\0\1\0\1x\0", 6); /* no name; an entry without one, x; no branch */
	draco_faces(&file, 4, 4, tetra[0]);
	draco_attributes(&file, &floats, 1);
	put_points(&file);
	check_tetra();
	for (size_t n = 11; n < 40; n++) {
		draco_decode(&whole, file.bytes, n, all, all, roomy);
		assert_int_equal(whole.ret, -1);
		assert_int_equal(whole.err.code, MP_TRUNCATED);
	}
}

/* The flag meant nothing then. */
static void before_version_1_3_there_are_no_metadata(void **state)
{
	(void)state;
	make_version(0x102);
	file.bytes[10] = 0x80;
	check_tetra();
}

/* A fan of four triangles about its first vertex, as the symbols E, R, R, R of three bits each. */
static void edgebreaker_meshes_are_read(void **state)
{
	static uint32_t uses[6];

	(void)state;
	draco_head(&file, 0x202, 1, 1, 0);
	draco_put(&file, "\0\6\4\0\4\0\0", 7); /* traversal 0, 6 vertices, 4 faces, 4 symbols */
	draco_put(&file, "\2\x6f\x0b", 3);     /* 2 bytes of them: 111 101 101 101 */
	draco_put(&file, "\xff\1\x3f", 3);     /* the first triangle lies at a boundary */
	draco_put(&file, "\1\xff\0\0\1\0\x09\3\0\0\0", 11);
	for (unsigned i = 0; i < 18; i++)
		draco_f32(&file, (float)(i * i));
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	if (whole.ret != 0)
		fail_msg("refused: %s", whole.err.text);
	assert_int_equal(whole.count, 4);
	memset(uses, 0, sizeof uses);
	for (size_t i = 0; i < 12; i++) {
		uint32_t v = whole.index[i / 3][i % 3];

		assert_true(v < 6 && whole.tri[i / 3][i % 3 * 3] == 9.0 * v * v);
		uses[v]++;
	}
	assert_int_equal(uses[0] + uses[1] + uses[2] + uses[3] + uses[4] + uses[5], 12);
	for (size_t v = 0; v < 6; v++)
		assert_in_range(uses[v], 1, 4);
	assert_int_equal(whole.notes.trailing_bytes, 0);
	for (size_t n = 9; n < file.len; n++) {
		draco_decode(&whole, file.bytes, n, all, all, roomy);
		assert_int_equal(whole.ret, -1);
	}
}

static void quantised_positions_are_libdracos_floats(void **state)
{
	const struct draco_attribute quantised = {0, D_F32, 3, 0, 2};
	static const uint32_t q[4][3] = {{0, 0, 0}, {1023, 0, 0}, {0, 512, 0}, {0, 0, 3}};
	const float low[3] = {-1.5f, 0.25f, 10}, range = 0.3f;

	(void)state;
	draco_head(&file, 0x202, 1, 0, 0);
	draco_faces(&file, 4, 4, tetra[0]);
	draco_attributes(&file, &quantised, 1);
	draco_u8(&file, 0xfe); /* no prediction */
	draco_u8(&file, 0);    /* not compressed: */
	draco_u8(&file, 4);    /* of 4 bytes each, the sign in the lowest bit */
	for (size_t i = 0; i < 12; i++)
		draco_u32(&file, 2 * q[i / 3][i % 3]);
	for (size_t k = 0; k < 3; k++)
		draco_f32(&file, low[k]);
	draco_f32(&file, range);
	draco_u8(&file, 10);
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	if (whole.ret != 0)
		fail_msg("refused: %s", whole.err.text);
	for (size_t t = 0; t < 4; t++)
		for (size_t k = 0; k < 9; k++) {
			float delta = range / 1023.0f;
			double want =
			    (double)q[tetra[t][k / 3]][k % 3] * (double)delta + (double)low[k % 3];

			/* one float rounding or two, as libdraco was compiled */
			assert_true(fabs(whole.tri[t][k] - want) <= 0x1p-20);
			assert_true(whole.tri[t][k] == (double)(float)whole.tri[t][k]);
		}
	assert_true(fabs(whole.notes.quantisation_step - (double)range / 1023) < 1e-12);
}

/* Positions of that type, raw or as integers of Draco's: the last one has a -1, if it can be. */
static void make_integers(unsigned data, size_t size, unsigned decoder)
{
	const struct draco_attribute a = {0, data, 3, 0, decoder};

	draco_head(&file, 0x202, 1, 0, 0);
	draco_faces(&file, 4, 4, tetra[0]);
	draco_attributes(&file, &a, 1);
	if (decoder == 1)
		draco_put(&file, "\xfe\0\4", 3);
	for (size_t i = 0; i < 12; i++) {
		uint32_t v = i == 11 ? UINT32_MAX : 10 + (uint32_t)i;

		if (decoder == 1)
			draco_u32(&file, i == 11 ? 1 : 2 * v); /* the sign in the lowest bit */
		else
			for (size_t k = 0; k < size; k++)
				draco_u8(&file, v >> 8 * k & 0xff);
	}
}

static void integer_positions_are_coordinates(void **state)
{
	static const struct {
		unsigned data;
		size_t size;
		double last;
	} types[] = {{D_I8, 1, -1},     {D_U8, 1, 255}, {D_I16, 2, -1},
		     {D_U16, 2, 65535}, {D_I32, 4, -1}, {D_U32, 4, 4294967295.0}};

	(void)state;
	for (size_t i = 0; i < 6; i++)
		for (unsigned decoder = 0; decoder < 2; decoder++) {
			make_integers(types[i].data, types[i].size, decoder);
			draco_decode(&whole, file.bytes, file.len, all, all, roomy);
			if (whole.ret != 0)
				fail_msg("type %u refused: %s", types[i].data, whole.err.text);
			assert_false(whole.wrong);
			assert_true(whole.tri[0][0] == 10 && whole.tri[0][4] == 17);
			assert_true(whole.tri[3][8] == types[i].last);
			assert_true(whole.notes.quantisation_step == 0);
		}
}

static void doubles_keep_their_digits(void **state)
{
	const struct draco_attribute doubles = {0, D_F64, 3, 0, 0};
	double v[12];

	(void)state;
	draco_head(&file, 0x202, 1, 0, 0);
	draco_faces(&file, 4, 4, tetra[0]);
	draco_attributes(&file, &doubles, 1);
	for (size_t i = 0; i < 12; i++)
		v[i] = 1.0 / (double)(i + 3);
	draco_put(&file, v, sizeof v); /* little-endian, as this machine */
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	assert_int_equal(whole.ret, 0);
	assert_true(whole.tri[3][8] == v[11]);
}

static void other_positions_are_refused(void **state)
{
	static const struct draco_attribute bad[] = {{0, D_F32, 2, 0, 0},  {0, D_F32, 4, 0, 0},
						     {0, D_I64, 3, 0, 0},  {0, D_U64, 3, 0, 0},
						     {0, D_BOOL, 3, 0, 0}, {0, D_I16, 3, 1, 0}};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		draco_head(&file, 0x202, 1, 0, 0);
		draco_faces(&file, 4, 4, tetra[0]);
		draco_attributes(&file, &bad[i], 1);
		for (size_t k = 0; k < 4 * 4 * 8; k++)
			draco_u8(&file, 0);
		check_refused(MP_UNSUPPORTED, "positions");
	}
}

static void a_mesh_without_positions_is_refused(void **state)
{
	(void)state;
	draco_head(&file, 0x202, 1, 0, 0);
	draco_faces(&file, 4, 4, tetra[0]);
	draco_attributes(&file, &normals, 1);
	put_points(&file);
	check_refused(MP_SYNTAX, "without positions");
}

static void point_clouds_and_other_kinds_are_refused(void **state)
{
	(void)state;
	draco_head(&file, 0x203, 0, 0, 0); /* one version ahead of meshes */
	check_refused(MP_POINT_CLOUD, "point cloud");
	assert_false(whole.notes.foreign_code);
	draco_head(&file, 0x202, 2, 0, 0);
	check_refused(MP_SYNTAX, "kind");
	draco_head(&file, 0x202, 1, 2, 0);
	check_refused(MP_SYNTAX, "method");
	file.bytes[4] = 'X';
	check_refused(MP_SYNTAX, "DRACO");
	file.len = 5;
	check_refused(MP_SYNTAX, "DRACO");
}

static void other_versions_are_named(void **state)
{
	static const unsigned versions[] = {0, 9, 0x203, 0x300, 0xffff};

	(void)state;
	for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
		make_version(versions[i]);
		check_refused(MP_UNSUPPORTED, "bitstream");
		assert_false(whole.notes.foreign_code);
	}
}

static void bad_indices_are_found(void **state)
{
	uint8_t corner[4][3];

	(void)state;
	for (size_t i = 0; i < 12; i++) {
		memcpy(corner, tetra, sizeof corner);
		corner[i / 3][i % 3] = i % 2 == 0 ? 4 : 255;
		draco_head(&file, 0x202, 1, 0, 0);
		draco_faces(&file, 4, 4, corner[0]);
		draco_attributes(&file, &floats, 1);
		put_points(&file);
		check_refused(MP_BAD_INDEX, "point");
	}
}

static void coordinates_are_finite(void **state)
{
	static const uint32_t bad[] = {0x7f800000, 0xff800000, 0x7fc00000, 0x7f800001};

	(void)state;
	for (size_t i = 0; i < 12; i++) {
		make();
		file.len -= 4 * (12 - i);
		draco_u32(&file, bad[i % 4]);
		file.len += 4 * (11 - i);
		check_refused(MP_NON_FINITE, "not finite");
	}
}

static void empty_meshes_have_no_faces(void **state)
{
	(void)state;
	draco_head(&file, 0x202, 1, 0, 0);
	draco_faces(&file, 0, 0, tetra[0]);
	draco_attributes(&file, &floats, 1);
	check_refused(MP_NO_FACES, "0 faces");
	assert_false(whole.notes.foreign_code);
}

static void more_triangles_than_allowed_are_refused(void **state)
{
	(void)state;
	make();
	draco_decode(&whole, file.bytes, file.len, all, all, 4);
	assert_int_equal(whole.ret, 0);
	draco_decode(&whole, file.bytes, file.len, all, all, 3);
	assert_int_equal(whole.ret, -1);
	assert_int_equal(whole.err.code, MP_LIMIT);
	assert_int_equal(whole.err.limit, 3);
	assert_int_equal(whole.err.actual, 4);
}

/* What the header says is judged by the bytes there are, and libdraco never sees the file. */
static void counts_that_the_bytes_cannot_bear_out_are_refused(void **state)
{
	static const uint32_t counts[] = {100, 70000, 600000000, UINT32_MAX};

	(void)state;
	for (size_t i = 0; i < 4; i++)
		for (unsigned version = 0x200; version <= 0x202; version++) {
			draco_head(&file, version, 1, 0, 0);
			draco_count(&file, counts[i], 0x202);
			draco_count(&file, counts[i], 0x202);
			draco_put(&file, "\1\2\3\4\5", 5);
			check_refused(MP_TRUNCATED, "too few");
			assert_false(whole.notes.foreign_code);
		}
}

/* Edgebreaker: traversal, vertices, faces, attributes, symbols, splits; then ${rest} bytes. */
static void make_edgebreaker(unsigned version, unsigned traversal, uint32_t faces, size_t rest)
{
	draco_head(&file, version, 1, 1, 0);
	draco_u8(&file, traversal);
	if (version < 0x202)
		draco_count(&file, 0, 0x200);
	draco_count(&file, faces, 0x200);
	draco_count(&file, faces, 0x200);
	draco_u8(&file, 0);
	draco_count(&file, faces, 0x200);
	draco_count(&file, 0, 0x200);
	for (size_t i = 0; i < rest; i++)
		draco_u8(&file, 0xff);
}

static void edgebreaker_counts_are_judged_by_the_bytes(void **state)
{
	static const unsigned versions[] = {0x102, 0x200, 0x201, 0x202};
	const struct mp_limits limits = {roomy};
	struct mp_error err;

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		const unsigned version = versions[i];

		make_edgebreaker(version, 0, 801, 100);
		check_refused(MP_TRUNCATED, "801 faces");
		assert_false(whole.notes.foreign_code);
		make_edgebreaker(version, 2, 600000000, 39);
		check_refused(MP_TRUNCATED, "600000000 faces");
		assert_false(whole.notes.foreign_code);
		make_edgebreaker(version, 2, 2000000, 200);
		check_refused(MP_LIMIT, "1000000 triangles");
		assert_false(whole.notes.foreign_code);
		make_edgebreaker(version, 0, 800, 100); /* these are libdraco's to judge */
		assert_int_equal(mp_draco_check_counts(file.bytes, file.len, &limits, &err), 0);
		make_edgebreaker(version, 1, 50 * 16384, 50);
		assert_int_equal(mp_draco_check_counts(file.bytes, file.len, &limits, &err), 0);
		make_edgebreaker(version, 2, 51 * 16384, 50);
		check_refused(MP_TRUNCATED, "835584 faces");
	}
}

static void what_libdraco_refuses_is_refused(void **state)
{
	(void)state;
	make();
	file.bytes[26] = 0; /* no decoder of attributes: a mesh without any */
	file.bytes[27] = 0;
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	assert_int_equal(whole.ret, -1);
	make();
	file.bytes[27] = 200; /* attributes */
	check_refused(MP_SYNTAX, "Failed to decode point attributes)");
	assert_true(whole.notes.foreign_code);
}

/* 600 triangles: more than two blocks. */
static void make_many(void)
{
	draco_head(&file, 0x202, 1, 0, 0);
	draco_varint(&file, 600);
	draco_varint(&file, 4);
	draco_u8(&file, 1);
	for (size_t i = 0; i < 150; i++)
		draco_put(&file, tetra, sizeof tetra);
	draco_attributes(&file, &floats, 1);
	put_points(&file);
}

static void triangles_come_in_blocks_until_the_sink_refuses(void **state)
{
	(void)state;
	make_many();
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	assert_int_equal(whole.ret, 0);
	assert_false(whole.wrong);
	assert_int_equal(whole.count, 600);
	assert_int_equal(whole.index[599][2], tetra[3][2]);
	whole.fail_at = 300;
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	whole.fail_at = 0;
	assert_int_equal(whole.ret, -1);
	assert_int_equal(whole.err.byte, 7);
	assert_int_equal(whole.count, 256);
	whole.fail_indices = true;
	draco_decode(&whole, file.bytes, file.len, all, all, roomy);
	whole.fail_indices = false;
	assert_int_equal(whole.ret, -1);
	assert_int_equal(whole.err.byte, 8);
	assert_int_equal(whole.count, 0);
}

static void a_failed_allocation_is_an_error(void **state)
{
	long before = alloc_count(), n;

	(void)state;
	make();
	while (file.len < 50000) /* the buffer has to grow */
		draco_u8(&file, 0);
	draco_decode(&whole, file.bytes, file.len, 1000, 1000, roomy);
	assert_int_equal(whole.ret, 0);
	n = alloc_count() - before - 50; /* the chunks' copies */
	assert_true(n >= 3);
	for (long i = 1; i <= 55; i++) {
		const struct mp_sink sink = {
		    .block = draco_seen_block, .self = &whole, .indices = draco_seen_indices};
		const struct mp_limits limits = {roomy};
		struct mp_error err = {0};
		struct mp_notes notes;
		void *st;
		int ret;

		memset(&whole, 0, sizeof whole);
		alloc_fail_at(i);
		ret = mp_draco_decoder.begin(&st, &sink, &limits, &notes, &err);
		for (size_t at = 0; ret == 0 && at < file.len; at += 1000)
			ret = mp_draco_decoder.push(
			    st, file.bytes + at, file.len - at < 1000 ? file.len - at : 1000, &err);
		if (ret == 0)
			ret = mp_draco_decoder.finish(st, &err);
		mp_draco_decoder.end(st);
		alloc_fail_at(0);
		if (ret == 0) {
			assert_true(i > 3);
			return;
		}
		assert_int_equal(err.code, MP_NOMEM);
	}
	fail_msg("it never went well");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(reads_what_was_written),
	    cmocka_unit_test(old_bitstreams_are_read),
	    cmocka_unit_test(where_a_chunk_ends_never_matters),
	    cmocka_unit_test(every_prefix_is_refused),
	    cmocka_unit_test(bytes_behind_the_mesh_are_counted),
	    cmocka_unit_test(positions_are_found_at_any_place),
	    cmocka_unit_test(metadata_are_passed_over),
	    cmocka_unit_test(before_version_1_3_there_are_no_metadata),
	    cmocka_unit_test(edgebreaker_meshes_are_read),
	    cmocka_unit_test(quantised_positions_are_libdracos_floats),
	    cmocka_unit_test(integer_positions_are_coordinates),
	    cmocka_unit_test(doubles_keep_their_digits),
	    cmocka_unit_test(other_positions_are_refused),
	    cmocka_unit_test(a_mesh_without_positions_is_refused),
	    cmocka_unit_test(point_clouds_and_other_kinds_are_refused),
	    cmocka_unit_test(other_versions_are_named),
	    cmocka_unit_test(bad_indices_are_found),
	    cmocka_unit_test(coordinates_are_finite),
	    cmocka_unit_test(empty_meshes_have_no_faces),
	    cmocka_unit_test(more_triangles_than_allowed_are_refused),
	    cmocka_unit_test(counts_that_the_bytes_cannot_bear_out_are_refused),
	    cmocka_unit_test(edgebreaker_counts_are_judged_by_the_bytes),
	    cmocka_unit_test(what_libdraco_refuses_is_refused),
	    cmocka_unit_test(triangles_come_in_blocks_until_the_sink_refuses),
	    cmocka_unit_test(a_failed_allocation_is_an_error),
	};

	return cmocka_run_group_tests_name("draco", tests, NULL, NULL);
}
