#include <stdlib.h>
#include <string.h>

#include "core/topology/disjoint.h"
#include "core/topology/topology_parts.h"

#define NONE UINT32_MAX

struct loop {
	uint32_t first;     /* its smallest half-edge */
	uint32_t triangles; /* how many have an edge on it */
	uint32_t vertices;
	bool circle; /* every vertex has two of its edges */
};

struct lister {
	const struct mp_mesh *mesh;
	const uint64_t *bit;
	size_t halves;
	uint32_t *parent;
	uint32_t *item; /* of the set's root: number of its loop, NONE where it is not listed */
	uint32_t
	    *link; /* all boundary half-edges at the vertex xored: two of them give the other */
	uint8_t *degree; /* of them at the vertex, 3 for more; 0 = listed or none */
	struct loop *loop;
	size_t items;
};

#define FOR_BOUNDARY(s, h)                                                      \
	for (size_t h = mp_bit_next((s)->bit, (s)->halves, 0); h < (s)->halves; \
	     h = mp_bit_next((s)->bit, (s)->halves, h + 1))

static uint32_t tail(const struct lister *s, size_t half)
{
	return mp_corner_vertex(s->mesh, (uint32_t)half);
}

static uint32_t head(const struct lister *s, size_t half)
{
	return mp_corner_vertex(s->mesh, mp_half_next((uint32_t)half));
}

/* The loop of a boundary vertex, NULL where it is not listed. */
static struct loop *loop_of(const struct lister *s, uint32_t v)
{
	uint32_t i = s->item[mp_set_find(s->parent, v)];

	return i == NONE ? NULL : &s->loop[i];
}

/* File order: a loop's first half-edge is the first one met. */
static void number(struct lister *s)
{
	size_t n = 0;

	FOR_BOUNDARY(s, h)
	{
		uint32_t root = mp_set_find(s->parent, tail(s, h));

		if (s->item[root] != NONE)
			continue;
		if (n == s->items)
			break;
		s->loop[n].first = (uint32_t)h;
		s->loop[n].circle = true;
		s->item[root] = (uint32_t)n++;
	}
}

static void meet(struct lister *s, uint32_t v, uint32_t half)
{
	s->link[v] ^= half;
	if (s->degree[v] < 3)
		s->degree[v]++;
}

static void measure(struct lister *s)
{
	uint32_t last = NONE;

	FOR_BOUNDARY(s, h)
	{
		struct loop *l = loop_of(s, tail(s, h));

		meet(s, tail(s, h), (uint32_t)h);
		meet(s, head(s, h), (uint32_t)h);
		/* All boundary edges of a triangle are on one loop and come together. */
		if (l != NULL && (uint32_t)h / 3 != last)
			l->triangles++;
		last = (uint32_t)h / 3;
	}
	for (uint32_t v = 0; v < mp_vertices_count(s->mesh->vertices); v++) {
		struct loop *l = s->degree[v] > 0 ? loop_of(s, v) : NULL;

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
static int begin(struct lister *s, struct mp_defect_list *l, bool *truncated)
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
		struct loop *o = &s->loop[i];

		o->triangles = (uint32_t)cut(o->triangles, MP_DEFECT_TRIANGLES, truncated);
		o->vertices = (uint32_t)cut(o->vertices, MP_DEFECT_VERTICES, truncated);
		l->triangle_at[i + 1] = l->triangle_at[i] + o->triangles;
		l->vertex_at[i + 1] = l->vertex_at[i] + o->vertices;
	}
	return 0;
}

static void walk(const struct lister *s, const struct loop *o, uint32_t *out)
{
	uint32_t half = o->first, v = tail(s, half);

	for (uint32_t n = 0; n < o->vertices; n++) {
		out[n] = v;
		v = tail(s, half) == v ? head(s, half) : tail(s, half);
		half ^= s->link[v];
	}
}

/* List ${v} unless it is already, or its loop is a circle, or full. */
static void list_vertex(struct lister *s, struct mp_defect_list *l, struct loop *o, uint32_t v)
{
	if (s->degree[v] == 0 || o->circle || o->vertices == 0)
		return;
	s->degree[v] = 0;
	l->vertices[l->vertex_at[(size_t)(o - s->loop) + 1] - o->vertices--] = v;
}

static void fill(struct lister *s, struct mp_defect_list *l)
{
	uint32_t last = NONE;

	for (size_t i = 0; i < s->items; i++)
		if (s->loop[i].circle)
			walk(s, &s->loop[i], l->vertices + l->vertex_at[i]);
	FOR_BOUNDARY(s, h)
	{
		uint32_t t = (uint32_t)h / 3;
		struct loop *o = loop_of(s, tail(s, h));

		if (o == NULL)
			continue;
		list_vertex(s, l, o, tail(s, h));
		list_vertex(s, l, o, head(s, h));
		if (t != last && o->triangles > 0)
			l->triangles[l->triangle_at[(size_t)(o - s->loop) + 1] - o->triangles--] =
			    t;
		last = t;
	}
}

int mp_loops_list(const struct mp_mesh *mesh, const uint64_t *bit, uint32_t *parent, size_t items,
		  struct mp_topology *out)
{
	struct mp_defect_list *l = &out->defect[MP_DEFECT_BOUNDARY_LOOP];
	size_t vertices = mp_vertices_count(mesh->vertices);
	struct lister s = {.mesh = mesh, .bit = bit, .parent = parent, .items = items};
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
		failed = begin(&s, l, &out->truncated);
	}
	if (!failed)
		fill(&s, l);
	free(s.loop);
	free(s.degree);
	free(s.link);
	free(s.item);
	return failed;
}
