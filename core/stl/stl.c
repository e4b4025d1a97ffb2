#include <stdlib.h>
#include <string.h>

#include "core/stl/stl_private.h"

static int stl_begin(void **state, const struct mp_sink *sink, const struct mp_limits *limits,
		     struct mp_notes *notes, struct mp_error *err)
{
	struct stl *s = malloc(sizeof *s);

	*state = s;
	if (s == NULL)
		return mp_fail_nomem(err);
	memset(notes, 0, sizeof *notes);
	s->sink = sink;
	s->limits = limits;
	s->notes = notes;
	s->kind = STL_UNDECIDED;
	s->at = 0;
	s->count = 0;
	s->kernel = stl_columns_kernels() - 1;
	s->window_len = 0;
	return 0;
}

int stl_flush(struct stl *s, struct mp_error *err)
{
	size_t count = s->count;

	s->count = 0;
	if (count == 0)
		return 0;
	if (s->kind == STL_BINARY && s->sink->floats != NULL)
		return s->sink->floats(s->sink->self,
				       (const float(*)[MP_BLOCK])(s->columns.row + 3), count, err);
	return s->sink->block(s->sink->self, (const double(*)[9])s->block, count, err);
}

static int pass_on(struct stl *s, const uint8_t *chunk, size_t len, struct mp_error *err)
{
	int ret;

	if (s->kind == STL_BINARY)
		ret = stl_binary_push(s, chunk, len, err);
	else
		ret = stl_text_push(s, (const char *)chunk, len, err);
	s->at += len;
	return ret;
}

static int decide(struct stl *s, bool whole, struct mp_error *err)
{
	const size_t len = s->window_len;
	const char *hint = NULL;
	size_t begin;

	s->kind = stl_sniff(s->window, len, whole, &hint);
	switch (s->kind) {
	case STL_BINARY:
		s->notes->format = MP_FORMAT_STL_BINARY;
		s->notes->rounding = MP_ROUNDING_FLOAT32;
		stl_binary_begin(s, s->window, hint);
		begin = STL_HEADER;
		break;
	case STL_TEXT:
		s->notes->format = MP_FORMAT_STL_ASCII;
		stl_text_begin(s);
		begin = len >= 3 && memcmp(s->window, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
		break;
	case STL_OTHER:
		return mp_fail(err, MP_SYNTAX, 0, "no STL: this seems to be %s", hint);
	default:
		return mp_fail(err, MP_TRUNCATED, len,
			       "only %zu bytes; a binary STL has 84 or more, a text one has facets",
			       len);
	}
	s->at = begin;
	return pass_on(s, s->window + begin, len - begin, err);
}

static int stl_push(void *state, const uint8_t *chunk, size_t len, struct mp_error *err)
{
	struct stl *s = state;

	s->notes->bytes += len;
	if (s->kind == STL_UNDECIDED) {
		size_t take = STL_WINDOW - s->window_len;

		if (take > len)
			take = len;
		if (take == 0)
			return 0;
		memcpy(s->window + s->window_len, chunk, take);
		s->window_len += take;
		chunk += take;
		len -= take;
		if (s->window_len < STL_WINDOW)
			return 0;
		if (decide(s, false, err))
			return -1;
	}
	return len == 0 ? 0 : pass_on(s, chunk, len, err);
}

static int stl_finish(void *state, struct mp_error *err)
{
	struct stl *s = state;

	if (s->notes->bytes == 0)
		return mp_fail(err, MP_EMPTY, MP_NO_BYTE, "it has 0 bytes");
	if (s->kind == STL_UNDECIDED && decide(s, true, err))
		return -1;
	if (s->kind == STL_BINARY ? stl_binary_finish(s, err) : stl_text_finish(s, err))
		return -1;
	return stl_flush(s, err);
}

static void stl_end(void *state)
{
	free(state);
}

const struct mp_decoder_ops mp_stl_decoder = {"stl", stl_begin, stl_push, stl_finish, stl_end};
