#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/topology/loop_list.h"

/*
 * Everything is summed about the loop's first vertex, so that nothing is lost far from the origin,
 * in compensated sums (Neumaier 1974, doi:10.1002/zamm.19740540106) of long doubles: the order of
 * the triangles in the file leaves no trace that a double would show.
 */
struct sum {
	long double hi, lo;
};

struct measure {
	double base[3];               /* the first vertex */
	struct sum length, vector[3]; /* vector: sum of p x q, p and q about base */
	struct sum mean[3];           /* of the vertices, about base; later their mean itself */
	long double size, deviation;  /* largest |coordinate|; distance from the plane */
	bool balanced, gap;           /* as often in as out of every vertex; some gap bit is set */
};

struct work {
	const struct mp_loop_lister *s;
	struct mp_loop *loop;
	struct measure *measure;
	int32_t *balance; /* per vertex: its boundary edges out of it less those into it */
};

static void add(struct sum *s, long double x)
{
	long double t = s->hi + x;

	s->lo += fabsl(s->hi) >= fabsl(x) ? (s->hi - t) + x : (x - t) + s->hi;
	s->hi = t;
}

static long double total(const struct sum *s)
{
	return s->hi + s->lo;
}

/* As a double; false where none holds it. */
static bool put(long double x, double *out)
{
	bool fits = isfinite(x) && x <= DBL_MAX && (x == 0 || x >= DBL_MIN);

	*out = fits ? (double)x : 0;
	return fits;
}

static void relative(const struct work *w, const struct measure *m, uint32_t v, long double out[3])
{
	double xyz[3];

	mp_loop_place_of(w->s, v, xyz);
	for (int k = 0; k < 3; k++)
		out[k] = (long double)xyz[k] - m->base[k];
}

static void add_area(const struct work *w, struct measure *m, uint32_t from, uint32_t to)
{
	long double p[3], q[3];

	relative(w, m, from, p);
	relative(w, m, to, q);
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		add(&m->vector[k], p[i] * q[j]);
		add(&m->vector[k], -p[j] * q[i]);
	}
}

static void add_edge(struct work *w, uint32_t item, uint32_t from, uint32_t to)
{
	struct measure *m = &w->measure[item];
	struct mp_loop *l = &w->loop[item];
	long double p[3], q[3];

	if (l->edges++ == 0)
		mp_loop_place_of(w->s, from, m->base);
	relative(w, m, from, p);
	relative(w, m, to, q);
	add(&m->length, hypotl(hypotl(q[0] - p[0], q[1] - p[1]), q[2] - p[2]));
	add_area(w, m, from, to);
	w->balance[from]++;
	w->balance[to]--;
}

static void add_vertex(struct work *w, uint32_t item, uint32_t v)
{
	struct measure *m = &w->measure[item];
	struct mp_loop *l = &w->loop[item];
	long double p[3];
	double xyz[3];

	mp_loop_place_of(w->s, v, xyz);
	relative(w, m, v, p);
	for (int k = 0; k < 3; k++) {
		if (l->vertices == 0 || xyz[k] < l->min[k])
			l->min[k] = xyz[k] + 0.0;
		if (l->vertices == 0 || xyz[k] > l->max[k])
			l->max[k] = xyz[k] + 0.0;
		m->size = fmaxl(m->size, fabsl(xyz[k]));
		add(&m->mean[k], p[k]);
	}
	l->vertices++;
	m->balanced = m->balanced && w->balance[v] == 0;
	m->gap = m->gap || (w->s->gap[v / 64] >> (v % 64) & 1);
}

/* A circle whose triangles are wound against each other: once around it, whatever they say. */
static void walk(const struct work *w, uint32_t item)
{
	const struct mp_loop_lister *s = w->s;
	uint32_t half = s->loop[item].first, v = mp_loop_tail(s, half);

	memset(w->measure[item].vector, 0, sizeof w->measure[item].vector);
	for (uint64_t n = 0; n < w->loop[item].vertices; n++) {
		uint32_t tail = mp_loop_tail(s, half), head = mp_loop_head(s, half);
		uint32_t next = tail == v ? head : tail;

		add_area(w, &w->measure[item], v, next);
		v = next;
		half ^= s->link[v];
	}
}

/* What the sums say, but for the plane, whose mean and unit normal they leave behind. */
static void conclude(struct work *w, uint32_t item)
{
	struct measure *m = &w->measure[item];
	struct mp_loop *l = &w->loop[item];
	long double vector, normal[3];

	l->simple = w->s->loop[item].circle;
	l->crack = !m->gap;
	l->length_defined = put(total(&m->length), &l->length);
	if (l->simple && !m->balanced)
		walk(w, item);
	for (int k = 0; k < 3; k++) {
		normal[k] = total(&m->vector[k]);
		m->mean[k].hi = total(&m->mean[k]) / (long double)l->vertices;
	}
	vector = hypotl(hypotl(normal[0], normal[1]), normal[2]);
	/* what rounding leaves of nothing */
	if (l->crack || vector <= 0x1p-60L * total(&m->length) * total(&m->length))
		vector = 0;
	l->area_defined = (m->balanced || l->simple) && put(vector / 2, &l->area);
	l->plane_defined = l->area_defined && l->area > 0;
	for (int k = 0; k < 3 && l->plane_defined; k++)
		m->vector[k].hi = normal[k] / vector;
}

static void add_deviation(struct work *w, uint32_t item, uint32_t v)
{
	struct measure *m = &w->measure[item];
	long double p[3], far = 0;

	relative(w, m, v, p);
	for (int k = 0; k < 3; k++)
		far += (p[k] - m->mean[k].hi) * m->vector[k].hi;
	m->deviation = fmaxl(m->deviation, fabsl(far));
}

static void judge_plane(struct work *w, uint32_t item)
{
	struct measure *m = &w->measure[item];
	struct mp_loop *l = &w->loop[item];

	l->planar = l->crack;
	if (!l->plane_defined)
		return;
	l->planar = m->deviation <= 0x1p-23L * m->size;
	if (m->deviation < DBL_MIN) /* less than a double tells */
		m->deviation = 0;
	l->plane_defined = put(m->deviation, &l->plane_deviation);
}

static void measure(struct work *w)
{
	const struct mp_loop_lister *s = w->s;
	uint32_t vertices = mp_vertices_count(s->mesh->vertices), item;

	for (size_t i = 0; i < s->items; i++)
		w->measure[i].balanced = true;
	MP_FOR_BOUNDARY(s, h)
	{
		item = mp_loop_number(s, mp_loop_tail(s, h));
		if (item != MP_NO_LOOP)
			add_edge(w, item, mp_loop_tail(s, h), mp_loop_head(s, h));
	}
	for (uint32_t v = 0; v < vertices; v++)
		if (s->degree[v] > 0 && (item = mp_loop_number(s, v)) != MP_NO_LOOP)
			add_vertex(w, item, v);
	for (uint32_t i = 0; i < s->items; i++)
		conclude(w, i);
	for (uint32_t v = 0; v < vertices; v++)
		if (s->degree[v] > 0 && (item = mp_loop_number(s, v)) != MP_NO_LOOP &&
		    w->loop[item].plane_defined)
			add_deviation(w, item, v);
	for (uint32_t i = 0; i < s->items; i++)
		judge_plane(w, i);
}

int mp_loops_measure(const struct mp_loop_lister *s, struct mp_topology *out)
{
	struct work w = {.s = s};
	int failed = -1;

	out->loop = calloc(s->items, sizeof *out->loop);
	w.loop = out->loop;
	w.measure = calloc(s->items, sizeof *w.measure);
	w.balance = calloc(mp_vertices_count(s->mesh->vertices), sizeof *w.balance);
	if (w.loop != NULL && w.measure != NULL && w.balance != NULL) {
		measure(&w);
		failed = 0;
	}
	free(w.balance);
	free(w.measure);
	return failed;
}
