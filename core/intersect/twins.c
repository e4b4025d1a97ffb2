#include "core/intersect/twins.h"

#include <stdlib.h>
#include <string.h>

static uint32_t from(const struct mp_mesh *mesh, uint32_t half)
{
	return mesh->tri[half / 3][half % 3];
}

static uint32_t to(const struct mp_mesh *mesh, uint32_t half)
{
	return mesh->tri[half / 3][(half + 1) % 3];
}

static uint32_t smaller(const struct mp_mesh *mesh, uint32_t half)
{
	uint32_t a = from(mesh, half), b = to(mesh, half);

	return a < b ? a : b;
}

/* Of a triangle with three different corners; others have no edges. */
static bool is_edge(const struct mp_mesh *mesh, uint32_t half)
{
	const uint32_t *v = mesh->tri[half / 3];

	return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
}

int mp_twins_build(const struct mp_mesh *mesh, struct mp_twins *out)
{
	uint32_t vertices = mp_vertices_count(mesh->vertices), halves = 3 * mesh->triangles;
	uint32_t sum = 0;

	memset(out, 0, sizeof *out);
	out->row = calloc((size_t)vertices + 2, sizeof *out->row);
	out->list = malloc(((size_t)halves + 1) * sizeof *out->list);
	if (out->row == NULL || out->list == NULL) {
		mp_twins_free(out);
		return -1;
	}
	for (uint32_t h = 0; h < halves; h++)
		out->row[smaller(mesh, h) + 2] += is_edge(mesh, h);
	for (uint32_t v = 0; v < vertices; v++) {
		sum += out->row[v + 2];
		out->row[v + 2] = sum;
	}
	for (uint32_t h = 0; h < halves; h++)
		if (is_edge(mesh, h))
			out->list[out->row[smaller(mesh, h) + 1]++] = h;
	return 0;
}

void mp_twins_free(struct mp_twins *t)
{
	free(t->row);
	free(t->list);
	memset(t, 0, sizeof *t);
}

uint32_t mp_twin_of(const struct mp_twins *t, const struct mp_mesh *mesh, uint32_t half,
		    uint64_t *steps)
{
	uint32_t low = smaller(mesh, half), a = from(mesh, half), b = to(mesh, half);
	uint32_t twin = MP_NO_TWIN;

	for (uint32_t i = t->row[low]; i < t->row[low + 1]; i++) {
		uint32_t h = t->list[i], f = from(mesh, h), e = to(mesh, h);

		++*steps;
		if (h == half || !((f == a && e == b) || (f == b && e == a)))
			continue;
		if (f == a || twin != MP_NO_TWIN)
			return MP_NO_TWIN;
		twin = h;
	}
	return twin;
}
