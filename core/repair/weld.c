#include "core/repair/weld.h"

#include <stdlib.h>

int mp_weld(const struct mp_vertices *vertices, const struct mp_affine *map, uint32_t (*tri)[3],
	    uint32_t triangles, double distance, const uint8_t key[16], struct mp_weld *out,
	    struct mp_error *err)
{
	uint32_t count = mp_vertices_count(vertices);
	uint32_t *leader = malloc(((size_t)count + 1) * sizeof *leader);

	out->went = 0;
	if (leader == NULL)
		return mp_fail_nomem(err);
	if (mp_cluster_find(vertices, map, NULL, count, distance, key, leader, &out->complete,
			    err)) {
		free(leader);
		return -1;
	}
	for (uint32_t v = 0; v < count; v++)
		out->went += leader[v] != v;
	for (uint32_t t = 0; t < triangles && out->went > 0; t++)
		for (int k = 0; k < 3; k++)
			tri[t][k] = leader[tri[t][k]];
	free(leader);
	return 0;
}
