#include "core/topology/edges.h"

#include <stdlib.h>
#include <string.h>

#include "core/sort.h"

/*
 * Compressed rows: a counting sort by the smaller vertex, then each row by (larger vertex,
 * half-edge).  Rows are a few entries long in a good mesh; mp_sort_u64() bears any length.
 */

/* row[v + 1] = where row v begins, so that scattering moves it to where row v + 1 begins. */
static void count_rows(const struct mp_mesh *mesh, uint32_t *row, uint32_t vertices)
{
	uint32_t sum = 0;

	for (uint32_t t = 0; t < mesh->triangles; t++) {
		const uint32_t *v = mesh->tri[t];

		if (!mp_has_edges(v))
			continue;
		row[(v[0] < v[1] ? v[0] : v[1]) + 1]++;
		row[(v[1] < v[2] ? v[1] : v[2]) + 1]++;
		row[(v[2] < v[0] ? v[2] : v[0]) + 1]++;
	}
	for (uint32_t v = 0; v < vertices; v++) {
		uint32_t n = row[v + 1];

		row[v + 1] = sum;
		sum += n;
	}
}

/* Keys: larger vertex << 32 | half-edge << 2 | MP_USE_BACK. */
static void scatter(const struct mp_mesh *mesh, uint32_t *row, uint64_t *key)
{
	for (uint32_t t = 0; t < mesh->triangles; t++) {
		const uint32_t *v = mesh->tri[t];

		if (!mp_has_edges(v))
			continue;
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t from = v[k], to = v[k == 2 ? 0 : k + 1];
			uint32_t use = (3 * t + k) << 2;

			if (from < to)
				key[row[from + 1]++] = (uint64_t)to << 32 | use;
			else
				key[row[to + 1]++] = (uint64_t)from << 32 | use | MP_USE_BACK;
		}
	}
}

/* Sort every row and keep the lower halves of the keys, in the same memory from its beginning. */
static void sort_rows(const uint32_t *row, uint32_t vertices, uint64_t *key)
{
	unsigned char *out = (unsigned char *)key;

	for (uint32_t v = 0; v < vertices; v++) {
		uint32_t begin = row[v], end = row[v + 1];
		uint64_t last = UINT64_MAX;

		mp_sort_u64(key + begin, end - begin);
		for (uint32_t i = begin; i < end; i++) {
			uint64_t k = key[i];
			uint32_t use = (uint32_t)k | (k >> 32 != last ? MP_USE_FIRST : 0);

			memcpy(out + i * sizeof use, &use, sizeof use);
			last = k >> 32;
		}
	}
}

static size_t count_half_edges(const struct mp_mesh *mesh)
{
	size_t n = 0;

	for (uint32_t t = 0; t < mesh->triangles; t++)
		n += mp_has_edges(mesh->tri[t]) ? 3 : 0;
	return n;
}

int mp_edges_build(const struct mp_mesh *mesh, struct mp_edges *out, struct mp_error *err)
{
	uint32_t vertices = mp_vertices_count(mesh->vertices);
	uint32_t *row, *less;
	uint64_t *key;

	out->count = count_half_edges(mesh);
	row = calloc((size_t)vertices + 1, sizeof *row);
	if (row == NULL)
		goto err0;
	key = malloc((out->count + 1) * sizeof *key);
	if (key == NULL)
		goto err1;
	count_rows(mesh, row, vertices);
	scatter(mesh, row, key);
	sort_rows(row, vertices, key);
	out->use = (uint32_t *)key;
	out->use[out->count] = MP_USE_FIRST;
	free(row);
	less = realloc(key, (out->count + 1) * sizeof *less);
	if (less != NULL) /* else it stays larger than it need be */
		out->use = less;
	return 0;
err1:
	free(row);
err0:
	return mp_fail_nomem(err);
}

void mp_edges_free(struct mp_edges *e)
{
	free(e->use);
	e->use = NULL;
}
