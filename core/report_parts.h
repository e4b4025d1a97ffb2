#ifndef MP_REPORT_PARTS_H
#define MP_REPORT_PARTS_H

#include "core/analysis.h"
#include "core/ball.h"
#include "core/bodies.h"
#include "core/report.h"

/* Parts of the making of a report that report.c shares. */

/*
 * Principal axes and radii of gyration of report->total.inertia, which is at most ${tensor} (in
 * norm) from the exact one, for a solid of ${mass}.
 */
void mp_report_principal(struct mp_report *report, double tensor, struct mp_ball mass);

/*
 * Where the request wants it (or leaves it open and it costs less than a millisecond), put results
 * that are rounded once from exact numbers in the place of the certified ones, with their bounds.
 * The certified ones stay where names have densities of their own, and for a solid whose volume is
 * too small to be told from 0 by them, so that the verdicts on its winding are of one mind.
 * -1: memory is out.
 */
int mp_report_exact(const struct mp_request *request, const struct mp_mesh *mesh,
		    const struct mp_bodies *bodies, struct mp_report *report, struct mp_error *err);

#endif
