#include "core/report/report_parts.h"

int mp_report_map_begin(const struct mp_request *request, struct mp_report *r, struct mp_error *err)
{
	if (!request->has_transform)
		return 0;
	if (!mp_affine_set(&r->map, (const double(*)[4])request->transform))
		return mp_fail(err, MP_BAD_MAP, MP_NO_BYTE,
			       "the transform is singular: its determinant is 0");
	r->mapped = !mp_affine_is_identity(&r->map);
	if (r->mapped && !mp_affine_box_of_all(&r->map, r->vertices, &r->box))
		return mp_fail(err, MP_BAD_MAP, MP_NO_BYTE,
			       "the transform takes a vertex beyond the range of a double");
	return 0;
}

void mp_report_map_box(const struct mp_mesh *mesh, const struct mp_box *box, struct mp_report *r)
{
	if (!r->mapped)
		r->box = *box;
	else if (r->repaired) /* some of the vertices that begin() saw may be unused */
		(void)mp_affine_box(&r->map, mesh, NULL, mesh->triangles, &r->box);
}

void mp_report_map_whole(const struct mp_report *r, const struct mp_mesh *mesh,
			 const struct mp_box *box, struct mp_solid *whole, struct mp_solid *heavy)
{
	if (!r->mapped)
		return;
	mp_affine_solid(&r->map, whole);
	mp_affine_area(&r->map, mesh, NULL, mesh->triangles, box, whole);
	if (heavy == NULL)
		return;
	mp_affine_solid(&r->map, heavy);
	heavy->area = whole->area;
	heavy->area_bound = whole->area_bound;
	heavy->area_in_range = whole->area_in_range;
}

void mp_report_map_bodies(const struct mp_report *r, const struct mp_mesh *mesh,
			  struct mp_bodies *b)
{
	for (uint32_t i = 0; r->mapped && i < b->listed; i++) {
		const uint32_t *order = mp_bodies_order(b, i);
		uint32_t count = b->start[i + 1] - b->start[i];

		mp_affine_solid(&r->map, &b->solid[i]);
		mp_affine_area(&r->map, mesh, order, count, &b->box[i], &b->solid[i]);
		(void)mp_affine_box(&r->map, mesh, order, count, &b->box[i]);
	}
}

void mp_report_vertex(const struct mp_report *r, uint32_t number, double xyz[3])
{
	mp_vertices_get(r->vertices, number, xyz);
	if (r->mapped) /* in range, as the box is */
		(void)mp_affine_point(&r->map, xyz, xyz);
}
