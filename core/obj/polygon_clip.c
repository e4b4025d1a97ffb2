#include <math.h>

#include "core/geometry/predicates.h"
#include "core/obj/polygon_private.h"

/*
 * Polygons that come here cross themselves.  An ear is a corner b with neighbours a and c, a b c
 * counter-clockwise, such that nothing of the rest of the boundary comes into the open triangle
 * (Meisters 1975, doi:10.1080/00029890.1975.11993898).  It is enough to look at the corners that
 * are not strictly convex: of what comes in, the point farthest from ac is such a corner, or
 * touches ab or bc in one.  A corner on the rim of the triangle is in the way only if one of its
 * edges goes inside.
 *
 * Often it is rounding that made a polygon cross itself where it only touched itself before.  So
 * three points are also tried to be on a line that nearly are; which of the tries was best is
 * decided by the area of the triangles that are reversed.
 */

/* How near, as a part of the polygon's size. */
static const double tolerances[] = {0, 1e-14, 1e-10, 1e-6, 1e-4};

enum { TRIES = sizeof tolerances / sizeof tolerances[0] };

/* Reversed triangles, as a part of the polygon's area: as good as none; an area that is off. */
#define GOOD    1e-10
#define TANGLED 1e-6

enum level {          /* what is clipped; the next where a whole round found nothing */
	     CLEAN,   /* ears that no corner touches */
	     TOUCHED, /* ears with corners on the diagonal */
	     FLAT,    /* corners without a turn */
	     CONVEX,  /* corners that turn the right way */
	     ANYTHING
};

struct clip {
	uint32_t n, left;
	double (*xy)[2];
	uint32_t *prev, *next; /* around the polygon that is left */
	uint8_t *convex;
	double size, tolerance; /* two lengths */
	uint64_t work;          /* steps, and corners looked at */
	uint32_t (*tri)[3];
	uint32_t done;
};

/* On which side of the line from ${a} to ${b} lies ${p}?  1: left, 0: on it. */
static int side_of(const struct clip *c, const double *a, const double *b, const double *p)
{
	double x = b[0] - a[0], y = b[1] - a[1];

	if (c->tolerance > 0 &&
	    fabs(x * (p[1] - a[1]) - y * (p[0] - a[0])) <= c->tolerance * fmax(fabs(x), fabs(y)))
		return 0;
	return mp_orient2d(a, b, p);
}

static int turn(const struct clip *c, uint32_t v)
{
	return side_of(c, c->xy[c->prev[v]], c->xy[v], c->xy[c->next[v]]);
}

/* Does the edge from a corner on the rim to ${q} go inside?  ${side}: of the corner. */
static bool goes_inside(const struct clip *c, const double *const tri[3], const int side[3],
			const double *q)
{
	for (int k = 0; k < 3; k++)
		if (side[k] == 0 && side_of(c, tri[k], tri[(k + 1) % 3], q) <= 0)
			return false;
	return true;
}

/* The lowest level at which the ear ${tri} could be clipped as far as corner ${v} is concerned. */
static enum level judge(const struct clip *c, const double *const tri[3], uint32_t v)
{
	int side[3];

	for (int k = 0; k < 3; k++) {
		side[k] = side_of(c, tri[k], tri[(k + 1) % 3], c->xy[v]);
		if (side[k] < 0)
			return CLEAN;
	}
	if ((side[0] > 0 && side[1] > 0 && side[2] > 0) ||
	    goes_inside(c, tri, side, c->xy[c->prev[v]]) ||
	    goes_inside(c, tri, side, c->xy[c->next[v]]))
		return CONVEX;
	return side[0] > 0 && side[1] > 0 ? TOUCHED : CLEAN;
}

static bool is_ear(struct clip *c, uint32_t v, enum level level)
{
	uint32_t a = c->prev[v], b = c->next[v];
	const double *const tri[3] = {c->xy[a], c->xy[v], c->xy[b]};
	double low[2], high[2];

	for (int k = 0; k < 2; k++) {
		low[k] = fmin(fmin(tri[0][k], tri[1][k]), tri[2][k]);
		high[k] = fmax(fmax(tri[0][k], tri[1][k]), tri[2][k]);
	}
	c->work += c->left;
	for (uint32_t i = b; i != v; i = c->next[i]) {
		const double *p = c->xy[i];

		if (!c->convex[i] && p[0] >= low[0] && p[0] <= high[0] && p[1] >= low[1] &&
		    p[1] <= high[1] && judge(c, tri, i) > level)
			return false;
	}
	return true;
}

/* Of three points on a line: is ${b} not between the others, or one of them? */
static bool is_spike(const double *a, const double *b, const double *c)
{
	for (int k = 0; k < 2; k++)
		if ((a[k] < b[k] && b[k] < c[k]) || (a[k] > b[k] && b[k] > c[k]))
			return false;
	return true;
}

static bool may_clip(struct clip *c, uint32_t v, enum level level)
{
	int side = turn(c, v);

	if (level == ANYTHING)
		return true;
	if (side == 0)
		return level >= FLAT || is_spike(c->xy[c->prev[v]], c->xy[v], c->xy[c->next[v]]);
	return side > 0 && (level >= CONVEX || is_ear(c, v, level));
}

static void clip_off(struct clip *c, uint32_t v)
{
	uint32_t a = c->prev[v], b = c->next[v];

	c->tri[c->done][0] = a;
	c->tri[c->done][1] = v;
	c->tri[c->done++][2] = b;
	c->next[a] = b;
	c->prev[b] = a;
	c->left--;
	c->convex[a] = turn(c, a) > 0;
	c->convex[b] = turn(c, b) > 0;
}

/* The work is bounded: past that, no more is asked than can be answered at once. */
static enum level least_level(const struct clip *c)
{
	const uint64_t most = 4096 + 1000 * (uint64_t)c->n;

	return c->work < most ? CLEAN : c->work < 2 * most ? CONVEX : ANYTHING;
}

static void clip_all(struct clip *c)
{
	enum level level = CLEAN;
	uint32_t v = 0, misses = 0;

	while (c->left > 2) {
		uint32_t next = c->next[v];

		c->work++;
		if (may_clip(c, v, level)) {
			clip_off(c, v);
			misses = 0;
			level = least_level(c);
		} else if (++misses >= c->left) {
			misses = 0;
			level = least_level(c) > level + 1 ? least_level(c) : level + 1;
		}
		v = next;
	}
}

/* The area of the reversed triangles as a part of the polygon's. */
static double reversed(const struct clip *c)
{
	double sum = 0, off = 0;

	for (uint32_t i = 0; i < c->done; i++) {
		const double *p = c->xy[c->tri[i][0]];
		double d[2][2], area;

		for (int k = 0; k < 4; k++)
			d[k / 2][k % 2] =
			    (c->xy[c->tri[i][1 + k / 2]][k % 2] / 2 - p[k % 2] / 2) / c->size;
		area = d[0][0] * d[1][1] - d[0][1] * d[1][0];
		sum += area;
		off += area < 0 ? -area : 0;
	}
	return off <= TANGLED * sum ? off / sum : 1;
}

static double clip_with(struct clip *c, double tolerance)
{
	c->tolerance = 2 * c->size * tolerance;
	c->left = c->n;
	c->done = 0;
	c->work = 0;
	for (uint32_t i = 0; i < c->n; i++) {
		c->prev[i] = i > 0 ? i - 1 : c->n - 1;
		c->next[i] = i + 1 < c->n ? i + 1 : 0;
	}
	for (uint32_t i = 0; i < c->n; i++)
		c->convex[i] = turn(c, i) > 0;
	clip_all(c);
	return reversed(c);
}

int polygon_clip(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner, uint32_t n,
		 const int axis[2], struct mp_error *err)
{
	struct clip c = {.n = n, .tri = p->tri};
	double best = 2, off = 2;
	int which = 0;

	c.xy = polygon_room(p, n * (sizeof *c.xy + 2 * sizeof *c.prev + sizeof *c.convex), err);
	if (c.xy == NULL)
		return -1;
	c.prev = (void *)(c.xy + n);
	c.next = c.prev + n;
	c.convex = (void *)(c.next + n);
	for (uint32_t i = 0; i < n; i++) {
		for (int k = 0; k < 2; k++) {
			c.xy[i][k] = xyz[corner[i]][axis[k]];
			c.size = fmax(c.size, fabs(c.xy[i][k] / 2 - c.xy[0][k] / 2));
		}
	}
	for (int i = 0; i < TRIES && off > GOOD; i++) {
		off = clip_with(&c, tolerances[i]);
		if (off < best) {
			best = off;
			which = i;
		}
	}
	if (off > best)
		(void)clip_with(&c, tolerances[which]);
	p->tangled = best > TANGLED;
	return 0;
}
