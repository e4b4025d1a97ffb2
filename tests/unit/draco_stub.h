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
	uint32_t (*face)[3]; /* exactly as many as it says */
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

static inline struct mp_draco_mesh *draco_stub_mesh(void)
{
	size_t faces = (size_t)draco_stub.shape.faces;
	struct mp_draco_mesh *m = malloc(sizeof *m);

	if (m == NULL)
		return NULL;
	m->face = malloc(faces > 0 ? faces * sizeof *m->face : 1);
	if (m->face == NULL) {
		free(m);
		return NULL;
	}
	for (size_t i = 0; i < faces; i++)
		memcpy(m->face[i], draco_stub.face[i % draco_stub.face_count], sizeof m->face[i]);
	return m;
}

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
	*out = draco_stub_mesh();
	if (*out == NULL)
		return MP_DRACO_NO_MEMORY;
	draco_stub.alive++;
	return MP_DRACO_DECODED;
}

const uint32_t (*mp_draco_faces(const struct mp_draco_mesh *mesh))[3]
{
	return (const uint32_t(*)[3])mesh->face;
}

bool mp_draco_values(const struct mp_draco_mesh *mesh, const uint32_t (*point)[3], size_t count,
		     uint32_t (*value)[3])
{
	(void)mesh;
	for (size_t i = 0; i < 3 * count; i++)
		if (point[i / 3][i % 3] >= draco_stub.shape.mapped)
			draco_stub.wrong = true;
		else if (draco_stub.value != NULL)
			value[i / 3][i % 3] = draco_stub.value[point[i / 3][i % 3]];
	return draco_stub.value != NULL;
}

void mp_draco_free(struct mp_draco_mesh *mesh)
{
	draco_stub.alive -= mesh != NULL;
	if (mesh != NULL)
		free(mesh->face);
	free(mesh);
}

#endif
