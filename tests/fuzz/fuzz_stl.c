/*
 * Any bytes: cut in any way they decode to the same triangles, parts, notes and errors; triangles
 * are finite and come in full blocks.  The cuts hang on the bytes themselves.
 */
#include <math.h>

#include "../unit/stl_seen.h"
#include "cut.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { WINDOW = 4096 }; /* what the decoder collects before it begins */

static struct seen whole, other;

static void check(const uint8_t *data, size_t size, size_t behind)
{
	const uint64_t dice = cut_dice(data + behind, size - behind);
	const uint64_t most = (dice >> 48) % 32 == 0 ? 3 : 100000;
	const struct cut cut = cut_of(dice, size - behind);

	seen_decode(&whole, data, size, SIZE_MAX, SIZE_MAX, most);
	seen_decode(&other, data, size, behind + cut.first, cut.step, most);
	if (!seen_same(&whole, &other))
		abort();
	for (uint64_t i = 0; i < whole.count && i < SEEN_TRIANGLES; i++)
		for (int k = 0; k < 9; k++)
			if (!isfinite(whole.tri[i][k]))
				abort();
	if (whole.ret == 0 && whole.count == 0)
		abort();
}

/*
 * As it is; and behind a window of text or of binary facets, so that short inputs are cut, too.
 * The window takes longer than a short input, so only every eighth has one.
 */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static uint8_t padded[WINDOW + (1 << 20)];

	check(data, size, 0);
	if (size == 0 || size > sizeof padded - WINDOW || cut_dice(data, size) >> 24 & 7)
		return 0;
	memset(padded, data[0] % 4 == 0 ? 0 : ' ', WINDOW);
	if (data[0] % 4 == 0)
		padded[80] = data[0];
	memcpy(padded + WINDOW, data, size);
	check(padded, WINDOW + size, WINDOW);
	return 0;
}
