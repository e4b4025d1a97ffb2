#ifndef TOPOLOGY_REFERENCE_H
#define TOPOLOGY_REFERENCE_H

#include "core/topology/topology.h"

/*
 * The same answers as mp_topology_find() straight from the definitions, by comparing everything
 * with everything.  For small meshes on small whole coordinates; fills the counts, body and
 * body_of, no defects.  mp_topology_free() frees it.
 */
void reference_topology(const struct mp_mesh *mesh, struct mp_topology *out);

#endif
