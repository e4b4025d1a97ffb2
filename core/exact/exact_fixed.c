#include "core/exact/exact_private.h"

/*
 * Sums of products in registers.  With h = 2^61 >= |q| and m = 2^63 the widths are, in bits:
 *
 *   edges e, f                    <= 2^62
 *   normal n = e x f              <= 2*2^124 = 2^125; low63(n) < 2^63, n >> 63 within 2^62
 *   a.low63(n), a.(n >> 63)       <= 3*2^61*2^63 < 2^126
 *   d = a.n = det(a, b, c)        <= 4*h^3 = 2^185 (Hadamard)
 *   a+b, s = a+b+c                <= 2^62, 3*2^61 < 2^63
 *   Q = (a+b)(a+b) + ...          <= 3*2^124 < 2^126; low63(Q) < 2^63, Q >> 63 within 2^63
 *   sum of d*Q over the triangles <= 2^185*2^126*2^32 = 2^343, in 384
 *
 * d is cut into limbs of 48 bits, unsigned but for the top one, so that limb * (63 bits and a
 * sign) has 111 and a block of 128 of them 118 bits: a column of 128 bits takes the products
 * whole, and no carry is looked at before the block is over.  With 62 bits a coordinate d has 4
 * limbs.  With 50, d <= 2^149, it has 3, the top one of 53 bits, their sums of 60.  With 30,
 * d <= 2^89, it has 2, and Q <= 3*2^60 fits one word, n <= 2*2^60 too.
 */
enum { LIMB = 48, MOST_LIMBS = 4, WORD = 63, MIDDLE_BITS = 50, NARROW_BITS = 30 };

#define LIMB_MASK (((uint64_t)1 << LIMB) - 1)

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

struct block {
	size_t count;
	int64_t d[MP_EXACT_BLOCK][MOST_LIMBS];
	int64_t pair[3][3][MP_EXACT_BLOCK]; /* axis; a+b, b+c, c+a */
	int64_t s[3][MP_EXACT_BLOCK];
	int64_t q[2][MP_EXACT_BLOCK]; /* low63(Q), Q >> 63 */
};

static int64_t limb_of(uint64_t x)
{
	return (int64_t)(x & LIMB_MASK);
}

/* 4 limbs, or 3 where d fits them; the top one has the sign. */
static void split_wide(const int64_t t[9], int limbs, int64_t d[MOST_LIMBS])
{
	int64_t ex = t[3] - t[0], ey = t[4] - t[1], ez = t[5] - t[2];
	int64_t fx = t[6] - t[0], fy = t[7] - t[1], fz = t[8] - t[2];
	mp_i128 nx = mp_mul_i64(ey, fz) - mp_mul_i64(ez, fy);
	mp_i128 ny = mp_mul_i64(ez, fx) - mp_mul_i64(ex, fz);
	mp_i128 nz = mp_mul_i64(ex, fy) - mp_mul_i64(ey, fx);
	mp_i128 low = mp_mul_i64(t[0], mp_low63(nx)) + mp_mul_i64(t[1], mp_low63(ny)) +
		      mp_mul_i64(t[2], mp_low63(nz));
	mp_i128 high = mp_mul_i64(t[0], (int64_t)(nx >> WORD)) +
		       mp_mul_i64(t[1], (int64_t)(ny >> WORD)) +
		       mp_mul_i64(t[2], (int64_t)(nz >> WORD)) + (low >> WORD);
	uint64_t rest = (uint64_t)mp_low63(low); /* d = high*2^63 + rest, |high| <= 2^122 */

	d[0] = limb_of(rest);
	d[1] = limb_of(rest >> LIMB | (uint64_t)high << (WORD - LIMB));
	high >>= 2 * LIMB - WORD;
	if (limbs == 3) {
		d[2] = (int64_t)high;
		return;
	}
	d[2] = limb_of((uint64_t)high);
	d[3] = (int64_t)(high >> LIMB);
}

/* 2 limbs. */
static void split_narrow(const int64_t t[9], int64_t d[MOST_LIMBS])
{
	int64_t ex = t[3] - t[0], ey = t[4] - t[1], ez = t[5] - t[2];
	int64_t fx = t[6] - t[0], fy = t[7] - t[1], fz = t[8] - t[2];
	mp_i128 det = mp_mul_i64(t[0], ey * fz - ez * fy) + mp_mul_i64(t[1], ez * fx - ex * fz) +
		      mp_mul_i64(t[2], ex * fy - ey * fx);

	d[0] = limb_of((uint64_t)det);
	d[1] = (int64_t)(det >> LIMB);
}

static void prepare(struct block *b, int limbs, const int64_t (*tri)[9])
{
	for (size_t i = 0; i < b->count; i++) {
		if (limbs == 2)
			split_narrow(tri[i], b->d[i]);
		else
			split_wide(tri[i], limbs, b->d[i]);
	}
	for (int k = 0; k < 3; k++) {
		for (size_t i = 0; i < b->count; i++) {
			int64_t p = tri[i][k], q = tri[i][3 + k], r = tri[i][6 + k];

			b->pair[k][0][i] = p + q;
			b->pair[k][1][i] = q + r;
			b->pair[k][2][i] = r + p;
			b->s[k][i] = p + q + r;
		}
	}
}

/* sum += sum of d */
static void add_plain(struct mp_fixed *sum, const struct block *b, int limbs)
{
	int64_t column[MOST_LIMBS] = {0};

	for (size_t i = 0; i < b->count; i++)
		for (int k = 0; k < limbs; k++)
			column[k] += b->d[i][k];
	for (int k = 0; k < limbs; k++)
		mp_fixed_add(sum, column[k], LIMB * (unsigned)k);
}

/* sum += 2^bit * sum of d*factor.  The columns are single variables to stay in registers. */
static inline __attribute__((always_inline)) void add_products(struct mp_fixed *sum,
							       const struct block *b,
							       const int64_t *factor, int limbs,
							       unsigned bit)
{
	mp_i128 c0 = 0, c1 = 0, c2 = 0, c3 = 0;

	for (size_t i = 0; i < b->count; i++) {
		c0 += mp_mul_i64(factor[i], b->d[i][0]);
		c1 += mp_mul_i64(factor[i], b->d[i][1]);
		if (limbs > 2)
			c2 += mp_mul_i64(factor[i], b->d[i][2]);
		if (limbs > 3)
			c3 += mp_mul_i64(factor[i], b->d[i][3]);
	}
	mp_fixed_add(sum, c0, bit);
	mp_fixed_add(sum, c1, bit + LIMB);
	if (limbs > 2)
		mp_fixed_add(sum, c2, bit + 2 * LIMB);
	if (limbs > 3)
		mp_fixed_add(sum, c3, bit + 3 * LIMB);
}

static void find_squares_wide(struct block *b, const int64_t (*x)[MP_EXACT_BLOCK],
			      const int64_t (*y)[MP_EXACT_BLOCK])
{
	for (size_t i = 0; i < b->count; i++) {
		mp_i128 q = mp_mul_i64(x[0][i], y[0][i]) + mp_mul_i64(x[1][i], y[1][i]) +
			    mp_mul_i64(x[2][i], y[2][i]);

		b->q[0][i] = mp_low63(q);
		b->q[1][i] = (int64_t)(q >> WORD);
	}
}

static void find_squares_narrow(struct block *b, const int64_t (*x)[MP_EXACT_BLOCK],
				const int64_t (*y)[MP_EXACT_BLOCK])
{
	for (size_t i = 0; i < b->count; i++)
		b->q[0][i] = x[0][i] * y[0][i] + x[1][i] * y[1][i] + x[2][i] * y[2][i];
}

/* ${limbs} is a constant at every call, so that each becomes a kernel of its own. */
static inline __attribute__((always_inline)) void
add_block(struct mp_fixed sum[MP_EXACT_SUMS], struct block *b, int limbs, const int64_t (*tri)[9])
{
	prepare(b, limbs, tri);
	add_plain(&sum[0], b, limbs);
	for (int k = 0; k < 3; k++)
		add_products(&sum[1 + k], b, b->s[k], limbs, 0);
	for (int k = 0; k < 6; k++) {
		const int64_t(*x)[MP_EXACT_BLOCK] =
		    (const int64_t(*)[MP_EXACT_BLOCK])b->pair[AXES[k][0]];
		const int64_t(*y)[MP_EXACT_BLOCK] =
		    (const int64_t(*)[MP_EXACT_BLOCK])b->pair[AXES[k][1]];

		if (limbs == 2) {
			find_squares_narrow(b, x, y);
		} else {
			find_squares_wide(b, x, y);
			add_products(&sum[4 + k], b, b->q[1], limbs, WORD);
		}
		add_products(&sum[4 + k], b, b->q[0], limbs, 0);
	}
}

void mp_exact_fixed_add(struct mp_fixed sum[MP_EXACT_SUMS], unsigned bits, const int64_t (*tri)[9],
			size_t count)
{
	struct block b;

	b.count = count;
	if (bits <= NARROW_BITS)
		add_block(sum, &b, 2, tri);
	else if (bits <= MIDDLE_BITS)
		add_block(sum, &b, 3, tri);
	else
		add_block(sum, &b, 4, tri);
}
