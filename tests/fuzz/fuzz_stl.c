/*
 * Any bytes: cut in any way they decode to the same triangles, parts, notes and errors; triangles
 * are finite and come in full blocks.  The cuts hang on the bytes themselves.
 */
#include <math.h>

#include "../unit/stl_seen.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { WINDOW = 4096 }; /* what the decoder collects before it begins */

static struct seen whole, other;

static uint64_t hash_of(const uint8_t *data, size_t size)
{
	other.hash = 0;
	seen_hash(&other, data, size);
	return other.hash >> 8;
}

static void check(const uint8_t *data, size_t size, size_t first)
{
	const uint64_t dice = hash_of(data, size);
	const uint64_t most = (dice >> 32) % 32 == 0 ? 3 : 100000;

	seen_decode(&whole, data, size, SIZE_MAX, SIZE_MAX, most);
	seen_decode(&other, data, size, first + dice % 256, 1 + (dice >> 16) % 200, most);
	if (!seen_same(&whole, &other))
		abort();
	seen_decode(&other, data, size, first, 1 + (dice >> 8) % 8, most);
	if (!seen_same(&whole, &other))
		abort();
	for (uint64_t i = 0; i < whole.count && i < SEEN_TRIANGLES; i++)
		for (int k = 0; k < 9; k++)
			if (!isfinite(whole.tri[i][k]))
				abort();
	if (whole.ret == 0 && whole.count == 0)
		abort();
}

/* As it is, and behind a window of blanks or of a binary STL, so that short inputs are cut, too. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint8_t *padded = malloc(WINDOW + size);
	bool binary = size > 0 && data[0] % 4 == 0;

	if (padded == NULL)
		return 0;
	check(data, size, 0);
	memset(padded, binary ? 0 : ' ', WINDOW);
	if (binary)
		padded[80] = data[0];
	if (size > 0)
		memcpy(padded + WINDOW, data, size);
	check(padded, WINDOW + size, WINDOW);
	free(padded);
	return 0;
}
