#include "tests/bench/mesh.h"

#include <math.h>

static const double turn = 6.283185307179586;

/* As square as the count allows, so that rows are long in small meshes too. */
struct bench_grid bench_grid_of(uint64_t triangles)
{
	uint64_t quads = triangles / 2, rows = (uint64_t)sqrt((double)quads);

	if (rows < 3)
		rows = 3;
	while (rows > 3 && quads % rows != 0 && rows * 2 > (uint64_t)sqrt((double)quads))
		rows--;
	return (struct bench_grid){(uint32_t)rows, (uint32_t)(quads / rows > 3 ? quads / rows : 3)};
}

void bench_vertex(struct bench_grid g, uint32_t i, uint32_t j, float xyz[3])
{
	double u = turn * (i % g.rows) / g.rows, v = turn * (j % g.columns) / g.columns;
	double tube = 18 + 0.6 * sin(9 * u) * cos(7 * v) + 0.05 * sin(61 * u + 43 * v);
	double r = 40 + tube * cos(v);

	xyz[0] = (float)(r * cos(u));
	xyz[1] = (float)(r * sin(u));
	xyz[2] = (float)(tube * sin(v));
}

void bench_corners(struct bench_grid g, uint64_t t, uint32_t ij[3][2])
{
	uint32_t i = (uint32_t)(t / 2 / g.columns), j = (uint32_t)(t / 2 % g.columns);
	uint32_t last = t % 2 == 0 ? 1 : 0;
	const uint32_t corner[3][2] = {{i, j}, {i + 1, j + 1 - last}, {i + last, j + 1}};

	for (int c = 0; c < 3; c++) {
		ij[c][0] = corner[c][0] % g.rows;
		ij[c][1] = corner[c][1] % g.columns;
	}
}

uint64_t bench_random(uint64_t *state) /* splitmix64: Steele, Lea, Flood 2014 */
{
	uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);

	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return z ^ (z >> 31);
}
