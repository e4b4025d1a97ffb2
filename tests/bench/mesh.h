#ifndef BENCH_MESH_H
#define BENCH_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * The solid that everything is measured on: a torus with bumps, closed and smooth, as an even grid
 * of ${rows} times ${columns} quads of two triangles each.  Its vertices are float32 values, every
 * one computed once from two small integers, so that each file format holds the same solid.
 */
struct bench_grid {
	uint32_t rows, columns;
};

/* The grid of 2*rows*columns triangles that comes nearest to ${triangles} from below. */
struct bench_grid bench_grid_of(uint64_t triangles);

static inline uint64_t bench_triangles(struct bench_grid g)
{
	return 2 * (uint64_t)g.rows * g.columns;
}

/* Vertex (i, j), both taken modulo the grid: about 120 mm wide. */
void bench_vertex(struct bench_grid g, uint32_t i, uint32_t j, float xyz[3]);

/* The corners of triangle t as grid positions, wound outward. */
void bench_corners(struct bench_grid g, uint64_t t, uint32_t ij[3][2]);

/* A fixed sequence of numbers that look random. */
uint64_t bench_random(uint64_t *state);

#endif
