#include "core/repair/nearly_closed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/repair/weld.h"
#include "core/sort.h"
#include "core/topology/edges.h"

enum { MOST_ENDS = 1 << 20 };

/* The edges that are used once. */
struct rim {
	uint32_t (*edge)[2]; /* places in ${end} */
	size_t edges;
	uint32_t *end; /* their vertices, each once */
	uint32_t ends;
	uint32_t *leader; /* of each end, when welded */
	uint64_t *key;    /* for the edges, welded */
};

static double largest(const struct mp_box *box)
{
	double x = 0;

	for (int k = 0; k < 3; k++)
		x = fmax(x, fmax(fabs(box->min[k]), fabs(box->max[k])));
	return x;
}

static bool is_boundary(const struct mp_edges *e, size_t i)
{
	return (e->use[i] & MP_USE_FIRST) && (e->use[i + 1] & MP_USE_FIRST);
}

/* ${place}: per vertex, UINT32_MAX before.  false: there are too many. */
static bool collect(const struct mp_mesh *mesh, const struct mp_edges *e, uint32_t *place,
		    struct rim *r)
{
	size_t n = 0;

	for (size_t i = 0; i < e->count; i++) {
		if (!is_boundary(e, i))
			continue;
		for (int k = 0; k < 2; k++) {
			uint32_t v = mp_corner_vertex(mesh, mp_use_corner(e->use[i], k == 1));

			if (place[v] == UINT32_MAX) {
				if (r->ends == MOST_ENDS)
					return false;
				r->end[r->ends] = v;
				place[v] = r->ends++;
			}
			r->edge[n][k] = place[v];
		}
		n++;
	}
	return true;
}

static int allocate(struct rim *r)
{
	size_t ends = 2 * r->edges < MOST_ENDS ? 2 * r->edges : MOST_ENDS;

	r->edge = malloc(r->edges * sizeof *r->edge);
	r->key = malloc(r->edges * sizeof *r->key);
	r->end = malloc(ends * sizeof *r->end);
	r->leader = malloc(ends * sizeof *r->leader);
	return r->edge == NULL || r->key == NULL || r->end == NULL || r->leader == NULL ? -1 : 0;
}

/* r->ends is 0 where there is nothing to try. */
static int find_rim(const struct mp_mesh *mesh, struct rim *r, struct mp_error *err)
{
	uint32_t vertices = mp_vertices_count(mesh->vertices), *place = NULL;
	struct mp_edges e;
	int failed = 0;

	if (mp_edges_build(mesh, &e, err))
		return -1;
	for (size_t i = 0; i < e.count; i++)
		r->edges += is_boundary(&e, i);
	if (r->edges > 0 && r->edges <= 2 * (size_t)MOST_ENDS) {
		place = malloc(vertices * sizeof *place);
		failed = place == NULL || allocate(r);
		if (!failed) {
			memset(place, 0xff, vertices * sizeof *place);
			if (!collect(mesh, &e, place, r))
				r->ends = 0;
		}
	}
	free(place);
	mp_edges_free(&e);
	return failed ? mp_fail_nomem(err) : 0;
}

/* Would the boundary edges, welded, be used twice each?  Those that collapse are used no more. */
static bool pairs_up(struct rim *r)
{
	size_t n = 0;

	for (size_t i = 0; i < r->edges; i++) {
		uint64_t a = r->leader[r->edge[i][0]], b = r->leader[r->edge[i][1]];

		if (a != b)
			r->key[n++] = a < b ? a << 32 | b : b << 32 | a;
	}
	if (n % 2 != 0)
		return false;
	mp_sort_u64(r->key, n);
	for (size_t i = 0; i < n; i += 2)
		if (r->key[i] != r->key[i + 1] || (i > 0 && r->key[i] == r->key[i - 1]))
			return false;
	return true;
}

static bool all_twice(const struct mp_edges *e)
{
	for (size_t i = 0, end; i < e->count; i = end) {
		end = mp_edges_end(e, i);
		if (end - i != 2)
			return false;
	}
	return e->count > 0;
}

/* Whether all of it is watertight when all of it is welded. */
static int judge(const struct mp_mesh *mesh, double distance, const uint8_t key[16], bool *closes,
		 struct mp_error *err)
{
	size_t size = mesh->triangles * sizeof *mesh->tri;
	uint32_t(*tri)[3] = malloc(size);
	struct mp_mesh welded = *mesh;
	struct mp_edges e;
	struct mp_weld done;
	int ret = -1;

	*closes = false;
	if (tri == NULL)
		return mp_fail_nomem(err);
	memcpy(tri, mesh->tri, size);
	welded.tri = (const uint32_t(*)[3])tri;
	if (mp_weld(mesh->vertices, mesh->map, tri, mesh->triangles, distance, key, &done, err) ||
	    mp_edges_build(&welded, &e, err))
		goto out;
	*closes = done.complete && all_twice(&e);
	mp_edges_free(&e);
	ret = 0;
out:
	free(tri);
	return ret;
}

static int try(const struct mp_mesh *mesh, struct rim *r, double distance, const uint8_t key[16],
	       bool *closes, struct mp_error *err)
{
	bool complete;

	*closes = false;
	if (mp_cluster_find(mesh->vertices, mesh->map, r->end, r->ends, distance, key, r->leader,
			    &complete, err))
		return -1;
	return complete && pairs_up(r) ? judge(mesh, distance, key, closes, err) : 0;
}

int mp_nearly_closed(const struct mp_mesh *mesh, const struct mp_box *box, const uint8_t key[16],
		     double *out, struct mp_error *err)
{
	static const double ulps[] = {1, 4};
	double size = largest(box), ulp = size > 0 ? ldexp(1.0, ilogb(size) - 23) : 0;
	struct rim r = {.edges = 0};
	int ret;

	*out = 0;
	if (ulp == 0)
		return 0;
	ret = find_rim(mesh, &r, err);
	for (int i = 0; i < 2 && ret == 0 && *out == 0 && r.ends > 0; i++) {
		bool closes;

		ret = try(mesh, &r, ulps[i] * ulp, key, &closes, err);
		if (ret == 0 && closes)
			*out = ulps[i] * ulp;
	}
	free(r.edge);
	free(r.key);
	free(r.end);
	free(r.leader);
	return ret;
}
