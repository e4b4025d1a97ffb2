#ifndef MP_FINGERPRINT_KERNEL_H
#define MP_FINGERPRINT_KERNEL_H

#include "core/decoder.h"
#include "core/fingerprint/fingerprint.h"

/* The sums over a block of triangles, in copies for what the processor can do; all of them compute
 * the same function. */
struct mp_fingerprint_kernel {
	const char *name;
	/* Add ${count} <= MP_BLOCK triangles to the sums of both keys. */
	void (*add)(const struct mp_aes key[2], const double (*tri)[9], size_t count,
		    uint64_t sum[2]);
	/* The same of coordinates that are floats, xyz[k][i] being that of tri[i][k]. */
	void (*add_floats)(const struct mp_aes key[2], const float (*xyz)[MP_BLOCK], size_t count,
			   uint64_t sum[2]);
};

/* The kernels that this machine can run, the portable one first, the best one last. */
size_t mp_fingerprint_kernels(void);
const struct mp_fingerprint_kernel *mp_fingerprint_kernel(size_t i);

/* mp_aes_encrypt() by other means. */
struct mp_cipher {
	void (*encrypt)(const struct mp_aes *, const uint64_t (*in)[2], uint64_t (*out)[2],
			size_t count);
};

/* The sums by definition, with whatever coordinates; ${count} <= MP_BLOCK. */
void mp_fingerprint_plain(const struct mp_cipher *, const struct mp_aes key[2],
			  const double (*tri)[9], size_t count, uint64_t sum[2]);

#endif
