#include "core/report/capped.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/affine/affine.h"
#include "core/bodies/bodies.h"
#include "core/decoder.h"
#include "core/moments/solid.h"
#include "core/topology/topology_parts.h"

struct loop {
	double sum[3];  /* of its vertices, about the first */
	uint32_t first; /* vertex */
	uint32_t vertices;
	uint32_t all; /* their numbers xored: two of three give the third */
};

struct caps {
	const struct mp_mesh *mesh;
	const uint64_t *bit; /* boundary half-edges */
	size_t halves;
	uint32_t *loop_of; /* per vertex; UINT32_MAX for none */
	struct loop *loop;
	size_t loops;
};

/* The one place from which fans take coordinates. */
static void place(const struct caps *c, uint32_t v, double xyz[3])
{
	mp_vertices_get(c->mesh->vertices, v, xyz);
}

/*
 * From disjoint sets to numbers of loops, in place: a set's root is its smallest vertex, so it has
 * its number before the others ask for it.
 */
static void sum_vertices(struct caps *c)
{
	uint32_t vertices = mp_vertices_count(c->mesh->vertices);

	for (uint32_t v = 0; v < vertices; v++) {
		double base[3], xyz[3];
		struct loop *l;

		if (c->loop_of[v] == UINT32_MAX)
			continue;
		if (c->loop_of[v] == v) {
			c->loop[c->loops].first = v;
			c->loop_of[v] = (uint32_t)c->loops++;
		} else {
			c->loop_of[v] = c->loop_of[c->loop_of[v]];
		}
		l = &c->loop[c->loop_of[v]];
		place(c, l->first, base);
		place(c, v, xyz);
		for (int k = 0; k < 3; k++)
			l->sum[k] += xyz[k] - base[k];
		l->vertices++;
		l->all ^= v;
	}
}

static double square(const double *p, const double *q)
{
	double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];

	return x * x + y * y + z * z;
}

/* Turn the triangle so that it begins opposite its longest side: long needles lose least then. */
static void turn(double tri[9])
{
	double a = square(tri + 3, tri + 6), b = square(tri + 6, tri), c = square(tri, tri + 3);
	double old[9];
	int by = a >= b && a >= c ? 0 : b >= c ? 3 : 6;

	memcpy(old, tri, sizeof old);
	for (int k = 0; k < 9; k++)
		tri[k] = old[(k + by) % 9];
}

/*
 * One triangle against the boundary half-edge, of a fan or the one that is missing; returns how
 * many, 0 where another half-edge has it, -1 where the fan's tip is out of range.
 */
static int cap(const struct caps *c, size_t half, double tri[9])
{
	uint32_t tail = mp_corner_vertex(c->mesh, (uint32_t)half);
	uint32_t head = mp_corner_vertex(c->mesh, mp_half_next((uint32_t)half));
	const struct loop *l = &c->loop[c->loop_of[tail]];

	if (l->vertices == 3 && tail != l->first)
		return 0;
	place(c, head, tri);
	place(c, tail, tri + 3);
	place(c, l->vertices == 3 ? l->all ^ head ^ tail : l->first, tri + 6);
	for (int k = 6; k < 9 && l->vertices != 3; k++) {
		tri[k] += l->sum[k - 6] / l->vertices;
		if (!isfinite(tri[k]))
			return -1;
	}
	turn(tri);
	return 1;
}

/* The triangles of the fans, or their images. */
static bool add_caps(const struct caps *c, const struct mp_affine *map, struct mp_moments *m)
{
	double block[MP_BLOCK][9];
	size_t fill = 0;

	for (size_t h = mp_bit_next(c->bit, c->halves, 0); h < c->halves;
	     h = mp_bit_next(c->bit, c->halves, h + 1)) {
		int got = cap(c, h, block[fill]);

		if (got < 0)
			return false;
		for (int k = 0; k < 9 && got > 0 && map != NULL; k += 3)
			if (!mp_affine_point(map, block[fill] + k, block[fill] + k))
				return false;
		fill += (size_t)got;
		if (fill < MP_BLOCK)
			continue;
		mp_moments_add(m, (const double(*)[9])block, fill);
		fill = 0;
	}
	if (fill > 0)
		mp_moments_add(m, (const double(*)[9])block, fill);
	return true;
}

static bool put(long double x, double *out)
{
	bool fits = fabsl(x) <= DBL_MAX && (x == 0 || fabsl(x) >= DBL_MIN);

	*out = fits ? (double)fabsl(x) : 0;
	return fits;
}

static void find_volume(const struct caps *c, const struct mp_moments *sums, struct mp_capped *out)
{
	struct mp_moments first = *sums, second;
	struct mp_solid solid, again;

	if (!add_caps(c, NULL, &first))
		return;
	mp_moments_solve(&first, &solid);
	/* no bound comes with the result, so it has to have its digits */
	if (solid.again || solid.volume_bound > 0x1p-40L * fabsl(solid.volume)) {
		mp_moments_begin_again(&second, &first);
		mp_solid_add(&second, c->mesh, NULL, c->mesh->triangles);
		(void)add_caps(c, NULL, &second);
		mp_moments_solve(&second, &again);
		if (!solid.in_range || again.volume_bound < solid.volume_bound)
			solid = again;
	}
	if (c->mesh->map != NULL) /* the mean of a loop is mapped to that of the mapped loop */
		mp_affine_solid(c->mesh->map, &solid);
	out->volume_defined = solid.in_range && put(solid.volume, &out->volume);
}

static void find_area(const struct caps *c, struct mp_capped *out)
{
	struct mp_moments first, second;
	struct mp_solid solid;

	mp_moments_begin(&first);
	if (!add_caps(c, c->mesh->map, &first))
		return;
	mp_moments_solve(&first, &solid);
	if (solid.area_again) {
		mp_moments_begin_again(&second, &first);
		(void)add_caps(c, c->mesh->map, &second);
		mp_moments_solve(&second, &solid);
	}
	out->area_defined = solid.area_in_range && put(solid.area, &out->area);
}

int mp_capped_find(const struct mp_mesh *mesh, const struct mp_topology *t,
		   const struct mp_moments *sums, struct mp_capped *out, struct mp_error *err)
{
	struct caps c = {.mesh = mesh, .bit = t->boundary, .halves = 3 * (size_t)mesh->triangles};
	int ret = 0;

	memset(out, 0, sizeof *out);
	if (mp_has_volume(t) || t->boundary_edges == 0 || t->unbalanced_edges > 0)
		return 0;
	c.loop_of = malloc(mp_vertices_count(mesh->vertices) * sizeof *c.loop_of);
	c.loop = calloc(t->boundary_loops, sizeof *c.loop);
	if (c.loop_of != NULL && c.loop != NULL) {
		mp_loops_join(mesh, c.bit, c.loop_of);
		sum_vertices(&c);
		find_volume(&c, sums, out);
		find_area(&c, out);
	} else {
		ret = mp_fail_nomem(err);
	}
	free(c.loop);
	free(c.loop_of);
	return ret;
}
