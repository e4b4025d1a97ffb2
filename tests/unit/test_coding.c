#include "api/coding.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <zlib.h>
#include <zstd.h>

#include "alloc_fail.h"

enum { ROOM = 1 << 20 };

struct text {
	uint8_t bytes[ROOM];
	size_t len;
};

/* What came out of a stream that was pushed in pieces. */
struct seen {
	int ret;
	struct api_problem problem;
	struct text out;
	size_t stop_at; /* the sink fails when so many bytes came, 0: never */
};

static struct text plain, packed; /* too large for the stack */
static struct seen whole, split;

static int take(void *self, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	struct seen *s = self;

	assert_true(len > 0 && len <= ROOM - s->out.len);
	memcpy(s->out.bytes + s->out.len, bytes, len);
	s->out.len += len;
	if (s->stop_at == 0 || s->out.len < s->stop_at)
		return 0;
	return api_problem_set(p, API_UNREADABLE, "enough");
}

/* The first ${first} bytes, then ${step} at a time, each from a heap copy of its size. */
static void decode(struct seen *s, enum api_coding_kind kind, uint64_t most, const uint8_t *bytes,
		   size_t len, size_t first, size_t step)
{
	const struct api_sink sink = {take, s};
	struct api_coding *c = api_coding_new(kind, most, &sink);

	memset(&s->problem, 0, sizeof s->problem);
	s->out.len = 0;
	s->ret = 0;
	assert_non_null(c);
	for (size_t at = 0, n = first; at < len && s->ret == 0; at += n, n = step) {
		uint8_t *copy;

		n = n < len - at ? n : len - at;
		if (n == 0)
			continue;
		copy = malloc(n);
		assert_non_null(copy);
		memcpy(copy, bytes + at, n);
		s->ret = api_coding_push(c, copy, n, &s->problem);
		free(copy);
	}
	if (s->ret == 0)
		s->ret = api_coding_finish(c, &s->problem);
	assert_int_equal(s->ret == 0, s->problem.code == API_OK);
	assert_true(s->stop_at > 0 || api_coding_decoded(c) == s->out.len);
	api_coding_free(c);
}

static void decode_whole(enum api_coding_kind kind, const struct text *t)
{
	decode(&whole, kind, ROOM, t->bytes, t->len, t->len, 1);
}

static void assert_same(void)
{
	assert_int_equal(split.problem.code, whole.problem.code);
	assert_string_equal(split.problem.detail, whole.problem.detail);
	assert_true(split.problem.byte == whole.problem.byte);
	assert_int_equal(split.out.len, whole.out.len);
	assert_memory_equal(split.out.bytes, whole.out.bytes, whole.out.len);
}

static void assert_plain(void)
{
	if (whole.ret)
		fail_msg("%s", whole.problem.detail);
	assert_int_equal(whole.out.len, plain.len);
	assert_memory_equal(whole.out.bytes, plain.bytes, plain.len);
}

static void assert_bad(const char *words, uint64_t byte)
{
	assert_int_equal(whole.problem.code, API_BAD_ENCODING);
	if (strstr(whole.problem.detail, words) == NULL)
		fail_msg("no '%s' in '%s'", words, whole.problem.detail);
	assert_int_equal(whole.problem.byte, byte);
}

static void say(struct text *t, const char *words)
{
	t->len = strlen(words);
	memcpy(t->bytes, words, t->len);
}

/* ${noise} of 256 bytes are random, so that it is packed in ways of all kinds. */
static void make_plain(size_t len, unsigned noise)
{
	uint64_t x = 1;

	for (size_t i = 0; i < len; i++) {
		x = x * 6364136223846793005u + 1442695040888963407u;
		plain.bytes[i] = x >> 56 < noise ? (uint8_t)(x >> 32) : (uint8_t)(i / 7 % 5);
	}
	plain.len = len;
}

static void add(struct text *t, const void *bytes, size_t len)
{
	memcpy(t->bytes + t->len, bytes, len);
	t->len += len;
}

/* Append to ${packed} a gzip member with a name, an extra field, a comment and a header check. */
static void add_gzip(const void *bytes, size_t len, int level)
{
	gz_header head = {.name = (Bytef *)"part.stl",
			  .comment = (Bytef *)"a comment",
			  .extra = (Bytef *)"extra",
			  .extra_len = 5,
			  .hcrc = 1};
	z_stream z = {0};

	assert_int_equal(deflateInit2(&z, level, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
	assert_int_equal(deflateSetHeader(&z, &head), Z_OK);
	z.next_in = (Bytef *)(uintptr_t)bytes;
	z.avail_in = (uInt)len;
	z.next_out = packed.bytes + packed.len;
	z.avail_out = (uInt)(ROOM - packed.len);
	assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
	packed.len = ROOM - z.avail_out;
	deflateEnd(&z);
}

/* The same as a zstd frame with a checksum; ${sized}: with the size of the content in front. */
static void add_zstd(const void *bytes, size_t len, bool sized)
{
	ZSTD_CCtx *c = ZSTD_createCCtx();
	ZSTD_inBuffer in = {bytes, len, 0};
	ZSTD_outBuffer out = {packed.bytes, ROOM, packed.len};

	assert_non_null(c);
	(void)ZSTD_CCtx_setParameter(c, ZSTD_c_checksumFlag, 1);
	(void)ZSTD_CCtx_setParameter(c, ZSTD_c_contentSizeFlag, sized);
	assert_int_equal(ZSTD_compressStream2(c, &out, &in, ZSTD_e_end), 0);
	packed.len = out.pos;
	ZSTD_freeCCtx(c);
}

static void add_packed(enum api_coding_kind kind, const void *bytes, size_t len)
{
	if (kind == API_CODING_GZIP)
		add_gzip(bytes, len, 6);
	else if (kind == API_CODING_ZSTD)
		add_zstd(bytes, len, true);
	else
		add(&packed, bytes, len);
}

static void headers_are_read(void **state)
{
	static const struct {
		const char *header;
		enum api_coding_kind kind; /* API_CODINGS: refused */
	} cases[] = {{NULL, API_CODING_IDENTITY},
		     {"", API_CODING_IDENTITY},
		     {"identity", API_CODING_IDENTITY},
		     {" Identity ,, identity,", API_CODING_IDENTITY},
		     {"gzip", API_CODING_GZIP},
		     {"GZip", API_CODING_GZIP},
		     {"x-gzip", API_CODING_GZIP},
		     {"\tgzip ", API_CODING_GZIP},
		     {"identity, gzip", API_CODING_GZIP},
		     {"gzip,identity", API_CODING_GZIP},
		     {"zstd", API_CODING_ZSTD},
		     {"zstd , identity", API_CODING_ZSTD},
		     {"br", API_CODINGS},
		     {"deflate", API_CODINGS},
		     {"compress", API_CODINGS},
		     {"gzip;q=1", API_CODINGS},
		     {"gzip zstd", API_CODINGS},
		     {"gzi", API_CODINGS},
		     {"gzipp", API_CODINGS},
		     {"gzip, gzip", API_CODINGS},
		     {"zstd, gzip", API_CODINGS},
		     {"gzip, br", API_CODINGS}};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		enum api_coding_kind kind = API_CODINGS;
		struct api_problem p = {.code = API_OK};
		int rc = api_coding_read(cases[i].header, &kind, &p);

		assert_int_equal(rc, cases[i].kind == API_CODINGS ? -1 : 0);
		assert_int_equal(p.code, rc ? API_UNSUPPORTED_ENCODING : API_OK);
		if (rc == 0)
			assert_int_equal(kind, cases[i].kind);
	}
}

static void where_a_chunk_ends_never_matters(void **state)
{
	(void)state;
	make_plain(700, 40);
	for (int kind = 0; kind < API_CODINGS; kind++) {
		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, 300);
		add_packed((enum api_coding_kind)kind, plain.bytes + 300, 400);
		decode_whole((enum api_coding_kind)kind, &packed);
		assert_plain();
		for (size_t first = 0; first <= packed.len; first++) {
			decode(&split, (enum api_coding_kind)kind, ROOM, packed.bytes, packed.len,
			       first, packed.len);
			assert_same();
			decode(&split, (enum api_coding_kind)kind, ROOM, packed.bytes, packed.len,
			       first, 1 + first % 7);
			assert_same();
		}
	}
}

static void long_streams_come_out_whole(void **state)
{
	static const unsigned noise[] = {0, 3, 100, 256};

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		make_plain(600000, noise[i]);
		packed.len = 0;
		add_gzip(plain.bytes, plain.len, noise[i] == 256 ? 0 : 6); /* 0: stored */
		decode_whole(API_CODING_GZIP, &packed);
		assert_plain();
		decode(&split, API_CODING_GZIP, ROOM, packed.bytes, packed.len, 1, 997);
		assert_same();
		for (int sized = 0; sized < 2; sized++) {
			packed.len = 0;
			add_zstd(plain.bytes, plain.len, sized);
			decode_whole(API_CODING_ZSTD, &packed);
			assert_plain();
			decode(&split, API_CODING_ZSTD, ROOM, packed.bytes, packed.len, 1, 997);
			assert_same();
		}
	}
}

/* RFC 1952, 2.2: gzip files one behind the other are one; tape and block writers fill up. */
static void gzip_members_are_one_file(void **state)
{
	(void)state;
	say(&plain, "onetwothree");
	packed.len = 0;
	add_gzip("", 0, 6);
	add_gzip("one", 3, 1);
	add_gzip("", 0, 9);
	add_gzip("two", 3, 0);
	add_gzip("three", 5, 9);
	decode_whole(API_CODING_GZIP, &packed);
	assert_plain();
	add(&packed, "\0\0\0\0\0", 5);
	decode_whole(API_CODING_GZIP, &packed);
	assert_plain();
}

static void behind_gzip_only_gzip_or_zeros_may_come(void **state)
{
	size_t end;

	(void)state;
	packed.len = 0;
	add_gzip("one", 3, 6);
	end = packed.len;
	add(&packed, "x", 1);
	decode_whole(API_CODING_GZIP, &packed);
	assert_bad("behind its end", end);
	assert_int_equal(whole.out.len, 3); /* what was good before that came out */
	packed.bytes[end] = '\0';
	add_gzip("two", 3, 6);
	decode_whole(API_CODING_GZIP, &packed);
	assert_bad("behind its end", end + 1);
	packed.len = end;
	add(&packed, "\x1f\x8c", 2);
	decode_whole(API_CODING_GZIP, &packed);
	assert_bad("incorrect header check", end + 2);
	packed.len = end;
	add(&packed, "\x1f", 1);
	decode_whole(API_CODING_GZIP, &packed);
	assert_bad("ends too early", end + 1);
}

static void what_is_no_gzip_is_refused(void **state)
{
	static const char *const others[] = {"solid a\n", "\x78\x9c\x03\x00", "\x28\xb5\x2f\xfd",
					     "PK\x03\x04", "\x1e"};

	(void)state;
	for (size_t i = 0; i < 5; i++) {
		say(&packed, others[i]);
		decode_whole(API_CODING_GZIP, &packed);
		assert_bad("does not begin", 0);
	}
	packed.len = 1; /* zeros fill up an end, they are none */
	packed.bytes[0] = 0;
	decode_whole(API_CODING_GZIP, &packed);
	assert_bad("does not begin", 0);
}

static void zstd_frames_are_one_file(void **state)
{
	static const uint8_t skip[] = {0x5e, 0x2a, 0x4d, 0x18, 3, 0, 0, 0, 'x', 'y', 'z'};
	static const uint8_t skip_none[] = {0x50, 0x2a, 0x4d, 0x18, 0, 0, 0, 0};

	(void)state;
	say(&plain, "onetwothree");
	packed.len = 0;
	add(&packed, skip, sizeof skip);
	add_zstd("one", 3, true);
	add(&packed, skip_none, sizeof skip_none);
	add_zstd("", 0, true);
	add_zstd("two", 3, false);
	add(&packed, skip, sizeof skip);
	add(&packed, skip, sizeof skip);
	add_zstd("three", 5, true);
	add(&packed, skip, sizeof skip);
	decode_whole(API_CODING_ZSTD, &packed);
	assert_plain();
	for (size_t step = 1; step < packed.len; step++) {
		decode(&split, API_CODING_ZSTD, ROOM, packed.bytes, packed.len, step, step);
		assert_same();
	}
}

static void what_is_no_zstd_is_refused(void **state)
{
	static const char *const others[] = {"solid a\n", "\x1f\x8b\x08\x08",
					     "\x27\xb5\x2f\xfd" /* 0.7 */,
					     "\x25\xb5\x2f\xfd" /* 0.5 */, "\xfd\x2f\xb5\x28"};
	size_t end;

	(void)state;
	for (size_t i = 0; i < 5; i++) {
		say(&packed, others[i]);
		decode_whole(API_CODING_ZSTD, &packed);
		assert_bad("does not begin", 0);
	}
	packed.len = 0;
	add_zstd("one", 3, true);
	end = packed.len;
	add(&packed, "\0\0\0\0", 4);
	decode_whole(API_CODING_ZSTD, &packed);
	assert_bad("behind its end", end);
	packed.len = end + 3;
	decode_whole(API_CODING_ZSTD, &packed);
	assert_bad("ends too early", end + 3);
}

/* The header names a window: more than 128 MiB is refused before anything is allocated. */
static void zstd_windows_are_bounded(void **state)
{
	static const uint8_t frame[] = {0x28, 0xb5, 0x2f, 0xfd, 0x00, 17 << 3, 0x01, 0x00, 0x00};
	static const uint8_t dictionary[] = {0x28, 0xb5, 0x2f, 0xfd, 0x01, 0x00, 0x07, 0x01, 0, 0};

	(void)state;
	packed.len = 0;
	add(&packed, frame, sizeof frame);
	decode_whole(API_CODING_ZSTD, &packed);
	assert_int_equal(whole.ret, 0);
	assert_int_equal(whole.out.len, 0);
	packed.bytes[5] = (17 << 3) + 1;
	decode_whole(API_CODING_ZSTD, &packed);
	assert_int_equal(whole.problem.code, API_BAD_ENCODING);
	assert_non_null(strstr(whole.problem.detail, "window of more than 128 MiB"));
	packed.len = 0;
	add(&packed, dictionary, sizeof dictionary);
	decode_whole(API_CODING_ZSTD, &packed);
	assert_int_equal(whole.problem.code, API_BAD_ENCODING);
	assert_non_null(strstr(whole.problem.detail, "dictionary"));
}

/* libzstd words what is wrong with it by how much of it came at once. */
static void a_bad_zstd_frame_header_is_judged_alike_in_any_pieces(void **state)
{
	static const uint8_t frame[] = {0x28, 0xb5, 0x2f, 0xfd, 0x93, 0xff, 0x25, 0xb5, 0x2f, 0xfd,
					0x93, 0x0c, 0x5c, 0x0c, 0x5c, 0x04, 0xff, 0xb5, 0x2f, 0xfd,
					0x93, 0x0c, 0x5c, 0x04, 0xff, 0xff, 0xff, 0xa9};

	(void)state;
	decode(&whole, API_CODING_ZSTD, ROOM, frame, sizeof frame, sizeof frame, 1);
	assert_int_equal(whole.problem.code, API_BAD_ENCODING);
	for (size_t step = 1; step < sizeof frame; step++) {
		decode(&split, API_CODING_ZSTD, ROOM, frame, sizeof frame, step, step);
		assert_same();
	}
}

/* libzstd puts out as much of a stored block as it was given, up to where the room ends. */
static void a_stored_block_beyond_the_declared_size_is_judged_alike_in_any_pieces(void **state)
{
	enum { BLOCK = 300, DECLARED = 50 };
	uint8_t frame[13 + BLOCK] = {0x28,    0xb5, 0x2f, 0xfd, 0x80, 0, /* a window of 1 KiB */
				     DECLARED};

	(void)state;
	frame[10] = ((BLOCK << 3) & 0xff) | 1; /* the last one, stored */
	frame[11] = (BLOCK << 3) >> 8;
	memset(frame + 13, 'x', BLOCK);
	for (size_t len = 1; len <= sizeof frame; len += len < 30 ? 1 : 45) {
		decode(&whole, API_CODING_ZSTD, ROOM, frame, len, len, 1);
		assert_int_equal(whole.problem.code, API_BAD_ENCODING);
		for (size_t step = 1; step < len; step += 1 + step / 8) {
			decode(&split, API_CODING_ZSTD, ROOM, frame, len, step, step);
			assert_same();
		}
	}
}

/* Every proper prefix is refused, unless it ends between members, with its length. */
static void every_prefix_is_cut_off(void **state)
{
	(void)state;
	make_plain(500, 40);
	for (int kind = API_CODING_GZIP; kind < API_CODINGS; kind++) {
		size_t first;

		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, 200);
		first = packed.len;
		add_packed((enum api_coding_kind)kind, plain.bytes + 200, 300);
		for (size_t n = 0; n < packed.len; n++) {
			decode(&whole, (enum api_coding_kind)kind, ROOM, packed.bytes, n, n, 1);
			if (n == first)
				assert_int_equal(whole.ret, 0);
			else
				assert_bad("ends too early", n);
			assert_memory_equal(whole.out.bytes, plain.bytes, whole.out.len);
		}
	}
}

/* All that the bytes say comes out at once, also where it is more than a piece. */
static void nothing_is_held_back(void **state)
{
	(void)state;
	make_plain(2 * (128 << 10), 0); /* two blocks of zstd */
	for (int kind = API_CODING_GZIP; kind < API_CODINGS; kind++) {
		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, plain.len);
		packed.len -= kind == API_CODING_GZIP ? 8 : 4; /* the check */
		decode_whole((enum api_coding_kind)kind, &packed);
		assert_bad("ends too early", packed.len);
		assert_int_equal(whole.out.len, plain.len);
	}
}

/* Whatever byte is wrong, the verdict and what came out before it are the same in any pieces. */
static void damage_shows_alike_in_any_pieces(void **state)
{
	size_t bad = 0;

	(void)state;
	make_plain(500, 40);
	for (int kind = API_CODING_GZIP; kind < API_CODINGS; kind++) {
		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, 200);
		add_packed((enum api_coding_kind)kind, plain.bytes + 200, 300);
		for (size_t i = 0; i < 8 * packed.len; i++) {
			packed.bytes[i / 8] ^= (uint8_t)(1u << i % 8);
			decode_whole((enum api_coding_kind)kind, &packed);
			for (size_t step = 1; step < 30; step += 1 + step) {
				decode(&split, (enum api_coding_kind)kind, ROOM, packed.bytes,
				       packed.len, 0, step);
				assert_same();
			}
			bad += whole.problem.code == API_BAD_ENCODING;
			packed.bytes[i / 8] ^= (uint8_t)(1u << i % 8);
		}
	}
	assert_true(bad > 4000);
}

/* libzstd by itself would lose the good blocks before a bad one when both come together. */
static void blocks_before_the_damage_come_out(void **state)
{
	(void)state;
	make_plain(500000, 100);
	for (int kind = API_CODING_GZIP; kind < API_CODINGS; kind++) {
		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, plain.len);
		for (size_t at = packed.len - 1; at > packed.len / 2; at -= packed.len / 11) {
			packed.bytes[at] ^= 0x55;
			decode_whole((enum api_coding_kind)kind, &packed);
			assert_int_equal(whole.problem.code, API_BAD_ENCODING);
			assert_true(whole.out.len > 128 << 10);
			decode(&split, (enum api_coding_kind)kind, ROOM, packed.bytes, packed.len,
			       10, 1013);
			assert_same();
			packed.bytes[at] ^= 0x55;
		}
	}
}

static void the_limit_counts_decoded_bytes(void **state)
{
	(void)state;
	make_plain(200000, 0);
	for (int kind = 0; kind < API_CODINGS; kind++) {
		static const size_t most[] = {199999, 65537, 65536, 65535, 1, 0};

		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, 100000);
		add_packed((enum api_coding_kind)kind, plain.bytes + 100000, 100000);
		decode(&whole, (enum api_coding_kind)kind, 200000, packed.bytes, packed.len,
		       packed.len, 1);
		assert_plain();
		for (size_t i = 0; i < sizeof most / sizeof most[0]; i++) {
			decode(&whole, (enum api_coding_kind)kind, most[i], packed.bytes,
			       packed.len, packed.len, 1);
			assert_int_equal(whole.problem.code, API_DECODED_TOO_LARGE);
			assert_int_equal(whole.problem.limit, most[i]);
			assert_int_equal(whole.problem.actual, most[i] + 1);
			assert_int_equal(whole.out.len, most[i]); /* not one byte more came out */
			decode(&split, (enum api_coding_kind)kind, most[i], packed.bytes,
			       packed.len, 3, 100);
			assert_same();
		}
	}
}

/* A megabyte of zeros in about a kilobyte, a hundred times: it stops at the limit. */
static void bombs_stop_at_the_limit(void **state)
{
	static uint8_t zeros[ROOM - 1];

	(void)state;
	for (int kind = API_CODING_GZIP; kind < API_CODINGS; kind++) {
		packed.len = 0;
		for (int i = 0; i < 100; i++)
			add_packed((enum api_coding_kind)kind, zeros, sizeof zeros);
		decode(&whole, (enum api_coding_kind)kind, ROOM, packed.bytes, packed.len,
		       packed.len, 1);
		assert_int_equal(whole.problem.code, API_DECODED_TOO_LARGE);
		assert_int_equal(whole.out.len, ROOM);
	}
}

static void the_sink_may_stop_it(void **state)
{
	(void)state;
	make_plain(1000, 40);
	for (int kind = 0; kind < API_CODINGS; kind++) {
		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, plain.len);
		add(&packed, "what is behind it is not looked at", 34);
		whole.stop_at = 500;
		decode_whole((enum api_coding_kind)kind, &packed);
		assert_int_equal(whole.problem.code, API_UNREADABLE);
		assert_string_equal(whole.problem.detail, "enough");
		whole.stop_at = 0;
	}
}

static void any_allocation_may_fail(void **state)
{
	(void)state;
	make_plain(100000, 40);
	for (int kind = 0; kind < API_CODINGS; kind++) {
		long asked = 1;

		packed.len = 0;
		add_packed((enum api_coding_kind)kind, plain.bytes, plain.len);
		for (long n = 1; n <= asked; n++) {
			const struct api_sink sink = {take, &whole};
			long before = alloc_count();
			struct api_coding *c;
			int ret = 0;

			whole.out.len = 0;
			memset(&whole.problem, 0, sizeof whole.problem);
			alloc_fail_at(n);
			c = api_coding_new((enum api_coding_kind)kind, ROOM, &sink);
			if (c != NULL)
				ret = api_coding_push(c, packed.bytes, packed.len, &whole.problem);
			alloc_fail_at(0);
			assert_true(c == NULL || ret == -1);
			if (ret)
				assert_int_equal(whole.problem.code, API_TOO_EXPENSIVE);
			api_coding_free(c);
			asked = kind == API_CODING_GZIP ? 3 : 1; /* ours, zlib's, its window */
			assert_true(alloc_count() - before >= n);
		}
	}
	api_coding_free(NULL);
}

int main(void)
{
	const struct CMUnitTest coding[] = {
	    cmocka_unit_test(headers_are_read),
	    cmocka_unit_test(where_a_chunk_ends_never_matters),
	    cmocka_unit_test(long_streams_come_out_whole),
	    cmocka_unit_test(gzip_members_are_one_file),
	    cmocka_unit_test(behind_gzip_only_gzip_or_zeros_may_come),
	    cmocka_unit_test(what_is_no_gzip_is_refused),
	    cmocka_unit_test(zstd_frames_are_one_file),
	    cmocka_unit_test(what_is_no_zstd_is_refused),
	    cmocka_unit_test(zstd_windows_are_bounded),
	    cmocka_unit_test(a_bad_zstd_frame_header_is_judged_alike_in_any_pieces),
	    cmocka_unit_test(a_stored_block_beyond_the_declared_size_is_judged_alike_in_any_pieces),
	    cmocka_unit_test(every_prefix_is_cut_off),
	    cmocka_unit_test(nothing_is_held_back),
	    cmocka_unit_test(damage_shows_alike_in_any_pieces),
	    cmocka_unit_test(blocks_before_the_damage_come_out),
	    cmocka_unit_test(the_limit_counts_decoded_bytes),
	    cmocka_unit_test(bombs_stop_at_the_limit),
	    cmocka_unit_test(the_sink_may_stop_it),
	    cmocka_unit_test(any_allocation_may_fail),
	};

	return cmocka_run_group_tests(coding, NULL, NULL);
}
