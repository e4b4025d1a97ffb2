#ifndef MP_REPORT_PARTS_H
#define MP_REPORT_PARTS_H

#include "core/analysis.h"
#include "core/bodies/bodies.h"
#include "core/exact/exact.h"
#include "core/moments/ball.h"
#include "core/moments/uncertainty.h"
#include "core/report/report.h"

/* Parts of the making of a report that report.c shares. */

/*
 * Principal axes and radii of gyration of report->total.inertia, which is at most ${tensor} (in
 * norm) from the exact one, for a solid of ${mass}.
 */
void mp_report_principal(struct mp_report *report, double tensor, struct mp_ball mass);

/*
 * The request's map (report_mapped.c).  begin: decide on it, before repairs; box: fill report->box,
 * where that of the file is ${box}; whole: map the solid of the whole, and ${heavy} unless it is
 * NULL; bodies: map solids and boxes of those that are listed, when nobody needs those of the file
 * any more.  They do nothing where there is no map.  -1: MP_BAD_MAP.
 */
int mp_report_map_begin(const struct mp_request *request, struct mp_report *report,
			struct mp_error *err);
void mp_report_map_box(const struct mp_mesh *mesh, const struct mp_box *box,
		       struct mp_report *report);
void mp_report_map_whole(const struct mp_report *report, const struct mp_mesh *mesh,
			 const struct mp_box *box, struct mp_solid *whole, struct mp_solid *heavy);
void mp_report_map_bodies(const struct mp_report *report, const struct mp_mesh *mesh,
			  struct mp_bodies *bodies);
/* MP_BAD_CHECKS: checks=closed is for STL files; always -1. */
int mp_report_no_stream(struct mp_error *err);

/*
 * Volume, mass, inertia and the like of the whole, by report->topology.closed and cracks_only.
 * ${named}: all 0 where names have no densities.  ${*density}: what makes masses of volumes.
 * ${mesh} and ${box}, of the file, may be NULL where there is no map; else ${*whole} is mapped.
 * ${*later}: principal axes and bounds may be left to mp_report_certify(); becomes whether they
 * are.
 */
void mp_report_masses(const struct mp_request *request, const struct mp_mesh *mesh,
		      const struct mp_named *named, const struct mp_box *box,
		      struct mp_solid *whole, struct mp_density *density, bool *later,
		      struct mp_report *report);

/*
 * Principal axes of report->total, and the bounds of everything in it: they take as long as all
 * else for a small part, and exact numbers have their own.  ${heavy}: the whole by its mass.
 */
void mp_report_certify(const struct mp_solid *whole, const struct mp_solid *heavy,
		       const struct mp_density *density, struct mp_report *report);

/* Warnings that need no table. */
void mp_report_warn_file(struct mp_report *report);

/* The whole report of ${a} under checks=closed, but for what take_mesh() did. */
int mp_report_streamed(const struct mp_analysis *a, const struct mp_request *request,
		       struct mp_report *report, struct mp_error *err);

/*
 * report->overlaps, overlapping and, where the request asks for it, self, with their warnings;
 * before solid is judged, once the winding of the bodies is settled.  ${key}: secret.
 */
int mp_report_crossings(const struct mp_request *request, const struct mp_mesh *mesh,
			const struct mp_bodies *bodies, const uint8_t key[16],
			struct mp_report *report, struct mp_error *err);

/* What mp_report_certify() is still to be called for; ${solid} NULL: nothing. */
struct mp_report_later {
	const struct mp_solid *solid;
	const struct mp_density *density;
};

/* Exact numbers beside the certified ones; all 0 is ready. */
struct mp_report_exact {
	bool wanted;
	struct mp_exact_grid grid;
};

/*
 * Where the request wants it (or leaves it open and it costs less than a millisecond), put results
 * that are rounded once from exact numbers in the place of the certified ones of the whole, with
 * their bounds, and settle the winding of bodies whose volume could not be told from 0.  Before
 * verdicts are given.  The certified ones stay where names have densities of their own, where
 * some exact result is beyond the range of doubles, and for what is not closed; they are certified
 * then, where ${later} asks for it.
 * -1: memory is out.  Free ${x} with mp_report_exact_free(), after a failure too.
 */
int mp_report_exact_whole(struct mp_report_exact *x, const struct mp_request *request,
			  const struct mp_mesh *mesh, struct mp_bodies *bodies,
			  const struct mp_report_later *later, struct mp_report *report,
			  struct mp_error *err);

/* The same for the bodies, once they are listed. */
int mp_report_exact_bodies(const struct mp_report_exact *x, const struct mp_request *request,
			   const struct mp_mesh *mesh, const struct mp_bodies *bodies,
			   struct mp_report *report, struct mp_error *err);
void mp_report_exact_free(struct mp_report_exact *x);

/*
 * report->uncertainty.  begin: before mp_topology_find(), which state->watcher should watch; false
 * where it need not, and then ${state} is not set.  ${box}: in the file's frame.
 */
bool mp_report_uncertainty_begin(const struct mp_request *request, const struct mp_mesh *mesh,
				 const struct mp_box *box, const struct mp_moments *moments,
				 const struct mp_report *report,
				 struct mp_uncertainty_state *state);
/*
 * Once total, topology and density are there.  ${box}, ${stored}: of the whole, in the file's
 * frame. -1: memory is out.
 */
int mp_report_uncertainty(const struct mp_request *request, const struct mp_mesh *mesh,
			  const struct mp_box *box, const struct mp_solid *stored,
			  struct mp_uncertainty_state *state, struct mp_report *report,
			  struct mp_error *err);

#endif
