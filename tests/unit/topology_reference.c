#include "topology_reference.h"

#include <stdlib.h>
#include <string.h>

#include "core/geometry/predicates.h"

struct edge {
	uint32_t v[2]; /* the smaller first */
	int forward, back;
	uint32_t body;
};

struct reference {
	const struct mp_mesh *mesh;
	struct edge *edge;
	size_t edges;
	struct mp_topology *out;
};

static bool has_edges(const uint32_t *v)
{
	return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
}

static bool uses(const uint32_t *tri, uint32_t v)
{
	return has_edges(tri) && (tri[0] == v || tri[1] == v || tri[2] == v);
}

static bool share_edge(const uint32_t *a, const uint32_t *b)
{
	int common = 0;

	for (int k = 0; k < 3; k++)
		common += uses(b, a[k]);
	return has_edges(a) && common >= 2;
}

static void point(const struct reference *r, uint32_t v, double p[3])
{
	mp_vertices_get(r->mesh->vertices, v, p);
}

static void collect_edges(struct reference *r)
{
	for (uint32_t t = 0; t < r->mesh->triangles; t++) {
		for (int k = 0; k < 3 && has_edges(r->mesh->tri[t]); k++) {
			uint32_t a = r->mesh->tri[t][k], b = r->mesh->tri[t][(k + 1) % 3];
			uint32_t u = a < b ? a : b, v = a < b ? b : a;
			size_t i = 0;

			while (i < r->edges && (r->edge[i].v[0] != u || r->edge[i].v[1] != v))
				i++;
			if (i == r->edges)
				r->edge[r->edges++] = (struct edge){.v = {u, v}};
			r->edge[i].forward += a == u;
			r->edge[i].back += a != u;
			r->edge[i].body = r->out->body_of[t];
		}
	}
}

/* Spread the label of triangle ${t} over those of ${label} >= it that hang together at ${v}. */
static void flood(const struct reference *r, uint32_t *label, uint32_t t, bool at_vertex,
		  uint32_t v)
{
	for (uint32_t o = 0; o < r->mesh->triangles; o++) {
		const uint32_t *a = r->mesh->tri[t], *b = r->mesh->tri[o];
		int common = 0;

		if (label[o] == label[t] || !share_edge(a, b))
			continue;
		for (int k = 0; k < 3; k++)
			common += a[k] != v && uses(b, a[k]);
		/* Around a vertex the shared edge must be one at that vertex. */
		if (at_vertex && !(uses(a, v) && uses(b, v) && common >= 1))
			continue;
		label[o] = label[t];
		flood(r, label, o, at_vertex, v);
	}
}

static void find_bodies(struct reference *r)
{
	uint32_t n = r->mesh->triangles;
	uint32_t *label = r->out->body_of;

	for (uint32_t t = 0; t < n; t++)
		label[t] = MP_NO_BODY;
	for (uint32_t t = 0; t < n; t++) {
		if (!has_edges(r->mesh->tri[t]))
			continue;
		r->out->faces++;
		if (label[t] == MP_NO_BODY) {
			struct mp_body_topology *b = &r->out->body[r->out->bodies];

			label[t] = r->out->bodies++;
			b->first = t;
			b->closed = b->watertight = true;
			flood(r, label, t, false, 0);
		}
		r->out->body[label[t]].triangles++;
	}
}

static void find_fans(struct reference *r)
{
	uint32_t n = r->mesh->triangles;
	uint32_t *label = malloc((n + 1) * sizeof *label);

	for (uint32_t v = 0; v < mp_vertices_count(r->mesh->vertices); v++) {
		uint32_t fans = 0;

		memset(label, 0xff, (n + 1) * sizeof *label);
		for (uint32_t t = 0; t < n; t++) {
			if (!uses(r->mesh->tri[t], v) || label[t] != UINT32_MAX)
				continue;
			label[t] = fans++;
			flood(r, label, t, true, v);
		}
		r->out->vertices += fans > 0;
		r->out->non_manifold_vertices += fans > 1;
	}
	free(label);
}

static void count_edges(struct reference *r)
{
	struct mp_topology *o = r->out;

	o->edges = r->edges;
	o->closed = o->watertight = r->edges > 0;
	for (size_t i = 0; i < r->edges; i++) {
		const struct edge *e = &r->edge[i];
		struct mp_body_topology *b = &o->body[e->body];
		int n = e->forward + e->back;

		o->boundary_edges += n == 1;
		b->boundary_edges += n == 1;
		o->non_manifold_edges += n > 2;
		b->non_manifold_edges += n > 2;
		o->misoriented_edges += n == 2 && e->forward != 1;
		b->misoriented_edges += n == 2 && e->forward != 1;
		if (e->forward != e->back)
			o->closed = b->closed = false;
		if (n != 2)
			o->watertight = b->watertight = false;
	}
	o->winding_consistent = o->misoriented_edges == 0;
}

static void count_loops(struct reference *r)
{
	size_t *label = malloc((r->edges + 1) * sizeof *label);

	for (size_t i = 0; i < r->edges; i++)
		label[i] = i;
	for (bool again = true; again;) {
		again = false;
		for (size_t i = 0; i < r->edges; i++) {
			for (size_t j = 0; j < r->edges; j++) {
				const struct edge *e = &r->edge[i], *f = &r->edge[j];

				if (e->forward + e->back == 1 && f->forward + f->back == 1 &&
				    label[i] < label[j] &&
				    (e->v[0] == f->v[0] || e->v[0] == f->v[1] ||
				     e->v[1] == f->v[0] || e->v[1] == f->v[1])) {
					label[j] = label[i];
					again = true;
				}
			}
		}
	}
	for (size_t i = 0; i < r->edges; i++)
		r->out->boundary_loops +=
		    r->edge[i].forward + r->edge[i].back == 1 && label[i] == i;
	free(label);
}

static void count_bad_triangles(struct reference *r)
{
	for (uint32_t t = 0; t < r->mesh->triangles; t++) {
		const uint32_t *a = r->mesh->tri[t];
		double p[3][3];
		bool repeats = false;

		for (int k = 0; k < 3; k++)
			point(r, a[k], p[k]);
		r->out->degenerate_triangles += mp_collinear(p[0], p[1], p[2]) != 0;
		for (uint32_t o = 0; o < t; o++) {
			const uint32_t *b = r->mesh->tri[o];

			repeats |= has_edges(a) && uses(b, a[0]) && uses(b, a[1]) && uses(b, a[2]);
		}
		r->out->duplicate_triangles += repeats;
	}
}

/* The signed cover of the middle between two marks on the line of ${e}; small whole numbers. */
static int cover(const struct reference *r, const struct edge *e, uint32_t body, double middle)
{
	double a[3], b[3], p[3], q[3];
	int sum = 0;

	point(r, e->v[0], a);
	point(r, e->v[1], b);
	for (size_t i = 0; i < r->edges; i++) {
		const struct edge *f = &r->edge[i];
		double s = 0, t = 0;

		point(r, f->v[0], p);
		point(r, f->v[1], q);
		if (!mp_collinear(a, b, p) || !mp_collinear(a, b, q) ||
		    (body != MP_NO_BODY && f->body != body))
			continue;
		for (int k = 0; k < 3; k++) {
			s += (p[k] - a[k]) * (b[k] - a[k]);
			t += (q[k] - a[k]) * (b[k] - a[k]);
		}
		if (s < middle && middle < t)
			sum += f->forward - f->back;
		if (t < middle && middle < s)
			sum -= f->forward - f->back;
	}
	return sum;
}

/* Whether the signed cover of every line vanishes: tried at all half marks along all edges. */
static bool zero_current(const struct reference *r, uint32_t body)
{
	for (size_t i = 0; i < r->edges; i++) {
		double a[3], b[3], length = 0;

		if (body != MP_NO_BODY && r->edge[i].body != body)
			continue;
		point(r, r->edge[i].v[0], a);
		point(r, r->edge[i].v[1], b);
		for (int k = 0; k < 3; k++)
			length += (b[k] - a[k]) * (b[k] - a[k]);
		for (int m = 0; m < (int)length; m++)
			if (cover(r, &r->edge[i], body, m + 0.5) != 0)
				return false;
	}
	return true;
}

void reference_topology(const struct mp_mesh *mesh, struct mp_topology *out)
{
	size_t n = mesh->triangles;
	struct reference r = {.mesh = mesh, .out = out};

	memset(out, 0, sizeof *out);
	out->body_of = malloc((n + 1) * sizeof *out->body_of);
	out->body = calloc(n + 1, sizeof *out->body);
	r.edge = malloc((3 * n + 1) * sizeof *r.edge);
	find_bodies(&r);
	collect_edges(&r);
	find_fans(&r);
	count_edges(&r);
	count_loops(&r);
	count_bad_triangles(&r);
	out->cracks_only = r.edges > 0 && !out->closed && zero_current(&r, MP_NO_BODY);
	for (uint32_t b = 0; b < out->bodies; b++)
		out->body[b].cracks_only = !out->body[b].closed && zero_current(&r, b);
	out->euler = (int64_t)(out->vertices + out->faces) - (int64_t)out->edges;
	free(r.edge);
}
