#ifndef MP_ANALYSIS_H
#define MP_ANALYSIS_H

#include "core/decoder.h"
#include "core/report/report.h"
#include "core/second.h"

/* The coordinator: bytes of one file in, report out. */

enum mp_format_wish { MP_WISH_AUTO, MP_WISH_STL, MP_WISH_OBJ, MP_WISH_DRACO };
enum mp_precision_wish { MP_WISH_PRECISION_AUTO, MP_WISH_CERTIFIED, MP_WISH_EXACT };
enum mp_checks_wish { MP_CHECKS_FULL, MP_CHECKS_CLOSED };
enum mp_density_kind { MP_DENSITY_NONE, MP_DENSITY_GIVEN, MP_DENSITY_FROM_MASS };

/* The density of the faces under a name; the numbers are as the request's density, density_divisor
 * and density_error. */
struct mp_named_density {
	const char
	    *name;  /* as in the file: material, or in files without them group, object, solid */
	size_t len; /* 1 to MP_NAME_MAX */
	double density, divisor, error;
};

enum { MP_MOST_NAMED = 1000 };

struct mp_request {
	enum mp_format_wish format;
	uint8_t key[16]; /* secret random bytes, fresh for every request: keys the hash tables */
	struct mp_limits limits;
	bool flip;
	bool orient; /* wind each body alike, and outward, or inward where it is a cavity */
	bool self_intersections; /* find them */
	double weld; /* [L] vertices nearer than this are one; 0: identical coordinates */
	/*
	 * CLOSED: STL only, else MP_BAD_CHECKS.  Nothing is kept of a triangle: memory does not
	 * grow with the file, limits.max_triangles does not apply, and the report has what can be
	 * said so.  No names with densities, no exact precision, no welding, no map.
	 */
	enum mp_checks_wish checks;
	enum mp_precision_wish precision; /* AUTO: exact where that costs under a millisecond */
	enum mp_density_kind density_kind;
	double density; /* GIVEN: [M/L^3] times density_divisor, FROM_MASS: the mass [M] */
	/*
	 * GIVEN: the density is density/density_divisor, kept apart so that units cost one
	 * rounding: mass = density*volume/divisor, inertia = density*(volume*...)/divisor (2700
	 * kg/m3 of a part in mm: 2700 and 1e9).  0 counts as 1.  FROM_MASS: not used.
	 */
	double density_divisor;
	double density_error; /* GIVEN: relative error of their quotient (change of units) */
	/*
	 * Densities of single names, all different; density_kind is then GIVEN, for all other
	 * faces, or NONE, if there are to be none.  Every name has to have faces that are a closed
	 * solid by themselves, else MP_BAD_NAME.  The caller's; only mp_analysis_report() reads it.
	 */
	const struct mp_named_density *named;
	uint32_t named_count; /* at most MP_MOST_NAMED */
	/*
	 * Rows of an affine map of the file's coordinates, the translation last.  Everything that
	 * the report measures or shows is of the mapped mesh; points and directions below are too.
	 * MP_BAD_MAP where it is singular or takes a vertex beyond the range of a double.
	 */
	bool has_transform;
	double transform[3][4];
	bool has_about, has_axis;
	double about[3];
	double axis_origin[3], axis_direction[3]; /* direction: any length > 0 */
	uint32_t bodies, defects;                 /* how many to list (defects: of each kind) */
	/* NULL, or who shares the work of large meshes; the caller's, until mp_analysis_free() */
	const struct mp_second *second;
};

struct mp_analysis;

/* NULL with ${err} filled. ${request} is copied. */
struct mp_analysis *mp_analysis_new(const struct mp_request *request, struct mp_error *err);

/* Take the next ${len} bytes of the file.  -1: only mp_analysis_free() is legal afterwards. */
int mp_analysis_push(struct mp_analysis *, const uint8_t *bytes, size_t len, struct mp_error *err);

/*
 * The file is over and another one follows, whose triangles belong to the same mesh; they are
 * numbered on.  Its format is found anew (unless the request forces one).  Every file has to hold
 * a triangle.  -1: only mp_analysis_free() is legal afterwards; the error is about the file that
 * ends, but for MP_NOMEM.
 */
int mp_analysis_next(struct mp_analysis *, struct mp_error *err);

/* The last file is over: end decoding.  Call before mp_analysis_report(). */
int mp_analysis_end(struct mp_analysis *, struct mp_error *err);

/*
 * What the mesh is: fills ${out}, which then owns its arrays until mp_report_free().
 * ${request} may differ from the one at the beginning in everything but format, key and limits
 * (options may follow the file in a form), and it may ask for fewer checks, never for more.
 */
int mp_analysis_report(struct mp_analysis *, const struct mp_request *request,
		       struct mp_report *out, struct mp_error *err);

/*
 * For problems with names: the name by which the density of triangle ${t} is found, ${*len} raw
 * bytes of the file, or "" where it has none; ${other}: the name that counts where that one has no
 * density.  ${*end}: the first triangle behind ${t} with another name, or the number of triangles.
 * Legal when the last file has ended; valid until mp_analysis_free().
 */
const char *mp_analysis_name(const struct mp_analysis *, uint64_t t, bool other, size_t *len,
			     uint64_t *end);

/*
 * Whether another project's decoder has read bytes of the uploader's, with or without success: this
 * process may be damaged where nothing shows it.  Takes NULL.
 */
bool mp_analysis_met_foreign_code(const struct mp_analysis *);

void mp_analysis_free(struct mp_analysis *); /* takes NULL */
void mp_report_free(struct mp_report *);     /* legal on a zeroed struct */

#endif
