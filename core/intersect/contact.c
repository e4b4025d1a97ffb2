#include "core/intersect/contact.h"

#include <string.h>

#include "core/intersect/intersect.h"
#include "core/intersect/wedge.h"

/* A triangle of one of the two bodies. */
struct side {
	uint32_t triangle, body;
	const struct mp_tri *tri;
};

/* The two half-planes of a surface at a line: on the first, the surface runs along the line. */
struct sheet {
	double ray[2][3];
};

static void copy(double to[3], const double from[3])
{
	memcpy(to, from, 3 * sizeof *to);
}

/* At its edge ${k}: the third corners of its two triangles. */
static bool sheet_of_edge(const struct mp_contact *c, const struct side *s, unsigned k,
			  struct sheet *out)
{
	uint64_t steps = 0;
	uint32_t half = mp_twin_of(&c->twins, c->mesh, 3 * s->triangle + k, &steps);

	mp_work_spend(c->work, steps);
	if (half == MP_NO_TWIN)
		return false;
	copy(out->ray[0], s->tri->p[(k + 2) % 3]);
	mp_vertices_get(c->mesh->vertices, c->mesh->tri[half / 3][(half + 2) % 3], out->ray[1]);
	return true;
}

/* Where the line p, q runs through it: a corner on either side. */
static bool sheet_of_face(const struct mp_contact *c, const struct side *s, const double p[3],
			  const double q[3], struct sheet *out)
{
	bool left = false, right = false;
	uint8_t axis[2];
	int sign = mp_sign_axes(c->work, s->tri->p, axis);

	for (unsigned k = 0; k < 3; k++) {
		int at = sign * mp_sign2(c->work, axis, p, q, s->tri->p[k]);

		if (at > 0)
			copy(out->ray[0], s->tri->p[k]);
		if (at < 0)
			copy(out->ray[1], s->tri->p[k]);
		left = left || at > 0;
		right = right || at < 0;
	}
	return left && right;
}

/* Whether two segments of a line run the same way. */
static bool same_way(const double p[3], const double q[3], const double r[3], const double s[3])
{
	for (unsigned k = 0; k < 3; k++)
		if (p[k] != q[k])
			return (p[k] < q[k]) == (r[k] < s[k]);
	return true;
}

static void swap(struct sheet *s)
{
	double t[3];

	copy(t, s->ray[0]);
	copy(s->ray[0], s->ray[1]);
	copy(s->ray[1], t);
}

/* Outward: the inside is behind the surface that runs along the line, clockwise from it. */
static struct mp_wedge wedge(const struct sheet *s, uint8_t winding)
{
	if (winding == MP_WOUND_OUTWARD)
		return (struct mp_wedge){s->ray[1], s->ray[0]};
	return (struct mp_wedge){s->ray[0], s->ray[1]};
}

/* What edge ${k} of ${a}, which runs along ${b} as ${along} says, tells of ${a} as the first. */
static unsigned compare(struct mp_contact *c, const struct side *a, unsigned k, unsigned along,
			const struct side *b)
{
	const double *p = a->tri->p[k], *q = a->tri->p[(k + 1) % 3];
	struct mp_wedge first, second;
	struct sheet x, y;

	if (!sheet_of_edge(c, a, k, &x))
		return 0;
	if (along == MP_ALONG_FACE) {
		if (!sheet_of_face(c, b, p, q, &y))
			return 0;
	} else {
		unsigned j = along - MP_ALONG_EDGE;

		if (!sheet_of_edge(c, b, j, &y))
			return 0;
		if (!same_way(p, q, b->tri->p[j], b->tri->p[(j + 1) % 3]))
			swap(&y);
	}
	first = wedge(&x, c->winding[a->body]);
	second = wedge(&y, c->winding[b->body]);
	return mp_wedge_compare(c->work, p, q, &first, &second);
}

static unsigned exchange(unsigned flags)
{
	return (flags & MP_WEDGE_BOTH) | (flags & MP_WEDGE_FIRST ? MP_WEDGE_SECOND : 0) |
	       (flags & MP_WEDGE_SECOND ? MP_WEDGE_FIRST : 0);
}

int mp_contact_add(struct mp_contact *c, const uint32_t triangle[2], const struct mp_tri *t,
		   const struct mp_tri *u, const struct mp_meeting *m, struct mp_body_pair *pair)
{
	struct side side[2] = {{triangle[0], pair->body[0], t}, {triangle[1], pair->body[1], u}};

	if (c->twins.row == NULL && mp_twins_build(c->mesh, &c->twins))
		return -1;
	for (unsigned i = 0; i < 2; i++)
		for (unsigned k = 0; k < 3; k++) {
			unsigned along = m->along[i][k], flags;

			/* Edges along each other are seen from the first one alone. */
			if (along == MP_ALONG_NO || (i == 1 && along != MP_ALONG_FACE))
				continue;
			flags = compare(c, &side[i], k, along, &side[1 - i]);
			pair->wedge |= (uint8_t)(i == 0 ? flags : exchange(flags));
			pair->along = true;
			pair->unsure = pair->unsure || flags == 0;
		}
	return 0;
}
