#include <string.h>

#include "core/geometry/predicates.h"
#include "core/report/report.h"

/* Whether a triangle is degenerate is said of the file's corners: mapping rounds. */
void mp_report_facet(const struct mp_report *r, uint32_t t, struct mp_facet *out)
{
	const uint32_t *v = r->tri[t];
	int b = r->mapped && r->map.mirrors ? 2 : 1;
	double file[3][3], corner[3][3];

	mp_report_vertex(r, v[0], corner[0]);
	mp_report_vertex(r, v[1], corner[b]);
	mp_report_vertex(r, v[2], corner[3 - b]);
	mp_facet_find((const double(*)[3])corner, out);
	if (!r->mapped || out->degenerate)
		return;
	mp_vertices_corners(r->vertices, v, file);
	if (!mp_collinear(file[0], file[1], file[2]))
		return;
	memset(out->normal, 0, sizeof out->normal);
	out->area = out->height = out->volume = 0;
	out->degenerate = true;
}
