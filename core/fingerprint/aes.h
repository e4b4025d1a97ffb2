#ifndef MP_AES_H
#define MP_AES_H

#include <stddef.h>
#include <stdint.h>

/*
 * AES-128 (FIPS 197) as a keyed function of 16 bytes, in C without tables, 256 blocks side by
 * side: what machines without instructions for it use, and what those that have them are held
 * against.  A block is two words, byte i of the standard in bits 8*(i%8) of word i/8.
 */
struct mp_aes {
	uint64_t round[11][2]; /* round keys, as blocks */
};

enum { MP_AES_BLOCKS = 256 }; /* at most in one call */

void mp_aes_expand(struct mp_aes *, const uint64_t key[2]);

/* out[i] = AES(in[i]), ${count} <= MP_AES_BLOCKS; ${out} may be ${in}. */
void mp_aes_encrypt(const struct mp_aes *, const uint64_t (*in)[2], uint64_t (*out)[2],
		    size_t count);

#endif
