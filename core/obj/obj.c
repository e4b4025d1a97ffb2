#include <stdlib.h>
#include <string.h>

#include "core/obj/obj_private.h"

/* So many vertices more than three for each triangle that is allowed. */
#define SPARE_VERTICES 65536

static size_t most_vertices(uint64_t triangles)
{
	const uint64_t most = UINT32_MAX - 1; /* numbers from 1 fit into 32 bits */

	if (triangles > (most - SPARE_VERTICES) / 3)
		return most;
	return (size_t)(3 * triangles + SPARE_VERTICES);
}

static int begin(void **state, const struct mp_sink *sink, const struct mp_limits *limits,
		 struct mp_notes *notes, struct mp_error *err)
{
	struct obj *o = malloc(sizeof *o);

	*state = o;
	if (o == NULL)
		return mp_fail_nomem(err);
	memset(o, 0, sizeof *o);
	memset(notes, 0, sizeof *notes);
	notes->format = MP_FORMAT_OBJ;
	o->sink = sink;
	o->limits = limits;
	o->notes = notes;
	o->line = 1;
	o->vertex_most = most_vertices(limits->max_triangles);
	return 0;
}

int obj_flush(struct obj *o, struct mp_error *err)
{
	size_t count = o->count;

	o->count = 0;
	if (count == 0)
		return 0;
	if (o->sink->indices != NULL &&
	    o->sink->indices(o->sink->self, (const uint32_t(*)[3])o->index, count, err))
		return -1;
	return o->sink->block(o->sink->self, (const double(*)[9])o->block, count, err);
}

static int take(struct obj *o, const char *text, size_t len, struct mp_error *err)
{
	const char *p = text, *end = text + len, *stop = end;

	while (stop > text && *--stop != '\n')
		;
	while (p < end) {
		if (o->cr && *p == '\n')
			p++;
		o->cr = false;
		if (o->mode == OBJ_AT_LINE && !o->backslash && p < stop &&
		    obj_take_lines(o, &p, stop, err))
			return -1;
		if (p < end && obj_text_push(o, text, &p, end, err))
			return -1;
	}
	o->at += len;
	return 0;
}

/* UTF-8 with or without its mark, and what was before it; UTF-16 has a NUL in every other byte. */
static int take_head(struct obj *o, struct mp_error *err)
{
	const uint8_t *h = o->head;
	size_t len = o->head_len;

	o->begun = true;
	if (len >= 2 && ((h[0] == 0xff && h[1] == 0xfe) || (h[0] == 0xfe && h[1] == 0xff) ||
			 (h[0] == 0) != (h[1] == 0)))
		return mp_fail_line(err, MP_SYNTAX, 0, 1,
				    "text in UTF-16; save it as ASCII or UTF-8");
	if (len == 3 && memcmp(h, "\xef\xbb\xbf", 3) == 0) {
		o->at = 3;
		return 0;
	}
	return take(o, (const char *)h, len, err);
}

static int push(void *state, const uint8_t *chunk, size_t len, struct mp_error *err)
{
	struct obj *o = state;

	o->notes->bytes += len;
	while (!o->begun && len > 0) {
		o->head[o->head_len++] = *chunk++;
		len--;
		if (o->head_len == sizeof o->head && take_head(o, err))
			return -1;
	}
	return len == 0 ? 0 : take(o, (const char *)chunk, len, err);
}

static int finish(void *state, struct mp_error *err)
{
	struct obj *o = state;
	struct mp_notes *n = o->notes;

	if (n->bytes == 0)
		return mp_fail(err, MP_EMPTY, MP_NO_BYTE, "it has 0 bytes");
	if ((!o->begun && take_head(o, err)) || obj_text_finish(o, err) || obj_finish_faces(o, err))
		return -1;
	n->vertices_in_file = o->vertices;
	if (n->triangles > 0)
		return 0;
	if (o->known == 0 && n->nonstandard_lines > 0)
		return mp_fail_line(err, MP_SYNTAX, 0, 1, "no line is an OBJ statement");
	return mp_fail(err, MP_NO_FACES, MP_NO_BYTE,
		       "an OBJ file without faces (%llu vertices, %llu statements with points, "
		       "%llu with lines)",
		       (unsigned long long)n->vertices_in_file, (unsigned long long)n->points,
		       (unsigned long long)n->lines);
}

static void end(void *state)
{
	struct obj *o = state;

	if (o == NULL)
		return;
	free(o->vertex);
	free(o->corner);
	mp_polygon_free(&o->polygon);
	free(o);
}

const struct mp_decoder_ops mp_obj_decoder = {"obj", begin, push, finish, end};
