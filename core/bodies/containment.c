#include "core/bodies/containment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/sort.h"

/*
 * Inside means a winding number other than 0, by signed crossings of a ray along +x; for a simple
 * body that is the parity of the crossings.  Where a body winds round a place twice (it overlaps
 * itself), parity would call that place outside although the volume counts it twice.
 *
 * The corners to be judged are put into a k-d tree and the container's triangles searched for them,
 * so many candidates cost little more than one.  A corner on the surface says nothing: its
 * candidate comes again in the next round with 16 times as many, spread over the whole of it.
 *
 * Of a body that overlaps the container some corners are inside and some outside.  So that the
 * order of the file does not decide, corners come in one that their places give.
 */
enum { PROBES = 65536, MORE = 16 };

struct mp_probe {
	double p[3];
	size_t candidate;
	int32_t winding;
	bool on_surface;
};

int mp_containment_begin(struct mp_containment *c, const struct mp_mesh *mesh, const uint32_t *row,
			 uint32_t *list, uint32_t bodies)
{
	uint32_t most = 0;

	for (uint32_t b = 0; b < bodies; b++)
		if (row[b + 1] - row[b] > most)
			most = row[b + 1] - row[b];
	c->mesh = mesh;
	c->row = row;
	c->list = list;
	c->probe = malloc(PROBES * sizeof *c->probe);
	c->tree = malloc(PROBES * sizeof *c->tree);
	c->key = malloc(((size_t)most + 1) * sizeof *c->key);
	c->arranged = calloc((size_t)bodies / 64 + 1, sizeof *c->arranged);
	if (c->probe != NULL && c->tree != NULL && c->key != NULL && c->arranged != NULL)
		return 0;
	mp_containment_end(c);
	return -1;
}

void mp_containment_end(struct mp_containment *c)
{
	free(c->probe);
	free(c->tree);
	free(c->key);
	free(c->arranged);
	c->probe = NULL;
	c->tree = NULL;
	c->key = NULL;
	c->arranged = NULL;
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

/* A number that the three places give, in any order of them. */
static uint64_t scatter(const double p[3][3])
{
	uint64_t sum = 0;

	for (unsigned i = 0; i < 3; i++) {
		uint64_t h = 0, x;

		for (unsigned k = 0; k < 3; k++) {
			double z = p[i][k] + 0.0; /* -0 is 0 */

			memcpy(&x, &z, sizeof x);
			h = (h ^ x ^ h >> 29) * UINT64_C(0x9e3779b97f4a7c15);
		}
		h = (h ^ h >> 32) * UINT64_C(0xd6e8feb86659fd93); /* of splitmix64's kind */
		sum += h ^ h >> 32;
	}
	return sum;
}

/* The triangles of ${body} in an order that does not depend on that of the file. */
static void arrange(struct mp_containment *c, uint32_t body)
{
	uint64_t bit = UINT64_C(1) << (body % 64);
	uint32_t *list = c->list + c->row[body], n = c->row[body + 1] - c->row[body];
	double p[3][3];

	if (c->arranged[body / 64] & bit)
		return;
	c->arranged[body / 64] |= bit;
	for (uint32_t i = 0; i < n; i++) {
		mp_vertices_corners(c->mesh->vertices, c->mesh->tri[list[i]], p);
		c->key[i] = scatter((const double(*)[3])p) >> 32 << 32 | list[i];
	}
	mp_sort_u64(c->key, n);
	for (uint32_t i = 0; i < n; i++)
		list[i] = (uint32_t)c->key[i];
}

static bool before(const double p[3], const double q[3])
{
	for (unsigned k = 0; k < 3; k++)
		if (p[k] != q[k])
			return p[k] < q[k];
	return false;
}

/* Corner ${corner} of ${body}: of each triangle the smallest place is the first, by x, y, z. */
static void corner_place(const struct mp_containment *c, uint32_t body, uint64_t corner,
			 double out[3])
{
	const uint32_t *tri = c->mesh->tri[c->list[c->row[body] + corner / 3]];
	double p[3][3];
	unsigned want = (unsigned)(corner % 3);

	mp_vertices_corners(c->mesh->vertices, tri, p);
	for (unsigned i = 0; i < 3; i++) {
		unsigned rank = 0;

		for (unsigned k = 0; k < 3; k++)
			rank += before(p[k], p[i]) || (k < i && !before(p[i], p[k]));
		if (rank == want)
			memcpy(out, p[i], sizeof p[i]);
	}
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
		arrange(c, who[i].body);
		step = spread(all);
		for (uint32_t k = 0; k < want && k < left && count < PROBES; k++, count++) {
			struct mp_probe *q = &c->probe[count];
			uint64_t corner = (who[i].tried + k) * step % all;

			*q = (struct mp_probe){.candidate = i};
			corner_place(c, who[i].body, corner, q->p);
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
