#include "tests/unit/mesh_make.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

static void *need(void *memory)
{
	if (memory == NULL)
		abort();
	return memory;
}

void mesh_free(struct mesh *m)
{
	free(m->tri);
	memset(m, 0, sizeof *m);
}

void mesh_triangle(struct mesh *m, const double a[3], const double b[3], const double c[3])
{
	if (m->count == m->room) {
		m->room = m->room == 0 ? 64 : 2 * m->room;
		m->tri = need(realloc(m->tri, m->room * sizeof *m->tri));
	}
	memcpy(m->tri[m->count] + 0, a, 3 * sizeof(double));
	memcpy(m->tri[m->count] + 3, b, 3 * sizeof(double));
	memcpy(m->tri[m->count] + 6, c, 3 * sizeof(double));
	m->count++;
}

void mesh_quad(struct mesh *m, const double a[3], const double b[3], const double c[3],
	       const double d[3])
{
	mesh_triangle(m, a, b, c);
	mesh_triangle(m, a, c, d);
}

void mesh_box(struct mesh *m, const double min[3], const double max[3])
{
	static const int FACE[6][4] = {/* bit k of a corner: max along axis k */
				       {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
				       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
	double corner[8][3];

	for (int i = 0; i < 8; i++)
		for (int k = 0; k < 3; k++)
			corner[i][k] = (i >> k & 1) != 0 ? max[k] : min[k];
	for (int f = 0; f < 6; f++)
		mesh_quad(m, corner[FACE[f][0]], corner[FACE[f][1]], corner[FACE[f][2]],
			  corner[FACE[f][3]]);
}

void mesh_wedge(struct mesh *m, double x, double y, double z)
{
	const double o[3] = {0, 0, 0}, a[3] = {x, 0, 0}, b[3] = {0, y, 0}, c[3] = {0, 0, z};

	mesh_triangle(m, a, b, c);
	mesh_triangle(m, o, b, a);
	mesh_triangle(m, o, c, b);
	mesh_triangle(m, o, a, c);
}

/* Point ${i} of ${around} on the circle of radius ${r} at height ${z}; the last is the first. */
static void on_circle(double r, double z, int i, int around, double out[3])
{
	double angle = TURN * (i % around) / around;

	out[0] = r * cos(angle);
	out[1] = r * sin(angle);
	out[2] = z;
}

void mesh_sphere(struct mesh *m, double radius, int around, int up)
{
	const double south[3] = {0, 0, -radius}, north[3] = {0, 0, radius};

	for (int j = 0; j < up; j++) {
		double low = TURN / 2 * j / up, high = TURN / 2 * (j + 1) / up;

		for (int i = 0; i < around; i++) {
			double a[3], b[3], c[3], d[3];

			on_circle(radius * sin(low), -radius * cos(low), i, around, a);
			on_circle(radius * sin(low), -radius * cos(low), i + 1, around, b);
			on_circle(radius * sin(high), -radius * cos(high), i + 1, around, c);
			on_circle(radius * sin(high), -radius * cos(high), i, around, d);
			if (j == 0)
				mesh_triangle(m, south, c, d);
			else if (j == up - 1)
				mesh_triangle(m, a, b, north);
			else
				mesh_quad(m, a, b, c, d);
		}
	}
}

void mesh_torus(struct mesh *m, double ring, double radius, int around, int section)
{
	for (int j = 0; j < section; j++) {
		double low = TURN * j / section, high = TURN * ((j + 1) % section) / section;

		for (int i = 0; i < around; i++) {
			double a[3], b[3], c[3], d[3];

			on_circle(ring + radius * cos(low), radius * sin(low), i, around, a);
			on_circle(ring + radius * cos(low), radius * sin(low), i + 1, around, b);
			on_circle(ring + radius * cos(high), radius * sin(high), i + 1, around, c);
			on_circle(ring + radius * cos(high), radius * sin(high), i, around, d);
			mesh_quad(m, a, b, c, d);
		}
	}
}

void mesh_flip(struct mesh *m, size_t from)
{
	for (size_t i = from; i < m->count; i++) {
		double second[3];

		memcpy(second, m->tri[i] + 3, sizeof second);
		memcpy(m->tri[i] + 3, m->tri[i] + 6, sizeof second);
		memcpy(m->tri[i] + 6, second, sizeof second);
	}
}

void mesh_move(struct mesh *m, size_t from, double x, double y, double z)
{
	const double by[3] = {x, y, z};

	for (size_t i = from; i < m->count; i++)
		for (int k = 0; k < 9; k++)
			m->tri[i][k] += by[k % 3];
}

void mesh_scale(struct mesh *m, size_t from, double x, double y, double z)
{
	const double by[3] = {x, y, z};

	for (size_t i = from; i < m->count; i++)
		for (int k = 0; k < 9; k++)
			m->tri[i][k] *= by[k % 3];
}

/* Unit normal; 0 where the triangle has none. */
static void normal(const double t[9], double n[3])
{
	double e[3], f[3], length;

	for (int k = 0; k < 3; k++) {
		e[k] = t[3 + k] - t[k];
		f[k] = t[6 + k] - t[k];
	}
	for (int k = 0; k < 3; k++)
		n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int k = 0; k < 3; k++)
		n[k] = length > 0 && isfinite(length) ? n[k] / length : 0;
}

static void put32(uint8_t *out, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		out[i] = (uint8_t)(value >> (8 * i));
}

static void put_float(uint8_t *out, double value)
{
	float narrow = (float)value;
	uint32_t bits;

	memcpy(&bits, &narrow, sizeof bits);
	put32(out, bits);
}

uint8_t *mesh_stl_binary(const struct mesh *m, const char *header, size_t *size)
{
	uint8_t *file, *at;

	*size = 84 + 50 * m->count;
	file = need(calloc(*size, 1));
	if (header != NULL)
		memcpy(file, header, strlen(header) < 80 ? strlen(header) : 80);
	put32(file + 80, (uint32_t)m->count);
	at = file + 84;
	for (size_t i = 0; i < m->count; i++, at += 50) {
		double n[3];

		normal(m->tri[i], n);
		for (int k = 0; k < 3; k++)
			put_float(at + 4 * k, n[k]);
		for (int k = 0; k < 9; k++)
			put_float(at + 12 + 4 * k, m->tri[i][k]);
	}
	return file;
}

uint8_t *mesh_stl_ascii(const struct mesh *m, const char *name, size_t *size)
{
	size_t room = 64 + 2 * strlen(name) + 512 * m->count;
	char *file = need(malloc(room));
	size_t at = (size_t)snprintf(file, room, "solid %s\n", name);

	for (size_t i = 0; i < m->count; i++) {
		const double *t = m->tri[i];
		double n[3];

		normal(t, n);
		at +=
		    (size_t)snprintf(file + at, room - at,
				     "facet normal %.9g %.9g %.9g\nouter loop\n", n[0], n[1], n[2]);
		for (int k = 0; k < 9; k += 3)
			at += (size_t)snprintf(file + at, room - at, "vertex %.17g %.17g %.17g\n",
					       t[k], t[k + 1], t[k + 2]);
		at += (size_t)snprintf(file + at, room - at, "endloop\nendfacet\n");
	}
	at += (size_t)snprintf(file + at, room - at, "endsolid %s\n", name);
	*size = at;
	return need(realloc(file, at));
}
