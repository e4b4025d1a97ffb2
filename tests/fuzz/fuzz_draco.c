/*
 * The Draco decoder's own code (libdraco is replaced by a stub): any bytes as a file, any promises
 * and indices as what libdraco made of it.  Wherever the file is cut, the same comes out; nothing
 * is read that was not promised; triangles are finite.
 *
 * 32 bytes say what the stub delivers, then comes the file.
 */
#include <math.h>

#include "../unit/draco_seen.h"
#include "../unit/draco_stub.h"

enum { TOLD = 32, FACES = 300, VALUES = 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Mostly small numbers, some at the very end of the range. */
static uint64_t odd(uint8_t byte, uint64_t usual)
{
	if (byte < 128)
		return usual;
	return byte < 240 ? byte - 128u : UINT64_MAX >> (byte & 7) * 8;
}

/* Positions are in exactly as many bytes as the stub says there are. */
static uint8_t *promise(const uint8_t told[TOLD])
{
	static uint32_t face[FACES][3], value[256];
	struct mp_draco_shape *s = &draco_stub.shape;
	size_t bytes = told[9] < 200 ? (size_t)VALUES * 12 : told[9] - 200u;
	uint8_t *values = malloc(bytes > 0 ? bytes : 1);

	if (values == NULL)
		abort();
	for (size_t i = 0; i < bytes; i++)
		values[i] = (uint8_t)(told[16 + i % 16] & (i % 4 == 3 ? told[15] : 0xff));
	memset(&draco_stub, 0, sizeof draco_stub);
	draco_stub.verdict = told[0] < 240 ? MP_DRACO_DECODED : told[0] % 3;
	draco_stub.why = told[0] & 1 ? "words" : NULL;
	*s = (struct mp_draco_shape){.faces = told[1] < 250 ? told[1] : 600,
				     .points = odd(told[2], VALUES),
				     .used = odd(told[3], UINT64_MAX),
				     .has_positions = told[4] != 255,
				     .normalised = told[4] == 254,
				     .type = told[5] < 128 ? MP_DRACO_FLOAT32 : told[5] % 9,
				     .components = told[6] < 240 ? 3 : told[6] - 240u,
				     .step = told[7] - 3.0,
				     .values = odd(told[8], VALUES),
				     .mapped = odd(told[10], VALUES),
				     .data = values,
				     .size = bytes,
				     .offset = odd(told[11], 0),
				     .stride = odd(told[12], 12)};
	for (size_t i = 0; i < FACES * (size_t)3; i++)
		face[i / 3][i % 3] = told[16 + i % 16] % (told[13] == 255 ? 200u : VALUES);
	for (size_t i = 0; i < 256; i++)
		value[i] = told[16 + i * 7 % 16] % (told[14] == 255 ? 200u : VALUES);
	draco_stub.face = (const uint32_t(*)[3])face;
	draco_stub.face_count = FACES;
	draco_stub.value = told[14] > 128 && s->mapped <= 256 ? value : NULL;
	return values;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct draco_seen whole, other = {.as_floats = true};
	uint8_t told[TOLD] = {0}, *values;
	size_t n = size < TOLD ? size : TOLD;
	uint64_t most;

	memcpy(told, data, n);
	data += n;
	size -= n;
	most = told[0] % 16 == 7 ? 5 : 100000;
	values = promise(told);
	draco_decode(&whole, data, size, SIZE_MAX, SIZE_MAX, most);
	draco_decode(&other, data, size, told[1] % 13, 1 + told[2] % 5, most);
	if (!draco_same(&whole, &other) || draco_stub.wrong || draco_stub.alive != 0)
		abort();
	for (size_t i = 0; i < whole.count && i < DRACO_SEEN; i++)
		for (size_t k = 0; k < 9; k++)
			if (!isfinite(whole.tri[i][k]))
				abort();
	free(values);
	return 0;
}
