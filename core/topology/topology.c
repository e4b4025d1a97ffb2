#include "core/topology/topology.h"

#include <stdlib.h>
#include <string.h>

#include "core/topology/topology_parts.h"

static uint64_t found(const struct mp_topology *t, enum mp_defect_kind kind)
{
	switch (kind) {
	case MP_DEFECT_BOUNDARY_EDGE:
		return t->boundary_edges;
	case MP_DEFECT_BOUNDARY_LOOP:
		return t->boundary_loops;
	case MP_DEFECT_NON_MANIFOLD_EDGE:
		return t->non_manifold_edges;
	case MP_DEFECT_NON_MANIFOLD_VERTEX:
		return t->non_manifold_vertices;
	case MP_DEFECT_MISORIENTED_EDGE:
		return t->misoriented_edges;
	case MP_DEFECT_DEGENERATE_TRIANGLE:
		return t->degenerate_triangles;
	case MP_DEFECT_DUPLICATE_TRIANGLE:
		return t->duplicate_triangles;
	case MP_DEFECT_KINDS:
		break;
	}
	return 0;
}

static int find_repeated(const struct mp_mesh *mesh, const struct mp_edges *edges, uint32_t most,
			 struct mp_topology *out)
{
	struct mp_repeats repeats = {NULL, NULL};
	int failed = mp_duplicates_find(mesh, edges, most, &repeats, out) ||
		     mp_walls_find(mesh, edges, &repeats, out);

	free(repeats.paired);
	free(repeats.spare);
	return failed;
}

static int find_boundary(const struct mp_mesh *mesh, const struct mp_edges *edges, uint32_t most,
			 struct mp_topology *out)
{
	uint64_t *gap = NULL;
	int failed = 0;

	if (!out->closed) {
		gap = calloc((size_t)mp_vertices_count(mesh->vertices) / 64 + 1, sizeof *gap);
		failed = gap == NULL || mp_cracks_find(mesh, edges, gap, out);
	}
	failed = failed || mp_loops_find(mesh, edges, most, gap, out);
	free(gap);
	return failed;
}

/* Everything but degenerate triangles, whatever the mesh is like. */
static int find_all(const struct mp_mesh *mesh, uint32_t most, struct mp_topology *out)
{
	struct mp_edges edges;
	int failed;

	if (mp_edges_build(mesh, &edges, NULL))
		return -1;
	failed = mp_bodies_find(mesh, &edges, out) || mp_fans_find(mesh, &edges, most, out) ||
		 find_repeated(mesh, &edges, most, out) ||
		 mp_bad_edges_list(mesh, &edges, most, out) ||
		 find_boundary(mesh, &edges, most, out);
	mp_edges_free(&edges);
	return failed ? -1 : 0;
}

static int find(const struct mp_mesh *mesh, uint32_t most, struct mp_topology *out)
{
	static const struct mp_manifold_room room = {
	    .vertices = MP_LINKS_WINDOW, .links = 1 << 22, .alone = 100000};
	bool good;

	if (mp_degenerate_find(mesh, most, out) || mp_manifold_find(mesh, &room, out, &good) ||
	    (!good && find_all(mesh, most, out)))
		return -1;
	out->euler = (int64_t)(out->vertices + out->faces) - (int64_t)out->edges;
	for (int k = 0; k < MP_DEFECT_KINDS; k++)
		out->truncated |= found(out, (enum mp_defect_kind)k) > out->defect[k].count;
	return 0;
}

int mp_topology_find(const struct mp_mesh *mesh, uint32_t most, struct mp_topology *out,
		     struct mp_error *err)
{
	memset(out, 0, sizeof *out);
	if (mesh->triangles > MP_MOST_TRIANGLES)
		return mp_fail_limit(err, MP_NO_BYTE, MP_MOST_TRIANGLES, mesh->triangles,
				     "more triangles than the checks can number");
	if (!find(mesh, most, out))
		return 0;
	mp_topology_free(out);
	return mp_fail_nomem(err);
}

int64_t mp_body_genus(const struct mp_body_topology *b)
{
	int64_t euler = (int64_t)b->fans - b->triangles / 2; /* 3 edges to 2 triangles */

	return b->watertight && !b->pinched && !b->one_sided ? (2 - euler) / 2 : -1;
}

void mp_topology_free(struct mp_topology *t)
{
	for (int k = 0; k < MP_DEFECT_KINDS; k++)
		mp_defects_free(&t->defect[k]);
	free(t->loop);
	free(t->junction);
	free(t->boundary);
	free(t->body);
	free(t->body_of);
	memset(t, 0, sizeof *t);
}
