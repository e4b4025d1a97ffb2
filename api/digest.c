#include "api/digest.h"

void api_digest_begin(struct api_digest *d)
{
	sha256_init(&d->context);
}

void api_digest_add(struct api_digest *d, const uint8_t *bytes, size_t len)
{
	sha256_update(&d->context, len, bytes);
}

void api_digest_end(struct api_digest *d, char hex[API_DIGEST_SIZE])
{
	static const char digits[] = "0123456789abcdef";
	uint8_t digest[SHA256_DIGEST_SIZE];

	sha256_digest(&d->context, sizeof digest, digest);
	for (size_t i = 0; i < sizeof digest; i++) {
		hex[2 * i] = digits[digest[i] >> 4];
		hex[2 * i + 1] = digits[digest[i] & 15];
	}
	hex[2 * sizeof digest] = '\0';
}
