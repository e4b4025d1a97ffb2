/*
 * Any bytes: cut in any way they decode to the same triangles, names, notes and errors; triangles
 * are finite and come in full blocks.  The cuts hang on the bytes themselves.
 */
#include <math.h>

#include "../unit/obj_seen.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct seen whole, other;
	uint64_t most, dice, first, step;

	other.hash = 0;
	seen_hash(&other, data, size);
	dice = other.hash >> 8;
	first = dice % 100;
	step = 1 + (dice >> 16) % 40;
	most = (dice >> 32) % 32 == 0 ? 3 : 100000;
	seen_decode(&whole, data, size, SIZE_MAX, SIZE_MAX, most);
	seen_decode(&other, data, size, first, step, most);
	if (!seen_same(&whole, &other))
		abort();
	seen_decode(&other, data, size, 1, 1, most);
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
