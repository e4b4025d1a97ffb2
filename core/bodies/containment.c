#include "core/bodies/containment.h"

#include <math.h>
#include <stdlib.h>

/*
 * Inside means a winding number other than 0, by signed crossings of a ray along +x; for a simple
 * body that is the parity of the crossings.  Where a body winds round a place twice (it overlaps
 * itself), parity would call that place outside although the volume counts it twice.
 *
 * The corners to be judged are put into a k-d tree and the container's triangles searched for them,
 * so many candidates cost little more than one.  A corner on the surface says nothing: its
 * candidate comes again in the next round with 16 times as many, spread over the whole of it.
 */
enum { PROBES = 65536, MORE = 16 };

struct mp_probe {
	double p[3];
	size_t candidate;
	int32_t winding;
	bool on_surface;
};

int mp_containment_begin(struct mp_containment *c, const struct mp_mesh *mesh, const uint32_t *row,
			 const uint32_t *list)
{
	c->mesh = mesh;
	c->row = row;
	c->list = list;
	c->probe = malloc(PROBES * sizeof *c->probe);
	c->tree = malloc(PROBES * sizeof *c->tree);
	if (c->probe != NULL && c->tree != NULL)
		return 0;
	mp_containment_end(c);
	return -1;
}

void mp_containment_end(struct mp_containment *c)
{
	free(c->probe);
	free(c->tree);
	c->probe = NULL;
	c->tree = NULL;
}

static uint32_t corners(const struct mp_containment *c, uint32_t body)
{
	return 3 * (c->row[body + 1] - c->row[body]);
}

/* A step that visits all of 0 .. n-1, spread by the golden section (Weyl sequence). */
static uint64_t spread(uint32_t n)
{
	uint64_t step = (uint64_t)(0.6180339887498949 * n) | 1;

	for (;; step += 2) {
		uint64_t a = n, b = step;

		while (b != 0) {
			uint64_t r = a % b;

			a = b;
			b = r;
		}
		if (a == 1)
			return step;
	}
}

static uint32_t corner_vertex(const struct mp_containment *c, uint32_t body, uint64_t corner)
{
	return c->mesh->tri[c->list[c->row[body] + corner / 3]][corner % 3];
}

/* Up to ${want} more corners of every pending candidate. */
static size_t collect(struct mp_containment *c, const struct mp_candidate *who, size_t n,
		      uint32_t want)
{
	size_t count = 0;

	for (size_t i = 0; i < n && count < PROBES; i++) {
		uint32_t all = corners(c, who[i].body), left = all - who[i].tried;
		uint64_t step;

		if (who[i].place != MP_PLACE_PENDING)
			continue;
		step = spread(all);
		for (uint32_t k = 0; k < want && k < left && count < PROBES; k++, count++) {
			struct mp_probe *q = &c->probe[count];
			uint64_t corner = (who[i].tried + k) * step % all;

			*q = (struct mp_probe){.candidate = i};
			mp_vertices_get(c->mesh->vertices, corner_vertex(c, who[i].body, corner),
					q->p);
			for (unsigned j = 0; j < 3; j++)
				c->tree[count].p[j] = q->p[j];
			c->tree[count].id = (uint32_t)count;
		}
	}
	mp_kd_build(c->tree, count);
	return count;
}

struct meeting {
	struct mp_probe *probe;
	struct mp_corners tri;
};

static int meet(void *self, uint32_t id)
{
	struct meeting *m = self;
	struct mp_probe *q = &m->probe[id];

	if (q->on_surface)
		return 0;
	if (mp_on_triangle(&m->tri, q->p))
		q->on_surface = true;
	else
		q->winding += mp_ray_crossing(&m->tri, q->p);
	return 0;
}

/* The part of space from which a ray along +x can meet the triangle. */
static void shadow(const struct mp_corners *tri, double lo[3], double hi[3])
{
	for (unsigned k = 0; k < 3; k++) {
		double a = tri->p[0][k], b = tri->p[1][k], c = tri->p[2][k];
		double least = a < b ? a : b, most = a < b ? b : a;

		lo[k] = c < least ? c : least;
		hi[k] = c > most ? c : most;
	}
	lo[0] = -INFINITY;
}

/* Every triangle of the container against the probes whose ray can meet it. */
static int cast(struct mp_containment *c, uint32_t container, size_t count)
{
	struct meeting m = {.probe = c->probe};
	double lo[3], hi[3];

	for (uint32_t i = c->row[container]; i < c->row[container + 1]; i++) {
		const uint32_t *v = c->mesh->tri[c->list[i]];

		for (unsigned k = 0; k < 3; k++)
			mp_vertices_get(c->mesh->vertices, v[k], m.tri.p[k]);
		shadow(&m.tri, lo, hi);
		if (mp_kd_search(c->tree, count, lo, hi, &c->steps, meet, &m))
			return -1;
	}
	return 0;
}

/* The first corner off the surface decides.  Returns how many candidates are still pending. */
static size_t decide(const struct mp_containment *c, struct mp_candidate *who, size_t n,
		     size_t count)
{
	size_t pending = 0;

	for (size_t i = 0; i < count; i++) {
		const struct mp_probe *q = &c->probe[i];
		struct mp_candidate *w = &who[q->candidate];

		if (w->place != MP_PLACE_PENDING)
			continue;
		w->tried++;
		if (!q->on_surface)
			w->place = q->winding != 0 ? MP_PLACE_INSIDE : MP_PLACE_OUTSIDE;
		else if (w->tried == corners(c, w->body))
			w->place = MP_PLACE_ON;
	}
	for (size_t i = 0; i < n; i++)
		pending += who[i].place == MP_PLACE_PENDING;
	return pending;
}

int mp_containment_judge(struct mp_containment *c, uint32_t container, struct mp_candidate *who,
			 size_t n)
{
	uint32_t want = 1;

	for (size_t pending = n; pending > 0;) {
		size_t count = collect(c, who, n, want);

		if (cast(c, container, count))
			return -1;
		pending = decide(c, who, n, count);
		if (count < PROBES && want < PROBES)
			want *= MORE;
	}
	return 0;
}
