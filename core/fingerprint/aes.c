#include "core/fingerprint/aes.h"

/*
 * Every bit of the state is a plane of its own: bit b of plane[i][k] is bit k of byte i of block b.
 * ShiftRows is then a change of names and the S-box a circuit.  The lanes are always the inner
 * loop, so that it becomes vectors.
 */
enum { LANES = MP_AES_BLOCKS / 64 };

struct state {
	uint64_t plane[16][8][LANES];
};

/*
 * The S-box in 113 gates: Boyar and Peralta, A depth-16 circuit for the AES S-box
 * (https://eprint.iacr.org/2011/332), the names are theirs.  x0 is the highest bit.
 */
static void substitute(uint64_t (*restrict q)[LANES])
{
	for (int j = 0; j < LANES; j++) {
		uint64_t x0 = q[7][j], x1 = q[6][j], x2 = q[5][j], x3 = q[4][j];
		uint64_t x4 = q[3][j], x5 = q[2][j], x6 = q[1][j], x7 = q[0][j];
		uint64_t y14 = x3 ^ x5, y13 = x0 ^ x6, y9 = x0 ^ x3, y8 = x0 ^ x5;
		uint64_t t0 = x1 ^ x2, y1 = t0 ^ x7, y4 = y1 ^ x3, y12 = y13 ^ y14;
		uint64_t y2 = y1 ^ x0, y5 = y1 ^ x6, y3 = y5 ^ y8, t1 = x4 ^ y12;
		uint64_t y15 = t1 ^ x5, y20 = t1 ^ x1, y6 = y15 ^ x7, y10 = y15 ^ t0;
		uint64_t y11 = y20 ^ y9, y7 = x7 ^ y11, y17 = y10 ^ y11, y19 = y10 ^ y8;
		uint64_t y16 = t0 ^ y11, y21 = y13 ^ y16, y18 = x0 ^ y16;

		uint64_t t2 = y12 & y15, t4 = (y3 & y6) ^ t2, t6 = (y4 & x7) ^ t2;
		uint64_t t7 = y13 & y16, t9 = (y5 & y1) ^ t7, t11 = (y2 & y7) ^ t7;
		uint64_t t12 = y9 & y11, t14 = (y14 & y17) ^ t12, t16 = (y8 & y10) ^ t12;
		uint64_t t21 = t4 ^ t14 ^ y20, t22 = t6 ^ t16 ^ y19;
		uint64_t t23 = t9 ^ t14 ^ y21, t24 = t11 ^ t16 ^ y18;
		uint64_t t25 = t21 ^ t22, t26 = t21 & t23, t27 = t24 ^ t26;
		uint64_t t29 = (t25 & t27) ^ t22, t30 = t23 ^ t24, t31 = t22 ^ t26;
		uint64_t t33 = (t31 & t30) ^ t24, t34 = t23 ^ t33, t35 = t27 ^ t33;
		uint64_t t36 = t24 & t35, t37 = t36 ^ t34, t38 = t27 ^ t36;
		uint64_t t40 = t25 ^ (t29 & t38), t41 = t40 ^ t37, t42 = t29 ^ t33;
		uint64_t t43 = t29 ^ t40, t44 = t33 ^ t37, t45 = t42 ^ t41;

		uint64_t z0 = t44 & y15, z1 = t37 & y6, z2 = t33 & x7, z3 = t43 & y16;
		uint64_t z4 = t40 & y1, z5 = t29 & y7, z6 = t42 & y11, z7 = t45 & y17;
		uint64_t z8 = t41 & y10, z9 = t44 & y12, z10 = t37 & y3, z11 = t33 & y4;
		uint64_t z12 = t43 & y13, z13 = t40 & y5, z14 = t29 & y2, z15 = t42 & y9;
		uint64_t z16 = t45 & y14, z17 = t41 & y8;

		uint64_t t46 = z15 ^ z16, t48 = z5 ^ z13, t50 = z2 ^ z12, t53 = z0 ^ z3;
		uint64_t t54 = z6 ^ z7, t57 = t50 ^ t53, t58 = z4 ^ t46, t59 = z3 ^ t54;
		uint64_t t60 = t46 ^ t57, t61 = z14 ^ t57, t62 = z7 ^ z8 ^ t58;
		uint64_t t63 = z9 ^ z10 ^ t58, t64 = z4 ^ t59, t65 = t61 ^ t62, t66 = z1 ^ t63;
		uint64_t s3 = t53 ^ t66;

		q[7][j] = t59 ^ t63;
		q[6][j] = t64 ^ ~s3;
		q[5][j] = z16 ^ z17 ^ ~(t64 ^ t65);
		q[4][j] = s3;
		q[3][j] = z2 ^ z5 ^ t66;
		q[2][j] = z10 ^ z11 ^ t65;
		q[1][j] = z12 ^ t48 ^ ~t62;
		q[0][j] = t48 ^ ~t60;
	}
}

/* Bit i of a[k] changes places with bit k of a[i] (Warren, Hacker's Delight, section 7-3). */
static void transpose(uint64_t a[64])
{
	uint64_t mask = UINT64_C(0xffffffff);

	for (unsigned j = 32; j != 0; j >>= 1, mask ^= mask << j) {
		for (unsigned k = 0; k < 64; k = ((k | j) + 1) & ~j) {
			uint64_t t = ((a[k] >> j) ^ a[k | j]) & mask;

			a[k] ^= t << j;
			a[k | j] ^= t;
		}
	}
}

static void slice(const uint64_t (*in)[2], size_t count, struct state *s)
{
	for (size_t j = 0; j < LANES; j++) {
		for (size_t half = 0; half < 2; half++) {
			uint64_t a[64];

			for (size_t b = 0; b < 64; b++)
				a[b] = 64 * j + b < count ? in[64 * j + b][half] : 0;
			transpose(a);
			for (size_t bit = 0; bit < 64; bit++)
				s->plane[8 * half + bit / 8][bit % 8][j] = a[bit];
		}
	}
}

static void unslice(const struct state *s, uint64_t (*out)[2], size_t count)
{
	for (size_t j = 0; j < LANES; j++) {
		for (size_t half = 0; half < 2; half++) {
			uint64_t a[64];

			for (size_t bit = 0; bit < 64; bit++)
				a[bit] = s->plane[8 * half + bit / 8][bit % 8][j];
			transpose(a);
			for (size_t b = 0; b < 64 && 64 * j + b < count; b++)
				out[64 * j + b][half] = a[b];
		}
	}
}

static void add_key(struct state *s, const uint64_t key[2])
{
	for (size_t i = 0; i < 128; i++) {
		uint64_t all = 0 - (key[i / 64] >> i % 64 & 1);

		for (int j = 0; j < LANES; j++)
			s->plane[i / 8][i % 8][j] ^= all;
	}
}

/* Byte r + 4*c comes from column c + r. */
static void shift_rows(const struct state *from, struct state *to)
{
	for (size_t i = 0; i < 16; i++)
		for (size_t k = 0; k < 8; k++)
			for (size_t j = 0; j < LANES; j++)
				to->plane[i][k][j] = from->plane[(i + 4 * (i % 4)) % 16][k][j];
}

/* out = a ^ all ^ 2*(a ^ b) in GF(2^8), all the sum of the column. */
static void mix_byte(uint64_t (*restrict a)[LANES], uint64_t (*restrict b)[LANES],
		     uint64_t (*restrict all)[LANES], uint64_t (*restrict out)[LANES])
{
	for (int k = 0; k < 8; k++) {
		int low = (k + 7) % 8;
		uint64_t carry =
		    k == 1 || k == 3 || k == 4 ? UINT64_MAX : 0; /* x^8 = x^4+x^3+x+1 */

		for (int j = 0; j < LANES; j++)
			out[k][j] = a[k][j] ^ all[k][j] ^ a[low][j] ^ b[low][j] ^
				    (carry & (a[7][j] ^ b[7][j]));
	}
}

static void mix_columns(struct state *from, struct state *to)
{
	for (size_t c = 0; c < 16; c += 4) {
		uint64_t all[8][LANES];

		for (size_t k = 0; k < 8; k++)
			for (size_t j = 0; j < LANES; j++)
				all[k][j] = from->plane[c][k][j] ^ from->plane[c + 1][k][j] ^
					    from->plane[c + 2][k][j] ^ from->plane[c + 3][k][j];
		for (size_t r = 0; r < 4; r++)
			mix_byte(from->plane[c + r], from->plane[c + (r + 1) % 4], all,
				 to->plane[c + r]);
	}
}

void mp_aes_encrypt(const struct mp_aes *aes, const uint64_t (*in)[2], uint64_t (*out)[2],
		    size_t count)
{
	struct state s, shifted;

	slice(in, count, &s);
	add_key(&s, aes->round[0]);
	for (int round = 1; round <= 10; round++) {
		for (size_t i = 0; i < 16; i++)
			substitute(s.plane[i]);
		shift_rows(&s, &shifted);
		if (round < 10)
			mix_columns(&shifted, &s);
		else
			s = shifted;
		add_key(&s, aes->round[round]);
	}
	unslice(&s, out, count);
}

/* The S-box on each byte of a word of the key. */
static uint32_t substitute_word(uint32_t word)
{
	uint64_t q[8][LANES] = {{0}};
	uint32_t out = 0;

	for (unsigned i = 0; i < 32; i++)
		q[i % 8][0] |= (uint64_t)(word >> i & 1) << i / 8;
	substitute(q);
	for (unsigned i = 0; i < 32; i++)
		out |= (uint32_t)(q[i % 8][0] >> i / 8 & 1) << i;
	return out;
}

void mp_aes_expand(struct mp_aes *aes, const uint64_t key[2])
{
	uint32_t w[44], constant = 1;

	for (unsigned i = 0; i < 4; i++)
		w[i] = (uint32_t)(key[i / 2] >> 32 * (i % 2));
	for (unsigned i = 4; i < 44; i++) {
		uint32_t t = w[i - 1];

		if (i % 4 == 0) {
			t = substitute_word(t >> 8 | t << 24) ^ constant;
			constant = (constant << 1 ^ (constant >> 7) * 0x11b) & 0xff;
		}
		w[i] = w[i - 4] ^ t;
	}
	for (unsigned i = 0; i < 22; i++)
		aes->round[i / 2][i % 2] = w[2 * i] | (uint64_t)w[2 * i + 1] << 32;
}
