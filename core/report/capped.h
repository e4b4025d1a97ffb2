#ifndef MP_CAPPED_H
#define MP_CAPPED_H

#include "core/moments/moments.h"
#include "core/report/report.h"

/*
 * mp_capped_find(mesh, topology, sums, out, err):
 * The volume of the open ${mesh} with each boundary loop closed by a fan from the mean of its
 * vertices (of a triangle: by it): exact for planar loops, else an estimate.  Defined where the
 * mesh has no volume itself and its boundary edges are all that keeps it from being closed (every
 * other edge is used equally often both ways), and where doubles hold the result.  ${sums}: over
 * the triangles of ${mesh}. The fans' triangles are added to these sums, and where the result asks
 * for it summed again about a better reference: what accuracy a closed mesh has, this one has too.
 * 40 bytes a loop and 4 a vertex for a moment.
 */
int mp_capped_find(const struct mp_mesh *mesh, const struct mp_topology *topology,
		   const struct mp_moments *sums, struct mp_capped *out, struct mp_error *err);

#endif
