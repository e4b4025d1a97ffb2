#include "core/repair/orient.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "core/bodies/bodies.h"
#include "core/exact/exact.h"
#include "core/moments/solid.h"
#include "core/repair/sides.h"
#include "core/topology/topology_parts.h"

struct orienter {
	struct mp_mesh mesh;
	uint32_t (*tri)[3]; /* mesh.tri, to write to */
	struct mp_sides sides;
	uint64_t *turned;          /* a bit per triangle */
	struct mp_topology real;   /* bodies and cracks, where there are holes */
	struct mp_topology sheets; /* sheets in the place of bodies; all sides.of's but body */
	struct mp_bodies bodies;   /* of sheets */
	bool *turn;                /* per sheet */
};

static void turn(struct orienter *o, uint32_t t)
{
	uint32_t second = o->tri[t][1];

	o->tri[t][1] = o->tri[t][2];
	o->tri[t][2] = second;
	o->turned[t / 64] ^= UINT64_C(1) << (t % 64);
}

/* Turn the sheets that o->turn says. */
static void turn_sheets(struct orienter *o)
{
	for (uint32_t t = 0; t < o->mesh.triangles; t++)
		if (o->sides.of[t] != MP_NO_BODY && o->turn[o->sides.of[t]])
			turn(o, t);
}

/* Every sheet with two sides alike, by turning the fewer of its triangles. */
static int wind_alike(struct orienter *o)
{
	const struct mp_sides *s = &o->sides;
	int64_t *more =
	    calloc((size_t)s->count + 1, sizeof *more); /* with less against the first */

	if (more == NULL)
		return -1;
	for (uint32_t t = 0; t < o->mesh.triangles; t++)
		if (s->of[t] != MP_NO_BODY)
			more[s->of[t]] += mp_sides_against(s, t) ? -1 : 1;
	for (uint32_t t = 0; t < o->mesh.triangles; t++) {
		uint32_t sheet = s->of[t];

		if (sheet != MP_NO_BODY && !(s->flaw[sheet] & MP_SIDE_ONE) &&
		    mp_sides_against(s, t) == (more[sheet] >= 0))
			turn(o, t);
	}
	free(more);
	return 0;
}

static bool any_flaw(const struct mp_sides *s, uint8_t flaw)
{
	for (uint32_t i = 0; i < s->count; i++)
		if (s->flaw[i] & flaw)
			return true;
	return false;
}

static int find_sides(struct orienter *o, struct mp_error *err)
{
	struct mp_edges edges;
	int ret;

	if (mp_edges_build(&o->mesh, &edges, err))
		return -1;
	ret = mp_sides_find(&o->mesh, &edges, &o->sides, err);
	mp_edges_free(&edges);
	assert(ret != 0 || (o->sides.of != NULL && o->sides.flaw != NULL));
	return ret;
}

/* Which bodies are open along cracks only, now that their sheets are wound alike. */
static int find_cracks(struct orienter *o, struct mp_error *err)
{
	struct mp_edges edges;
	uint64_t *gap; /* nobody asks where */
	int failed;

	if (!any_flaw(&o->sides, MP_SIDE_HOLE))
		return 0;
	if (mp_edges_build(&o->mesh, &edges, err))
		return -1;
	gap = calloc((size_t)mp_vertices_count(o->mesh.vertices) / 64 + 1, sizeof *gap);
	failed = gap == NULL || mp_bodies_find(&o->mesh, &edges, &o->real) ||
		 (!o->real.closed && mp_cracks_find(&o->mesh, &edges, gap, &o->real));
	free(gap);
	mp_edges_free(&edges);
	return failed ? mp_fail_nomem(err) : 0;
}

/* The sheets in the place of bodies, for what measures and nests bodies. */
static int list_sheets(struct orienter *o, struct mp_error *err)
{
	struct mp_topology *s = &o->sheets;

	s->bodies = o->sides.count;
	s->body_of = o->sides.of;
	s->body = calloc((size_t)s->bodies + 1, sizeof *s->body);
	o->turn = calloc((size_t)s->bodies + 1, sizeof *o->turn);
	if (s->body == NULL || o->turn == NULL)
		return mp_fail_nomem(err);
	for (uint32_t t = 0; t < o->mesh.triangles; t++)
		if (s->body_of[t] != MP_NO_BODY && s->body[s->body_of[t]].triangles++ == 0)
			s->body[s->body_of[t]].first = t;
	s->closed = true;
	for (uint32_t i = 0; i < s->bodies; i++) {
		struct mp_body_topology *b = &s->body[i];

		b->closed = o->sides.flaw[i] == 0;
		if (o->sides.flaw[i] == MP_SIDE_HOLE) {
			const struct mp_body_topology *whole =
			    &o->real.body[o->real.body_of[b->first]];

			b->cracks_only = whole->cracks_only && whole->triangles == b->triangles;
		}
		s->closed = s->closed && mp_body_has_volume(b);
	}
	return 0;
}

/* Which way those sheets are wound whose volume rounding cannot tell from 0. */
static int settle_winding(struct orienter *o, struct mp_error *err)
{
	struct mp_bodies *b = &o->bodies;
	struct mp_exact_grid grid = {.q = NULL};
	struct mp_exact e;
	int ret = 0;

	for (uint32_t i = 0; i < b->count && ret == 0; i++) {
		int sign;

		if (b->winding[i] != MP_ORIENTATION_NONE || !mp_body_has_volume(&o->sheets.body[i]))
			continue;
		if (grid.q == NULL && mp_exact_grid_find(&o->mesh, &grid, err))
			return -1;
		ret = mp_exact_find(&o->mesh, &grid, mp_bodies_order(b, i),
				    b->start[i + 1] - b->start[i], &e, err);
		if (ret)
			break;
		sign = mp_exact_sign(&e);
		if (sign != 0)
			b->winding[i] =
			    (uint8_t)(sign > 0 ? MP_ORIENTATION_OUTWARD : MP_ORIENTATION_INWARD);
		mp_exact_free(&e);
	}
	mp_exact_grid_free(&grid);
	return ret;
}

static int measure(struct orienter *o, struct mp_error *err)
{
	struct mp_moments moments;
	struct mp_solid whole;

	mp_moments_begin(&moments);
	mp_solid_add(&moments, &o->mesh, NULL, o->mesh.triangles);
	if (mp_bodies_measure(&o->mesh, &o->sheets, 0, &moments, NULL, &whole, &o->bodies, err) ||
	    settle_winding(o, err))
		return -1;
	return mp_bodies_nest(&o->mesh, &o->sheets, &o->bodies, err);
}

static bool is_turned(const struct orienter *o, uint32_t sheet)
{
	uint32_t first = o->sheets.body[sheet].first;

	return ((o->turned[first / 64] >> (first % 64)) & 1) != o->turn[sheet];
}

/*
 * A cavity may have all its corners and edges on the outer surface, so that no corner says where it
 * is.  Then the others that it meets at edges do, if they know.
 */
static int follow(struct orienter *o, struct mp_error *err)
{
	const struct mp_bodies *b = &o->bodies;
	const uint32_t *beside = o->sides.beside;
	uint32_t *known = malloc(((size_t)b->count + 1) * sizeof *known);

	if (known == NULL)
		return mp_fail_nomem(err);
	for (uint32_t i = 0; i < b->count; i++)
		known[i] = MP_NO_BODY;
	for (uint32_t i = 0; i < b->count; i++)
		if (b->nest[i].decided && b->winding[i] != MP_ORIENTATION_NONE)
			known[beside[i] >> 1] = i;
	for (uint32_t i = 0; i < b->count; i++) {
		uint32_t k = known[beside[i] >> 1];

		if (b->nest[i].decided || b->winding[i] == MP_ORIENTATION_NONE || k == MP_NO_BODY)
			continue;
		o->turn[i] = (is_turned(o, i) ^ is_turned(o, k) ^ beside[i] ^ beside[k]) & 1;
	}
	free(known);
	return 0;
}

static int face_outward(struct orienter *o, struct mp_error *err)
{
	const struct mp_bodies *b = &o->bodies;

	for (uint32_t i = 0; i < b->count; i++) {
		enum mp_orientation want =
		    b->nest[i].depth % 2 != 0 ? MP_ORIENTATION_INWARD : MP_ORIENTATION_OUTWARD;

		o->turn[i] = b->nest[i].decided && b->winding[i] != MP_ORIENTATION_NONE &&
			     b->winding[i] != want;
	}
	if (follow(o, err))
		return -1;
	turn_sheets(o);
	return 0;
}

/*
 * Sheets that are open by themselves may enclose a volume together, with nothing but cracks between
 * them.  Then they are turned all together or not at all.
 */
static int face_cracked_outward(struct orienter *o, struct mp_error *err)
{
	uint32_t *order, count = 0;
	struct mp_moments moments;
	struct mp_solid solid;

	if (o->sheets.closed || !o->real.cracks_only)
		return 0;
	order = malloc(((size_t)o->mesh.triangles + 1) * sizeof *order);
	if (order == NULL)
		return mp_fail_nomem(err);
	for (uint32_t i = 0; i < o->sheets.bodies; i++)
		o->turn[i] = !mp_body_has_volume(&o->sheets.body[i]);
	for (uint32_t t = 0; t < o->mesh.triangles; t++)
		if (o->sides.of[t] != MP_NO_BODY && o->turn[o->sides.of[t]])
			order[count++] = t;
	mp_moments_begin(&moments);
	mp_solid_add(&moments, &o->mesh, order, count);
	mp_solid_find(&moments, &o->mesh, order, count, true, &solid);
	if (solid.in_range && solid.volume < 0)
		turn_sheets(o);
	o->sheets.closed = true;
	free(order);
	return 0;
}

static int orient(struct orienter *o, struct mp_error *err)
{
	if (find_sides(o, err))
		return -1;
	if (wind_alike(o))
		return mp_fail_nomem(err);
	if (find_cracks(o, err) || list_sheets(o, err) || measure(o, err))
		return -1;
	return face_outward(o, err) || face_cracked_outward(o, err) ? -1 : 0;
}

static int tell(const struct orienter *o, struct mp_oriented *out, struct mp_error *err)
{
	struct mp_moments moments;
	struct mp_solid whole;

	for (uint32_t t = 0; t < o->mesh.triangles; t += 64)
		out->turned += (unsigned)__builtin_popcountll(o->turned[t / 64]);
	out->closed = o->sheets.closed && o->sides.count > 0;
	if (out->closed) {
		mp_moments_begin(&moments);
		mp_solid_add(&moments, &o->mesh, NULL, o->mesh.triangles);
		mp_solid_find(&moments, &o->mesh, NULL, o->mesh.triangles, true, &whole);
		out->volume = whole.in_range ? whole.volume : 0;
	}
	if (!any_flaw(&o->sides, MP_SIDE_ONE))
		return 0;
	out->one_sided = calloc((size_t)o->mesh.triangles / 64 + 1, sizeof *out->one_sided);
	if (out->one_sided == NULL)
		return mp_fail_nomem(err);
	for (uint32_t t = 0; t < o->mesh.triangles; t++)
		if (o->sides.of[t] != MP_NO_BODY && o->sides.flaw[o->sides.of[t]] & MP_SIDE_ONE)
			out->one_sided[t / 64] |= UINT64_C(1) << (t % 64);
	return 0;
}

int mp_orient(const struct mp_vertices *vertices, uint32_t (*tri)[3], uint32_t triangles,
	      struct mp_oriented *out, struct mp_error *err)
{
	struct orienter o = {.mesh = {.vertices = vertices,
				      .tri = (const uint32_t(*)[3])tri,
				      .triangles = triangles},
			     .tri = tri};
	int ret = -1;

	memset(out, 0, sizeof *out);
	o.turned = calloc((size_t)triangles / 64 + 1, sizeof *o.turned);
	if (o.turned == NULL)
		(void)mp_fail_nomem(err);
	else if (orient(&o, err) == 0)
		ret = tell(&o, out, err);
	mp_bodies_free(&o.bodies);
	free(o.sheets.body); /* the rest of it is of others */
	mp_topology_free(&o.real);
	mp_sides_free(&o.sides);
	free(o.turn);
	free(o.turned);
	return ret;
}

void mp_oriented_free(struct mp_oriented *o)
{
	free(o->one_sided);
	memset(o, 0, sizeof *o);
}
