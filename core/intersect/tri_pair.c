#include "core/intersect/tri_pair.h"

#include <string.h>

void mp_meeting_add(struct mp_meeting *m, unsigned on_first, unsigned on_second)
{
	for (unsigned i = 0; i < m->points; i++)
		if (m->place[i][0] == on_first && m->place[i][1] == on_second)
			return;
	if (m->points == MP_MEETING_POINTS)
		return;
	m->place[m->points][0] = (uint8_t)on_first;
	m->place[m->points++][1] = (uint8_t)on_second;
}

/* The edge on which both places are, 3 for none. */
static unsigned common_edge(unsigned a, unsigned b)
{
	for (unsigned k = 0; k < 3; k++) {
		bool with_a = a == k || a == (k + 1) % 3 || a == MP_ON_EDGE + k;
		bool with_b = b == k || b == (k + 1) % 3 || b == MP_ON_EDGE + k;

		if (with_a && with_b)
			return k;
	}
	return 3;
}

/* Where ${p}, in the plane of ${t}, is on it. */
static unsigned locate(const struct mp_tri *t, const double p[3], struct mp_work *w)
{
	unsigned zeros = 0, edge = 0;
	uint8_t axis[2];
	int s = mp_sign_axes(w, t->p, axis);

	for (unsigned k = 0; k < 3; k++) {
		int side = s * mp_sign2(w, axis, t->p[k], t->p[(k + 1) % 3], p);

		if (side < 0)
			return MP_ON_NOTHING;
		if (side == 0) {
			edge = zeros == 1 && k == edge + 2 ? 0 : k;
			zeros++;
		}
	}
	if (zeros == 0)
		return MP_ON_FACE;
	return zeros == 1 ? MP_ON_EDGE + edge : edge; /* two edges: the corner between them */
}

/* Where the line through p and q, on different sides of the plane of ${t}, goes through it. */
static unsigned pierce(const struct mp_tri *t, const double p[3], const double q[3],
		       struct mp_work *w)
{
	unsigned zeros = 0, edge = 0;
	bool left = false, right = false;

	for (unsigned k = 0; k < 3; k++) {
		int s = mp_sign3(w, p, q, t->p[k], t->p[(k + 1) % 3]);

		left = left || s > 0;
		right = right || s < 0;
		if (left && right)
			return MP_ON_NOTHING;
		if (s == 0) {
			zeros++;
			edge = k;
		}
	}
	if (zeros == 0)
		return MP_ON_FACE;
	return zeros == 1 ? MP_ON_EDGE + edge : MP_ON_NOTHING; /* a corner is found as a corner */
}

/* The corners of ${t} and the crossings of its edges, as places on it and on ${u}. */
static void add_points(const struct mp_tri *t, const struct mp_tri *u, const int side[3],
		       const uint8_t partner[3], bool swapped, struct mp_work *w,
		       struct mp_meeting *m)
{
	for (unsigned k = 0; k < 3; k++) {
		unsigned next = (k + 1) % 3, on = MP_ON_NOTHING;

		if (side[k] == 0) {
			on = partner[k] < 3 ? partner[k] : locate(u, t->p[k], w);
			if (on != MP_ON_NOTHING)
				mp_meeting_add(m, swapped ? on : k, swapped ? k : on);
		}
		if (side[k] * side[next] >= 0)
			continue;
		on = pierce(u, t->p[k], t->p[next], w);
		if (on != MP_ON_NOTHING)
			mp_meeting_add(m, swapped ? on : MP_ON_EDGE + k,
				       swapped ? MP_ON_EDGE + k : on);
	}
}

static void judge_point(struct mp_meeting *m)
{
	unsigned a = m->place[0][0], b = m->place[0][1];

	if (a < 3 && b < 3) { /* a shared corner: no two vertices are at the same place */
		m->points = 0;
		return;
	}
	m->touches = true;
	m->intersects = a == MP_ON_FACE || b == MP_ON_FACE || (a >= MP_ON_EDGE && b >= MP_ON_EDGE);
}

static void judge_segment(struct mp_meeting *m)
{
	unsigned et = common_edge(m->place[0][0], m->place[1][0]);
	unsigned eu = common_edge(m->place[0][1], m->place[1][1]);

	m->touches = true;
	m->intersects = et == 3 || eu == 3;
	m->crosses = et == 3 && eu == 3;
	if (et < 3)
		m->along[0][et] = (uint8_t)(eu < 3 ? MP_ALONG_EDGE + eu : MP_ALONG_FACE);
	if (eu < 3)
		m->along[1][eu] = (uint8_t)(et < 3 ? MP_ALONG_EDGE + et : MP_ALONG_FACE);
}

/* The sides of the corners of ${t} on the plane of ${u}.  False: the triangles have nothing but
 * shared corners in common. */
static bool find_sides(const struct mp_tri *t, const struct mp_tri *u, const uint8_t partner[3],
		       struct mp_work *w, int side[3])
{
	int least = 1, most = -1;

	for (unsigned k = 0; k < 3; k++) {
		side[k] = partner[k] < 3 ? 0 : mp_sign3(w, u->p[0], u->p[1], u->p[2], t->p[k]);
		if (partner[k] < 3)
			continue;
		least = side[k] < least ? side[k] : least;
		most = side[k] > most ? side[k] : most;
	}
	return least <= 0 && most >= 0;
}

static unsigned find_shared(const struct mp_tri *t, const struct mp_tri *u, uint8_t partner[2][3])
{
	unsigned shared = 0;

	memset(partner, 3, 6);
	for (uint8_t i = 0; i < 3; i++)
		for (uint8_t j = 0; j < 3; j++)
			if (t->v[i] == u->v[j]) {
				partner[0][i] = j;
				partner[1][j] = i;
				shared++;
			}
	return shared;
}

void mp_tri_meet(const struct mp_tri *t, const struct mp_tri *u, struct mp_work *w,
		 struct mp_meeting *out)
{
	uint8_t partner[2][3];
	int st[3], su[3];

	memset(out, 0, sizeof *out);
	mp_work_spend(w, MP_WORK_TRIANGLES);
	out->shared = (uint8_t)find_shared(t, u, partner);
	if (out->shared == 3) {
		out->coplanar = true;
		return;
	}
	if (!find_sides(t, u, partner[0], w, st))
		return;
	if (st[0] == 0 && st[1] == 0 && st[2] == 0) {
		out->coplanar = true;
		mp_tri_coplanar(t, u, w, out);
		return;
	}
	if (!find_sides(u, t, partner[1], w, su)) /* as always where they share an edge */
		return;
	add_points(t, u, st, partner[0], false, w, out);
	add_points(u, t, su, partner[1], true, w, out);
	if (out->points == 1)
		judge_point(out);
	else if (out->points >= 2)
		judge_segment(out);
}
