#include "core/fingerprint/fingerprint.h"

#include <string.h>

#include "core/fingerprint/fingerprint_kernel.h"

_Static_assert((int)MP_BLOCK <= (int)MP_AES_BLOCKS,
	       "a corner of every triangle fits into one call");

/* Bits 32 to 63 of the second word: the high half of a double that no coordinate is. */
#define FLOAT_TAG (UINT64_C(0xffffffff) << 32)

/* The blocks of one corner of each triangle. */
struct corners {
	uint64_t first[MP_BLOCK][2], second[MP_BLOCK][2];
	bool two[MP_BLOCK]; /* the second counts */
	bool some;          /* of them */
};

/*
 * Whether the finite double of these ${bits} is a float, and which.  In integers, for what a
 * compiler may do with conversions there and back.
 */
static bool is_float(uint64_t bits, uint32_t *out)
{
	uint64_t sign = bits >> 63 << 31, exponent = bits >> 52 & 0x7ff;
	uint64_t digits = (bits & ((UINT64_C(1) << 52) - 1)) | UINT64_C(1) << 52;
	uint64_t lost;

	if (bits << 1 == 0) {
		*out = 0; /* -0 too */
		return true;
	}
	if (exponent < 874 || exponent > 1150) /* below 2^-149, from 2^128 on */
		return false;
	lost = exponent < 897 ? 29 + 897 - exponent : 29;
	if ((digits & ((UINT64_C(1) << lost) - 1)) != 0)
		return false;
	*out = (uint32_t)(sign | digits >> lost);
	if (exponent >= 897) /* the leading 1 goes away with what is added */
		*out += (uint32_t)((exponent - 897) << 23);
	return true;
}

static void encode(const double p[3], struct corners *c, size_t i)
{
	uint64_t bits[3];
	uint32_t f[3] = {0, 0, 0};
	bool floats = true;

	memcpy(bits, p, sizeof bits);
	for (int k = 0; k < 3; k++) {
		floats = is_float(bits[k], &f[k]) && floats;
		if (bits[k] << 1 == 0)
			bits[k] = 0;
	}
	c->two[i] = !floats;
	c->some = c->some || !floats;
	c->first[i][0] = floats ? f[0] | (uint64_t)f[1] << 32 : bits[0];
	c->first[i][1] = floats ? f[2] | FLOAT_TAG : bits[1];
	c->second[i][0] = bits[2];
	c->second[i][1] = 0;
}

static void compute(const struct mp_cipher *cipher, const struct mp_aes *key,
		    const struct corners *c, size_t count, uint64_t (*out)[2])
{
	uint64_t again[MP_BLOCK][2];

	cipher->encrypt(key, c->first, out, count);
	if (!c->some)
		return;
	for (size_t i = 0; i < count; i++)
		for (int k = 0; k < 2; k++)
			again[i][k] = out[i][k] ^ c->second[i][k];
	cipher->encrypt(key, (const uint64_t(*)[2])again, again, count);
	for (size_t i = 0; i < count; i++)
		if (c->two[i])
			memcpy(out[i], again[i], sizeof out[i]);
}

void mp_fingerprint_plain(const struct mp_cipher *cipher, const struct mp_aes key[2],
			  const double (*tri)[9], size_t count, uint64_t sum[2])
{
	uint64_t v[3][MP_BLOCK][2];
	struct corners corners[3];

	for (size_t k = 0; k < 3; k++) {
		corners[k].some = false;
		for (size_t i = 0; i < count; i++)
			encode(tri[i] + 3 * k, &corners[k], i);
	}
	for (size_t lane = 0; lane < 2; lane++) {
		for (size_t k = 0; k < 3; k++)
			compute(cipher, &key[lane], &corners[k], count, v[k]);
		for (size_t i = 0; i < count; i++) {
			const uint64_t *a = v[0][i], *b = v[1][i], *c = v[2][i];

			sum[lane] += (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
		}
	}
}

void mp_fingerprint_begin(struct mp_fingerprint *f, const uint8_t key[16])
{
	uint64_t secret[2] = {0, 0}, lanes[2][2] = {{1, 0}, {2, 0}};
	struct mp_aes aes;

	for (size_t i = 0; i < 16; i++)
		secret[i / 8] |= (uint64_t)key[i] << 8 * (i % 8);
	f->kernel = mp_fingerprint_kernel(mp_fingerprint_kernels() - 1);
	mp_aes_expand(&aes, secret);
	mp_aes_encrypt(&aes, (const uint64_t(*)[2])lanes, lanes, 2);
	for (size_t lane = 0; lane < 2; lane++) {
		mp_aes_expand(&f->key[lane], lanes[lane]);
		f->sum[lane] = 0;
	}
}

void mp_fingerprint_add(struct mp_fingerprint *f, const double (*tri)[9], size_t count)
{
	f->kernel->add(f->key, tri, count, f->sum);
}

void mp_fingerprint_add_floats(struct mp_fingerprint *f, const float (*xyz)[MP_BLOCK], size_t count)
{
	f->kernel->add_floats(f->key, xyz, count, f->sum);
}

bool mp_fingerprint_closed(const struct mp_fingerprint *f)
{
	return f->sum[0] == 0 && f->sum[1] == 0;
}
