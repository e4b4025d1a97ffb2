#include <stdlib.h>
#include <string.h>

#include "core/obj/obj_private.h"

void obj_corner_begin(struct obj_corner *c)
{
	memset(c, 0, sizeof *c);
}

/* Is what has come of the field an index, or nothing where it may be nothing? */
static bool is_field(const struct obj_corner *c)
{
	return c->digits || (c->field > 0 && !c->sign);
}

void obj_corner_feed(struct obj_corner *c, const char *text, size_t len)
{
	const uint64_t most = UINT64_MAX / 16; /* stay there: no file has so many vertices */

	for (size_t i = 0; i < len; i++) {
		if (mp_is_digit(text[i])) {
			c->digits = true;
			if (c->field == 0)
				c->value =
				    c->value < most ? 10 * c->value + mp_digit(text[i]) : most;
		} else if (text[i] == '-' && !c->sign && !c->digits) {
			c->sign = true;
			c->negative = c->negative || c->field == 0;
		} else if (text[i] == '/' && c->field < 2 && is_field(c)) {
			c->field++;
			c->sign = c->digits = false;
		} else {
			c->bad = true;
		}
	}
}

bool obj_corner_finish(struct obj_corner *c)
{
	return !c->bad && is_field(c);
}

/* Room for ${need} items of ${size} bytes; doubles.  The old memory stays good when this fails. */
static void *grow(void *old, size_t size, size_t need, size_t *room)
{
	size_t more = *room < 1024 ? 1024 : *room;
	void *new;

	while (more < need)
		more = more > SIZE_MAX / 2 ? SIZE_MAX : 2 * more;
	if (more > SIZE_MAX / size)
		return NULL;
	new = realloc(old, more * size);
	if (new != NULL)
		*room = more;
	return new;
}

int obj_add_vertex(struct obj *o, struct mp_error *err)
{
	if (o->vertices == o->vertex_most)
		return mp_fail_limit(err, o->statement_at, o->vertex_most, o->vertices + 1,
				     "more than %llu vertices, three for each triangle allowed",
				     (unsigned long long)o->vertex_most);
	if (o->vertices == o->vertex_room) {
		void *new = grow(o->vertex, sizeof *o->vertex, o->vertices + 1, &o->vertex_room);

		if (new == NULL)
			return mp_fail_nomem(err);
		o->vertex = new;
	}
	memcpy(o->vertex[o->vertices++], o->xyz, sizeof o->xyz);
	return 0;
}

static int reserve_corners(struct obj *o, size_t count, struct mp_error *err)
{
	void *new;

	if (o->corner_room - o->corners >= count)
		return 0;
	new = grow(o->corner, sizeof *o->corner, o->corners + count, &o->corner_room);
	if (new == NULL)
		return mp_fail_nomem(err);
	o->corner = new;
	return 0;
}

int obj_split_face(struct obj *o, const uint32_t *corner, size_t n, struct mp_error *err)
{
	struct mp_polygon *p = &o->polygon;
	bool nonplanar;

	if (n == 3)
		return obj_triangle(o, corner[0], corner[1], corner[2], err);
	if (n == 4 && mp_polygon_usual_quad((const double(*)[3])o->vertex, corner, &nonplanar)) {
		o->notes->nonplanar_polygons += nonplanar;
		return obj_triangle(o, corner[0], corner[1], corner[2], err) ||
			       obj_triangle(o, corner[0], corner[2], corner[3], err)
			   ? -1
			   : 0;
	}
	if (mp_polygon_split(p, (const double(*)[3])o->vertex, corner, (uint32_t)n, err))
		return -1;
	o->notes->nonplanar_polygons += p->nonplanar;
	o->notes->tangled_polygons += p->tangled;
	for (size_t i = 0; i < n - 2; i++)
		if (obj_triangle(o, corner[p->tri[i][0]], corner[p->tri[i][1]],
				 corner[p->tri[i][2]], err))
			return -1;
	return 0;
}

static uint64_t line_of(const uint32_t *head)
{
	return head[1] | (uint64_t)head[2] << 32;
}

/* The faces held back, in their order, up to the first with a vertex that is still missing. */
static int release(struct obj *o, struct mp_error *err)
{
	for (size_t at = 0; at < o->held;) {
		const uint32_t *head = o->corner + at, *corner = head + OBJ_FACE_HEAD;
		size_t n = head[0];

		for (size_t i = 0; i < n; i++)
			if (corner[i] >= o->vertices)
				return mp_fail_line(err, MP_BAD_INDEX, MP_NO_BYTE, line_of(head),
						    "a face with vertex %llu, but there are %llu",
						    (unsigned long long)corner[i] + 1,
						    (unsigned long long)o->vertices);
		if (obj_split_face(o, corner, n, err))
			return -1;
		at += OBJ_FACE_HEAD + n;
	}
	o->held = o->corners = 0;
	o->held_most = 0;
	return 0;
}

int obj_begin_face(struct obj *o, struct mp_error *err)
{
	if (o->held > 0 && o->held_most <= o->vertices && release(o, err))
		return -1;
	o->corners = o->face = o->held;
	o->face_most = 0;
	if (reserve_corners(o, OBJ_FACE_HEAD, err))
		return -1;
	o->corners += OBJ_FACE_HEAD;
	return 0;
}

/* The number of the vertex, from 1; 0 with the error set where it can be none. */
static uint32_t vertex_number(struct obj *o, const struct obj_corner *c, struct mp_error *err)
{
	if (c->value == 0)
		(void)obj_fail(o, err, MP_BAD_INDEX,
			       "a face with vertex 0; they are counted from 1");
	else if (c->negative ? c->value > o->vertices : c->value > o->vertex_most)
		(void)mp_fail_line(err, MP_BAD_INDEX, o->word_at, o->word_line,
				   "a face with vertex %s%llu, but there are %llu before it",
				   c->negative ? "-" : "", (unsigned long long)c->value,
				   (unsigned long long)o->vertices);
	else
		return (uint32_t)(c->negative ? o->vertices + 1 - c->value : c->value);
	return 0;
}

int obj_add_corner(struct obj *o, const struct obj_corner *c, struct mp_error *err)
{
	const uint64_t most = o->limits->max_triangles, had = o->notes->triangles;
	uint32_t number = vertex_number(o, c, err);
	size_t n = o->corners - o->face - OBJ_FACE_HEAD + 1;

	if (number == 0)
		return -1;
	if (n > 2 && n - 2 > most - had)
		return mp_fail_limit(err, o->word_at, most, had + n - 2, "more than %llu triangles",
				     (unsigned long long)most);
	if (n > OBJ_MOST_CORNERS)
		return mp_fail_limit(err, o->word_at, OBJ_MOST_CORNERS, n,
				     "a face with more than %d corners", OBJ_MOST_CORNERS);
	if (reserve_corners(o, 1, err))
		return -1;
	o->corner[o->corners++] = number - 1;
	if (number > o->face_most)
		o->face_most = number;
	return 0;
}

int obj_end_face(struct obj *o, struct mp_error *err)
{
	uint32_t *head = o->corner + o->face;
	size_t n = o->corners - o->face - OBJ_FACE_HEAD;

	if (n < 3)
		return mp_fail_line(err, MP_SYNTAX, o->statement_at, o->statement_line,
				    "a face with %zu corners; it needs 3 or more", n);
	o->notes->triangles += n - 2;
	o->notes->polygons += n > 3;
	if (o->held == 0 && o->face_most <= o->vertices)
		return obj_split_face(o, head + OBJ_FACE_HEAD, n, err);
	head[0] = (uint32_t)n;
	head[1] = (uint32_t)o->statement_line;
	head[2] = (uint32_t)(o->statement_line >> 32);
	o->held = o->corners;
	if (o->face_most > o->held_most)
		o->held_most = o->face_most;
	return 0;
}

int obj_finish_faces(struct obj *o, struct mp_error *err)
{
	return release(o, err) || obj_flush(o, err) ? -1 : 0;
}
