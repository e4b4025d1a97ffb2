#include "api/option_value.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/number/number.h"

int api_value_bad(const struct api_value *v, const char *what)
{
	/* 1e+3 arrives as "1e 3" when the client forgets to encode it */
	const char *hint = v->len > 0 && memchr(v->text, ' ', v->len) != NULL
			       ? "; in a URL '+' means a space, write %2B"
			       : "";

	return api_problem_option(v->problem, API_BAD_OPTION, v->name, v->name_len,
				  "The option must be %s%s%s.", what,
				  v->len == 0 ? ", and it is empty" : "", hint);
}

bool api_value_is(const struct api_value *v, const char *word)
{
	return strlen(word) == v->len && memcmp(word, v->text, v->len) == 0;
}

int api_value_choice(const struct api_value *v, const char *const *words, size_t count,
		     unsigned *which)
{
	char list[sizeof v->problem->detail - 100] = "one of ";

	for (size_t i = 0; i < count; i++) {
		if (api_value_is(v, words[i])) {
			*which = (unsigned)i;
			return 0;
		}
	}
	for (size_t i = 0; i < count; i++) {
		size_t at = strlen(list);

		snprintf(list + at, sizeof list - at, "%s%s", i > 0 ? ", " : "", words[i]);
	}
	return api_value_bad(v, list);
}

int api_value_bool(const struct api_value *v, bool *out)
{
	static const char *const words[] = {"false", "true"};
	unsigned which = 0;

	if (api_value_choice(v, words, 2, &which))
		return -1;
	*out = which == 1;
	return 0;
}

int api_value_count(const struct api_value *v, uint32_t most, uint32_t *out)
{
	uint64_t n = 0;
	bool good = v->len > 0;
	char what[64];

	for (size_t i = 0; i < v->len && good; i++) {
		good = v->text[i] >= '0' && v->text[i] <= '9';
		n = n * 10 + (uint64_t)(v->text[i] - '0');
		good = good && n <= most;
	}
	if (!good) {
		snprintf(what, sizeof what, "a whole number from 0 to %u", most);
		return api_value_bad(v, what);
	}
	*out = (uint32_t)n;
	return 0;
}

/* mp_number_parse() takes Fortran's d exponents and nan for the sake of files; options do not. */
static bool read_number(const char *text, size_t len, double *out)
{
	if (len == 0 || memchr(text, 'd', len) != NULL || memchr(text, 'D', len) != NULL)
		return false;
	return mp_number_parse(text, len, out) == 0 && isfinite(*out);
}

int api_value_numbers(const struct api_value *v, double *out, size_t count)
{
	const char *p = v->text;
	size_t left = v->len;
	char what[64];
	bool good = true;

	for (size_t i = 0; i < count && good; i++) {
		const char *comma = left > 0 && i + 1 < count ? memchr(p, ',', left) : NULL;
		size_t len = comma != NULL ? (size_t)(comma - p) : left;

		good = (comma != NULL || i + 1 == count) && read_number(p, len, &out[i]);
		if (comma != NULL) {
			p = comma + 1;
			left -= len + 1;
		}
	}
	if (good)
		return 0;
	if (count == 1)
		return api_value_bad(v, "a finite number");
	snprintf(what, sizeof what, "%zu finite numbers with commas between them", count);
	return api_value_bad(v, what);
}

int api_value_positive(const struct api_value *v, double *out)
{
	double x;

	if (!read_number(v->text, v->len, &x) || !(x > 0))
		return api_value_bad(v, "a finite number greater than 0");
	*out = x;
	return 0;
}
