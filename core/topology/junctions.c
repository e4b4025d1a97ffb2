#include <stdlib.h>

#include "core/sort.h"
#include "core/topology/loop_list.h"

/*
 * T-junctions: vertices of a loop that lie between the ends of one of its edges.  Edges that meet
 * in a vertex and have one line (exactly) are put together; along each such line a sweep keeps the
 * edge that reaches farthest.  On a crack every line hangs together that way, so each of its
 * junctions is found; elsewhere those are that hang on their line.  O(n log n).
 */
struct search {
	const struct mp_loop_lister *s;
	uint32_t *half;   /* the boundary half-edges of listed loops, in file order */
	uint32_t *parent; /* disjoint sets of them: on one line */
	uint64_t *key;    /* 2 * count */
	size_t count;
};

/* As in the file: what lies on a line there need not do so to the bit once it is mapped. */
static void stored(const struct search *f, uint32_t v, double xyz[3])
{
	mp_vertices_get(f->s->mesh->vertices, v, xyz);
}

/* An order of numbers: < 0 where ${x} comes before ${y}. */
typedef int compare_fn(const void *self, uint32_t x, uint32_t y);

static void sift(uint32_t *a, size_t i, size_t n, compare_fn *compare, const void *self)
{
	uint32_t x = a[i];

	for (size_t child = 2 * i + 1; child < n; child = 2 * i + 1) {
		if (child + 1 < n && compare(self, a[child], a[child + 1]) < 0)
			child++;
		if (compare(self, x, a[child]) >= 0)
			break;
		a[i] = a[child];
		i = child;
	}
	a[i] = x;
}

/* Heapsort: in place, and no order makes it slow. */
static void sort(uint32_t *a, size_t n, compare_fn *compare, const void *self)
{
	for (size_t i = n / 2; i-- > 0;)
		sift(a, i, n, compare, self);
	for (size_t last = n; last-- > 1;) {
		uint32_t top = a[0];

		a[0] = a[last];
		a[last] = top;
		sift(a, 0, last, compare, self);
	}
}

/* ---- Edges on one line ---- */

struct around {
	const struct search *f;
	uint32_t v;
};

static uint32_t other_end(const struct search *f, uint32_t edge, uint32_t v)
{
	uint32_t tail = mp_loop_tail(f->s, f->half[edge]);

	return tail == v ? mp_loop_head(f->s, f->half[edge]) : tail;
}

static int compare_lines(const void *self, uint32_t x, uint32_t y)
{
	const struct around *a = self;
	double m[3], p[3], q[3];

	stored(a->f, a->v, m);
	stored(a->f, other_end(a->f, x, a->v), p);
	stored(a->f, other_end(a->f, y, a->v), q);
	return mp_compare_lines(m, p, q);
}

/* Put together the edges edge[0 .. n) at ${v} that have one line. */
static void join_at(struct search *f, uint32_t v, uint32_t *edge, size_t n)
{
	const struct around a = {f, v};

	sort(edge, n, compare_lines, &a);
	for (size_t i = 1; i < n; i++)
		if (compare_lines(&a, edge[i - 1], edge[i]) == 0)
			mp_set_unite(f->parent, edge[i - 1], edge[i]);
}

static void join(struct search *f, uint32_t *room)
{
	for (uint32_t i = 0; i < f->count; i++) {
		f->parent[i] = i;
		f->key[2 * (size_t)i] = (uint64_t)mp_loop_tail(f->s, f->half[i]) << 32 | i;
		f->key[2 * (size_t)i + 1] = (uint64_t)mp_loop_head(f->s, f->half[i]) << 32 | i;
	}
	mp_sort_u64(f->key, 2 * f->count);
	for (size_t i = 0, end; i < 2 * f->count; i = end) {
		for (end = i; end < 2 * f->count && f->key[end] >> 32 == f->key[i] >> 32; end++)
			room[end - i] = (uint32_t)f->key[end];
		if (end - i > 1)
			join_at(f, (uint32_t)(f->key[i] >> 32), room, end - i);
	}
}

/* ---- Along a line ---- */

struct line {
	const struct search *f;
	unsigned axis; /* along which no two of its points have the same coordinate */
};

static double at(const struct line *l, uint32_t v)
{
	double xyz[3];

	stored(l->f, v, xyz);
	return xyz[l->axis];
}

static uint32_t end_of(const struct line *l, uint32_t edge, bool high)
{
	uint32_t tail = mp_loop_tail(l->f->s, l->f->half[edge]);
	uint32_t head = mp_loop_head(l->f->s, l->f->half[edge]);

	return (at(l, tail) < at(l, head)) != high ? tail : head;
}

static int compare_starts(const void *self, uint32_t x, uint32_t y)
{
	double a = at(self, end_of(self, x, false)), b = at(self, end_of(self, y, false));

	if (a == b)
		return (x > y) - (x < y);
	return a < b ? -1 : 1;
}

static int compare_places(const void *self, uint32_t x, uint32_t y)
{
	double a = at(self, x), b = at(self, y);

	return (a > b) - (a < b);
}

static unsigned leading_axis(const struct search *f, uint32_t edge)
{
	double p[3], q[3];
	unsigned k = 0;

	stored(f, mp_loop_tail(f->s, f->half[edge]), p);
	stored(f, mp_loop_head(f->s, f->half[edge]), q);
	while (k < 2 && p[k] == q[k])
		k++;
	return k;
}

struct list {
	struct mp_junction *junction;
	size_t count, room;
	bool failed;
};

static void found(struct list *l, uint32_t vertex, uint32_t from, uint32_t to)
{
	if (l->count == l->room) {
		size_t room = l->room == 0 ? 16 : 2 * l->room;
		struct mp_junction *more = realloc(l->junction, room * sizeof *more);

		if (more == NULL) {
			l->failed = true;
			return;
		}
		l->junction = more;
		l->room = room;
	}
	l->junction[l->count++] = (struct mp_junction){vertex, {from, to}};
}

/* edge[0 .. n) on one line, with room for their 2 * n ends behind them. */
static void sweep(const struct search *f, uint32_t *edge, size_t n, struct list *out)
{
	const struct line l = {f, leading_axis(f, edge[0])};
	uint32_t *end = edge + n, farthest = 0;
	size_t begun = 0;

	for (size_t i = 0; i < n; i++) {
		end[2 * i] = mp_loop_tail(f->s, f->half[edge[i]]);
		end[2 * i + 1] = mp_loop_head(f->s, f->half[edge[i]]);
	}
	sort(edge, n, compare_starts, &l);
	sort(end, 2 * n, compare_places, &l);
	for (size_t i = 0; i < 2 * n; i++) {
		double x = at(&l, end[i]);

		if (i > 0 && end[i] == end[i - 1])
			continue;
		for (; begun < n && at(&l, end_of(&l, edge[begun], false)) < x; begun++)
			if (begun == 0 || at(&l, end_of(&l, edge[begun], true)) >
					      at(&l, end_of(&l, farthest, true)))
				farthest = edge[begun];
		if (begun > 0 && at(&l, end_of(&l, farthest, true)) > x)
			found(out, end[i], end_of(&l, farthest, false), end_of(&l, farthest, true));
	}
}

/* ---- All of them ---- */

/* By loop and vertex; the first MP_DEFECT_TRIANGLES of a loop stay. */
static int keep(const struct search *f, struct list *l, struct mp_topology *out)
{
	struct mp_junction *kept = malloc((l->count + 1) * sizeof *kept);
	uint64_t *key = malloc((l->count + 1) * sizeof *key);
	size_t n = 0;

	for (size_t i = 0; kept != NULL && key != NULL && i < l->count; i++) {
		uint64_t loop = mp_loop_number(f->s, l->junction[i].vertex);

		key[i] = loop << 32 | i;
	}
	if (kept == NULL || key == NULL) {
		free(kept);
		free(key);
		return -1;
	}
	mp_sort_u64(key, l->count);
	for (size_t i = 0; i < l->count; i++) {
		struct mp_loop *o = &out->loop[key[i] >> 32];

		if (o->junctions == 0)
			o->junction_at = n;
		if (o->junctions == MP_DEFECT_TRIANGLES) {
			out->truncated = true;
			continue;
		}
		o->junctions++;
		kept[n++] = l->junction[(uint32_t)key[i]];
	}
	free(key);
	out->junction = kept;
	return 0;
}

/* Every line with more than one edge. */
static void sweep_all(struct search *f, uint32_t *room, struct list *out)
{
	for (uint32_t i = 0; i < f->count; i++)
		f->key[i] = (uint64_t)mp_set_find(f->parent, i) << 32 | i;
	mp_sort_u64(f->key, f->count);
	for (size_t i = 0, end; i < f->count; i = end) {
		for (end = i; end < f->count && f->key[end] >> 32 == f->key[i] >> 32; end++)
			room[end - i] = (uint32_t)f->key[end];
		if (end - i > 1)
			sweep(f, room, end - i, out);
	}
}

static size_t collect(struct search *f)
{
	size_t n = 0;

	MP_FOR_BOUNDARY(f->s, h)
	{
		if (mp_loop_number(f->s, mp_loop_tail(f->s, h)) == MP_NO_LOOP)
			continue;
		if (f->half != NULL)
			f->half[n] = (uint32_t)h;
		n++;
	}
	return n;
}

int mp_junctions_find(const struct mp_loop_lister *s, struct mp_topology *out)
{
	struct search f = {.s = s};
	struct list found = {0};
	uint32_t *room;
	int failed = -1;

	f.count = collect(&f);
	f.half = calloc(f.count + 1, sizeof *f.half);
	f.parent = malloc((f.count + 1) * sizeof *f.parent);
	f.key = malloc((2 * f.count + 1) * sizeof *f.key);
	room = malloc((3 * f.count + 1) * sizeof *room);
	if (f.half != NULL && f.parent != NULL && f.key != NULL && room != NULL) {
		collect(&f);
		join(&f, room);
		sweep_all(&f, room, &found);
		failed = found.failed || keep(&f, &found, out);
	}
	free(found.junction);
	free(room);
	free(f.key);
	free(f.parent);
	free(f.half);
	return failed ? -1 : 0;
}
