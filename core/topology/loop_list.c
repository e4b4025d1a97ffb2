#include <stdlib.h>
#include <string.h>

#include "core/topology/loop_list.h"

#define NONE MP_NO_LOOP

static struct mp_loop_place *loop_of(const struct mp_loop_lister *s, uint32_t v)
{
	uint32_t i = mp_loop_number(s, v);

	return i == NONE ? NULL : &s->loop[i];
}

/* File order: a loop's first half-edge is the first one met. */
static void number(struct mp_loop_lister *s)
{
	size_t n = 0;

	MP_FOR_BOUNDARY(s, h)
	{
		uint32_t root = mp_set_find(s->parent, mp_loop_tail(s, h));

		if (s->item[root] != NONE)
			continue;
		if (n == s->items)
			break;
		s->loop[n].first = (uint32_t)h;
		s->loop[n].circle = true;
		s->item[root] = (uint32_t)n++;
	}
}

static void meet(struct mp_loop_lister *s, uint32_t v, uint32_t half)
{
	s->link[v] ^= half;
	if (s->degree[v] < 3)
		s->degree[v]++;
}

static void measure(struct mp_loop_lister *s)
{
	uint32_t last = NONE;

	MP_FOR_BOUNDARY(s, h)
	{
		struct mp_loop_place *l = loop_of(s, mp_loop_tail(s, h));

		meet(s, mp_loop_tail(s, h), (uint32_t)h);
		meet(s, mp_loop_head(s, h), (uint32_t)h);
		/* All boundary edges of a triangle are on one loop and come together. */
		if (l != NULL && (uint32_t)h / 3 != last)
			l->triangles++;
		last = (uint32_t)h / 3;
	}
	for (uint32_t v = 0; v < mp_vertices_count(s->mesh->vertices); v++) {
		struct mp_loop_place *l = s->degree[v] > 0 ? loop_of(s, v) : NULL;

		if (l == NULL)
			continue;
		l->vertices++;
		l->circle = l->circle && s->degree[v] == 2;
	}
}

static size_t cut(size_t n, size_t most, bool *truncated)
{
	*truncated |= n > most;
	return n < most ? n : most;
}

/* Memory for all, and where each loop's items begin; the lists' cursors are the next begins. */
static int begin(struct mp_loop_lister *s, struct mp_defect_list *l, bool *truncated)
{
	size_t triangles = 0, vertices = 0;

	for (size_t i = 0; i < s->items; i++) {
		triangles += cut(s->loop[i].triangles, MP_DEFECT_TRIANGLES, truncated);
		vertices += cut(s->loop[i].vertices, MP_DEFECT_VERTICES, truncated);
	}
	if (mp_defects_begin(l, s->items, triangles, vertices))
		return -1;
	l->count = s->items;
	for (size_t i = 0; i < s->items; i++) {
		struct mp_loop_place *o = &s->loop[i];

		o->triangles = (uint32_t)cut(o->triangles, MP_DEFECT_TRIANGLES, truncated);
		o->vertices = (uint32_t)cut(o->vertices, MP_DEFECT_VERTICES, truncated);
		l->triangle_at[i + 1] = l->triangle_at[i] + o->triangles;
		l->vertex_at[i + 1] = l->vertex_at[i] + o->vertices;
	}
	return 0;
}

static void walk(const struct mp_loop_lister *s, const struct mp_loop_place *o, uint32_t *out)
{
	uint32_t half = o->first, v = mp_loop_tail(s, half);

	for (uint32_t n = 0; n < o->vertices; n++) {
		out[n] = v;
		v = mp_loop_tail(s, half) == v ? mp_loop_head(s, half) : mp_loop_tail(s, half);
		half ^= s->link[v];
	}
}

/* List ${v} unless it is already, or its loop is a circle, or full. */
static void list_vertex(struct mp_loop_lister *s, struct mp_defect_list *l, struct mp_loop_place *o,
			uint32_t v)
{
	if (s->degree[v] == 0 || o->circle || o->vertices == 0)
		return;
	s->degree[v] = 0;
	l->vertices[l->vertex_at[(size_t)(o - s->loop) + 1] - o->vertices--] = v;
}

static void fill(struct mp_loop_lister *s, struct mp_defect_list *l)
{
	uint32_t last = NONE;

	for (size_t i = 0; i < s->items; i++)
		if (s->loop[i].circle)
			walk(s, &s->loop[i], l->vertices + l->vertex_at[i]);
	MP_FOR_BOUNDARY(s, h)
	{
		uint32_t t = (uint32_t)h / 3;
		struct mp_loop_place *o = loop_of(s, mp_loop_tail(s, h));

		if (o == NULL)
			continue;
		list_vertex(s, l, o, mp_loop_tail(s, h));
		list_vertex(s, l, o, mp_loop_head(s, h));
		if (t != last && o->triangles > 0)
			l->triangles[l->triangle_at[(size_t)(o - s->loop) + 1] - o->triangles--] =
			    t;
		last = t;
	}
}

int mp_loops_list(const struct mp_mesh *mesh, const uint64_t *bit, const uint64_t *gap,
		  uint32_t *parent, size_t items, struct mp_topology *out)
{
	struct mp_defect_list *l = &out->defect[MP_DEFECT_BOUNDARY_LOOP];
	size_t vertices = mp_vertices_count(mesh->vertices);
	struct mp_loop_lister s = {
	    .mesh = mesh, .bit = bit, .gap = gap, .parent = parent, .items = items};
	int failed = -1;

	if (items == 0)
		return mp_defects_begin(l, 0, 0, 0);
	s.halves = 3 * (size_t)mesh->triangles;
	s.item = malloc(vertices * sizeof *s.item);
	s.link = calloc(vertices, sizeof *s.link);
	s.degree = calloc(vertices, sizeof *s.degree);
	s.loop = calloc(items, sizeof *s.loop);
	if (s.item != NULL && s.link != NULL && s.degree != NULL && s.loop != NULL) {
		memset(s.item, 0xff, vertices * sizeof *s.item);
		number(&s);
		measure(&s);
		failed = mp_loops_measure(&s, out) || mp_junctions_find(&s, out) ||
			 begin(&s, l, &out->truncated);
	}
	if (!failed)
		fill(&s, l);
	free(s.loop);
	free(s.degree);
	free(s.link);
	free(s.item);
	return failed ? -1 : 0;
}
