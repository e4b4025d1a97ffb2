#include <stdlib.h>
#include <string.h>

#include "core/topology/topology_parts.h"

int mp_defects_begin(struct mp_defect_list *l, size_t items, size_t triangles, size_t vertices)
{
	l->count = 0;
	l->triangle_at = calloc(items + 1, sizeof *l->triangle_at);
	l->vertex_at = calloc(items + 1, sizeof *l->vertex_at);
	l->triangles = malloc((triangles + 1) * sizeof *l->triangles);
	l->vertices = malloc((vertices + 1) * sizeof *l->vertices);
	if (l->triangle_at != NULL && l->vertex_at != NULL && l->triangles != NULL &&
	    l->vertices != NULL)
		return 0;
	mp_defects_free(l);
	return -1;
}

void mp_defects_add(struct mp_defect_list *l, const uint32_t *triangles, size_t triangle_count,
		    const uint32_t *vertices, size_t vertex_count)
{
	size_t t = l->triangle_at[l->count], v = l->vertex_at[l->count];

	memcpy(l->triangles + t, triangles, triangle_count * sizeof *triangles);
	memcpy(l->vertices + v, vertices, vertex_count * sizeof *vertices);
	l->count++;
	l->triangle_at[l->count] = t + triangle_count;
	l->vertex_at[l->count] = v + vertex_count;
}

void mp_defects_free(struct mp_defect_list *l)
{
	free(l->triangle_at);
	free(l->vertex_at);
	free(l->triangles);
	free(l->vertices);
	memset(l, 0, sizeof *l);
}
