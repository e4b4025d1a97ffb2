#include <stdlib.h>
#include <string.h>

#include "core/bodies/bodies.h"

/* The part of body ${i}, or where it has several their object, or else its material. */
static const char *find_name(const struct mp_bodies *b, uint32_t i, const struct mp_names *names,
			     size_t *len)
{
	const struct mp_parts *const from[] = {&names->parts, &names->objects, &names->materials};
	const uint32_t *tri = mp_bodies_order(b, i);
	const char *name = NULL;

	for (size_t k = 0; k < 3 && name == NULL; k++)
		name = mp_parts_name(from[k], tri, b->start[i + 1] - b->start[i], len);
	return name;
}

/* Names are copied behind each other; body[].name is set when the pool no longer moves. */
static int copy_names(const struct mp_bodies *b, const struct mp_names *names, struct mp_report *r,
		      struct mp_error *err)
{
	size_t size = 0, len, at = 0;

	for (uint32_t i = 0; i < r->bodies_listed; i++) {
		(void)find_name(b, i, names, &len);
		size += len;
	}
	if (size == 0)
		return 0;
	r->names = malloc(size);
	if (r->names == NULL)
		return mp_fail_nomem(err);
	for (uint32_t i = 0; i < r->bodies_listed; i++) {
		const char *name = find_name(b, i, names, &len);

		if (name == NULL)
			continue;
		memcpy(r->names + at, name, len);
		r->body[i].name = r->names + at;
		r->body[i].name_len = len;
		at += len;
	}
	return 0;
}

static void fill(const struct mp_bodies *b, uint32_t i, const struct mp_density *density,
		 const struct mp_named *named, struct mp_report *r)
{
	const struct mp_body_topology *t = &r->topology.body[i];
	struct mp_density own = named->count > 0 ? mp_named_density_of(named, i) : *density;
	struct mp_body *body = &r->body[i];
	bool fits = mp_mass_fill(&body->mass, &b->solid[i], mp_body_has_volume(t), &own);

	mp_warn(r, MP_WARN_OUT_OF_RANGE, !fits);
	body->first = t->first;
	body->triangles = t->triangles;
	body->box = b->box[i];
	body->watertight = t->watertight;
	body->orientable = !t->one_sided;
	body->genus = mp_body_genus(t);
	body->orientation = b->winding[i];
	body->nest = b->nest[i];
	body->cavity = body->orientation == MP_ORIENTATION_INWARD && body->nest.decided &&
		       body->nest.depth > 0;
}

int mp_bodies_list(const struct mp_bodies *b, const struct mp_density *density,
		   const struct mp_named *named, const struct mp_names *names, struct mp_report *r,
		   struct mp_error *err)
{
	if (b->listed == 0)
		return 0;
	r->body = calloc(b->listed, sizeof *r->body);
	if (r->body == NULL)
		return mp_fail_nomem(err);
	r->bodies_listed = b->listed;
	for (uint32_t i = 0; i < b->listed; i++)
		fill(b, i, density, named, r);
	return copy_names(b, names, r, err);
}
