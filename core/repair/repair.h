#ifndef MP_REPAIR_H
#define MP_REPAIR_H

#include "core/analysis.h"
#include "core/moments/moments.h"
#include "core/report/report.h"

/*
 * mp_repair(request, key, report, moments, err):
 * What the request asks to be done to the mesh before anything is said of it: welding, then
 * orienting.  Changes
 * report->tri, counts what was done in ${report}, and sums ${moments} again where the mesh is
 * another one now.  ${key}: as for the vertex table.  -1: memory is out.
 */
int mp_repair(const struct mp_request *request, const uint8_t key[16], struct mp_report *report,
	      struct mp_moments *moments, struct mp_error *err);

/*
 * mp_repair_judge(mesh, key, report, err):
 * What repairing ${mesh} would give.  Where the winding is not consistent: which bodies have one
 * side only, and the volume that there would be with orient; where it is open: the weld tolerance
 * at which it would be watertight.  report->topology and box must be filled.  -1: memory is out.
 */
int mp_repair_judge(const struct mp_mesh *mesh, const uint8_t key[16], struct mp_report *report,
		    struct mp_error *err);

#endif
