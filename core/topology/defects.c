#include <stdlib.h>
#include <string.h>

#include "core/topology/topology_parts.h"

/* One piece of memory for all four arrays: most lists are empty, and every report has seven. */
int mp_defects_begin(struct mp_defect_list *l, size_t items, size_t triangles, size_t vertices)
{
	size_t at = 2 * (items + 1) * sizeof *l->triangle_at;
	size_t numbers = (triangles + vertices) * sizeof *l->triangles;

	l->count = 0;
	l->triangle_at = malloc(at + numbers);
	if (l->triangle_at == NULL)
		return -1;
	memset(l->triangle_at, 0, at);
	l->vertex_at = l->triangle_at + items + 1;
	l->triangles = (uint32_t *)(void *)(l->vertex_at + items + 1);
	l->vertices = l->triangles + triangles;
	return 0;
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
	memset(l, 0, sizeof *l);
}
