#ifndef MP_DRACO_WRAP_H
#define MP_DRACO_WRAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Draco's decoder (libdraco) as C.  No exception leaves it and it prints nothing, but that is all:
 * on hostile bytes libdraco can read or write out of bounds, run for minutes, take all the memory
 * it gets, and call success what holds indices out of range.  So the process it runs in must have
 * limits and must not serve anybody else afterwards, and every number below is the file's claim,
 * for the caller to check.
 */

#ifdef __cplusplus
extern "C" {
#endif

enum mp_draco_type { /* of a coordinate */
		     MP_DRACO_OTHER = 0,
		     MP_DRACO_INT8,
		     MP_DRACO_UINT8,
		     MP_DRACO_INT16,
		     MP_DRACO_UINT16,
		     MP_DRACO_INT32,
		     MP_DRACO_UINT32,
		     MP_DRACO_FLOAT32,
		     MP_DRACO_FLOAT64
};

struct mp_draco_shape {
	uint64_t faces;  /* triangles, each of three points */
	uint64_t points; /* a point has one value of every attribute */
	uint64_t used;   /* bytes of the file that were read */

	bool has_positions;      /* the rest is about the first attribute of the type POSITION */
	bool normalised;         /* integers stand for 0 to 1 or -1 to 1 */
	enum mp_draco_type type; /* as delivered: floats where the file has quantised ones */
	unsigned components;
	double step;         /* between neighbouring quantised coordinates, 0: not quantised */
	uint64_t values;     /* how many */
	uint64_t mapped;     /* points whose value is known; all of them where value = point */
	const uint8_t *data; /* of ${size} bytes; value v at offset + v * stride, native order */
	uint64_t size, offset, stride;
};

enum mp_draco_verdict {
	MP_DRACO_DECODED,
	MP_DRACO_REFUSED,
	MP_DRACO_NO_MEMORY /* or a size that no memory could hold */
};

struct mp_draco_mesh;

/*
 * Decode ${len} bytes of ${file}, which libdraco needs no longer afterwards.  DECODED: fills
 * ${out}, for mp_draco_free(), and ${shape}, whose data lives as long.  Else ${out} is NULL and
 * ${why} (of ${room} bytes) says what libdraco did not like: a clause in printable ASCII, maybe "".
 */
enum mp_draco_verdict mp_draco_decode(const uint8_t *file, size_t len, struct mp_draco_mesh **out,
				      struct mp_draco_shape *shape, char *why, size_t room);

/* The three points of each face, in order; good as long as the mesh. */
const uint32_t (*mp_draco_faces(const struct mp_draco_mesh *mesh))[3];

/*
 * The position values of ${count} triples of points, each < mapped.  False, with nothing written:
 * a point has the value of its own number.
 */
bool mp_draco_values(const struct mp_draco_mesh *mesh, const uint32_t (*point)[3], size_t count,
		     uint32_t (*value)[3]);

void mp_draco_free(struct mp_draco_mesh *mesh); /* takes NULL */

#ifdef __cplusplus
}
#endif

#endif
