#ifndef DRACO_STUB_H
#define DRACO_STUB_H

/*
 * In the place of libdraco: delivers what a test put into draco_stub, however wrong, and notes
 * whether it was asked for what it said it does not have.  The linker then leaves draco_wrap out.
 */

#include <stdlib.h>
#include <string.h>

#include "core/draco/draco_wrap.h"

struct mp_draco_mesh {
	char nothing;
};

static struct draco_stub {
	enum mp_draco_verdict verdict;
	struct mp_draco_shape shape;
	const char *why;
	const uint32_t (*face)[3]; /* repeated when they run out */
	size_t face_count;
	const uint32_t *value; /* of ${shape.mapped} points; NULL: the point's number */
	bool wrong;
	size_t alive; /* meshes */
} draco_stub;

enum mp_draco_verdict mp_draco_decode(const uint8_t *file, size_t len, struct mp_draco_mesh **out,
				      struct mp_draco_shape *shape, char *why, size_t room)
{
	(void)file;
	*out = NULL;
	memset(shape, 0, sizeof *shape);
	why[0] = '\0';
	if (draco_stub.why != NULL && strlen(draco_stub.why) < room)
		strcpy(why, draco_stub.why); /* NOLINT: it fits */
	if (draco_stub.verdict != MP_DRACO_DECODED)
		return draco_stub.verdict;
	*shape = draco_stub.shape;
	if (shape->used > len)
		shape->used = len;
	*out = malloc(sizeof **out);
	if (*out == NULL)
		return MP_DRACO_NO_MEMORY;
	draco_stub.alive++;
	return MP_DRACO_DECODED;
}

void mp_draco_faces(const struct mp_draco_mesh *mesh, uint64_t first, size_t count,
		    uint32_t (*point)[3])
{
	(void)mesh;
	if (count > draco_stub.shape.faces || first > draco_stub.shape.faces - count)
		draco_stub.wrong = true;
	for (size_t i = 0; i < count; i++)
		memcpy(point[i], draco_stub.face[(first + i) % draco_stub.face_count],
		       sizeof point[i]);
}

void mp_draco_values(const struct mp_draco_mesh *mesh, uint32_t *point, size_t count)
{
	(void)mesh;
	for (size_t i = 0; i < count; i++) {
		if (point[i] >= draco_stub.shape.mapped)
			draco_stub.wrong = true;
		else if (draco_stub.value != NULL)
			point[i] = draco_stub.value[point[i]];
	}
}

void mp_draco_free(struct mp_draco_mesh *mesh)
{
	draco_stub.alive -= mesh != NULL;
	free(mesh);
}

#endif
