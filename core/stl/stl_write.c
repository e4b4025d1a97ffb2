#include "core/stl/stl_write.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void put32(uint8_t *out, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		out[i] = (uint8_t)(v >> (8 * i));
}

static void put_float(uint8_t *out, float value)
{
	uint32_t bits;

	memcpy(&bits, &value, sizeof bits);
	put32(out, bits);
}

void mp_stl_write_head(uint8_t out[MP_STL_HEAD], uint32_t triangles)
{
	/* never "solid" at the beginning: readers would take it for text */
	static const char words[] = "binary STL; add the point of Mesh-Origin to every corner";

	memset(out, 0, MP_STL_HEAD);
	memcpy(out, words, sizeof words - 1);
	put32(out + 80, triangles);
}

/* Unit normal; edges are scaled to 1 first, so that nothing overflows on the way. */
static void normal_of(const double corner[3][3], double n[3])
{
	double e[2][3], largest = 0, length;

	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 2; i++) {
			e[i][k] = corner[i + 1][k] / 2 - corner[0][k] / 2;
			largest = fmax(largest, fabs(e[i][k]));
		}
		n[k] = 0;
	}
	if (largest < DBL_MIN)
		return;
	for (int k = 0; k < 3; k++) {
		e[0][k] /= largest;
		e[1][k] /= largest;
	}
	for (int k = 0; k < 3; k++)
		n[k] =
		    e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int k = 0; k < 3; k++)
		n[k] = length > DBL_MIN ? n[k] / length : 0;
}

bool mp_stl_write_facet(uint8_t out[MP_STL_FACET], const double corner[3][3],
			const double origin[3])
{
	double n[3];

	normal_of(corner, n);
	for (int k = 0; k < 3; k++)
		put_float(out + 4 * k, (float)n[k]);
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++) {
			double x = corner[i][k] - origin[k];

			if (!(fabs(x) <= (double)FLT_MAX))
				return false;
			put_float(out + 12 + 12 * i + 4 * k, (float)x);
		}
	}
	memset(out + 48, 0, 2);
	return true;
}
