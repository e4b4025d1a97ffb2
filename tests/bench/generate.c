/*
 * generate KIND TRIANGLES FILE: write the solid of mesh.h.  KIND: stl (binary, in the order of the
 * mesh), shuffled (binary STL, triangles in no order), ascii (STL), obj (v, vt, vn and faces of
 * four corners), plain (OBJ: v and triangles), box (binary STL of 12 triangles, whatever TRIANGLES
 * says). The same words give the same bytes.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/mesh.h"

static void put_u32(uint8_t *to, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		to[i] = (uint8_t)(v >> 8 * i);
}

static void unit_normal(const float p[3][3], float n[3])
{
	double u[3], v[3], m[3], length;

	for (int k = 0; k < 3; k++) {
		u[k] = (double)p[1][k] - (double)p[0][k];
		v[k] = (double)p[2][k] - (double)p[0][k];
	}
	for (int k = 0; k < 3; k++)
		m[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
	length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
	for (int k = 0; k < 3; k++)
		n[k] = (float)(length > 0 ? m[k] / length : 0);
}

static void stl_head(FILE *f, uint64_t count)
{
	uint8_t head[84] = "a torus with bumps";

	put_u32(head + 80, (uint32_t)count);
	fwrite(head, sizeof head, 1, f);
}

static void stl_facet(FILE *f, const float p[3][3])
{
	uint8_t facet[50] = {0};
	float all[4][3];

	unit_normal(p, all[0]);
	memcpy(all[1], p, sizeof(float[3][3]));
	for (int i = 0; i < 12; i++) {
		uint32_t bits;

		memcpy(&bits, &all[i / 3][i % 3], sizeof bits);
		put_u32(facet + 4 * i, bits);
	}
	fwrite(facet, sizeof facet, 1, f);
}

static void corners(struct bench_grid g, uint64_t t, float p[3][3])
{
	uint32_t ij[3][2];

	bench_corners(g, t, ij);
	for (int c = 0; c < 3; c++)
		bench_vertex(g, ij[c][0], ij[c][1], p[c]);
}

static void stl(FILE *f, struct bench_grid g)
{
	stl_head(f, bench_triangles(g));
	for (uint64_t t = 0; t < bench_triangles(g); t++) {
		float p[3][3];

		corners(g, t, p);
		stl_facet(f, (const float(*)[3])p);
	}
}

static void shuffled(FILE *f, struct bench_grid g)
{
	uint64_t count = bench_triangles(g), state = 1;
	uint32_t *order = calloc(count, sizeof *order);

	if (order == NULL)
		exit(1);
	for (uint64_t i = 0; i < count; i++) { /* Fisher and Yates, inside out */
		uint64_t at = bench_random(&state) % (i + 1);

		order[i] = order[at];
		order[at] = (uint32_t)i;
	}
	stl_head(f, count);
	for (uint64_t i = 0; i < count; i++) {
		float p[3][3];

		corners(g, order[i], p);
		stl_facet(f, (const float(*)[3])p);
	}
	free(order);
}

static void ascii(FILE *f, struct bench_grid g)
{
	fputs("solid torus\n", f);
	for (uint64_t t = 0; t < bench_triangles(g); t++) {
		float p[3][3], n[3];

		corners(g, t, p);
		unit_normal((const float(*)[3])p, n);
		fprintf(f, "  facet normal %e %e %e\n    outer loop\n", (double)n[0], (double)n[1],
			(double)n[2]);
		for (int c = 0; c < 3; c++)
			fprintf(f, "      vertex %e %e %e\n", (double)p[c][0], (double)p[c][1],
				(double)p[c][2]);
		fputs("    endloop\n  endfacet\n", f);
	}
	fputs("endsolid torus\n", f);
}

static void vertices(FILE *f, struct bench_grid g)
{
	for (uint32_t i = 0; i < g.rows; i++)
		for (uint32_t j = 0; j < g.columns; j++) {
			float p[3];

			bench_vertex(g, i, j, p);
			fprintf(f, "v %.9g %.9g %.9g\n", (double)p[0], (double)p[1], (double)p[2]);
		}
}

static uint64_t number(struct bench_grid g, const uint32_t ij[2])
{
	return (uint64_t)ij[0] * g.columns + ij[1] + 1;
}

static void obj(FILE *f, struct bench_grid g)
{
	fputs("# a torus with bumps\no torus\n", f);
	vertices(f, g);
	for (uint32_t i = 0; i < g.rows; i++)
		for (uint32_t j = 0; j < g.columns; j++)
			fprintf(f, "vt %.6f %.6f\n", (double)i / g.rows, (double)j / g.columns);
	for (uint32_t i = 0; i < g.rows; i++)
		for (uint32_t j = 0; j < g.columns; j++) {
			double u = 6.283185307179586 * i / g.rows;
			double v = 6.283185307179586 * j / g.columns;

			fprintf(f, "vn %.4f %.4f %.4f\n", cos(u) * cos(v), sin(u) * cos(v), sin(v));
		}
	for (uint64_t q = 0; q < bench_triangles(g) / 2; q++) {
		uint32_t a[3][2], b[3][2];
		uint64_t n[4];

		bench_corners(g, 2 * q, a);
		bench_corners(g, 2 * q + 1, b);
		n[0] = number(g, a[0]);
		n[1] = number(g, a[1]);
		n[2] = number(g, a[2]);
		n[3] = number(g, b[2]);
		fputs("f", f);
		for (int c = 0; c < 4; c++)
			fprintf(f, " %llu/%llu/%llu", (unsigned long long)n[c],
				(unsigned long long)n[c], (unsigned long long)n[c]);
		fputs("\n", f);
	}
}

static void plain(FILE *f, struct bench_grid g)
{
	vertices(f, g);
	for (uint64_t t = 0; t < bench_triangles(g); t++) {
		uint32_t ij[3][2];

		bench_corners(g, t, ij);
		fprintf(f, "f %llu %llu %llu\n", (unsigned long long)number(g, ij[0]),
			(unsigned long long)number(g, ij[1]), (unsigned long long)number(g, ij[2]));
	}
}

static void box(FILE *f, struct bench_grid g)
{
	static const uint8_t face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
					   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

	(void)g;
	stl_head(f, 12);
	for (int t = 0; t < 12; t++) {
		const uint8_t *q = face[t / 2];
		const uint8_t c[3] = {q[0], q[1 + t % 2], q[2 + t % 2]};
		float p[3][3];

		for (int i = 0; i < 3; i++) {
			p[i][0] = (c[i] & 1) != 0 ? 40 : 0;
			p[i][1] = (c[i] & 2) != 0 ? 30 : 0;
			p[i][2] = (c[i] & 4) != 0 ? 20 : 0;
		}
		stl_facet(f, (const float(*)[3])p);
	}
}

int main(int argc, char **argv)
{
	static const struct {
		const char *name;
		void (*write)(FILE *, struct bench_grid);
	} kind[] = {{"stl", stl}, {"shuffled", shuffled}, {"ascii", ascii},
		    {"obj", obj}, {"plain", plain},       {"box", box}};
	static char room[1 << 20];
	FILE *f;

	for (size_t i = 0; argc == 4 && i < sizeof kind / sizeof kind[0]; i++) {
		if (strcmp(argv[1], kind[i].name) != 0)
			continue;
		f = fopen(argv[3], "wb");
		if (f == NULL || setvbuf(f, room, _IOFBF, sizeof room) != 0) {
			perror(argv[3]);
			return 1;
		}
		kind[i].write(f, bench_grid_of(strtoull(argv[2], NULL, 10)));
		if (ferror(f) || fclose(f) != 0) {
			perror(argv[3]);
			return 1;
		}
		return 0;
	}
	fputs("generate stl|shuffled|ascii|obj|plain|box TRIANGLES FILE\n", stderr);
	return 2;
}
