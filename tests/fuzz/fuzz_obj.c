/*
 * Any bytes: cut in any way they decode to the same triangles, names, notes and errors; triangles
 * are finite and come in full blocks.  The cuts hang on the bytes themselves.
 */
#include <math.h>

#include "../unit/obj_seen.h"
#include "cut.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct seen whole, other;
	const uint64_t dice = cut_dice(data, size);
	const uint64_t most = (dice >> 48) % 32 == 0 ? 3 : 100000;
	const struct cut cut = cut_of(dice, size);

	seen_decode(&whole, data, size, SIZE_MAX, SIZE_MAX, most);
	seen_decode(&other, data, size, cut.first, cut.step, most);
	if (!seen_same(&whole, &other))
		abort();
	for (uint64_t i = 0; i < whole.count && i < SEEN_TRIANGLES; i++)
		for (int k = 0; k < 9; k++)
			if (!isfinite(whole.tri[i][k]))
				abort();
	if (whole.ret == 0 && whole.count == 0)
		abort();
	if (whole.ret != 0 && whole.err.code == MP_BUG)
		abort();
	return 0;
}
