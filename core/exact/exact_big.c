#include "core/exact/exact_big.h"

#include <assert.h>
#include <string.h>

_Static_assert(GMP_NUMB_BITS == 64 && sizeof(mp_limb_t) == sizeof(uint64_t),
	       "limbs are taken for uint64_t");

static void trim(struct mp_big *x)
{
	while (x->n > 0 && x->d[x->n - 1] == 0)
		x->n--;
	if (x->n == 0)
		x->sign = 0;
}

void mp_big_set(struct mp_big *out, int sign, uint64_t size, int exponent)
{
	out->sign = size == 0 ? 0 : sign;
	out->exponent = exponent;
	out->n = size != 0;
	out->d[0] = size;
}

void mp_big_set_i64(struct mp_big *out, int64_t x, int exponent)
{
	mp_big_set(out, x < 0 ? -1 : 1, x < 0 ? -(uint64_t)x : (uint64_t)x, exponent);
}

/* By its bits, for the GMP path spends half its time here with frexp() and ldexp(). */
void mp_big_set_double(struct mp_big *out, double x)
{
	uint64_t bits, size;
	int exponent, zeros;

	memcpy(&bits, &x, sizeof bits);
	exponent = (int)(bits >> 52 & 0x7ff);
	size = bits & (((uint64_t)1 << 52) - 1);
	if (exponent > 0)
		size |= (uint64_t)1 << 52;
	else
		exponent = 1;
	zeros = size == 0 ? 0 : __builtin_ctzll(size);
	mp_big_set(out, bits >> 63 ? -1 : 1, size >> zeros, exponent - 1075 + zeros);
}

void mp_big_set_limbs(struct mp_big *out, int sign, const uint64_t *limb, int n, int exponent)
{
	assert(n <= MP_BIG_LIMBS);
	out->sign = sign;
	out->exponent = exponent;
	out->n = n;
	if (n > 0)
		memcpy(out->d, limb, (size_t)n * sizeof *limb);
	trim(out);
}

void mp_big_copy(struct mp_big *out, const struct mp_big *x)
{
	out->sign = x->sign;
	out->exponent = x->exponent;
	out->n = x->n;
	memcpy(out->d, x->d, (size_t)x->n * sizeof x->d[0]);
}

int mp_big_bits(const struct mp_big *x)
{
	return x->n == 0 ? 0 : 64 * x->n - __builtin_clzll(x->d[x->n - 1]);
}

int mp_big_shift(const mp_limb_t *a, int n, unsigned shift, mp_limb_t *out)
{
	int limbs = (int)(shift / 64);

	assert(n + limbs < MP_BIG_LIMBS);
	memset(out, 0, (size_t)limbs * sizeof *out);
	if (n == 0)
		return 0;
	out[n + limbs] = 0;
	if (shift % 64 != 0)
		out[n + limbs] = mpn_lshift(out + limbs, a, n, shift % 64);
	else
		memcpy(out + limbs, a, (size_t)n * sizeof *a);
	n += limbs;
	return n + (out[n] != 0);
}

/* |out| = |big| +- |small|, the limbs of the same unit, big not the shorter one. */
static void join(const mp_limb_t *big, int nb, const mp_limb_t *small, int ns, int minus,
		 struct mp_big *out)
{
	out->n = nb;
	if (minus) {
		mpn_sub(out->d, big, nb, small, ns);
		return;
	}
	if (mpn_add(out->d, big, nb, small, ns) != 0) {
		assert(nb < MP_BIG_LIMBS);
		out->d[out->n++] = 1;
	}
}

void mp_big_add(const struct mp_big *a, const struct mp_big *b, int side, struct mp_big *out)
{
	mp_limb_t shifted[MP_BIG_LIMBS];
	const struct mp_big *fine = a->exponent <= b->exponent ? a : b;
	const struct mp_big *coarse = fine == a ? b : a;
	const mp_limb_t *p = coarse->d;
	int sp = fine == a ? side * b->sign : a->sign, sq = fine == a ? a->sign : side * b->sign;
	int np = coarse->n, exponent = fine->exponent;

	if (a->sign == 0 || b->sign == 0) {
		const struct mp_big *x = a->sign == 0 ? b : a;
		int sign = a->sign == 0 ? side * b->sign : a->sign;

		if (out != x)
			mp_big_copy(out, x);
		out->sign = sign;
		return;
	}
	if (coarse->exponent != exponent) {
		np = mp_big_shift(p, np, (unsigned)(coarse->exponent - exponent), shifted);
		p = shifted;
	}
	if (np < fine->n || (np == fine->n && mpn_cmp(p, fine->d, np) < 0)) {
		join(fine->d, fine->n, p, np, sp != sq, out);
		out->sign = sq;
	} else {
		join(p, np, fine->d, fine->n, sp != sq, out);
		out->sign = sp;
	}
	out->exponent = exponent;
	trim(out);
}

void mp_big_mul(const struct mp_big *a, const struct mp_big *b, struct mp_big *out)
{
	const struct mp_big *big = a->n >= b->n ? a : b, *small = big == a ? b : a;

	out->sign = a->sign * b->sign;
	out->exponent = a->exponent + b->exponent;
	out->n = 0;
	if (out->sign == 0)
		return;
	assert(a->n + b->n <= MP_BIG_LIMBS);
	mpn_mul(out->d, big->d, big->n, small->d, small->n);
	out->n = a->n + b->n;
	trim(out);
}

void mp_big_scale(struct mp_big *io, unsigned factor)
{
	mp_limb_t carry;

	if (io->n == 0)
		return;
	carry = mpn_mul_1(io->d, io->d, io->n, factor);
	if (carry != 0) {
		assert(io->n < MP_BIG_LIMBS);
		io->d[io->n++] = carry;
	}
}
