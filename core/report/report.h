#ifndef MP_REPORT_H
#define MP_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/affine/affine.h"
#include "core/bodies/nesting.h"
#include "core/decoder.h"
#include "core/intersect/intersect.h"
#include "core/moments/facet.h"
#include "core/moments/principal.h"
#include "core/moments/uncertainty.h"
#include "core/topology/index.h"
#include "core/topology/topology.h"

/* Lengths are in the file's unit L throughout; masses in the unit M that the density implies. */

enum mp_orientation {
	MP_ORIENTATION_NONE,    /* not closed, or flat */
	MP_ORIENTATION_OUTWARD, /* every body is wound as its nesting depth wants */
	MP_ORIENTATION_INWARD,  /* every body the other way */
	MP_ORIENTATION_MIXED
};

enum mp_truth { MP_NO, MP_YES, MP_UNDECIDED };

/* What the client should know beside the numbers; stable; api/ gives each its code and sentence. */
enum mp_warning {
	MP_WARN_OPEN,                /* volume undefined: boundary */
	MP_WARN_CRACKS,              /* open only along zero-area cracks; the volume is exact */
	MP_WARN_WINDING,             /* volume undefined: winding is not consistent */
	MP_WARN_NON_MANIFOLD,        /* edges used more than twice */
	MP_WARN_NON_MANIFOLD_VERTEX, /* fans that only share a vertex */
	MP_WARN_INSIDE_OUT,          /* closed, wound inward; answered as the solid it means */
	MP_WARN_MIXED_BODIES,        /* bodies wound against each other or their depth */
	MP_WARN_CAVITY_OUTWARD,      /* a body inside another counts twice, not as a hole */
	MP_WARN_ZERO_VOLUME,         /* closed, volume 0 */
	MP_WARN_OUT_OF_RANGE,        /* a result exceeds the range of a double */
	MP_WARN_DEGENERATE,          /* triangles of zero area */
	MP_WARN_DUPLICATE,           /* triangles that repeat another's corners */
	MP_WARN_NORMALS,             /* stored normals contradict the winding */
	MP_WARN_TRAILING_BYTES,      /* bytes behind the last facet passed over */
	MP_WARN_MISSING_END,         /* ASCII STL without endsolid */
	MP_WARN_NONSTANDARD,         /* lines passed over */
	MP_WARN_SEVERAL_SOLIDS,      /* the file holds several solids; they are one mesh here */
	MP_WARN_NESTING_UNDECIDED,   /* depth of some body is not decided */
	MP_WARN_DEFECTS_TRUNCATED,   /* more defects than were listed */
	MP_WARN_NAME_AGAINST,        /* named densities: solids wound against each other */
	MP_WARN_NONPLANAR,           /* polygons that are not flat */
	MP_WARN_TANGLED,             /* polygons that cross themselves: the area is off */
	MP_WARN_NUL_BYTES,           /* text that ends with NUL characters */
	MP_WARN_NEARLY_CLOSED,       /* open, but watertight when welded at what rounding does */
	MP_WARN_NON_ORIENTABLE,      /* some bodies have one side only */
	MP_WARN_WELD_UNDECIDED,      /* some vertices nearer than weld may be apart still */
	MP_WARN_INTERNAL_WALLS,      /* walls of no thickness, double or single */
	MP_WARN_OVERLAPPING,         /* bodies overlap: their common space counts twice */
	MP_WARN_OVERLAP_UNDECIDED,   /* it is not known whether others do */
	MP_WARN_SELF_INTERSECTING,   /* triangles intersect */
	MP_WARN_SELF_UNDECIDED,      /* it is not known how many do */
	MP_WARN_NOT_CLOSED,          /* checks=closed: volume undefined, the place is not known */
	MP_WARNINGS
};

/*
 * Of a body or of the whole.  A field means something where its flag says so and is 0 elsewhere;
 * nothing here is ever infinite or NaN: a result that no double can hold (above DBL_MAX, or not 0
 * and below DBL_MIN) is not defined and MP_WARN_OUT_OF_RANGE is raised.
 */
struct mp_mass {
	double volume;         /* signed [L^3] */
	double area;           /* [L^2] */
	double mass;           /* [M], or [L^3] without a density; >= 0 */
	double centroid[3];    /* [L]; of the mass where names have densities */
	double inertia[3][3];  /* about the centroid [M L^2], or [L^5] without a density */
	bool volume_defined;   /* closed, or open only along zero-area cracks */
	bool area_defined;     /* always, but for the range of a double */
	bool mass_defined;     /* the volume is defined, and so is the density if one was asked */
	bool centroid_defined; /* closed as above and the volume is not 0 */
	bool inertia_defined;  /* as the centroid, with the density if one was asked */
};

struct mp_body {
	uint32_t first, triangles;
	struct mp_mass mass;
	struct mp_box box;
	bool watertight;
	int64_t genus;   /* -1: it is not closed, manifold and orientable */
	bool orientable; /* it has two sides, whether or not it is wound consistently */
	enum mp_orientation orientation; /* of its own winding: OUTWARD = volume > 0; never MIXED */
	struct mp_nest nest;
	bool cavity;      /* inward and inside another */
	const char *name; /* raw bytes of the file, NULL for none; owned by the report */
	size_t name_len;
};

struct mp_axis_moment {
	double origin[3], direction[3]; /* direction: unit */
	double moment, radius_of_gyration;
	bool radius_defined; /* false where the moment is negative: bodies of mixed winding */
};

/* How the sums were formed. */
enum mp_precision {
	MP_PRECISION_CERTIFIED, /* in doubles, with a running error bound */
	MP_PRECISION_EXACT      /* in integers or fractions; every result is rounded once */
};

/*
 * Each result is at most this far from the exact value of the mesh as stored: rigorous bounds, not
 * estimates, in the unit of the result; of several numbers the largest.  0 where the result is not
 * defined; may be infinite where next to nothing is known.
 */
struct mp_bounds {
	double volume, area, mass;
	double centroid;       /* of each coordinate */
	double inertia;        /* of each element of the tensor about the centroid */
	double inertia_origin; /* the same about the origin */
	double moments, radii;
	/*
	 * [rad] Between the line along an axis and that of the exact axis.  Axial: of the axis that
	 * stands alone, the others being chosen; spherical: a quarter turn, all are.
	 */
	double axes;
};

/* An open mesh with its holes closed by fans, see core/report/capped.h. */
struct mp_capped {
	double volume, area; /* >= 0, as though outward [L^3]; the area of the fans alone [L^2] */
	bool volume_defined, area_defined;
};

struct mp_report {
	struct mp_notes notes;
	/*
	 * checks=closed: there are no vertices, triangles and bodies; of the topology only closed
	 * and degenerate_triangles are known; OUTWARD and INWARD are the sign of the whole volume,
	 * and NONE with closed means that the sign is not known.
	 */
	bool streamed;
	/* As in the file, whatever the request's map; mp_report_vertex() shows them. */
	struct mp_vertices *vertices;
	uint32_t (*tri)[3];
	uint32_t triangles;
	/*
	 * The request's map, unless it changes nothing.  If it mirrors, corners b and c of every
	 * triangle change places in the mapped frame.
	 */
	bool mapped;
	struct mp_affine map;
	struct mp_topology topology;
	struct mp_by_index by_index;
	struct mp_box box;

	enum mp_orientation orientation;
	enum mp_truth solid;
	enum mp_truth overlapping;    /* MP_YES: some bodies do, maybe more than overlaps has */
	struct mp_crossings overlaps; /* pairs of bodies, located by two triangles of theirs */
	struct mp_crossings self;     /* pairs of triangles; where the request asks */
	struct mp_capped capped;
	double closure_defect[3]; /* the mesh's vector area, sum of n/2 [L^2]; 0 if closed */

	struct mp_mass total; /* total.volume is signed, total.mass is not */
	double surface_centroid[3];
	bool surface_centroid_defined; /* area > 0 */
	bool has_density;
	/*
	 * [M/L^3]: given, or mass over volume where the mass was weighed or names have densities
	 * of their own; meaningful if has_density.
	 */
	double density;
	bool density_defined; /* mass over volume needs a defined volume */
	double inertia_origin[3][3];
	double inertia_about[3][3];    /* about the request's point */
	struct mp_axis_moment axis;    /* about the request's axis */
	struct mp_principal principal; /* defined where total.inertia is */
	double radii_of_gyration[3];
	enum mp_precision precision;
	struct mp_bounds bounds;
	struct mp_uncertainty uncertainty;
	bool inertia_origin_defined;
	bool inertia_about_defined, axis_defined; /* false too where the request did not ask */
	bool radii_defined; /* false where a moment is negative: bodies of mixed winding */

	struct mp_body *body; /* the first ${bodies_listed} */
	uint32_t bodies_listed;
	char *names;                /* what body[].name points into */
	double closes_at_tolerance; /* [L] 1 or 4 float32 ulp of the largest |coordinate|; 0: no */
	double volume_if_oriented;  /* [L^3] that there would be if the winding was repaired */
	bool volume_if_oriented_defined;
	/* wound the other way than in the file: flip, orient; not what a map mirrors */
	uint64_t flipped_triangles;
	uint64_t welded_vertices;   /* no longer used, as others have taken their place */
	bool repaired;              /* the mesh is not the file's: welded or oriented */
	uint64_t warnings;          /* bit 1 << enum mp_warning */
	double decode_s, analyse_s; /* 0: core reads no clock; the caller fills these */
};

/* Coordinates of vertex ${number} as the report shows them: mapped. */
void mp_report_vertex(const struct mp_report *report, uint32_t number, double xyz[3]);

/* Triangle ${t} by itself, as the report shows it: flipped, mapped. */
void mp_report_facet(const struct mp_report *report, uint32_t t, struct mp_facet *out);

#define MP_WARNED(report, w) (((report)->warnings >> (w)) & 1u)

static inline void mp_warn(struct mp_report *report, enum mp_warning w, bool when)
{
	report->warnings |= (uint64_t)when << w;
}

#endif
