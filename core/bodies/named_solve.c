#include <stdlib.h>
#include <string.h>

#include "core/bodies/bodies.h"
#include "core/bodies/named.h"
#include "core/moments/solid.h"

/*
 * The solid of a group whose bodies are its own is their sum.  One that shares bodies with others
 * (solids that touch along an edge or a face), or that is open by itself, is taken out of the mesh
 * and measured as a mesh of its own.
 */
struct apart {
	struct mp_vertices *vertices;
	uint32_t (*tri)[3];
	struct mp_moments moments;
	struct mp_topology topology;
	struct mp_bodies bodies;
};

/* The triangles order[0 .. count). */
static int take_out(struct apart *a, const struct mp_mesh *mesh, const uint32_t *order,
		    uint32_t count, const uint8_t key[16], struct mp_error *err)
{
	double block[MP_BLOCK][9];

	a->vertices = mp_vertices_new(key, err);
	if (a->vertices == NULL)
		return -1;
	a->tri = malloc((size_t)count * sizeof *a->tri);
	if (a->tri == NULL)
		return mp_fail_nomem(err);
	for (uint32_t at = 0, n; at < count; at += n) {
		n = count - at < MP_BLOCK ? count - at : MP_BLOCK;
		for (uint32_t i = 0; i < 3 * n; i++)
			mp_vertices_get(mesh->vertices, mesh->tri[order[at + i / 3]][i % 3],
					&block[i / 3][3 * (i % 3)]);
		if (mp_vertices_add(a->vertices, (const double(*)[9])block, n, a->tri + at, err))
			return -1;
		mp_moments_add(&a->moments, (const double(*)[9])block, n);
	}
	mp_vertices_seal(a->vertices);
	return 0;
}

static int measure(struct apart *a, uint32_t count, struct mp_group *g, struct mp_error *err)
{
	const struct mp_mesh mesh = {
	    .vertices = a->vertices, .tri = (const uint32_t(*)[3])a->tri, .triangles = count};

	if (mp_topology_find(&mesh, 0, &a->topology, err))
		return -1;
	g->open = !mp_has_volume(&a->topology);
	if (g->open)
		return 0;
	if (mp_bodies_measure(&mesh, &a->topology, 0, &a->moments, NULL, &g->solid, &a->bodies,
			      err))
		return -1;
	g->in_range = g->solid.in_range;
	return 0;
}

static int solve_apart(struct mp_group *g, const struct mp_mesh *mesh, const uint32_t *order,
		       const uint8_t key[16], struct mp_error *err)
{
	struct apart a = {0};
	int ret;

	mp_moments_begin(&a.moments);
	ret = take_out(&a, mesh, order, g->triangles, key, err);
	if (ret == 0)
		ret = measure(&a, g->triangles, g, err);
	mp_bodies_free(&a.bodies);
	mp_topology_free(&a.topology);
	mp_vertices_free(a.vertices);
	free(a.tri);
	return ret;
}

/* The triangles by group, ascending within each; NULL where memory is out. */
static uint32_t *sort_triangles(const struct mp_named *n, uint32_t triangles)
{
	uint32_t *order = calloc(triangles, sizeof *order);
	uint32_t *next = malloc(n->count * sizeof *next), at = 0;

	for (uint32_t g = 0; g < n->count && next != NULL; g++) {
		next[g] = at;
		at += n->group[g].triangles;
	}
	for (uint32_t i = 0; i < triangles && next != NULL && order != NULL; i++)
		order[next[n->of[i]]++] = i;
	if (next == NULL) {
		free(order);
		order = NULL;
	}
	free(next);
	return order;
}

static bool has_loose(const struct mp_named *n)
{
	for (uint32_t g = 0; g < n->count; g++)
		if (n->group[g].loose)
			return true;
	return false;
}

static int solve_loose(struct mp_named *n, const struct mp_mesh *mesh, const uint8_t key[16],
		       struct mp_error *err)
{
	uint32_t *order = sort_triangles(n, mesh->triangles), at = 0;
	int ret = 0;

	if (order == NULL)
		return mp_fail_nomem(err);
	for (uint32_t g = 0; g < n->count && ret == 0; g++) {
		if (n->group[g].loose)
			ret = solve_apart(&n->group[g], mesh, order + at, key, err);
		at += n->group[g].triangles;
		if (n->group[g].open && g + 1 < n->count)
			break; /* judge() refuses it */
	}
	free(order);
	return ret;
}

/* A name's own density needs a solid; what all other faces make is judged with the whole. */
static int judge(const struct mp_named *n, struct mp_error *err)
{
	for (uint32_t g = 0; g + 1 < n->count; g++) {
		if (!n->group[g].open)
			continue;
		(void)mp_fail(err, MP_BAD_NAME, MP_NO_BYTE,
			      "the faces under this name are not a closed solid by themselves");
		if (err != NULL) {
			err->limit = g;
			err->actual = n->group[g].first;
		}
		return -1;
	}
	return 0;
}

int mp_named_solve(struct mp_named *n, const struct mp_mesh *mesh, const uint8_t key[16],
		   struct mp_error *err)
{
	if (n->count == 0)
		return 0;
	for (uint32_t g = 0; g < n->count; g++) {
		n->group[g].open = n->group[g].bodies == 0;
		if (!n->group[g].loose)
			mp_merge_solve(&n->group[g].merge, &n->group[g].solid);
	}
	if (has_loose(n) && solve_loose(n, mesh, key, err))
		return -1;
	return judge(n, err);
}
