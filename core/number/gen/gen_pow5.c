/*
 * Prints the 128-bit powers of five that Eisel-Lemire multiplies with (Lemire 2021,
 * doi:10.1002/spe.2984): for every q the top 128 bits of 5^q, the highest bit set.  Powers with
 * q >= 0 are rounded down; reciprocals are rounded up down to 5^-27 and rounded down below, as the
 * proof in the paper wants.
 */
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { LOWEST = -342, HIGHEST = 308 };
enum { LIMBS = 26 }; /* 5^342 has 795 bits, one more for doubling a remainder */

struct big { /* little-endian */
	uint32_t limb[LIMBS];
};

static void times(struct big *a, uint32_t factor)
{
	uint64_t carry = 0;

	for (int i = 0; i < LIMBS; i++) {
		carry += (uint64_t)a->limb[i] * factor;
		a->limb[i] = (uint32_t)carry;
		carry >>= 32;
	}
}

static int compare(const struct big *a, const struct big *b)
{
	for (int i = LIMBS - 1; i >= 0; i--) {
		if (a->limb[i] != b->limb[i])
			return a->limb[i] < b->limb[i] ? -1 : 1;
	}
	return 0;
}

static void subtract(struct big *a, const struct big *b) /* a >= b */
{
	uint64_t borrow = 0;

	for (int i = 0; i < LIMBS; i++) {
		uint64_t d = (uint64_t)a->limb[i] - b->limb[i] - borrow;

		a->limb[i] = (uint32_t)d;
		borrow = d >> 63;
	}
}

static int bit(const struct big *a, int i)
{
	return i < 0 ? 0 : (int)(a->limb[i / 32] >> (i % 32) & 1);
}

static void power(int q, uint64_t out[2])
{
	struct big a = {{1}};
	int top = LIMBS * 32 - 1;

	for (int i = 0; i < q; i++)
		times(&a, 5);
	while (bit(&a, top) == 0)
		top--;
	for (int i = 0; i < 128; i++)
		out[i / 64] = out[i / 64] << 1 | (uint64_t)bit(&a, top - i);
}

static void reciprocal(int q, uint64_t out[2])
{
	struct big divisor = {{1}}, rest = {{1}};

	for (int i = 0; i < q; i++)
		times(&divisor, 5);
	while (compare(&rest, &divisor) < 0)
		times(&rest, 2);
	for (int i = 0; i < 128; i++) { /* long division, one bit at a time */
		int one = compare(&rest, &divisor) >= 0;

		if (one)
			subtract(&rest, &divisor);
		times(&rest, 2);
		out[i / 64] = out[i / 64] << 1 | (uint64_t)one;
	}
	if (q <= 27 && ++out[1] == 0)
		out[0]++;
}

int main(void)
{
	printf("/* Made by core/number/gen/gen_pow5.c: { high, low } of 5^q, q from POW5_LOWEST. "
	       "*/\n");
	printf("enum { POW5_LOWEST = %d, POW5_HIGHEST = %d };\n", LOWEST, HIGHEST);
	printf("static const uint64_t pow5_table[%d][2] = {\n", HIGHEST - LOWEST + 1);
	for (int q = LOWEST; q <= HIGHEST; q++) {
		uint64_t v[2] = {0, 0};

		if (q < 0)
			reciprocal(-q, v);
		else
			power(q, v);
		printf("\t{0x%016" PRIx64 "u, 0x%016" PRIx64 "u},\n", v[0], v[1]);
	}
	printf("};\n");
	return fflush(stdout) != 0 || ferror(stdout) != 0;
}
