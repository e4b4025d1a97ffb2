#ifndef API_DIGEST_H
#define API_DIGEST_H

#include <nettle/sha2.h>
#include <stddef.h>
#include <stdint.h>

/* SHA-256 of what passes by, in hexadecimal, by nettle. */

enum { API_DIGEST_SIZE = 2 * SHA256_DIGEST_SIZE + 1 };

struct api_digest {
	struct sha256_ctx context;
};

void api_digest_begin(struct api_digest *);
void api_digest_add(struct api_digest *, const uint8_t *bytes, size_t len);
void api_digest_end(struct api_digest *, char hex[API_DIGEST_SIZE]); /* begins anew */

#endif
