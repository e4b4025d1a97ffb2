#include "api/warnings.h"

enum { UNIT_ASSUMED = MP_WARNINGS, ATTACHMENT_IGNORED, WARNINGS };

static const struct api_warning rows[WARNINGS] = {
    [MP_WARN_OPEN] =
	{"open_mesh",
	 "The surface has holes, so it encloses no volume: volume, mass, centroid and "
	 "inertia are not given. Close the holes (checks and defects say where they are) "
	 "and send the file again. volume_if_capped, where it is given, is the volume with "
	 "the holes closed by flat fans: exact for flat holes, else an estimate, and the "
	 "rougher the larger cap_area is beside surface_area."},
    [MP_WARN_CRACKS] =
	{"cracks", "The surface is open only along cracks of no width, where an edge meets a "
		   "vertex in its middle. Volume, mass, centroid and inertia are not affected."},
    [MP_WARN_WINDING] =
	{"inconsistent_winding",
	 "Some neighbouring triangles face opposite ways, or some occur more than once, so inside "
	 "and outside cannot be told apart: volume, mass, centroid and inertia are not given. Send "
	 "orient=fix, or make all normals point outward and send the file again."},
    [MP_WARN_NON_MANIFOLD] =
	{"non_manifold_edges",
	 "Some edges are shared by more than two triangles, as where two parts "
	 "touch along an edge. The volume does not depend on it, but other programs "
	 "may refuse the part."},
    [MP_WARN_NON_MANIFOLD_VERTEX] =
	{"non_manifold_vertices",
	 "Some parts of the surface touch in a single point. The numbers do "
	 "not depend on it, but other programs may refuse the part."},
    [MP_WARN_INSIDE_OUT] =
	{"inside_out", "The surface is closed but inside out. The numbers are those of the solid "
		       "it means; signed_volume is negative. Reverse the normals, or send "
		       "flip=true."},
    [MP_WARN_MIXED_BODIES] =
	{"mixed_bodies", "Some bodies are wound outward and others inward where they should not "
			 "be, so that their volumes are partly added and partly subtracted. Check "
			 "volume and mass body by body."},
    [MP_WARN_CAVITY_OUTWARD] =
	{"cavity_outward", "A body lies inside another and is wound outward, so its volume counts "
			   "twice. If it is a cavity, reverse it: volume and mass are too large."},
    [MP_WARN_ZERO_VOLUME] = {"zero_volume",
			     "The surface is closed but encloses no volume, as a flat part or one "
			     "drawn with both sides does: centroid and inertia are not given."},
    [MP_WARN_OUT_OF_RANGE] = {"out_of_range",
			      "Some result is too large or too small for a double-precision number "
			      "and is given as null. A coarser or finer unit may help."},
    [MP_WARN_DEGENERATE] = {"degenerate_triangles",
			    "Some triangles have no area. They add nothing to area, volume or "
			    "inertia."},
    [MP_WARN_DUPLICATE] =
	{"duplicate_triangles",
	 "Some triangles occur more than once. Each counts as often as it occurs, "
	 "in the surface area too."},
    [MP_WARN_NORMALS] =
	{"normals_disagreeing",
	 "Some normals stored in the file point the other way than the order of the "
	 "corners says. The stored normals are not used; the order of the corners "
	 "decides."},
    [MP_WARN_TRAILING_BYTES] =
	{"trailing_bytes", "There are bytes behind the last triangle. They were passed over; all "
			   "triangles that the file announces are there."},
    [MP_WARN_MISSING_END] =
	{"missing_endsolid",
	 "The file does not end as it should (endsolid is missing). If it was cut "
	 "off, triangles may be missing: see whether the mesh is closed."},
    [MP_WARN_NONSTANDARD] = {"nonstandard_lines",
			     "Some lines do not belong to the format and were passed over. If they "
			     "were meant to be geometry, it is missing here."},
    [MP_WARN_SEVERAL_SOLIDS] =
	{"several_solids", "The file holds several solids. They are taken together as one part; "
			   "the list of bodies, if any, has their separate figures."},
    [MP_WARN_NESTING_UNDECIDED] =
	{"nesting_undecided", "It was not decided which bodies lie inside which, so it is not "
			      "known whether some volume counts twice. Each body's own figures do "
			      "not depend on it."},
    [MP_WARN_DEFECTS_TRUNCATED] =
	{"defects_truncated", "There are more defects than are listed. The counts under checks are "
			      "complete; ask for more with the option defects."},
    [MP_WARN_NAME_AGAINST] =
	{"named_against",
	 "Some of the solids that have densities by name are wound outward and others inward. "
	 "Each weighs as the solid it means, but their volumes are partly subtracted: turn those "
	 "that are inside out."},
    [MP_WARN_NONPLANAR] = {"nonplanar_polygons", "Some polygons are not flat, so their surface "
						 "depends on the diagonals along which they are "
						 "split into triangles. Other programs may choose "
						 "others, with a slightly different volume and "
						 "area. Send triangles if that matters."},
    [MP_WARN_TANGLED] =
	{"tangled_polygons",
	 "Some polygons cross themselves. The surface area is too large for them; the volume is "
	 "not "
	 "affected if they are flat. Split them into simple polygons and send the file again."},
    [MP_WARN_NUL_BYTES] =
	{"nul_bytes", "The file ends with NUL characters, as some programs write them. They were "
		      "passed over."},
    [MP_WARN_NEARLY_CLOSED] =
	{"nearly_closed",
	 "The surface is open only because corners that should meet are apart by what rounding to "
	 "single precision does. Send weld= with the number in checks.closes_at_tolerance: the "
	 "surface is then closed, and volume, mass, centroid and inertia are given."},
    [MP_WARN_NON_ORIENTABLE] =
	{"non_orientable",
	 "Some bodies have only one side, as a Moebius strip or a Klein bottle has: nothing is "
	 "inside or outside of them and no winding of them is consistent. orient=fix leaves them "
	 "as they are. They are marked in the list of bodies."},
    [MP_WARN_WELD_UNDECIDED] =
	{"weld_undecided",
	 "There are so many places at nearly the weld distance from each other that not all were "
	 "compared: some that are nearer may be apart still. Choose a smaller or a larger weld."},
    [MP_WARN_INTERNAL_WALLS] =
	{"internal_walls",
	 "Walls of no thickness divide the inside or span an opening. A double wall (each "
	 "triangle there twice, once each way round) cancels: the volume is right, the surface "
	 "area counts both sides. A single wall leaves edges with an odd number of triangles: the "
	 "mesh is not closed, and volume, mass, centroid and inertia are not given until it is "
	 "removed."},
    [MP_WARN_OVERLAPPING] =
	{"overlapping_bodies",
	 "Some bodies overlap: their surfaces pass through each other, or they fill the same "
	 "space. Space that they have in common counts once for each of them, so volume and mass "
	 "are too large. Unite the bodies and send the file again."},
    [MP_WARN_OVERLAP_UNDECIDED] =
	{"overlap_undecided",
	 "It was not decided of all bodies whether they overlap: open ones cross others, surfaces "
	 "that touch themselves lie on others, or there are too many places to look at. Where "
	 "bodies overlap, their common space counts more than once."},
    [MP_WARN_SELF_INTERSECTING] =
	{"self_intersecting",
	 "Some triangles pass through each other or lie on each other. Where the surface overlaps "
	 "itself, the space counts twice, so volume and mass are too large; where faces only lie "
	 "on each other, they are right. Other programs may refuse the part."},
    [MP_WARN_SELF_UNDECIDED] = {"self_intersections_undecided",
				"So many triangles are near each other that not all pairs were "
				"compared: how many intersect is not known. Those listed do."},
    [MP_WARN_NOT_CLOSED] =
	{"not_closed", "The surface has holes, or its winding is not consistent: volume, mass, "
		       "centroid and inertia are not given. Send the file again with checks=full "
		       "to see where, and whether these are only cracks of no width."},
    [UNIT_ASSUMED] =
	{"unit_assumed",
	 "No unit was given and the file does not say one, so its numbers were taken as "
	 "millimetres. If they are inches, send unit=in: otherwise the mass is wrong by a "
	 "factor of 16387."},
    [ATTACHMENT_IGNORED] =
	{"attachment_ignored",
	 "Some files of the form are materials or pictures by their names or media types. "
	 "They were passed over: nothing here depends on them."},
};

const struct api_warning *api_warning_row(size_t i)
{
	return i < WARNINGS ? &rows[i] : NULL;
}

bool api_warning_applies(size_t i, const struct mp_report *report,
			 const struct api_options *options, bool lists_cut)
{
	if (i == UNIT_ASSUMED)
		return !options->unit_given;
	if (i == ATTACHMENT_IGNORED)
		return options->sent.attachment;
	if (i == MP_WARN_DEFECTS_TRUNCATED && lists_cut)
		return true;
	return i < MP_WARNINGS && MP_WARNED(report, i);
}
