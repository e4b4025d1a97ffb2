#include "core/moments/solid.h"

#include "core/decoder.h"

void mp_solid_add(struct mp_moments *m, const struct mp_mesh *mesh, const uint32_t *order,
		  uint32_t count)
{
	double block[MP_BLOCK][9];
	size_t fill = 0;

	for (uint32_t i = 0; i < count; i++) {
		const uint32_t *corner = mesh->tri[order != NULL ? order[i] : i];

		for (int k = 0; k < 3; k++)
			mp_vertices_get(mesh->vertices, corner[k], &block[fill][3 * k]);
		if (++fill < MP_BLOCK && i + 1 < count)
			continue;
		mp_moments_add(m, (const double(*)[9])block, fill);
		fill = 0;
	}
}

void mp_solid_find(struct mp_moments *moments, const struct mp_mesh *mesh, const uint32_t *order,
		   uint32_t count, bool closed, struct mp_solid *out)
{
	struct mp_moments second;

	mp_moments_solve(moments, out);
	if (!(closed ? out->again : out->area_again))
		return;
	mp_moments_begin_again(&second, moments);
	mp_solid_add(&second, mesh, order, count);
	mp_moments_solve(&second, out);
	*moments = second;
}
