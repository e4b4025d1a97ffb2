#include <math.h>

#include "core/exact/exact_private.h"

/*
 * Twice the width, for what a sine or a rotation leaves near 0 where it should leave 0: steps of
 * 2^-54 of the grid.  Numbers are digits of 60 bits, lowest first, unsigned but for the top one,
 * so that a column of 128 bits takes 64 products whole.  With X = 2^54*q, |X| <= h = 2^115, the
 * widths are, in bits besides the sign:
 *
 *   X, edges, a+b, s               115, 116, 116, 117     2 digits
 *   normal, 2*2^232                233                    4 digits
 *   d <= 4*h^3 (Hadamard)          347                    6 digits
 *   Q = (a+b)(a+b) + ... <= 3*2^232 234                   4 digits
 *   d*s, d*Q                       464, 581               8, 10 digits
 *
 * So no digit is longer than 60 bits, and no column has more than 3*4 products, below 2^124.  The
 * sums of 2^32 numbers are kept as sums of their digits, below 2^92.
 */
enum { STEP = 54, DIGIT = 60, MOST_DIGITS = 10 };

enum { LIMBS = 11 }; /* of 64 bits, for the whole sum of 613 and its sign */

#define DIGIT_MASK (((mp_u128)1 << DIGIT) - 1)

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

/* X of a coordinate; false where it is no integer. */
static bool find_digits(double x, const struct mp_exact_grid *grid, int axis, int64_t out[2])
{
	double scaled = x * grid->scale[axis][0] * grid->scale[axis][1];
	double whole = trunc(scaled), part = (scaled - whole) * 0x1p54; /* both exact */
	mp_i128 size;

	size = mp_mul_i64((int64_t)whole - grid->axis[axis].origin, (int64_t)1 << STEP) +
	       (int64_t)part;
	out[0] = (int64_t)((mp_u128)size & DIGIT_MASK);
	out[1] = (int64_t)(size >> DIGIT);
	return (double)(int64_t)part == part && (scaled != 0 || x == 0);
}

/* column += a*b, of ${na} and ${nb} digits */
static inline __attribute__((always_inline)) void multiply(mp_i128 *column, const int64_t *a,
							   int na, const int64_t *b, int nb)
{
	for (int i = 0; i < na; i++)
		for (int j = 0; j < nb; j++)
			column[i + j] += mp_mul_i64(a[i], b[j]);
}

/* ${n} digits, the last of which has the sign, of the columns. */
static inline __attribute__((always_inline)) void carry(const mp_i128 *column, int n, int64_t *out)
{
	mp_i128 sum = 0;

	for (int i = 0; i < n - 1; i++) {
		sum += column[i];
		out[i] = (int64_t)((mp_u128)sum & DIGIT_MASK);
		sum >>= DIGIT;
	}
	out[n - 1] = (int64_t)(sum + column[n - 1]);
}

/* out = a + side*b, of 2 digits */
static void add(const int64_t a[2], const int64_t b[2], int side, int64_t out[2])
{
	const mp_i128 column[2] = {(mp_i128)a[0] + side * b[0], (mp_i128)a[1] + side * b[1]};

	carry(column, 2, out);
}

/* d = a.((b-a) x (c-a)), corners x[corner][axis] */
static void find_determinant(int64_t x[3][3][2], int64_t d[6])
{
	int64_t e[3][2], f[3][2], minus[2], n[4];
	mp_i128 sum[6] = {0};

	for (int k = 0; k < 3; k++) {
		add(x[1][k], x[0][k], -1, e[k]);
		add(x[2][k], x[0][k], -1, f[k]);
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		mp_i128 normal[4] = {0};

		minus[0] = -e[j][0];
		minus[1] = -e[j][1];
		multiply(normal, e[i], 2, f[j], 2);
		multiply(normal, minus, 2, f[i], 2);
		carry(normal, 4, n);
		multiply(sum, x[0][k], 2, n, 4);
	}
	carry(sum, 6, d);
}

/* sum += the digits of the columns */
static inline __attribute__((always_inline)) void add_digits(mp_i128 sum[MP_EXACT_COLUMNS],
							     const mp_i128 *column, int n)
{
	int64_t digit[MOST_DIGITS];

	carry(column, n, digit);
	for (int i = 0; i < n; i++)
		sum[i] += digit[i];
}

static void add_second(mp_i128 (*sum)[MP_EXACT_COLUMNS], const int64_t d[6], int64_t pair[3][3][2])
{
	for (int k = 0; k < 6; k++) {
		mp_i128 square[4] = {0}, product[MOST_DIGITS] = {0};
		int64_t q[4];

		for (int c = 0; c < 3; c++)
			multiply(square, pair[c][AXES[k][0]], 2, pair[c][AXES[k][1]], 2);
		carry(square, 4, q);
		multiply(product, d, 6, q, 4);
		add_digits(sum[k], product, 10);
	}
}

bool mp_exact_digits_add(mp_i128 sum[MP_EXACT_SUMS][MP_EXACT_COLUMNS],
			 const struct mp_exact_grid *grid, const double tri[9])
{
	int64_t x[3][3][2], pair[3][3][2], d[6], s[2];

	for (int i = 0; i < 9; i++)
		if (!find_digits(tri[i], grid, i % 3, x[i / 3][i % 3]))
			return false;
	find_determinant(x, d);
	for (int i = 0; i < 6; i++)
		sum[0][i] += d[i];
	for (int k = 0; k < 3; k++) {
		mp_i128 product[8] = {0};

		for (int c = 0; c < 3; c++)
			add(x[c][k], x[(c + 1) % 3][k], 1, pair[c][k]);
		add(pair[0][k], x[2][k], 1, s);
		multiply(product, d, 6, s, 2);
		add_digits(sum[1 + k], product, 8);
	}
	add_second(sum + 4, d, pair);
	return true;
}

/* limbs += digit * 2^bit, in two's complement: digits are sums, longer than 60 bits. */
static void add_limbs(uint64_t limb[LIMBS], mp_i128 digit, int bit)
{
	uint64_t sign = digit < 0 ? UINT64_MAX : 0;
	int shift = bit % 64;
	mp_u128 low = (mp_u128)(uint64_t)digit << shift;
	mp_u128 high = ((mp_u128)sign << 64 | (uint64_t)(digit >> 64)) << shift;
	const uint64_t word[3] = {(uint64_t)low, (uint64_t)(low >> 64) | (uint64_t)high,
				  (uint64_t)(high >> 64)};
	mp_u128 sum = 0;

	for (int i = bit / 64, k = 0; i < LIMBS; i++, k++) {
		sum = (sum >> 64) + limb[i] + (k < 3 ? word[k] : sign);
		limb[i] = (uint64_t)sum;
	}
}

void mp_exact_digits_get(const mp_i128 sum[MP_EXACT_COLUMNS], int unit, int coordinates,
			 struct mp_big *out)
{
	uint64_t limb[LIMBS] = {0};
	bool negative;

	for (int i = 0; i < MP_EXACT_COLUMNS; i++)
		if (sum[i] != 0)
			add_limbs(limb, sum[i], DIGIT * i);
	negative = limb[LIMBS - 1] >> 63 != 0;
	for (int i = 0, carry = 1; i < LIMBS && negative; i++) {
		limb[i] = ~limb[i] + (uint64_t)carry;
		carry = carry != 0 && limb[i] == 0;
	}
	mp_big_set_limbs(out, negative ? -1 : 1, limb, LIMBS, unit - STEP * coordinates);
}
