#ifndef MP_TRI_PAIR_H
#define MP_TRI_PAIR_H

#include "core/intersect/signs.h"

/*
 * Where two triangles of a mesh meet, exactly: no sign of it is ever wrong.  Both have an area.
 *
 * What they share by vertex number, a corner or an edge, is no contact.  Any other contact is
 *  - a touch, where it is on the border of both and a corner of one lies on it, or edges run along
 *    each other: what a T-junction does;
 *  - an intersection otherwise: a point within one of them, edges that cross, an area in common;
 *  - a crossing, where the planes differ and a segment runs within both.
 */
struct mp_tri {
	double p[3][3];
	uint32_t v[3];
};

/* A place on a triangle: corner 0 to 2, within edge 3 to 5 (3 + k: from corner k on), within it. */
enum { MP_ON_EDGE = 3, MP_ON_FACE = 6, MP_ON_NOTHING = 7 };

/* What an edge has in common with the other triangle: more than points only if not MP_ALONG_NO. */
enum {
	MP_ALONG_NO,
	MP_ALONG_EDGE, /* MP_ALONG_EDGE + j: a part of edge j */
	MP_ALONG_FACE = 4
};

enum { MP_MEETING_POINTS = 9 };

struct mp_meeting {
	bool touches, intersects, crosses; /* each one implies those before */
	bool coplanar;
	uint8_t shared;      /* how many corners they share */
	uint8_t along[2][3]; /* edges of the first, and of the second; left out with two or three
				shared corners */
	/* The corners of what they have in common, but for shared ones without an intersection. */
	uint8_t points;
	uint8_t place[MP_MEETING_POINTS][2]; /* on the first, on the second */
};

/* mp_tri_meet(t, u, work, out): legal for triangles without an area only if that is not asked. */
void mp_tri_meet(const struct mp_tri *t, const struct mp_tri *u, struct mp_work *work,
		 struct mp_meeting *out);

/* Point ${i} of the meeting, rounded: within a few ulp of the triangles' size. */
void mp_tri_point(const struct mp_tri *t, const struct mp_tri *u, const struct mp_meeting *m,
		  unsigned i, double out[3]);

/* Private to tri_pair.c and tri_coplanar.c. */
void mp_tri_coplanar(const struct mp_tri *t, const struct mp_tri *u, struct mp_work *work,
		     struct mp_meeting *out);
void mp_meeting_add(struct mp_meeting *, unsigned on_first, unsigned on_second);

#endif
