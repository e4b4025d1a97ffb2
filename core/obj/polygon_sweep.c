#include "core/obj/polygon_sweep.h"

static size_t most_links(uint32_t n) /* three where an interval is split, else two at most */
{
	return 3 * (size_t)n;
}

static uint32_t new_link(struct polygon_sweep *s, uint32_t corner)
{
	struct polygon_link *l = &s->link[s->links];

	if (s->links + 1 < most_links(s->n)) /* the last is there for the worst */
		s->links++;
	else
		s->failed = true;
	l->corner = corner;
	l->below = l->above = POLYGON_NONE;
	return (uint32_t)(l - s->link);
}

/*
 * Is the corner ${b} of the chain seen from the new one ${v}, past its end ${a}?  ${side}: the turn
 * a v b or b v a.  If the three lie on a line, it is if ${a} does not lie between.
 */
static bool is_seen(const struct polygon_sweep *s, int side, uint32_t v, uint32_t a, uint32_t b)
{
	const double *p = s->xy[v], *q = s->xy[a], *r = s->xy[b];

	if (side != 0)
		return side > 0;
	for (int k = 0; k < 2; k++)
		if ((p[k] < q[k] && q[k] < r[k]) || (p[k] > q[k] && q[k] > r[k]))
			return false;
	return true;
}

/* Add ${v} at the lower end of the chain and split off the triangles that come about. */
static uint32_t add_below(struct polygon_sweep *s, struct polygon_interval *i, uint32_t v)
{
	uint32_t new = new_link(s, v);
	struct polygon_link *a = &s->link[i->head];

	while (a->above != POLYGON_NONE) {
		struct polygon_link *b = &s->link[a->above];

		if (!is_seen(s, polygon_sweep_turn(s, a->corner, v, b->corner), v, a->corner,
			     b->corner))
			break;
		polygon_sweep_emit(s, a->corner, v, b->corner);
		a = b;
	}
	s->link[new].above = (uint32_t)(a - s->link);
	a->below = new;
	i->head = i->last = new;
	return new;
}

static uint32_t add_above(struct polygon_sweep *s, struct polygon_interval *i, uint32_t v)
{
	uint32_t new = new_link(s, v);
	struct polygon_link *a = &s->link[i->tail];

	while (a->below != POLYGON_NONE) {
		struct polygon_link *b = &s->link[a->below];

		if (!is_seen(s, polygon_sweep_turn(s, b->corner, v, a->corner), v, a->corner,
			     b->corner))
			break;
		polygon_sweep_emit(s, b->corner, v, a->corner);
		a = b;
	}
	s->link[new].below = (uint32_t)(a - s->link);
	a->above = new;
	i->tail = i->last = new;
	return new;
}

static void start(struct polygon_sweep *s, uint32_t v)
{
	uint32_t new = polygon_sweep_open(s, polygon_sweep_below(s, v), v, s->prev[v]);
	struct polygon_interval *i = &s->interval[new];

	if (!s->failed)
		i->head = i->tail = i->last = new_link(s, v);
}

/* A tip that points to the left, into an interval: cut that along the way to its newest corner. */
static void split(struct polygon_sweep *s, uint32_t v)
{
	uint32_t below = polygon_sweep_below(s, v), new, last, copy;
	struct polygon_interval *i, *j;
	struct polygon_link *l;

	s->failed = s->failed || below == POLYGON_NONE;
	if (s->failed)
		return;
	i = &s->interval[below];
	new = polygon_sweep_open(s, below, v, i->upper);
	if (s->failed)
		return;
	j = &s->interval[new];
	i->upper = s->prev[v];
	s->side_of[i->upper] = below;
	last = i->last;
	copy = new_link(s, s->link[last].corner);
	l = &s->link[copy];
	l->above = s->link[last].above;
	if (l->above != POLYGON_NONE)
		s->link[l->above].below = copy;
	s->link[last].above = POLYGON_NONE;
	j->head = copy;
	j->tail = l->above != POLYGON_NONE ? i->tail : copy;
	i->tail = last;
	(void)add_above(s, i, v);
	(void)add_below(s, j, v);
}

static void bend_below(struct polygon_sweep *s, uint32_t v)
{
	uint32_t old = s->side_of[s->prev[v]];

	if (old == POLYGON_NONE || s->interval[old].lower != s->prev[v]) {
		s->failed = true;
		return;
	}
	s->side_of[s->prev[v]] = POLYGON_NONE;
	s->side_of[v] = old;
	s->interval[old].lower = v;
	(void)add_below(s, &s->interval[old], v);
}

static void bend_above(struct polygon_sweep *s, uint32_t v)
{
	uint32_t old = s->side_of[v];

	if (old == POLYGON_NONE || s->interval[old].upper != v) {
		s->failed = true;
		return;
	}
	s->side_of[v] = POLYGON_NONE;
	s->side_of[s->prev[v]] = old;
	s->interval[old].upper = s->prev[v];
	(void)add_above(s, &s->interval[old], v);
}

/* Both edges at ${v} come from the left: it ends an interval, or a gap between two. */
static void end_or_merge(struct polygon_sweep *s, uint32_t v, bool merge)
{
	uint32_t lower = s->side_of[v], upper = s->side_of[s->prev[v]];
	struct polygon_interval *i, *j;
	uint32_t at, v_below;

	if (lower == POLYGON_NONE || upper == POLYGON_NONE || s->interval[lower].upper != v ||
	    s->interval[upper].lower != s->prev[v] || merge != (lower != upper)) {
		s->failed = true;
		return;
	}
	i = &s->interval[lower];
	j = &s->interval[upper];
	if (!merge) {
		for (at = i->head; s->link[at].above != POLYGON_NONE; at = s->link[at].above) {
			uint32_t a = s->link[at].corner, b = s->link[s->link[at].above].corner;

			s->failed = s->failed || polygon_sweep_turn(s, a, v, b) < 0;
			polygon_sweep_emit(s, a, v, b);
		}
		polygon_sweep_close(s, lower, v);
		return;
	}
	v_below = add_above(s, i, v);
	at = s->link[add_below(s, j, v)].above;
	s->link[v_below].above = at;
	s->link[at].below = v_below;
	polygon_sweep_close(s, upper, v);
	i->upper = j->upper;
	i->tail = j->tail;
	s->side_of[i->upper] = lower;
}

enum event { CLOSE, BEND, SPLIT, START };

static enum event kind_of(const struct polygon_sweep *s, uint32_t v)
{
	uint32_t at = s->rank[v], a = s->prev[v], b = s->next[v];

	if (s->rank[a] < at && s->rank[b] < at)
		return CLOSE;
	if (s->rank[a] < at || s->rank[b] < at)
		return BEND;
	return polygon_sweep_turn(s, a, v, b) > 0 ? START : SPLIT;
}

static void take_event(struct polygon_sweep *s, uint32_t v, enum event kind)
{
	switch (kind) {
	case CLOSE:
		end_or_merge(s, v, polygon_sweep_turn(s, s->prev[v], v, s->next[v]) < 0);
		break;
	case BEND:
		(s->rank[s->prev[v]] < s->rank[v] ? bend_below : bend_above)(s, v);
		break;
	case SPLIT:
		split(s, v);
		break;
	case START:
		start(s, v);
		break;
	}
}

/* Where several corners are one point, what ends there comes first. */
static void take_events(struct polygon_sweep *s)
{
	uint32_t begin = 0, end = 0;

	for (; begin < s->n && !s->failed; begin = end) {
		while (end < s->n && s->rank[s->order[end]] == begin)
			end++;
		for (int kind = CLOSE; kind <= START; kind++) {
			for (uint32_t i = begin; i < end && !s->failed; i++) {
				uint32_t v = s->order[i];

				if (s->next[v] != POLYGON_NONE && kind_of(s, v) == (enum event)kind)
					take_event(s, v, (enum event)kind);
			}
		}
	}
}

static int make_room(struct polygon_sweep *s, struct mp_polygon *p, struct mp_error *err)
{
	const size_t n = s->n, intervals = polygon_sweep_intervals(s->n), links = most_links(s->n);
	char *at = polygon_room(p,
				n * (sizeof *s->xy + 5 * sizeof(uint32_t)) +
				    links * sizeof *s->link + intervals * sizeof *s->interval,
				err);

	if (at == NULL)
		return -1;
	s->xy = (void *)at;
	s->link = (void *)(s->xy + n); /* 36 bytes a corner, and 8-byte aligned */
	s->interval = (void *)(s->link + links);
	s->prev = (void *)(s->interval + intervals);
	s->next = s->prev + n;
	s->order = s->next + n;
	s->rank = s->order + n;
	s->side_of = s->rank + n;
	return 0;
}

int polygon_sweep(struct mp_polygon *p, const double (*xyz)[3], const uint32_t *corner, uint32_t n,
		  const int axis[2], bool *split_up, struct mp_error *err)
{
	struct polygon_sweep s = {.n = n, .tri = p->tri, .root = POLYGON_NONE};

	*split_up = false;
	if (make_room(&s, p, err))
		return -1;
	for (uint32_t i = 0; i < n; i++) {
		s.xy[i][0] = xyz[corner[i]][axis[0]];
		s.xy[i][1] = xyz[corner[i]][axis[1]];
		s.prev[i] = i > 0 ? i - 1 : n - 1;
		s.next[i] = i + 1 < n ? i + 1 : 0;
		s.side_of[i] = POLYGON_NONE;
	}
	polygon_sweep_sort(&s, s.link);
	take_events(&s);
	*split_up = !s.failed && s.open == 0;
	while (*split_up && s.done < n - 2) /* both sides of a bridge to nowhere, or of a gap */
		polygon_sweep_emit(&s, 0, 1, 0);
	return 0;
}
