#include "soup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double turn = 6.283185307179586;

void soup_add(struct soup *s, const double a[3], const double b[3], const double c[3])
{
	if (s->count == s->room) {
		s->room = s->room == 0 ? 64 : 2 * s->room;
		s->tri = realloc(s->tri, s->room * sizeof *s->tri);
		if (s->tri == NULL)
			abort();
	}
	memcpy(s->tri[s->count], a, 3 * sizeof *a);
	memcpy(s->tri[s->count] + 3, b, 3 * sizeof *b);
	memcpy(s->tri[s->count] + 6, c, 3 * sizeof *c);
	s->count++;
}

void soup_copy(struct soup *s, const struct soup *from, double scale, const double shift[3])
{
	size_t n = from->count;

	for (size_t i = 0; i < n; i++) {
		double t[9];

		for (unsigned k = 0; k < 9; k++)
			t[k] = from->tri[i][k] * scale + shift[k % 3];
		soup_add(s, t, t + 3, t + 6);
	}
}

void soup_drop(struct soup *s, size_t triangle)
{
	s->count--;
	memmove(s->tri[triangle], s->tri[s->count], sizeof *s->tri);
}

void soup_flip(struct soup *s, size_t triangle)
{
	double *t = s->tri[triangle];

	for (unsigned k = 0; k < 3; k++) {
		double x = t[k];

		t[k] = t[k + 3];
		t[k + 3] = x;
	}
}

void soup_free(struct soup *s)
{
	free(s->tri);
	memset(s, 0, sizeof *s);
}

void soup_divide(struct soup *s, size_t first)
{
	for (size_t i = first, n = s->count; i < n; i++) {
		double p[3][3], m[3][3];

		memcpy(p, s->tri[i], sizeof p);
		for (int c = 0; c < 3; c++)
			for (int k = 0; k < 3; k++)
				m[c][k] = (p[c][k] + p[(c + 1) % 3][k]) / 2;
		for (int c = 0; c < 3; c++)
			soup_add(s, p[c], m[c], m[(c + 2) % 3]);
		memcpy(s->tri[i], m, sizeof m);
	}
}

/* a, b, c, d counter-clockwise seen from outside; the diagonal is a, c. */
static void quad(struct soup *s, const double *a, const double *b, const double *c, const double *d)
{
	soup_add(s, a, b, c);
	soup_add(s, a, c, d);
}

void soup_box(struct soup *s, const double min[3], const double max[3])
{
	double p[8][3];

	for (unsigned i = 0; i < 8; i++)
		for (unsigned k = 0; k < 3; k++)
			p[i][k] = (i >> k & 1) ? max[k] : min[k];
	quad(s, p[0], p[4], p[6], p[2]); /* x min: diagonal 0 6 */
	quad(s, p[1], p[3], p[7], p[5]); /* x max: 1 7 */
	quad(s, p[0], p[1], p[5], p[4]); /* y min: 0 5 */
	quad(s, p[2], p[6], p[7], p[3]); /* y max: 2 7 */
	quad(s, p[0], p[2], p[3], p[1]); /* z min: 0 3 */
	quad(s, p[4], p[5], p[7], p[6]); /* z max: 4 7 */
}

void soup_cube(struct soup *s, double x, double y, double z, double size)
{
	const double min[3] = {x, y, z}, max[3] = {x + size, y + size, z + size};

	soup_box(s, min, max);
}

void soup_tetrahedron(struct soup *s, double x, double y, double z, double size)
{
	const double o[3] = {x, y, z}, a[3] = {x + size, y, z}, b[3] = {x, y + size, z};
	const double c[3] = {x, y, z + size};

	soup_add(s, o, b, a);
	soup_add(s, o, a, c);
	soup_add(s, o, c, b);
	soup_add(s, a, b, c);
}

void soup_torus(struct soup *s, unsigned n, unsigned m, double large, double small)
{
	for (unsigned i = 0; i < n; i++) {
		for (unsigned j = 0; j < m; j++) {
			double p[4][3];

			for (unsigned c = 0; c < 4; c++) {
				double u = turn * ((i + (c & 1)) % n) / n;
				double v = turn * ((j + (c >> 1)) % m) / m;
				double r = large + small * cos(v);

				p[c][0] = r * cos(u);
				p[c][1] = r * sin(u);
				p[c][2] = small * sin(v);
			}
			quad(s, p[0], p[1], p[3], p[2]);
		}
	}
}

void soup_tube(struct soup *s, unsigned n, double radius)
{
	for (unsigned i = 0; i < n; i++) {
		double p[4][3];

		for (unsigned c = 0; c < 4; c++) {
			double u = turn * ((i + (c & 1)) % n) / n;

			p[c][0] = radius * cos(u);
			p[c][1] = radius * sin(u);
			p[c][2] = c >> 1;
		}
		quad(s, p[0], p[1], p[3], p[2]);
	}
}

uint64_t soup_random(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state * 0x2545f4914f6cdd1du;
}

void soup_shuffle(struct soup *s, uint64_t *state)
{
	for (size_t i = s->count; i-- > 0;) {
		size_t j = soup_random(state) % (i + 1), turns = soup_random(state) % 3;
		double t[9];

		memcpy(t, s->tri[i], sizeof t);
		memmove(s->tri[i], s->tri[j], sizeof t);
		for (size_t k = 0; k < 9; k++)
			s->tri[j][k] = t[(k + 3 * turns) % 9];
	}
}

int soup_build(const struct soup *s, uint64_t key, struct built *b, struct mp_error *err)
{
	uint8_t bytes[16];

	memset(b, 0, sizeof *b);
	for (unsigned i = 0; i < 16; i++)
		bytes[i] = (uint8_t)(soup_random(&key) >> 56);
	b->tri = malloc((s->count + 1) * sizeof *b->tri);
	b->vertices = mp_vertices_new(bytes, err);
	if (b->tri == NULL || b->vertices == NULL ||
	    mp_vertices_add(b->vertices, (const double(*)[9])s->tri, s->count, b->tri, err)) {
		built_free(b);
		return -1;
	}
	mp_vertices_seal(b->vertices);
	b->mesh.vertices = b->vertices;
	b->mesh.tri = (const uint32_t(*)[3])b->tri;
	b->mesh.triangles = (uint32_t)s->count;
	return 0;
}

void built_free(struct built *b)
{
	mp_vertices_free(b->vertices);
	free(b->tri);
	memset(b, 0, sizeof *b);
}

void found_look(struct found *f, uint32_t most)
{
	if (soup_build(&f->soup, 9, &f->built, NULL) ||
	    mp_topology_find(&f->built.mesh, most, &f->t, NULL))
		abort();
}

void found_free(struct found *f)
{
	mp_topology_free(&f->t);
	built_free(&f->built);
	soup_free(&f->soup);
}

void found_boxes(const struct found *f, struct mp_box *box)
{
	for (uint32_t t = 0; t < f->built.mesh.triangles; t++) {
		for (int k = 0; k < 9; k++) {
			struct mp_box *b = &box[f->t.body_of[t]];
			double x = f->soup.tri[t][k];

			if (t == f->t.body[f->t.body_of[t]].first && k < 3)
				b->min[k] = b->max[k] = x;
			b->min[k % 3] = fmin(b->min[k % 3], x);
			b->max[k % 3] = fmax(b->max[k % 3], x);
		}
	}
}

void soup_bipyramid(struct soup *s, unsigned n, double x)
{
	const double top[3] = {x, 0, 1}, bottom[3] = {x, 0, -1};

	for (unsigned i = 0; i < n; i++) {
		double u = 6.283185307179586 * i / n, v = 6.283185307179586 * ((i + 1) % n) / n;
		const double p[3] = {x + cos(u), sin(u), 0}, q[3] = {x + cos(v), sin(v), 0};

		soup_add(s, p, q, top);
		soup_add(s, q, p, bottom);
	}
}
