#include "core/draco/draco_load.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

uint64_t mp_draco_size_of(enum mp_draco_type type)
{
	switch (type) {
	case MP_DRACO_INT8:
	case MP_DRACO_UINT8:
		return 1;
	case MP_DRACO_INT16:
	case MP_DRACO_UINT16:
		return 2;
	case MP_DRACO_INT32:
	case MP_DRACO_UINT32:
	case MP_DRACO_FLOAT32:
		return 4;
	case MP_DRACO_FLOAT64:
		return 8;
	case MP_DRACO_OTHER:
		break;
	}
	return 0;
}

/* One coordinate, in the byte order of this machine. */
static inline double number(enum mp_draco_type type, const uint8_t *p)
{
	union {
		int16_t i16;
		uint16_t u16;
		int32_t i32;
		uint32_t u32;
		float f32;
		double f64;
	} v;

	switch (type) {
	case MP_DRACO_INT8:
		return (int8_t)*p;
	case MP_DRACO_UINT8:
		return *p;
	case MP_DRACO_INT16:
		memcpy(&v.i16, p, sizeof v.i16);
		return v.i16;
	case MP_DRACO_UINT16:
		memcpy(&v.u16, p, sizeof v.u16);
		return v.u16;
	case MP_DRACO_INT32:
		memcpy(&v.i32, p, sizeof v.i32);
		return v.i32;
	case MP_DRACO_UINT32:
		memcpy(&v.u32, p, sizeof v.u32);
		return v.u32;
	case MP_DRACO_FLOAT32:
		memcpy(&v.f32, p, sizeof v.f32);
		return (double)v.f32;
	case MP_DRACO_FLOAT64:
		memcpy(&v.f64, p, sizeof v.f64);
		return v.f64;
	case MP_DRACO_OTHER:
		break;
	}
	return 0;
}

int mp_draco_load(const struct mp_draco_shape *s, uint64_t first, const uint32_t (*corner)[3],
		  size_t count, double (*tri)[9], struct mp_error *err)
{
	const uint64_t size = mp_draco_size_of(s->type);

	for (size_t i = 0; i < 3 * count; i++) {
		uint32_t value = corner[i / 3][i % 3];
		const uint8_t *p = s->data + s->offset + s->stride * value;

		for (size_t k = 0; k < 3; k++, p += size) {
			double x = number(s->type, p);

			if (!isfinite(x))
				return mp_fail(err, MP_NON_FINITE, MP_NO_BYTE,
					       "face %" PRIu64 " (from 0): %c of position %" PRIu32
					       " is not finite",
					       first + i / 3, "xyz"[k], value);
			tri[i / 3][3 * (i % 3) + k] = x;
		}
	}
	return 0;
}

/* Bit 31 of what is returned is set where one of ${count} floats in a row is not finite. */
static uint32_t look_for_bad(const uint8_t *p, uint64_t count)
{
	uint32_t bad = 0;

	for (uint64_t i = 0; i < count; i++) { /* all bits of the exponent carry into the next */
		uint32_t bits;

		memcpy(&bits, p + i * sizeof bits, sizeof bits);
		bad |= (bits & 0x7f800000) + 0x00800000;
	}
	return bad;
}

bool mp_draco_are_floats(const struct mp_draco_shape *s)
{
	const uint8_t *first = s->data + s->offset;
	uint32_t bad = 0;

	if (s->type != MP_DRACO_FLOAT32)
		return false;
	if (s->stride == 3 * sizeof(float))
		return look_for_bad(first, 3 * s->values) >> 31 == 0;
	for (uint64_t i = 0; i < s->values; i++)
		bad |= look_for_bad(first + i * s->stride, 3);
	return bad >> 31 == 0;
}

static void load_one(const uint8_t *data, uint64_t stride, const uint32_t corner[3], size_t at,
		     float (*xyz)[MP_BLOCK])
{
	for (size_t k = 0; k < 3; k++) {
		float x[3];

		memcpy(x, data + stride * corner[k], sizeof x);
		for (size_t j = 0; j < 3; j++)
			xyz[3 * k + j][at] = x[j];
	}
}

/* Four floats anywhere. */
typedef float quad __attribute__((vector_size(16), aligned(1), may_alias));

static inline quad quad_at(const uint8_t *data, uint64_t stride, uint32_t value)
{
	return *(const quad *)(const void *)(data + stride * value);
}

/* Corner ${k} of four triangles: rows become columns, and what follows each position is dropped. */
static inline void load_corners(const uint8_t *data, uint64_t stride, const uint32_t (*corner)[3],
				size_t k, size_t at, float (*xyz)[MP_BLOCK])
{
	const quad a = quad_at(data, stride, corner[0][k]), b = quad_at(data, stride, corner[1][k]);
	const quad c = quad_at(data, stride, corner[2][k]), d = quad_at(data, stride, corner[3][k]);
	const quad ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
	const quad cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);

	*(quad *)(void *)&xyz[3 * k][at] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
	*(quad *)(void *)&xyz[3 * k + 1][at] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
	*(quad *)(void *)&xyz[3 * k + 2][at] =
	    __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 6, -1, -1),
				    __builtin_shufflevector(c, d, 2, 6, -1, -1), 0, 1, 4, 5);
}

void mp_draco_load_floats(const struct mp_draco_shape *s, const uint32_t (*corner)[3], size_t count,
			  uint32_t most, float (*xyz)[MP_BLOCK])
{
	const uint8_t *data = s->data + s->offset;
	bool roomy = s->size - s->offset - s->stride * most >= sizeof(quad);
	size_t i = 0;

	for (; roomy && i + 4 <= count; i += 4)
		for (size_t k = 0; k < 3; k++)
			load_corners(data, s->stride, corner + i, k, i, xyz);
	for (; i < count; i++)
		load_one(data, s->stride, corner[i], i, xyz);
}
