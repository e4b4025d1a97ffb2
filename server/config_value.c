#include "server/config_value.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

struct unit {
	const char *name;
	double factor;
};

/* Plain decimal digits and one point, then a unit of the table; strtod alone takes too much. */
static int value(const char *text, const struct unit *unit, double *out)
{
	size_t digits = strspn(text, "0123456789"), n = digits;
	char *end;
	double v;

	if (text[n] == '.') {
		size_t more = strspn(text + n + 1, "0123456789");

		if (more == 0)
			return -1;
		n += 1 + more;
	}
	if (digits == 0 || n > 40)
		return -1;
	v = strtod(text, &end);
	if (end != text + n)
		return -1;
	for (; unit->name != NULL; unit++) {
		if (strcmp(end, unit->name) == 0) {
			*out = v * unit->factor;
			return isfinite(*out) ? 0 : -1;
		}
	}
	return -1;
}

static int whole(const char *text, const struct unit *unit, uint64_t *out)
{
	double v;

	if (value(text, unit, &v) != 0 || v > 9e18 || v != floor(v))
		return -1;
	*out = (uint64_t)v;
	return 0;
}

int srv_value_size(const char *text, uint64_t *bytes)
{
	static const struct unit units[] = {
	    {"", 1},         {"B", 1},           {"kB", 1e3},           {"MB", 1e6}, {"GB", 1e9},
	    {"KiB", 1024.0}, {"MiB", 1048576.0}, {"GiB", 1073741824.0}, {NULL, 0}};

	return whole(text, units, bytes);
}

int srv_value_duration(const char *text, double *seconds)
{
	static const struct unit units[] = {{"", 1},     {"ms", 1e-3}, {"s", 1},
					    {"min", 60}, {"h", 3600},  {NULL, 0}};

	return value(text, units, seconds);
}

int srv_value_count(const char *text, uint64_t *count)
{
	static const struct unit units[] = {{"", 1}, {"k", 1e3}, {"M", 1e6}, {NULL, 0}};

	return whole(text, units, count);
}
