#include "core/moments/uncertainty.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory/huge.h"
#include "core/topology/edges.h"

/*
 * With V and M_i the derivatives of the volume, times 6, and of the first moments about an origin,
 * times 24, those of the moments about the centroid C are M_i - 4*(C_i - origin_i)*V, so that sums
 * of V*V, V*M_i and M_i*M_i tell what theirs are when the centroid is known.  The origin is close
 * to it, so nothing cancels.  Coordinates are scaled by powers of two, each axis by its own, so
 * that the box is about 1 wide and no product leaves the range of a double.
 */

enum { LANES = 3 };

static const int AXIS[LANES] = {2, 0, 1}; /* z, x, y: of lanes */

/*
 * The centroid of the mapped solid moves as the map says, while the normals stay those of the file.
 * Powers of two keep the numbers near 1.
 */
static void set_turn(struct mp_uncertainty_state *s, const struct mp_affine *map)
{
	struct mp_deviation_frame *f = &s->frame;

	f->turned = map != NULL;
	for (int i = 0; i < 3; i++) {
		long double row[3], largest = 0;

		s->row_scale[i] = f->scale[i];
		for (int k = 0; k < 3 && map != NULL; k++) {
			row[k] = (long double)map->row[i][k] / f->scale[k];
			largest = fmaxl(largest, fabsl(row[k]));
		}
		if (map == NULL)
			continue;
		s->row_scale[i] = ldexp(1, ilogbl(largest) < -1000 ? 1000 : -ilogbl(largest));
		for (int k = 0; k < 3; k++)
			f->turn[i][k] = (double)(row[k] * s->row_scale[i]);
	}
}

/* A box without an extent along an axis takes the factor of the others: nothing is scaled away. */
static void set_scale(struct mp_deviation_frame *f, const struct mp_rounded_solid *s)
{
	int exponent[3], top = INT_MIN;

	for (int k = 0; k < 3; k++) {
		double half = s->max[k] / 2 - s->min[k] / 2;

		exponent[k] = half > 0 ? -ilogb(half) - 1 : INT_MIN;
		if (exponent[k] > 1000)
			exponent[k] = 1000;
		if (exponent[k] > top)
			top = exponent[k];
	}
	for (int k = 0; k < 3; k++)
		f->scale[k] = ldexp(1, exponent[k] != INT_MIN ? exponent[k]
				       : top != INT_MIN       ? top
							      : 0);
}

static void set_origin(struct mp_uncertainty_state *state, const struct mp_rounded_solid *s)
{
	for (int k = 0; k < 3; k++) {
		double middle = s->min[k] / 2 + s->max[k] / 2;
		bool inside = s->centroid[k] >= s->min[k] && s->centroid[k] <= s->max[k];

		state->frame.origin[k] = s->volume != 0 && inside ? s->centroid[k] : middle;
	}
}

static void set_steps(struct mp_deviation_frame *f, const struct mp_rounded_solid *s)
{
	for (int lane = 0; lane < LANES; lane++) {
		double scale = f->scale[AXIS[lane]];

		f->ulp[lane] = s->float32 ? 0x1p-24 * scale : 0;
		f->step[lane] = s->step / 2 * scale;
	}
}

static int begin_windows(void *self, size_t windows)
{
	struct mp_uncertainty_state *s = self;

	s->windows = windows;
	s->window = calloc(windows, sizeof *s->window);
	return s->window == NULL ? -1 : 0;
}

static void take(void *self, size_t window, const struct mp_links *links)
{
	struct mp_uncertainty_state *s = self;

	s->kernel->add(&s->window[window], &s->frame, links);
}

static void add_sums(struct mp_deviation_sums *to, const struct mp_deviation_sums *from)
{
	for (int lane = 0; lane < LANES; lane++) {
		to->vv[lane] += from->vv[lane];
		for (int row = 0; row < MP_DEVIATION_ROWS; row++) {
			to->vm[row][lane] += from->vm[row][lane];
			to->mm[row][lane] += from->mm[row][lane];
		}
	}
}

static void end_windows(void *self, bool all)
{
	struct mp_uncertainty_state *s = self;
	struct mp_deviation_sums *window = s->window;

	s->window = NULL;
	for (size_t i = 0; i < s->windows && all; i++)
		add_sums(&s->sums, &window[i]);
	s->seen = all;
	free(window);
}

void mp_uncertainty_begin(struct mp_uncertainty_state *state, const struct mp_rounded_solid *s)
{
	memset(state, 0, sizeof *state);
	state->watcher = (struct mp_links_sink){begin_windows, take, end_windows, state};
	state->mesh = s->mesh;
	state->kernel = mp_deviation_kernel_get(mp_deviation_kernel_count() - 1);
	set_scale(&state->frame, s);
	set_origin(state, s);
	set_steps(&state->frame, s);
	mp_vertices_all(s->mesh->vertices, &state->frame.narrow, &state->frame.wide);
	set_turn(state, s->map);
}

/* row[v + 1] = where row v begins, so that scattering moves it to where row v + 1 begins. */
static void count_rows(const struct mp_mesh *m, uint32_t vertices, uint32_t *row)
{
	uint32_t sum = 0;

	for (uint32_t t = 0; t < m->triangles; t++)
		for (int c = 0; c < 3 && mp_has_edges(m->tri[t]); c++)
			row[m->tri[t][c] + 1]++;
	for (uint32_t v = 0; v < vertices; v++) {
		uint32_t n = row[v + 1];

		row[v + 1] = sum;
		sum += n;
	}
}

static void scatter(const struct mp_mesh *m, uint32_t *row, uint64_t *link)
{
	for (uint32_t t = 0; t < m->triangles; t++) {
		const uint32_t *v = m->tri[t];

		for (int c = 0; c < 3 && mp_has_edges(v); c++)
			link[row[v[c] + 1]++] =
			    (uint64_t)v[c == 2 ? 0 : c + 1] << 32 | v[c == 0 ? 2 : c - 1];
	}
}

/* What mp_topology_find() does not show, of any mesh.  Rows fit: 3 * MP_MOST_TRIANGLES < 2^32. */
static int look_at_all(struct mp_uncertainty_state *s, struct mp_error *err)
{
	uint32_t vertices = mp_vertices_count(s->mesh->vertices);
	const size_t size = ((size_t)3 * s->mesh->triangles + 1) * sizeof(uint64_t);
	uint32_t *row = calloc((size_t)vertices + 1, sizeof *row);
	uint64_t *link = mp_huge(malloc(size), size);
	int failed =
	    row == NULL || link == NULL || begin_windows(s, vertices / MP_LINKS_WINDOW + 1);

	if (!failed) {
		count_rows(s->mesh, vertices, row);
		scatter(s->mesh, row, link);
		for (uint32_t v = 0, left; v < vertices; v += MP_LINKS_WINDOW) {
			left = vertices - v;
			take(s, v / MP_LINKS_WINDOW,
			     &(struct mp_links){v, left < MP_LINKS_WINDOW ? left : MP_LINKS_WINDOW,
						row + v, link + row[v]});
		}
		end_windows(s, true);
	}
	free(row);
	free(link);
	return failed ? mp_fail_nomem(err) : 0;
}

static long double sum_of(const double lane[MP_DEVIATION_LANES])
{
	return (long double)lane[0] + (long double)lane[1] + (long double)lane[2];
}

/* How far the centroid is from the origin in row ${i}, scaled as that, times 4. */
static long double shift_of(const struct mp_uncertainty_state *s, const struct mp_rounded_solid *r,
			    int i)
{
	long double shift = 0;

	if (r->volume == 0)
		return 0;
	for (int k = 0; k < 3; k++) {
		long double factor = s->frame.turned ? (long double)s->frame.turn[i][k] : k == i;

		shift += 4 * factor * (long double)s->frame.scale[k] *
			 ((long double)r->centroid[k] - (long double)s->frame.origin[k]);
	}
	return shift;
}

static void set_deviation(const struct mp_uncertainty_state *state,
			  const struct mp_rounded_solid *s, struct mp_deviation *out)
{
	const double *scale = state->frame.scale;
	long double product = (long double)scale[0] * scale[1] * scale[2];
	long double volume = fabsl(s->volume * product), vv = sum_of(state->sums.vv);

	out->volume = sqrtl(vv / 3) / 6 / product;
	if (s->map != NULL)
		out->volume *= s->map->size.mid;
	for (int i = 0; i < 3; i++) {
		long double shift = shift_of(state, s, i);
		long double square = sum_of(state->sums.mm[i]) -
				     shift * (2 * sum_of(state->sums.vm[i]) - shift * vv);

		out->centroid[i] =
		    volume > 0 ? sqrtl(fmaxl(square, 0) / 3) / 24 / volume / state->row_scale[i]
			       : 0;
	}
}

int mp_uncertainty_end(struct mp_uncertainty_state *state, const struct mp_rounded_solid *s,
		       struct mp_deviation *out, struct mp_error *err)
{
	if (!state->seen && look_at_all(state, err))
		return -1;
	set_deviation(state, s, out);
	return 0;
}

int mp_uncertainty_find(const struct mp_rounded_solid *s, struct mp_deviation *out,
			struct mp_error *err)
{
	struct mp_uncertainty_state state;

	mp_uncertainty_begin(&state, s);
	return mp_uncertainty_end(&state, s, out, err);
}
