#ifndef MP_NAMED_H
#define MP_NAMED_H

#include "core/analysis.h"
#include "core/bodies/parts.h"
#include "core/moments/mass.h"
#include "core/moments/moments.h"
#include "core/topology/topology.h"

/*
 * Densities by name.  The faces under each name that has a density of its own are a group, all
 * other faces are one more; each group has to be closed by itself, weighs by itself, and the whole
 * is their sum.
 */
struct mp_group {
	uint32_t first, triangles; /* its smallest triangle number; how many there are */
	struct mp_ball density;    /* [M/L^3] */
	uint32_t bodies;           /* that are closed and all its own: merged in ${merge} */
	bool loose; /* some of its triangles lie in another body: the group is summed apart */
	bool open;  /* it encloses no volume */
	bool in_range;
	struct mp_merge merge;
	struct mp_solid solid; /* volume, centroid, cov */
};

struct mp_named {       /* all 0: no name has a density */
	uint32_t count; /* of groups; the last one is of the faces without a density of their own */
	uint16_t *of;   /* group of each triangle */
	uint16_t *of_body; /* group of each body */
	struct mp_group *group;
};

#define MP_NO_GROUP UINT16_MAX /* of a body with faces of several groups */

/*
 * The name of triangle ${t}, ${*len} bytes, "" for none.  ${*end}: the first triangle behind ${t}
 * of which that may not be true.  Faces have two names: their part's, or if that has no density
 * (${other}) their object's.  Where a file has materials its faces have the material's alone.
 */
const char *mp_named_at(const struct mp_names *, uint64_t t, bool other, size_t *len,
			uint64_t *end);

/*
 * The steps, in this order.  Where ${request} has no named densities they do nothing.  Each
 * returns 0, or -1 with MP_NOMEM or MP_BAD_NAME; mp_named_free() is for the caller in any case.
 */

/* Which group each of the triangles 0 .. ${triangles} is in, and its density. */
int mp_named_sort(struct mp_named *, const struct mp_request *request, const struct mp_names *names,
		  uint32_t triangles, struct mp_error *err);

/* Which group each body is in. */
int mp_named_bodies(struct mp_named *, const struct mp_mesh *mesh,
		    const struct mp_topology *topology, struct mp_error *err);

/* Body ${body}, which has a volume, is ${solid}.  Takes NULL. */
void mp_named_add(struct mp_named *, uint32_t body, const struct mp_solid *solid);

/*
 * The solid of each group.  ${key} as for the vertex table: groups that share bodies with others
 * get tables of their own.
 */
int mp_named_solve(struct mp_named *, const struct mp_mesh *mesh, const uint8_t key[16],
		   struct mp_error *err);

/*
 * What all groups make together: ${out} is ${whole} with the mass in the place of the volume, so
 * that centroid and cov are those of the mass.  Each group weighs as the solid it means, however
 * it is wound; true where some are wound against each other.
 */
bool mp_named_weigh(const struct mp_named *, const struct mp_solid *whole, struct mp_solid *out);

/* The density of a body: not defined where it has faces of several groups. */
struct mp_density mp_named_density_of(const struct mp_named *, uint32_t body);

void mp_named_free(struct mp_named *); /* legal on a zeroed struct, and again */

#endif
