#include "core/exact/exact_private.h"

/*
 * One triangle at a time in numbers as long as they need be: each has the exponent of its own
 * lowest bit, so that a long number is paid for by the triangles that have it.
 */

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

/* out = a*b - c*d */
static void cross(const struct mp_big *a, const struct mp_big *b, const struct mp_big *c,
		  const struct mp_big *d, struct mp_big *out)
{
	struct mp_big left, right;

	mp_big_mul(a, b, &left);
	mp_big_mul(c, d, &right);
	mp_big_add(&left, &right, -1, out);
}

static void add_product(struct mp_big *sum, const struct mp_big *a, const struct mp_big *b)
{
	struct mp_big product;

	mp_big_mul(a, b, &product);
	mp_big_add(sum, &product, 1, sum);
}

/* d = a.((b-a) x (c-a)), corners q[corner][axis] */
static void determinant(struct mp_big q[3][3], struct mp_big *d)
{
	struct mp_big e[3], f[3], n;

	for (int k = 0; k < 3; k++) {
		mp_big_add(&q[1][k], &q[0][k], -1, &e[k]);
		mp_big_add(&q[2][k], &q[0][k], -1, &f[k]);
	}
	mp_big_set(d, 0, 0, 0);
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;

		cross(&e[i], &f[j], &e[j], &f[i], &n);
		add_product(d, &q[0][k], &n);
	}
}

static void add_second(struct mp_big sum[6], const struct mp_big *d, struct mp_big pair[3][3])
{
	struct mp_big square;

	for (int k = 0; k < 6; k++) {
		mp_big_set(&square, 0, 0, 0);
		for (int c = 0; c < 3; c++)
			add_product(&square, &pair[c][AXES[k][0]], &pair[c][AXES[k][1]]);
		add_product(&sum[k], d, &square);
	}
}

void mp_exact_gmp_add(struct mp_big sum[MP_EXACT_SUMS], const struct mp_exact_axis axis[3],
		      const double tri[9])
{
	struct mp_big q[3][3], pair[3][3], origin, d, s;

	for (int k = 0; k < 3; k++) {
		mp_big_set_i64(&origin, axis[k].origin, axis[k].exponent);
		for (int c = 0; c < 3; c++) {
			mp_big_set_double(&s, tri[3 * c + k]);
			mp_big_add(&s, &origin, -1, &q[c][k]);
		}
		for (int c = 0; c < 3; c++)
			mp_big_add(&q[c][k], &q[(c + 1) % 3][k], 1, &pair[c][k]);
	}
	determinant(q, &d);
	if (d.sign == 0)
		return;
	mp_big_add(&sum[0], &d, 1, &sum[0]);
	for (int k = 0; k < 3; k++) {
		mp_big_add(&pair[0][k], &q[2][k], 1, &s);
		add_product(&sum[1 + k], &d, &s);
	}
	add_second(sum + 4, &d, pair);
}
