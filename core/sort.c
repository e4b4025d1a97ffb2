#include "core/sort.h"

enum { SHORT = 48 };

static void insertion(uint64_t *a, size_t n)
{
	for (size_t i = 1; i < n; i++) {
		uint64_t x = a[i];
		size_t j = i;

		for (; j > 0 && a[j - 1] > x; j--)
			a[j] = a[j - 1];
		a[j] = x;
	}
}

/* The highest byte in which the keys differ, as a shift; -1 where they are all equal. */
static int top_byte(const uint64_t *a, size_t n)
{
	uint64_t differ = 0;
	int shift = -8;

	for (size_t i = 1; i < n; i++)
		differ |= a[i] ^ a[0];
	for (; differ != 0; differ >>= 8)
		shift += 8;
	return shift < 0 ? -1 : shift;
}

/* Bring every key into its bucket by the byte at ${shift}; end[b] becomes the end of bucket b. */
static void permute(uint64_t *a, size_t n, int shift, size_t end[256])
{
	size_t next[256], at = 0;

	for (unsigned b = 0; b < 256; b++)
		end[b] = 0;
	for (size_t i = 0; i < n; i++)
		end[(a[i] >> shift) & 255]++;
	for (unsigned b = 0; b < 256; b++) {
		next[b] = at;
		at += end[b];
		end[b] = at;
	}
	for (unsigned b = 0; b < 256; b++) {
		while (next[b] < end[b]) {
			uint64_t x = a[next[b]];
			unsigned c = (x >> shift) & 255;

			if (c == b) {
				next[b]++;
			} else {
				a[next[b]] = a[next[c]];
				a[next[c]++] = x;
			}
		}
	}
}

void mp_sort_u64(uint64_t *a, size_t n)
{
	size_t end[256], begin = 0;
	int shift;

	if (n <= SHORT) {
		insertion(a, n);
		return;
	}
	shift = top_byte(a, n);
	if (shift < 0)
		return;
	permute(a, n, shift, end);
	if (shift == 0)
		return;
	for (unsigned b = 0; b < 256; b++) { /* at most eight deep: each level ends one byte */
		mp_sort_u64(a + begin, end[b] - begin);
		begin = end[b];
	}
}
