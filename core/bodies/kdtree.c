#include "core/bodies/kdtree.h"

static void swap(struct mp_kd_point *a, struct mp_kd_point *b)
{
	struct mp_kd_point t = *a;

	*a = *b;
	*b = t;
}

static void sift(struct mp_kd_point *a, size_t i, size_t n, unsigned axis)
{
	for (size_t child = 2 * i + 1; child < n; child = 2 * i + 1) {
		if (child + 1 < n && a[child].p[axis] < a[child + 1].p[axis])
			child++;
		if (a[i].p[axis] >= a[child].p[axis])
			return;
		swap(&a[i], &a[child]);
		i = child;
	}
}

static void heapsort(struct mp_kd_point *a, size_t n, unsigned axis)
{
	for (size_t i = n / 2; i-- > 0;)
		sift(a, i, n, axis);
	for (size_t last = n; last-- > 1;) {
		swap(&a[0], &a[last]);
		sift(a, 0, last, axis);
	}
}

static double median3(double a, double b, double c)
{
	double low = a < b ? a : b, high = a < b ? b : a;

	return c < low ? low : c > high ? high : c;
}

/*
 * Place the point of rank ${k}: quickselect, and heapsort once that has looked at more than any
 * but contrived input needs (Musser 1997).
 */
static void select_rank(struct mp_kd_point *a, size_t n, size_t k, unsigned axis)
{
	size_t work = 0, limit = 8 * n;

	while (n > 1) {
		double pivot = median3(a[0].p[axis], a[n / 2].p[axis], a[n - 1].p[axis]);
		ptrdiff_t i = 0, j = (ptrdiff_t)n - 1;

		work += n;
		if (work > limit) {
			heapsort(a, n, axis);
			return;
		}
		while (i <= j) {
			while (a[i].p[axis] < pivot)
				i++;
			while (a[j].p[axis] > pivot)
				j--;
			if (i <= j)
				swap(&a[i++], &a[j--]);
		}
		if ((ptrdiff_t)k <= j) {
			n = (size_t)j + 1;
		} else if ((ptrdiff_t)k >= i) {
			a += i;
			n -= (size_t)i;
			k -= (size_t)i;
		} else {
			return;
		}
	}
}

static void build(struct mp_kd_point *a, size_t n, unsigned axis)
{
	while (n > 1) {
		size_t middle = n / 2;

		select_rank(a, n, middle, axis);
		axis = (axis + 1) % 3;
		build(a, middle, axis);
		a += middle + 1;
		n -= middle + 1;
	}
}

void mp_kd_build(struct mp_kd_point *a, size_t n)
{
	build(a, n, 0);
}

struct search {
	const double *lo, *hi;
	uint64_t *steps;
	int (*visit)(void *self, uint32_t id);
	void *self;
};

static bool inside(const struct search *s, const double p[3])
{
	return s->lo[0] <= p[0] && p[0] <= s->hi[0] && s->lo[1] <= p[1] && p[1] <= s->hi[1] &&
	       s->lo[2] <= p[2] && p[2] <= s->hi[2];
}

/* As deep as the tree: 64 at most. */
static int search(const struct search *s, const struct mp_kd_point *a, size_t n, unsigned axis)
{
	while (n > 0) {
		size_t middle = n / 2;
		const struct mp_kd_point *m = &a[middle];
		bool right = s->hi[axis] >= m->p[axis];
		unsigned next = (axis + 1) % 3;

		if (*s->steps == 0)
			return -1;
		--*s->steps;
		if (inside(s, m->p) && s->visit(s->self, m->id))
			return -1;
		if (s->lo[axis] <= m->p[axis] && search(s, a, middle, next))
			return -1;
		if (!right)
			return 0;
		a = m + 1;
		n -= middle + 1;
		axis = next;
	}
	return 0;
}

int mp_kd_search(const struct mp_kd_point *a, size_t n, const double lo[3], const double hi[3],
		 uint64_t *steps, int (*visit)(void *self, uint32_t id), void *self)
{
	struct search s = {.lo = lo, .hi = hi, .steps = steps, .visit = visit, .self = self};

	return search(&s, a, n, 0);
}
