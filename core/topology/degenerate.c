#include "core/geometry/predicates.h"
#include "core/topology/topology_parts.h"

enum { AHEAD = 16 };

static bool is_degenerate(const struct mp_mesh *mesh, const uint32_t v[3])
{
	double p[3][3];

	if (!mp_has_edges(v))
		return true;
	for (unsigned k = 0; k < 3; k++)
		mp_vertices_get(mesh->vertices, v[k], p[k]);
	return mp_collinear(p[0], p[1], p[2]);
}

static int list(const struct mp_mesh *mesh, const struct mp_smallest *found,
		struct mp_defect_list *l)
{
	if (mp_defects_begin(l, found->count, found->count, 3 * found->count))
		return -1;
	for (size_t i = 0; i < found->count; i++) {
		uint32_t t = (uint32_t)found->key[i];

		mp_defects_add(l, &t, 1, mesh->tri[t], 3);
	}
	return 0;
}

/* Where the next triangle to look at is, ${t} or behind. */
static uint32_t candidate(const struct mp_mesh *mesh, uint32_t t)
{
	while (mesh->flat != NULL && t < mesh->triangles) {
		size_t groups = (size_t)mesh->triangles / MP_FLAT_GROUP + 1;
		size_t group = mp_bit_next(mesh->flat, groups, t / MP_FLAT_GROUP);

		if (group == t / MP_FLAT_GROUP)
			break;
		t = group < groups ? (uint32_t)group * MP_FLAT_GROUP : mesh->triangles;
	}
	return t;
}

int mp_degenerate_find(const struct mp_mesh *mesh, uint32_t most, struct mp_topology *out)
{
	struct mp_smallest found = {.most = most};
	int failed;

	for (uint32_t t = candidate(mesh, 0); t < mesh->triangles; t = candidate(mesh, t + 1)) {
		for (unsigned k = 0; k < 3 && t + AHEAD < mesh->triangles; k++)
			mp_vertices_prefetch(mesh->vertices, mesh->tri[t + AHEAD][k]);
		if (!is_degenerate(mesh, mesh->tri[t]))
			continue;
		out->degenerate_triangles++;
		if (found.count < most)
			mp_smallest_add(&found, t);
	}
	failed = found.failed || list(mesh, &found, &out->defect[MP_DEFECT_DEGENERATE_TRIANGLE]);
	mp_smallest_free(&found);
	return failed ? -1 : 0;
}
