#include "core/bodies/named.h"

#include <stdlib.h>
#include <string.h>

#include "core/bodies/bodies.h"

static int fail(struct mp_error *err, uint64_t name, uint64_t triangle, const char *text)
{
	(void)mp_fail(err, MP_BAD_NAME, MP_NO_BYTE, "%s", text);
	if (err != NULL) {
		err->limit = name;
		err->actual = triangle;
	}
	return -1;
}

const char *mp_named_at(const struct mp_names *names, uint64_t t, bool other, size_t *len,
			uint64_t *end)
{
	const struct mp_parts *from = &names->materials;
	const struct mp_part *part = mp_parts_at(from, t, end);
	uint64_t ends[2];

	if (part == NULL) {
		const struct mp_part *group = mp_parts_at(&names->parts, t, &ends[0]);
		const struct mp_part *object = mp_parts_at(&names->objects, t, &ends[1]);

		from = other ? &names->objects : &names->parts;
		part = other ? object : group;
		for (int i = 0; i < 2; i++)
			*end = ends[i] < *end ? ends[i] : *end;
	} else if (other) {
		part = NULL;
	}
	*len = part != NULL ? part->len : 0;
	return *len > 0 ? from->pool + part->name : "";
}

static int order(const char *a, size_t a_len, const char *b, size_t b_len)
{
	if (a_len != b_len)
		return a_len < b_len ? -1 : 1;
	return memcmp(a, b, a_len);
}

static int by_name(const void *a, const void *b)
{
	const struct mp_named_density *x = *(const struct mp_named_density *const *)a;
	const struct mp_named_density *y = *(const struct mp_named_density *const *)b;

	return order(x->name, x->len, y->name, y->len);
}

/* Which of the ${count} names that of triangle ${t} is, ${count} for none. */
static uint32_t find(const struct mp_named_density *const *sorted, uint32_t count,
		     const struct mp_named_density *first, const char *name, size_t len)
{
	uint32_t low = 0, high = count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		int side = order(sorted[middle]->name, sorted[middle]->len, name, len);

		if (side == 0)
			return (uint32_t)(sorted[middle] - first);
		if (side < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return count;
}

static int assign(struct mp_named *n, const struct mp_request *request,
		  const struct mp_names *names, uint32_t triangles, struct mp_error *err)
{
	const uint32_t count = request->named_count;
	const struct mp_named_density **sorted = malloc(count * sizeof(void *));

	if (sorted == NULL)
		return mp_fail_nomem(err);
	for (uint32_t i = 0; i < count; i++)
		sorted[i] = &request->named[i];
	qsort(sorted, count, sizeof(void *), by_name);
	for (uint64_t t = 0, end = 0; t < triangles; t = end) {
		uint32_t g = count;

		for (int other = 0; other < 2 && g == count; other++) {
			size_t len;
			const char *name = mp_named_at(names, t, other, &len, &end);

			g = find((const struct mp_named_density *const *)sorted, count,
				 request->named, name, len);
		}
		if (end > triangles)
			end = triangles;
		if (n->group[g].triangles == 0)
			n->group[g].first = (uint32_t)t;
		n->group[g].triangles += (uint32_t)(end - t);
		for (uint64_t i = t; i < end; i++)
			n->of[i] = (uint16_t)g;
	}
	free(sorted);
	return 0;
}

/* Every name has faces, and every face has a density. */
static int judge(const struct mp_named *n, const struct mp_request *request, struct mp_error *err)
{
	const struct mp_group *rest = &n->group[n->count - 1];

	for (uint32_t i = 0; i + 1 < n->count; i++)
		if (n->group[i].triangles == 0)
			return fail(err, i, UINT64_MAX, "no faces are under this name");
	if (rest->triangles > 0 && request->density_kind != MP_DENSITY_GIVEN)
		return fail(err, UINT64_MAX, rest->first, "some faces have no density");
	return 0;
}

int mp_named_sort(struct mp_named *n, const struct mp_request *request,
		  const struct mp_names *names, uint32_t triangles, struct mp_error *err)
{
	memset(n, 0, sizeof *n);
	if (request->named_count == 0)
		return 0;
	if (request->named_count > MP_MOST_NAMED)
		return mp_fail(err, MP_BUG, MP_NO_BYTE, "too many named densities");
	n->count = request->named_count + 1;
	n->group = calloc(n->count, sizeof *n->group);
	n->of = malloc(((size_t)triangles + 1) * sizeof *n->of);
	if (n->group == NULL || n->of == NULL)
		return mp_fail_nomem(err);
	for (uint32_t i = 0; i < request->named_count; i++) {
		const struct mp_named_density *d = &request->named[i];

		n->group[i].density = mp_density_ball(d->density, d->divisor, d->error);
	}
	n->group[n->count - 1].density =
	    mp_density_ball(request->density, request->density_divisor, request->density_error);
	if (assign(n, request, names, triangles, err))
		return -1;
	return judge(n, request, err);
}

int mp_named_bodies(struct mp_named *n, const struct mp_mesh *mesh, const struct mp_topology *t,
		    struct mp_error *err)
{
	if (n->count == 0)
		return 0;
	n->of_body = malloc(((size_t)t->bodies + 1) * sizeof *n->of_body);
	if (n->of_body == NULL)
		return mp_fail_nomem(err);
	for (uint32_t b = 0; b < t->bodies; b++)
		n->of_body[b] = n->of[t->body[b].first];
	for (uint32_t i = 0; i < mesh->triangles; i++)
		if (t->body_of[i] != MP_NO_BODY && n->of_body[t->body_of[i]] != n->of[i])
			n->of_body[t->body_of[i]] = MP_NO_GROUP;
	for (uint32_t i = 0; i < mesh->triangles; i++) {
		uint32_t b = t->body_of[i];

		if (b != MP_NO_BODY &&
		    (n->of_body[b] == MP_NO_GROUP || !mp_body_has_volume(&t->body[b])))
			n->group[n->of[i]].loose = true;
	}
	for (uint32_t g = 0; g < n->count; g++) {
		double first[3] = {0, 0, 0};
		long double origin[3];

		if (n->group[g].triangles > 0)
			mp_vertices_get(mesh->vertices, mesh->tri[n->group[g].first][0], first);
		for (int k = 0; k < 3; k++)
			origin[k] = first[k];
		mp_merge_begin(&n->group[g].merge, origin);
		n->group[g].in_range = true;
	}
	return 0;
}

void mp_named_add(struct mp_named *n, uint32_t body, const struct mp_solid *solid)
{
	struct mp_group *g;

	if (n == NULL || n->count == 0 || n->of_body[body] == MP_NO_GROUP)
		return;
	g = &n->group[n->of_body[body]];
	g->bodies++;
	g->in_range = g->in_range && solid->in_range;
	mp_merge_add(&g->merge, solid);
}

bool mp_named_weigh(const struct mp_named *n, const struct mp_solid *whole, struct mp_solid *out)
{
	bool outward = false, inward = false;
	struct mp_merge merge;

	*out = *whole;
	mp_merge_begin(&merge, n->group[n->of[0]].merge.origin);
	for (uint32_t g = 0; g < n->count; g++) {
		struct mp_solid solid = n->group[g].solid;

		if (n->group[g].triangles == 0 || n->group[g].open)
			continue;
		outward = outward || solid.volume > 0;
		inward = inward || solid.volume < 0;
		out->in_range = out->in_range && n->group[g].in_range;
		mp_mass_weigh(&solid, n->group[g].density);
		mp_merge_add(&merge, &solid);
	}
	mp_merge_solve(&merge, out);
	/* a whole without a volume has no centroid, as everywhere */
	out->has_centroid = out->has_centroid && whole->volume != 0;
	return outward && inward;
}

struct mp_density mp_named_density_of(const struct mp_named *n, uint32_t body)
{
	struct mp_density d = {.asked = true};

	d.defined = n->of_body[body] != MP_NO_GROUP;
	if (d.defined) {
		d.value = n->group[n->of_body[body]].density.mid;
		d.bound = n->group[n->of_body[body]].density.rad;
	}
	return d;
}

void mp_named_free(struct mp_named *n)
{
	free(n->of);
	free(n->of_body);
	free(n->group);
	memset(n, 0, sizeof *n);
}
