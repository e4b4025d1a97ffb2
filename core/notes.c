#include "core/notes.h"

void mp_notes_add(struct mp_notes *sum, const struct mp_notes *file)
{
	if (sum->format == MP_FORMAT_UNKNOWN) {
		*sum = *file;
		return;
	}
	if (sum->format != file->format)
		sum->format = MP_FORMAT_MIXED;
	sum->bytes += file->bytes;
	sum->triangles += file->triangles;
	sum->polygons += file->polygons;
	if (sum->parts < file->parts)
		sum->parts = file->parts;
	sum->normals_disagreeing += file->normals_disagreeing;
	sum->normals_not_finite += file->normals_not_finite;
	sum->trailing_bytes += file->trailing_bytes;
	sum->missing_endsolid += file->missing_endsolid;
	sum->nonstandard_lines += file->nonstandard_lines;
	sum->vertices_in_file += file->vertices_in_file;
	sum->points += file->points;
	sum->lines += file->lines;
	sum->nonplanar_polygons += file->nonplanar_polygons;
	sum->tangled_polygons += file->tangled_polygons;
	sum->nul_bytes += file->nul_bytes;
	if (sum->quantisation_step < file->quantisation_step)
		sum->quantisation_step = file->quantisation_step;
	if (sum->rounding != file->rounding)
		sum->rounding = MP_ROUNDING_UNKNOWN;
	sum->foreign_code |= file->foreign_code;
}
