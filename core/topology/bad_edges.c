#include "core/topology/topology_parts.h"

struct search {
	struct mp_smallest non_manifold, misoriented; /* half-edge << 32 | place of its first use */
};

static void search(struct search *s, const struct mp_edges *e)
{
	for (size_t i = 0, end; i < e->count; i = end) {
		uint64_t key = (uint64_t)mp_use_half(e->use[i]) << 32 | i;

		end = mp_edges_end(e, i);
		if (end - i > 2)
			mp_smallest_add(&s->non_manifold, key);
		else if (end - i == 2 && !((e->use[i] ^ e->use[i + 1]) & MP_USE_BACK))
			mp_smallest_add(&s->misoriented, key);
	}
}

static size_t listed(size_t uses)
{
	return uses < MP_DEFECT_TRIANGLES ? uses : MP_DEFECT_TRIANGLES;
}

static int list(const struct mp_mesh *mesh, const struct mp_edges *e, const struct mp_smallest *s,
		struct mp_defect_list *l, bool *truncated)
{
	size_t triangles = 0;

	for (size_t i = 0; i < s->count; i++) {
		size_t at = (uint32_t)s->key[i];

		triangles += listed(mp_edges_end(e, at) - at);
	}
	if (mp_defects_begin(l, s->count, triangles, 2 * s->count))
		return -1;
	for (size_t i = 0; i < s->count; i++) {
		const uint32_t *use = e->use + (uint32_t)s->key[i];
		size_t uses = mp_edges_end(e, (uint32_t)s->key[i]) - (uint32_t)s->key[i];
		/* Two uses are a misoriented edge, which has a direction. */
		bool back = uses == 2 && (use[0] & MP_USE_BACK);
		uint32_t ends[2] = {mp_corner_vertex(mesh, mp_use_corner(use[0], back)),
				    mp_corner_vertex(mesh, mp_use_corner(use[0], !back))};
		uint32_t t[MP_DEFECT_TRIANGLES];

		for (size_t j = 0; j < listed(uses); j++)
			t[j] = mp_use_triangle(use[j]);
		mp_defects_add(l, t, listed(uses), ends, 2);
		*truncated |= uses > MP_DEFECT_TRIANGLES;
	}
	return 0;
}

int mp_bad_edges_list(const struct mp_mesh *mesh, const struct mp_edges *e, uint32_t most,
		      struct mp_topology *out)
{
	struct search s = {.non_manifold = {.most = most}, .misoriented = {.most = most}};
	int failed;

	if (out->non_manifold_edges > 0 || out->misoriented_edges > 0)
		search(&s, e);
	failed = mp_smallest_finish(&s.non_manifold) || mp_smallest_finish(&s.misoriented) ||
		 list(mesh, e, &s.non_manifold, &out->defect[MP_DEFECT_NON_MANIFOLD_EDGE],
		      &out->truncated) ||
		 list(mesh, e, &s.misoriented, &out->defect[MP_DEFECT_MISORIENTED_EDGE],
		      &out->truncated);
	mp_smallest_free(&s.non_manifold);
	mp_smallest_free(&s.misoriented);
	return failed ? -1 : 0;
}
