#include "core/intersect/tri_pair.h"

/* Two triangles in a plane, each as if it ran counter-clockwise. */
struct plane {
	const struct mp_tri *tri[2];
	/* Of corner j of the other against edge k of triangle i: 1 within, 0 on its line. */
	int side[2][3][3];
	uint8_t axis[2];
};

static void find_sides(struct plane *p, struct mp_work *w)
{
	for (unsigned i = 0; i < 2; i++) {
		const struct mp_tri *t = p->tri[i], *u = p->tri[1 - i];
		int s = mp_sign2(w, p->axis, t->p[0], t->p[1], t->p[2]);

		for (unsigned k = 0; k < 3; k++)
			for (unsigned j = 0; j < 3; j++) {
				unsigned next = (k + 1) % 3;
				bool on = u->v[j] == t->v[k] || u->v[j] == t->v[next];

				p->side[i][k][j] =
				    on ? 0 : s * mp_sign2(w, p->axis, t->p[k], t->p[next], u->p[j]);
			}
	}
}

/* Whether an edge of triangle ${i} has all of the other one on its outer side, or on its line. */
static bool separates(const struct plane *p, unsigned i, int least)
{
	for (unsigned k = 0; k < 3; k++) {
		const int *s = p->side[i][k];

		if (s[0] < least && s[1] < least && s[2] < least)
			return true;
	}
	return false;
}

static unsigned locate(const struct plane *p, unsigned i, unsigned corner)
{
	unsigned on = MP_ON_FACE;

	for (unsigned k = 0; k < 3; k++) {
		int s = p->side[i][k][corner];

		if (s < 0)
			return MP_ON_NOTHING;
		if (s == 0 && on == MP_ON_FACE)
			on = MP_ON_EDGE + k;
		else if (s == 0)
			on = k == 2 && on == MP_ON_EDGE ? 0 : k;
	}
	return on;
}

/* What edge ${k} of triangle ${i} has in common with the other: more than a point? */
static uint8_t along(const struct plane *p, unsigned i, unsigned k)
{
	const struct mp_tri *t = p->tri[i], *u = p->tri[1 - i];
	const int *of_other = p->side[i][k];
	unsigned next = (k + 1) % 3;
	bool left = false, right = false, outside = false;

	for (unsigned j = 0; j < 3; j++) {
		const int *s = p->side[1 - i][j];

		left = left || of_other[j] > 0;
		right = right || of_other[j] < 0;
		outside = outside || (s[k] <= 0 && s[next] <= 0);
	}
	if (left && right && !outside)
		return MP_ALONG_FACE;
	for (unsigned j = 0; j < 3; j++) {
		unsigned to = (j + 1) % 3;

		if (of_other[j] != 0 || of_other[to] != 0)
			continue;
		for (unsigned a = 0; a < 2; a++) { /* along an axis on which they are no point */
			double x = t->p[k][p->axis[a]], y = t->p[next][p->axis[a]];
			double r = u->p[j][p->axis[a]], s = u->p[to][p->axis[a]];
			double from = x < y ? x : y, end = x < y ? y : x;

			if (x != y)
				return (r < s ? r : s) < end && from < (r < s ? s : r)
					   ? (uint8_t)(MP_ALONG_EDGE + j)
					   : MP_ALONG_NO;
		}
	}
	return MP_ALONG_NO;
}

static bool edges_cross(const struct plane *p, unsigned k, unsigned j)
{
	return p->side[0][k][j] * p->side[0][k][(j + 1) % 3] < 0 &&
	       p->side[1][j][k] * p->side[1][j][(k + 1) % 3] < 0;
}

static void add_points(const struct plane *p, struct mp_meeting *m)
{
	for (unsigned k = 0; k < 3; k++) {
		unsigned on = locate(p, 1, k);

		if (on != MP_ON_NOTHING)
			mp_meeting_add(m, k, on);
		on = locate(p, 0, k);
		if (on != MP_ON_NOTHING)
			mp_meeting_add(m, on, k);
	}
	for (unsigned k = 0; k < 3; k++)
		for (unsigned j = 0; j < 3; j++)
			if (edges_cross(p, k, j))
				mp_meeting_add(m, MP_ON_EDGE + k, MP_ON_EDGE + j);
}

void mp_tri_coplanar(const struct mp_tri *t, const struct mp_tri *u, struct mp_work *w,
		     struct mp_meeting *out)
{
	struct plane p = {.tri = {t, u}};

	(void)mp_sign_axes(w, t->p, p.axis);
	find_sides(&p, w);
	if (separates(&p, 0, 0) || separates(&p, 1, 0))
		return;
	out->intersects = !separates(&p, 0, 1) && !separates(&p, 1, 1);
	add_points(&p, out);
	out->touches = out->intersects || out->points > out->shared;
	if (!out->touches) {
		out->points = 0;
		return;
	}
	for (unsigned k = 0; k < 3 && out->shared < 2; k++) {
		out->along[0][k] = along(&p, 0, k);
		out->along[1][k] = along(&p, 1, k);
	}
}
