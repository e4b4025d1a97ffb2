/*
 * stages DIR TRIANGLES: what single stages cost on one core, in nanoseconds a triangle (the best of
 * several runs), on the solid of mesh.h and on the files DIR/TRIANGLES.*, which generate made.
 * stages DIR TRIANGLES STAGE: that stage once, for an instruction counter that looks at
 * measured() only.  stages: the names of the stages.
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/bodies/bodies.h"
#include "core/decoder.h"
#include "core/exact/exact.h"
#include "core/moments/moments.h"
#include "core/moments/uncertainty.h"
#include "core/topology/edges.h"
#include "core/topology/topology.h"
#include "core/topology/vertices.h"
#include "tests/bench/mesh.h"

#ifdef __clang__
#define MEASURED __attribute__((noinline))
#else
#define MEASURED __attribute__((noinline, noclone))
#endif

struct work {
	double (*tri)[9]; /* ${count}, in the order of the mesh or in none */
	size_t count;
	uint8_t *bytes; /* of a file */
	size_t len;
	struct mp_vertices *vertices;
	uint32_t (*corner)[3];
	uint64_t *flat; /* as mp_flat_mark() has it */
	struct mp_mesh mesh;
	struct mp_topology topology;
	uint32_t *row; /* struct mp_links of all vertices */
	uint64_t *link;
	struct mp_moments moments;
	struct mp_exact_grid grid;
};

static void die(const char *what)
{
	(void)fprintf(stderr, "stages: %s\n", what);
	exit(1);
}

/* ---- the measured ---- */

static int drop_block(void *self, const double (*tri)[9], size_t count, struct mp_error *err)
{
	struct mp_moments *m = self;

	(void)tri;
	(void)err;
	m->triangles += count;
	return 0;
}

static void decode(struct work *w, const struct mp_decoder_ops *decoder)
{
	const struct mp_sink sink = {.block = drop_block, .self = &w->moments};
	const struct mp_limits limits = {.max_triangles = UINT32_MAX};
	struct mp_notes notes = {.format = MP_FORMAT_UNKNOWN};
	void *state = NULL;

	w->moments.triangles = 0;
	if (decoder->begin(&state, &sink, &limits, &notes, NULL))
		die("cannot begin");
	for (size_t at = 0; at < w->len;) {
		size_t n = w->len - at < 65536 ? w->len - at : 65536;

		if (decoder->push(state, w->bytes + at, n, NULL))
			die("the file cannot be read");
		at += n;
	}
	if (decoder->finish(state, NULL))
		die("the file ends early");
	decoder->end(state);
}

static void run_stl(struct work *w)
{
	decode(w, &mp_stl_decoder);
}

static void run_obj(struct work *w)
{
	decode(w, &mp_obj_decoder);
}

static void run_draco(struct work *w)
{
	decode(w, &mp_draco_decoder);
}

static void run_moments(struct work *w)
{
	mp_moments_begin(&w->moments);
	for (size_t at = 0; at < w->count; at += MP_BLOCK)
		mp_moments_add(&w->moments, (const double(*)[9])w->tri + at,
			       w->count - at < MP_BLOCK ? w->count - at : MP_BLOCK);
}

static void run_marks(struct work *w)
{
	for (size_t at = 0; at < w->count; at += MP_BLOCK)
		mp_flat_mark((const double(*)[9])w->tri + at,
			     w->count - at < MP_BLOCK ? w->count - at : MP_BLOCK, at, w->flat);
}

static void run_vertices(struct work *w)
{
	const uint8_t key[16] = "sixteen of bytes";

	mp_vertices_free(w->vertices);
	w->vertices = mp_vertices_new(key, NULL);
	for (size_t at = 0; at < w->count; at += MP_BLOCK)
		if (w->vertices == NULL ||
		    mp_vertices_add(w->vertices, (const double(*)[9])w->tri + at,
				    w->count - at < MP_BLOCK ? w->count - at : MP_BLOCK,
				    w->corner + at, NULL))
			die("no memory");
	mp_vertices_seal(w->vertices);
}

static void run_edges(struct work *w)
{
	struct mp_edges edges;

	if (mp_edges_build(&w->mesh, &edges, NULL))
		die("no memory");
	mp_edges_free(&edges);
}

static void run_topology(struct work *w)
{
	mp_topology_free(&w->topology);
	if (mp_topology_find(&w->mesh, 100, &w->topology, NULL))
		die("no memory");
}

static void run_bodies(struct work *w)
{
	struct mp_moments total = w->moments;
	struct mp_bodies bodies = {0};
	struct mp_solid whole;

	if (mp_bodies_measure(&w->mesh, &w->topology, 100, &total, NULL, &whole, &bodies, NULL) ||
	    mp_bodies_nest(&w->mesh, &w->topology, &bodies, NULL))
		die("no memory");
	mp_bodies_free(&bodies);
}

static void run_exact(struct work *w)
{
	struct mp_exact e;

	mp_exact_grid_free(&w->grid);
	if (mp_exact_grid_find(&w->mesh, &w->grid, NULL) ||
	    mp_exact_find(&w->mesh, &w->grid, NULL, w->mesh.triangles, &e, NULL))
		die("no memory");
	mp_exact_free(&e);
}

static struct mp_rounded_solid rounded(const struct work *w)
{
	const struct mp_moments *m = &w->moments;
	struct mp_rounded_solid s = {.mesh = &w->mesh, .float32 = true, .volume = 1};

	for (int k = 0; k < 3; k++) {
		s.min[k] = m->min[k];
		s.max[k] = m->max[k];
	}
	return s;
}

/* By links that the topology has shown, as always where a mesh is closed and manifold. */
static void run_uncertainty(struct work *w)
{
	const uint32_t vertices = mp_vertices_count(w->vertices);
	const struct mp_rounded_solid s = rounded(w);
	struct mp_uncertainty_state state;
	struct mp_deviation deviation;

	mp_uncertainty_begin(&state, &s);
	if (state.watcher.begin(&state, vertices / MP_LINKS_WINDOW + 1))
		die("no memory");
	for (uint32_t v = 0, n; v < vertices; v += n) {
		n = vertices - v < 1024 ? vertices - v : 1024;
		state.watcher.take(&state, v / MP_LINKS_WINDOW,
				   &(struct mp_links){v, n, w->row + v, w->link + w->row[v]});
	}
	state.watcher.end(&state, true);
	if (mp_uncertainty_end(&state, &s, &deviation, NULL))
		die("no memory");
}

/* ---- what they are measured on ---- */

static void take_grid(struct work *w, struct bench_grid g)
{
	w->count = bench_triangles(g);
	w->tri = malloc(w->count * sizeof *w->tri);
	w->corner = malloc(w->count * sizeof *w->corner);
	w->flat = calloc(w->count / MP_FLAT_GROUP / 64 + 1, sizeof *w->flat);
	if (w->tri == NULL || w->corner == NULL || w->flat == NULL)
		die("no memory");
	for (size_t t = 0; t < w->count; t++) {
		uint32_t ij[3][2];
		float p[3];

		bench_corners(g, t, ij);
		for (int c = 0; c < 3; c++) {
			bench_vertex(g, ij[c][0], ij[c][1], p);
			for (int k = 0; k < 3; k++)
				w->tri[t][3 * c + k] = (double)p[k];
		}
	}
}

static void shuffle(struct work *w)
{
	uint64_t state = 1;

	for (size_t i = w->count; i > 1; i--) {
		size_t at = bench_random(&state) % i;
		double keep[9];

		memcpy(keep, w->tri[at], sizeof keep);
		memcpy(w->tri[at], w->tri[i - 1], sizeof keep);
		memcpy(w->tri[i - 1], keep, sizeof keep);
	}
}

/* Coordinates that a grid of 2^-${bits} mm, or no grid, holds. */
static void change(struct work *w, int bits)
{
	for (size_t i = 0; i < w->count; i++)
		for (int k = 0; k < 9; k++) {
			double x = w->tri[i][k];

			w->tri[i][k] = bits > 0 ? ldexp(rint(ldexp(x, bits)), -bits) : x / 3;
		}
}

static int begin_links(void *self, size_t windows)
{
	(void)self;
	(void)windows;
	return 0;
}

static void end_links(void *self, bool all)
{
	(void)self;
	(void)all;
}

/* Ascending: nobody shares the work. */
static void keep_links(void *self, size_t window, const struct mp_links *l)
{
	struct work *w = self;
	uint32_t at = l->first == 0 ? 0 : w->row[l->first];

	(void)window;
	for (uint32_t i = 0; i <= l->count; i++)
		w->row[l->first + i] = at + (l->row[i] - l->row[0]);
	memcpy(w->link + at, l->link, (l->row[l->count] - l->row[0]) * sizeof *l->link);
}

static void find_mesh(struct work *w)
{
	const struct mp_links_sink keeper = {begin_links, keep_links, end_links, w};

	run_moments(w);
	run_vertices(w);
	run_marks(w);
	w->mesh = (struct mp_mesh){.vertices = w->vertices,
				   .tri = (const uint32_t(*)[3])w->corner,
				   .triangles = (uint32_t)w->count,
				   .flat = w->flat,
				   .watcher = &keeper};
	w->row = malloc(((size_t)mp_vertices_count(w->vertices) + 1) * sizeof *w->row);
	w->link = malloc((3 * w->count + 1) * sizeof *w->link);
	if (w->row == NULL || w->link == NULL)
		die("no memory");
	run_topology(w);
	w->mesh.watcher = NULL;
}

static void read_file(struct work *w, const char *path)
{
	FILE *f = fopen(path, "rb");
	long len = -1;

	if (f == NULL || fseek(f, 0, SEEK_END) != 0 || (len = ftell(f)) < 0)
		die(path);
	rewind(f);
	w->len = (size_t)len;
	w->bytes = malloc(w->len);
	if (w->bytes == NULL || fread(w->bytes, 1, w->len, f) != w->len)
		die(path);
	(void)fclose(f);
}

static void work_free(struct work *w)
{
	free(w->tri);
	free(w->bytes);
	free(w->corner);
	free(w->flat);
	mp_vertices_free(w->vertices);
	free(w->row);
	free(w->link);
	mp_topology_free(&w->topology);
	mp_exact_grid_free(&w->grid);
	memset(w, 0, sizeof *w);
}

/* ---- the list ---- */

static const struct stage {
	const char *name, *words;
	void (*run)(struct work *);
	const char *file; /* suffix of the file to read, or NULL: the solid itself, */
	int bits;         /* on a grid (0: float32 as they are, -1: double), */
	bool shuffled;    /* in no order, */
	bool mesh;        /* with its vertices and topology found */
} stages[] = {
    {"stl", "decode binary STL", run_stl, "stl", 0, false, false},
    {"ascii", "decode ASCII STL", run_stl, "ascii.stl", 0, false, false},
    {"obj", "decode OBJ, v/vt/vn, faces of four", run_obj, "obj", 0, false, false},
    {"draco7", "decode Draco, level 7", run_draco, "7.drc", 0, false, false},
    {"draco0", "decode Draco, level 0", run_draco, "0.drc", 0, false, false},
    {"moments", "bounds and sums", run_moments, NULL, 0, false, false},
    {"marks", "marks of what may be degenerate", run_marks, NULL, 0, false, false},
    {"vertices", "vertices, mesh order", run_vertices, NULL, 0, false, false},
    {"vertices-shuffled", "vertices, shuffled", run_vertices, NULL, 0, true, false},
    {"edges", "edges, mesh order", run_edges, NULL, 0, false, true},
    {"edges-shuffled", "edges, shuffled", run_edges, NULL, 0, true, true},
    {"topology", "edges and all other topology, mesh order", run_topology, NULL, 0, false, true},
    {"topology-shuffled", "edges and all other topology, shuffled", run_topology, NULL, 0, true,
     true},
    {"bodies", "bodies and nesting", run_bodies, NULL, 0, false, true},
    {"uncertainty", "what rounded coordinates do", run_uncertainty, NULL, 0, false, true},
    {"uncertainty-shuffled", "what rounded coordinates do, shuffled", run_uncertainty, NULL, 0,
     true, true},
    {"exact", "exact sums, float32", run_exact, NULL, 0, false, true},
    {"exact-20", "exact sums, multiples of 2^-20", run_exact, NULL, 20, false, true},
    {"exact-40", "exact sums, multiples of 2^-40", run_exact, NULL, 40, false, true},
    {"exact-double", "exact sums, double", run_exact, NULL, -1, false, true},
};

MEASURED void measured(const struct stage *s, struct work *w);

void measured(const struct stage *s, struct work *w)
{
	s->run(w);
}

enum { STAGES = sizeof stages / sizeof stages[0] };

static double cpu(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void prepare(struct work *w, const struct stage *s, const char *dir, uint64_t triangles)
{
	char path[4096];

	memset(w, 0, sizeof *w);
	if (s->file != NULL) {
		(void)snprintf(path, sizeof path, "%s/%llu.%s", dir, (unsigned long long)triangles,
			       s->file);
		read_file(w, path);
		w->count = bench_triangles(bench_grid_of(triangles));
		return;
	}
	take_grid(w, bench_grid_of(triangles));
	if (s->shuffled)
		shuffle(w);
	if (s->bits != 0)
		change(w, s->bits);
	if (s->mesh)
		find_mesh(w);
}

static void measure(const struct stage *s, const char *dir, uint64_t triangles)
{
	double best = INFINITY, total = 0;
	struct work w;

	prepare(&w, s, dir, triangles);
	for (int i = 0; i < 9 && (i < 3 || total < 1); i++) {
		double start = cpu(), took;

		measured(s, &w);
		took = cpu() - start;
		best = fmin(best, took);
		total += took;
	}
	if (s->file != NULL && w.moments.triangles != w.count)
		die("triangles are missing");
	printf("%s\t%.2f\t%s\n", s->name, 1e9 * best / (double)w.count, s->words);
	(void)fflush(stdout);
	work_free(&w);
}

int main(int argc, char **argv)
{
	uint64_t triangles = argc > 2 ? strtoull(argv[2], NULL, 10) : 0;
	struct work w;

	for (int i = 0; i < STAGES; i++) {
		const struct stage *s = &stages[i];

		if (argc == 1) {
			puts(s->name);
		} else if (argc == 3) {
			measure(s, argv[1], triangles);
		} else if (argc == 4 && strcmp(s->name, argv[3]) == 0) {
			prepare(&w, s, argv[1], triangles);
			measured(s, &w);
			work_free(&w);
		}
	}
	return 0;
}
