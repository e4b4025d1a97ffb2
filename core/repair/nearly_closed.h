#ifndef MP_NEARLY_CLOSED_H
#define MP_NEARLY_CLOSED_H

#include "core/bodies/nesting.h"
#include "core/topology/topology.h"

/*
 * mp_nearly_closed(mesh, box, key, out, err):
 * Whether an open mesh is watertight once it is welded at a tolerance that only rounding to float32
 * explains: 1 or 4 units in the last place of its largest |coordinate|.  ${*out}: the smaller
 * one that does, as mp_weld() takes it [L], else 0.  ${box}: of the mesh, mapped where it is.
 * The ends of its boundary edges are tried alone first; then what all of it is like when welded is
 * looked at.  Where there are more than 2^20 such ends nobody looks.  60 bytes a triangle for a
 * moment at most.  -1: memory is out.
 */
int mp_nearly_closed(const struct mp_mesh *mesh, const struct mp_box *box, const uint8_t key[16],
		     double *out, struct mp_error *err);

#endif
