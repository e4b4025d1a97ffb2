#include "tests/unit/mesh_random.h"

#include <math.h>
#include <string.h>

static uint64_t mix(uint64_t x)
{
	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

uint64_t random_bits(uint64_t *state)
{
	return mix(*state += 0x9e3779b97f4a7c15u);
}

double random_between(uint64_t *state, double low, double high)
{
	return low + (high - low) * ((double)(random_bits(state) >> 11) * 0x1p-53);
}

bool random_chance(uint64_t *state, double chance)
{
	return random_between(state, 0, 1) < chance;
}

static int random_count(uint64_t *state, int low, int high)
{
	return low + (int)(random_bits(state) % (uint64_t)(high - low + 1));
}

/* Draws one after the other: the order of arguments is the compiler's. */
static void move_by(struct mesh *m, size_t from, double x, double y, double z, uint64_t *state)
{
	double by[3] = {x, y, z};

	for (int k = 0; k < 3; k++)
		by[k] = random_between(state, -by[k], by[k]);
	mesh_move(m, from, by[0], by[1], by[2]);
}

/* About the size of 1, near the origin. */
static void add_body(struct mesh *m, uint64_t *state)
{
	const double min[3] = {-0.5, -0.5, -0.5}, max[3] = {0.5, 0.5, 0.5};
	size_t from = m->count;

	int round = random_count(state, 3, 11), up = random_count(state, 3, 8);

	switch (random_count(state, 0, 3)) {
	case 0:
		mesh_box(m, min, max);
		break;
	case 1:
		mesh_wedge(m, 1, 0.8, 0.7);
		break;
	case 2:
		mesh_sphere(m, 0.6, round, up - 1);
		break;
	default:
		mesh_torus(m, 0.5, 0.2, round, up);
	}
	for (size_t i = from; i < m->count; i++) /* -0 and 0 must be moved alike */
		for (int k = 0; k < 9; k++)
			m->tri[i][k] += 0.0;
}

/* Up to ${by} along each axis, by what is drawn for the place. */
static void displace(struct mesh *m, size_t from, double by, uint64_t salt)
{
	for (size_t i = from; i < m->count; i++)
		for (int c = 0; c < 9; c += 3) {
			uint64_t bits[3], place = salt;

			memcpy(bits, &m->tri[i][c], sizeof bits);
			for (int k = 0; k < 3; k++)
				place = mix(place ^ bits[k]) + 1;
			for (int k = 0; k < 3; k++)
				m->tri[i][c + k] += random_between(&place, -by, by);
		}
}

static void turn(struct mesh *m, size_t from, uint64_t *state)
{
	double q[4], length = 0, r[3][3];

	for (int k = 0; k < 4; k++) {
		q[k] = random_between(state, -1, 1);
		length += q[k] * q[k];
	}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			double cross = q[0] * q[1 + (3 - i - j) % 3];

			r[i][j] = 2 * q[1 + i] * q[1 + j] / length + (i == j ? -1 : 0);
			if (i == j)
				r[i][j] += 2 * q[0] * q[0] / length;
			else
				r[i][j] += ((j - i + 3) % 3 == 1 ? -2 : 2) * cross / length;
		}
	for (size_t t = from; t < m->count; t++)
		for (int c = 0; c < 9; c += 3) {
			double *v = m->tri[t] + c, x = v[0], y = v[1], z = v[2];

			for (int k = 0; k < 3; k++)
				v[k] = r[k][0] * x + r[k][1] * y + r[k][2] * z;
		}
}

/* One that may be a needle, a plate, or reach from micrometres to gigametres. */
static void stretch(struct mesh *m, uint64_t *state)
{
	double reach = random_chance(state, 0.1) ? 7 : 1, by[3];

	for (int k = 0; k < 3; k++)
		by[k] =
		    random_chance(state, 0.3) ? pow(10, random_between(state, -reach, reach)) : 1;
	mesh_scale(m, 0, by[0], by[1], by[2]);
}

/* A body and the same again, wound the other way: nothing, or what displacing leaves of it. */
static void add_reverse(struct mesh *m, size_t from, uint64_t *state)
{
	size_t count = m->count;

	for (size_t i = from; i < count; i++) {
		double t[9];

		memcpy(t, m->tri[i], sizeof t);
		mesh_triangle(m, t, t + 6, t + 3);
	}
	if (random_chance(state, 0.7))
		displace(m, count, 1e-14, random_bits(state));
}

static void add_bodies(struct mesh *m, uint64_t *state)
{
	int bodies = random_chance(state, 0.3) ? random_count(state, 2, 4) : 1;
	double apart = random_chance(state, 0.3) ? 1000 : 1.5;

	for (int b = 0; b < bodies; b++) {
		size_t from = m->count;
		double scale = b == 0 ? 1 : pow(10, random_between(state, -2, 0.2));

		add_body(m, state);
		if (random_chance(state, 0.8)) {
			double by = random_between(state, 0, 0.2);

			displace(m, from, by, random_bits(state));
		}
		mesh_scale(m, from, scale, scale, scale);
		if (random_chance(state, 0.25))
			mesh_flip(m, from);
		if (random_chance(state, 0.04))
			add_reverse(m, from, state);
		if (b > 0 && random_chance(state, 0.6))
			move_by(m, from, apart, apart, 0, state);
	}
}

static void place(struct random_mesh *out, uint64_t *state)
{
	double scale = pow(10, random_between(state, -6, 9)), far = 0;
	struct mesh *m = &out->mesh;

	if (random_chance(state, 0.1)) /* float32 ends at 1e38 */
		scale = pow(10, out->narrow ? random_between(state, -36, 19)
					    : random_between(state, -60, 60));
	if (random_chance(state, 0.5))
		far = scale * pow(10, random_between(state, 0, random_chance(state, 0.2) ? 9 : 6));
	mesh_scale(m, 0, scale, scale, scale);
	move_by(m, 0, far, far, far, state);
	for (size_t i = 0; i < m->count && out->narrow; i++)
		for (int k = 0; k < 9; k++)
			m->tri[i][k] = (float)m->tri[i][k];
}

void mesh_random(struct random_mesh *out, uint64_t *state)
{
	memset(out, 0, sizeof *out);
	out->narrow = random_chance(state, 0.4);
	add_bodies(&out->mesh, state);
	stretch(&out->mesh, state);
	if (random_chance(state, 0.7))
		turn(&out->mesh, 0, state);
	if (random_chance(state, 0.1))
		mesh_flip(&out->mesh, 0);
	place(out, state);
}

void mesh_random_boxes(struct random_mesh *out, uint64_t *state)
{
	const double min[3] = {-0.5, -0.5, -0.5}, max[3] = {0.5, 0.5, 0.5};

	memset(out, 0, sizeof *out);
	mesh_box(&out->mesh, min, max);
	mesh_box(&out->mesh, min, max);
	displace(&out->mesh, 0, 0.2, random_bits(state));
	mesh_move(&out->mesh, 12, random_between(state, 2, 100), 0, 0);
	turn(&out->mesh, 0, state);
	place(out, state);
}
