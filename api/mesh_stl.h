#ifndef API_MESH_STL_H
#define API_MESH_STL_H

#include <stddef.h>

#include "api/problem.h"
#include "core/report/report.h"

enum { API_MESH_ORIGIN = 96 }; /* three numbers of API_NUMBER_SIZE, two commas, NUL */

/*
 * The mesh as analysed (mapped, welded, re-oriented, tessellated) as binary STL, triangles in the
 * report's order, coordinates relative to the point that ${origin} says as "x,y,z".  Along an axis
 * that is 0 where the mesh lies within twice its size of 0, so that a file in float32 comes back
 * as it is, else the middle of the bounding box as a float32.  Heap bytes, ${*len} of them; NULL
 * with ${p}: memory is out, or the coordinates are out of the range of float32.
 */
char *api_mesh_stl(const struct mp_report *report, char origin[API_MESH_ORIGIN], size_t *len,
		   struct api_problem *p);

#endif
