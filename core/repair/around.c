#include <string.h>

#include "core/geometry/predicates.h"
#include "core/repair/sides.h"

/* An edge from a to b, and the half-plane from which angles count. */
struct around {
	const struct mp_mesh *mesh;
	double a[3], b[3], first[3];
};

static void third(const struct around *r, uint32_t use, double out[3])
{
	uint32_t corner = mp_half_next(mp_half_next(mp_use_half(use)));

	mp_vertices_get(r->mesh->vertices, mp_corner_vertex(r->mesh, corner), out);
}

/* Whether ${p} and ${q}, in a plane with the edge and not on its line, lie on one side of it. */
static bool same_side(const struct around *r, const double p[3], const double q[3])
{
	for (unsigned i = 0; i < 3; i++) {
		unsigned j = (i + 1) % 3;
		double a[2] = {r->a[i], r->a[j]}, b[2] = {r->b[i], r->b[j]}, p2[2] = {p[i], p[j]},
		       q2[2] = {q[i], q[j]};
		int side = mp_orient2d(a, b, p2);

		if (side != 0)
			return side == mp_orient2d(a, b, q2);
	}
	return true;
}

/* 0: in the first half-plane; 1, 2, 3: less than, just, more than half a turn from it. */
static int sector(const struct around *r, const double p[3])
{
	int side = mp_orient3d(r->a, r->b, r->first, p);

	if (side != 0)
		return side > 0 ? 1 : 3;
	return same_side(r, r->first, p) ? 0 : 2;
}

/* Whether the triangle of ${x} comes before that of ${y}. */
static bool before(const struct around *r, uint32_t x, uint32_t y)
{
	double p[3], q[3];
	int i, j;

	third(r, x, p);
	third(r, y, q);
	i = sector(r, p);
	j = sector(r, q);
	if (i != j)
		return i < j;
	return i % 2 == 1 && mp_orient3d(r->a, r->b, p, q) > 0;
}

static void merge(const struct around *r, const uint32_t *use, size_t half, size_t n, uint32_t *out)
{
	size_t i = 0, j = half;

	for (size_t k = 0; k < n; k++)
		out[k] = i < half && (j == n || !before(r, use[j], use[i])) ? use[i++] : use[j++];
}

/* Merge sort: it is stable, and no order makes it slow. */
static void sort(const struct around *r, uint32_t *use, size_t n, uint32_t *spare)
{
	if (n < 2)
		return;
	sort(r, use, n / 2, spare);
	sort(r, use + n / 2, n - n / 2, spare);
	merge(r, use, n / 2, n, spare);
	memcpy(use, spare, n * sizeof *use);
}

bool mp_around_sort(const struct mp_mesh *mesh, uint32_t *use, size_t n, uint32_t *spare)
{
	struct around r = {.mesh = mesh};

	mp_vertices_get(mesh->vertices, mp_corner_vertex(mesh, mp_use_corner(use[0], false)), r.a);
	mp_vertices_get(mesh->vertices, mp_corner_vertex(mesh, mp_use_corner(use[0], true)), r.b);
	for (size_t i = 0; i < n; i++) {
		double p[3];

		third(&r, use[i], p);
		if (mp_collinear(r.a, r.b, p))
			return false;
		if (i == 0)
			memcpy(r.first, p, sizeof p);
	}
	sort(&r, use, n, spare);
	return true;
}
