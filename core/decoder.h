#ifndef MP_DECODER_H
#define MP_DECODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"

/*
 * Decoders are pushed: bytes go in as they arrive, blocks of triangles come out.  A chunk may end
 * anywhere, even inside a number, and neither the triangles nor the block boundaries show where.
 */

enum mp_format {
	MP_FORMAT_UNKNOWN = 0,
	MP_FORMAT_STL_BINARY,
	MP_FORMAT_STL_ASCII,
	MP_FORMAT_OBJ,
	MP_FORMAT_DRACO,
	MP_FORMAT_MIXED /* of several files; no decoder says so */
};

/* What the format does to every coordinate that is written to it. */
enum mp_rounding {
	MP_ROUNDING_UNKNOWN = 0, /* text: how many digits count is not said; or not found out */
	MP_ROUNDING_FLOAT32,     /* to the nearest float32 */
	MP_ROUNDING_QUANTISED    /* to the nearest multiple of quantisation_step, then to float32 */
};

enum { MP_BLOCK = 256 }; /* triangles in every block but the last */

/* Three finite float32 each, point i at data + i * stride, of any alignment. */
struct mp_points {
	const unsigned char *data;
	size_t stride, count;
};

/*
 * Where triangles go.  Each triangle is 9 finite doubles ax ay az bx by bz cx cy cz in file units,
 * in file order, wound as in the file.  Every block but the last has MP_BLOCK triangles.
 * Return 0, or -1 with the error filled; the decoder then stops with that error.
 */
struct mp_sink {
	int (*block)(void *self, const double (*tri)[9], size_t count, struct mp_error *err);
	/*
	 * Triangles numbered ${first} and above (0-based, over the whole file) belong to the named
	 * part (STL solid; OBJ group, where there is none the object); ${name} is raw file bytes,
	 * not terminated, not necessarily UTF-8, at most MP_NAME_MAX long (cut by the decoder).
	 * Calls come in order of ${first}; a later call for the same ${first} replaces the former.
	 * May be NULL.
	 */
	int (*part)(void *self, uint64_t first, const char *name, size_t len, struct mp_error *err);
	void *self;
	/*
	 * The same triangles as the block() or floats() that follows, by the file's own vertex
	 * numbers (Draco: of the POSITION value); formats that number no vertices never call it.
	 * A number has one place in the file, and the largest is less than the number of places in
	 * it.  ${tri} stays good until that call has returned.  May be NULL.
	 */
	int (*indices)(void *self, const uint32_t (*tri)[3], size_t count, struct mp_error *err);
	/* As part(), but of the material (OBJ usemtl), which parts do not end.  May be NULL. */
	int (*material)(void *self, uint64_t first, const char *name, size_t len,
			struct mp_error *err);
	/* As part(), but of the object alone (OBJ o), whatever groups it has.  May be NULL. */
	int (*object)(void *self, uint64_t first, const char *name, size_t len,
		      struct mp_error *err);
	/*
	 * The same as block(), for files of float32 (binary STL, Draco), which call it instead
	 * unless it is NULL: coordinate k of triangle i is xyz[k][i], as it lies in the file.
	 */
	int (*floats)(void *self, const float (*xyz)[MP_BLOCK], size_t count, struct mp_error *err);
	/*
	 * So many triangles are in memory and about to come as floats(), and indices() will name
	 * ${points}: all that can be done with them at once.  Called before the first block, by
	 * formats that know, and never for another file's; ${points} is gone when it returns.  May
	 * be NULL.
	 */
	void (*expect)(void *self, uint64_t triangles, const struct mp_points *points);
};

enum { MP_NAME_MAX = 255 };

struct mp_limits {
	uint64_t max_triangles; /* more is MP_LIMIT, judged by what has come, never by a header */
};

/* What a decoder noticed beside the triangles; valid after finish() returned 0. */
struct mp_notes {
	enum mp_format format;
	uint64_t bytes;               /* of the file, all that was pushed */
	uint64_t triangles;           /* sent to the sink */
	uint64_t polygons;            /* faces of the file with more than 3 corners */
	uint64_t parts;               /* STL: solids in the file (binary: 1) */
	uint64_t normals_disagreeing; /* stored normal with a negative product with the winding */
	uint64_t normals_not_finite;  /* stored normal NaN or infinite (ignored) */
	uint64_t trailing_bytes;      /* bytes behind the last triangle that were passed over */
	uint64_t missing_endsolid;    /* ASCII STL: solids that were not ended */
	uint64_t nonstandard_lines;   /* text passed over that the format does not know */
	uint64_t vertices_in_file;    /* OBJ: v statements */
	uint64_t points, lines;       /* OBJ: p and l statements, passed over */
	uint64_t nonplanar_polygons;  /* not flat: the surface hangs on how they are split */
	uint64_t tangled_polygons;    /* crossing themselves: their area is off */
	uint64_t nul_bytes;           /* OBJ: NUL and Ctrl-Z characters at the end */
	double quantisation_step; /* [L] of the coordinates; 0: none, or (Draco 1.x) not known */
	enum mp_rounding rounding;
	bool foreign_code; /* another project's decoder read the bytes, maybe in vain */
};

struct mp_decoder_ops {
	const char *name;
	/*
	 * Begin a file.  ${*state} owns everything; ${sink}, ${limits} and ${notes} are kept by
	 * pointer and must outlive it.  Only end() is legal after any call returned -1.
	 */
	int (*begin)(void **state, const struct mp_sink *sink, const struct mp_limits *limits,
		     struct mp_notes *notes, struct mp_error *err);
	/* Take ${len} bytes; keeps no pointer to them.  Never says MP_TRUNCATED. */
	int (*push)(void *state, const uint8_t *chunk, size_t len, struct mp_error *err);
	/* The file is over: flush the last block or say what is missing. */
	int (*finish)(void *state, struct mp_error *err);
	void (*end)(void *state); /* takes NULL */
};

extern const struct mp_decoder_ops mp_stl_decoder;   /* binary or ASCII, found from the bytes */
extern const struct mp_decoder_ops mp_obj_decoder;   /* polygons; no free-form surfaces */
extern const struct mp_decoder_ops mp_draco_decoder; /* meshes of bitstreams 1.0 to 2.2 */

#endif
