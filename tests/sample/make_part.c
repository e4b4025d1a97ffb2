/*
 * make_part FILE [STEPS]: write a machined part as binary STL in millimetres.
 *
 * A flange: a disc of 120 mm with eight bolt holes of 11 mm on a circle of 94 mm, and a hub of
 * 60 mm with a bore of 40 mm, its edges broken by 1 mm chamfers and a 5 mm fillet at its foot.
 * Every vertex is computed by one function of small integers, so that triangles that share it get
 * the same bits and the mesh is watertight.  STEPS (default 12) segments make up an eighth of
 * every circle.
 */
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HOLES = 8, FILLET = 8, SIDE = 4, MAX_STEPS = 4096 };

#define PI 3.14159265358979323846
static const double hole_circle = 47, hole_radius = 5.5;
static const double face_inner = 35, face_outer = 59; /* the ring that the holes go through */
static const double bottom = 0, top = 12;

struct point {
	float x, y, z;
};

struct part {
	FILE *out;
	uint32_t count;
	int steps; /* segments in an eighth of a circle */
	int failed;
};

static void put_u32(uint8_t *to, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		to[i] = (uint8_t)(v >> 8 * i);
}

static void put_point(uint8_t *to, struct point p)
{
	const float xyz[3] = {p.x, p.y, p.z};
	uint32_t bits[3];

	memcpy(bits, xyz, sizeof bits);
	for (int i = 0; i < 3; i++)
		put_u32(to + 4 * i, bits[i]);
}

static struct point unit_normal(struct point a, struct point b, struct point c)
{
	const double u[3] = {b.x - a.x, b.y - a.y, b.z - a.z};
	const double v[3] = {c.x - a.x, c.y - a.y, c.z - a.z};
	const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
			     u[0] * v[1] - u[1] * v[0]};
	const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

	return (struct point){(float)(n[0] / length), (float)(n[1] / length),
			      (float)(n[2] / length)};
}

/* Counter-clockwise seen from outside. */
static void triangle(struct part *p, struct point a, struct point b, struct point c)
{
	uint8_t facet[50] = {0};

	put_point(facet, unit_normal(a, b, c));
	put_point(facet + 12, a);
	put_point(facet + 24, b);
	put_point(facet + 36, c);
	if (fwrite(facet, sizeof facet, 1, p->out) != 1)
		p->failed = 1;
	p->count++;
}

static void quad(struct part *p, struct point a, struct point b, struct point c, struct point d)
{
	triangle(p, a, b, c);
	triangle(p, a, c, d);
}

/* On the circle of radius ${r} at height ${z}; ${k} counts segments, any number of turns. */
static struct point on_circle(const struct part *p, double r, double z, int k)
{
	const int n = HOLES * p->steps;
	const double angle = 2 * PI * (k % n) / n;

	return (struct point){(float)(r * cos(angle)), (float)(r * sin(angle)), (float)z};
}

/* The band between two corners of the profile, which runs with the material on its left. */
static void band(struct part *p, const double from[2], const double to[2])
{
	for (int k = 0; k < HOLES * p->steps; k++)
		quad(p, on_circle(p, from[0], from[1], k), on_circle(p, from[0], from[1], k + 1),
		     on_circle(p, to[0], to[1], k + 1), on_circle(p, to[0], to[1], k));
}

/* Everything that is round about the z axis, as (radius, height). */
static void turned_surfaces(struct part *p)
{
	static const double outside[][2] = {{59, 0}, {60, 1}, {60, 11}, {59, 12}};
	static const double inside[][2] = {{30, 39}, {29, 40}, {21, 40}, {20, 39},
					   {20, 1},  {21, 0},  {35, 0}};
	double fillet[FILLET + 1][2];

	for (int i = 0; i <= FILLET; i++) {
		const double a = PI / 2 * i / FILLET;

		fillet[i][0] = face_inner - 5 * sin(a);
		fillet[i][1] = top + 5 - 5 * cos(a);
	}
	for (int i = 0; i < 3; i++)
		band(p, outside[i], outside[i + 1]);
	for (int i = 0; i < FILLET; i++)
		band(p, fillet[i], fillet[i + 1]);
	band(p, fillet[FILLET], inside[0]);
	for (int i = 0; i < 6; i++)
		band(p, inside[i], inside[i + 1]);
}

/* The edge of the eighth of the ring about hole ${hole}, counter-clockwise from its inner right. */
static struct point sector_edge(const struct part *p, int hole, int i, double z)
{
	const int m = p->steps, first = hole * m;
	const double step = (face_outer - face_inner) / SIDE;

	i %= 2 * m + 2 * SIDE;
	if (i < SIDE)
		return on_circle(p, face_inner + step * i, z, first);
	i -= SIDE;
	if (i < m)
		return on_circle(p, face_outer, z, first + i);
	i -= m;
	if (i < SIDE)
		return on_circle(p, face_inner + step * (SIDE - i), z, first + m);
	return on_circle(p, face_inner, z, first + m - (i - SIDE));
}

/* The point of the hole's edge that faces point ${i} of the edge of its eighth. */
static struct point hole_edge(const struct part *p, int hole, int i, double z)
{
	const double angle = 2 * PI * (hole + 0.5) / HOLES;
	const double x = hole_circle * cos(angle), y = hole_circle * sin(angle);
	const struct point e = sector_edge(p, hole, i, z);
	const double away = hypot(e.x - x, e.y - y);

	return (struct point){(float)(x + hole_radius * (e.x - x) / away),
			      (float)(y + hole_radius * (e.y - y) / away), (float)z};
}

/* Both faces of the disc about one hole, and the wall of the hole. */
static void drilled_eighth(struct part *p, int hole)
{
	for (int i = 0; i < 2 * p->steps + 2 * SIDE; i++) {
		const struct point t0 = hole_edge(p, hole, i, top);
		const struct point t1 = hole_edge(p, hole, i + 1, top);
		const struct point b0 = hole_edge(p, hole, i, bottom);
		const struct point b1 = hole_edge(p, hole, i + 1, bottom);

		quad(p, sector_edge(p, hole, i, top), sector_edge(p, hole, i + 1, top), t1, t0);
		quad(p, sector_edge(p, hole, i + 1, bottom), sector_edge(p, hole, i, bottom), b0,
		     b1);
		quad(p, b1, b0, t0, t1);
	}
}

/* The 84 bytes in front of the facets; written twice, as the count is known only at the end. */
static void header(struct part *p)
{
	uint8_t head[84] = "flange, millimetres, made by make_part";

	put_u32(head + 80, p->count);
	if (fseek(p->out, 0, SEEK_SET) != 0 || fwrite(head, sizeof head, 1, p->out) != 1)
		p->failed = 1;
}

int main(int argc, char **argv)
{
	struct part p = {.steps = 12};

	if (argc == 3)
		p.steps = (int)strtol(argv[2], NULL, 10);
	if (argc < 2 || argc > 3 || p.steps < 2 || p.steps > MAX_STEPS) {
		fprintf(stderr, "usage: make_part FILE [STEPS], STEPS from 2 to %d\n", MAX_STEPS);
		return 2;
	}
	if ((p.out = fopen(argv[1], "wb")) == NULL) {
		fprintf(stderr, "make_part: %s: %s\n", argv[1], strerror(errno));
		return 1;
	}
	header(&p);
	turned_surfaces(&p);
	for (int hole = 0; hole < HOLES; hole++)
		drilled_eighth(&p, hole);
	header(&p);
	if (fclose(p.out) != 0 || p.failed) {
		fprintf(stderr, "make_part: %s: %s\n", argv[1], strerror(errno));
		return 1;
	}
	return 0;
}
