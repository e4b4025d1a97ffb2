#include "api/mesh_stl.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "api/json_number.h"
#include "core/stl/stl_write.h"

/* A mesh whose largest side is below this would crumble in float32's subnormal numbers [L]. */
static const double least_size = 0x1p-100;

static void find_origin(const struct mp_box *box, double size, double origin[3])
{
	for (int k = 0; k < 3; k++) {
		double far = fmax(fabs(box->min[k]), fabs(box->max[k]));
		double middle = box->min[k] / 2 + box->max[k] / 2;

		if (far > 2 * size)
			origin[k] =
			    fabs(middle) <= (double)FLT_MAX ? (double)(float)middle : middle;
		else
			origin[k] = 0;
	}
}

static double size_of(const struct mp_box *box)
{
	double size = 0;

	for (int k = 0; k < 3; k++)
		size = fmax(size, box->max[k] - box->min[k]);
	return size;
}

static void say(const double origin[3], char text[API_MESH_ORIGIN])
{
	char number[3][API_NUMBER_SIZE];

	for (int k = 0; k < 3; k++)
		(void)api_json_number(number[k], origin[k]);
	(void)snprintf(text, API_MESH_ORIGIN, "%s,%s,%s", number[0], number[1], number[2]);
}

static bool write_triangle(const struct mp_report *r, uint32_t t, const double origin[3],
			   uint8_t *out)
{
	/* a map that mirrors has the second and third corner change places */
	const int order[3] = {0, r->mapped && r->map.mirrors ? 2 : 1,
			      r->mapped && r->map.mirrors ? 1 : 2};
	double corner[3][3];

	for (int i = 0; i < 3; i++)
		mp_report_vertex(r, r->tri[t][order[i]], corner[i]);
	return mp_stl_write_facet(out, (const double(*)[3])corner, origin);
}

static int out_of_range(struct api_problem *p)
{
	return api_problem_set(p, API_UNSUPPORTED_FEATURE,
			       "The mesh is too large or too small for binary STL, whose numbers "
			       "are 32 bits wide; scale it with the option transform.");
}

char *api_mesh_stl(const struct mp_report *r, char origin_text[API_MESH_ORIGIN], size_t *len,
		   struct api_problem *p)
{
	const size_t all = MP_STL_HEAD + (size_t)r->triangles * MP_STL_FACET;
	const double size = size_of(&r->box);
	double origin[3];
	uint8_t *out;

	if (!(size <= DBL_MAX) || (size > 0 && size < least_size)) {
		(void)out_of_range(p);
		return NULL;
	}
	out = malloc(all);
	if (out == NULL) {
		(void)api_problem_set(p, API_TOO_EXPENSIVE,
				      "The request needs more memory than one request may use.");
		return NULL;
	}
	find_origin(&r->box, size, origin);
	say(origin, origin_text);
	mp_stl_write_head(out, r->triangles);
	for (uint32_t t = 0; t < r->triangles; t++) {
		if (write_triangle(r, t, origin, out + MP_STL_HEAD + (size_t)t * MP_STL_FACET))
			continue;
		free(out);
		(void)out_of_range(p);
		return NULL;
	}
	*len = all;
	return (char *)out;
}
