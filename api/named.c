#include "api/named.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "api/option_table.h"
#include "api/units.h"
#include "api/utf8.h"

enum { HEAD = sizeof API_OPTION_FAMILY - 1, SHOWN_NAMES = 6, SHOWN = 32 };

/* The NAME of density[NAME]. */
static const char *inner(const struct api_value *v, size_t *len)
{
	*len = v->name_len - HEAD - 1;
	return v->name + HEAD;
}

bool api_named_has(const struct api_named *n, const struct api_value *v)
{
	size_t len;
	const char *name = inner(v, &len);

	for (uint32_t i = 0; i < n->count; i++)
		if (n->list[i].len == len && memcmp(n->list[i].text, name, len) == 0)
			return true;
	return false;
}

static int too_expensive(struct api_problem *p)
{
	return api_problem_set(p, API_TOO_EXPENSIVE,
			       "The request needs more memory than one request may use.");
}

static int reserve(struct api_named *n)
{
	uint32_t room = n->room == 0 ? 8 : 2 * n->room;
	struct mp_named_density *request;
	struct api_name *list;

	if (n->count < n->room)
		return 0;
	list = realloc(n->list, room * sizeof *list);
	if (list == NULL)
		return -1;
	n->list = list;
	request = realloc(n->request, room * sizeof *request);
	if (request == NULL)
		return -1;
	n->request = request;
	n->room = room;
	return 0;
}

int api_named_add(struct api_named *n, const struct api_value *v, double density)
{
	size_t len;
	const char *name = inner(v, &len);
	struct api_name *new;

	if (len > MP_NAME_MAX)
		return api_problem_option(v->problem, API_BAD_OPTION, v->name, v->name_len,
					  "The name in the brackets must be at most %d bytes long.",
					  MP_NAME_MAX);
	if (n->count == API_MOST_NAMED) {
		(void)api_problem_option(v->problem, API_BAD_OPTION, v->name, v->name_len,
					 "More than %d names have densities of their own.",
					 API_MOST_NAMED);
		v->problem->limit = API_MOST_NAMED;
		v->problem->actual = API_MOST_NAMED + 1;
		return -1;
	}
	if (reserve(n))
		return too_expensive(v->problem);
	new = &n->list[n->count];
	*new = (struct api_name){malloc(len), len, density};
	if (new->text == NULL)
		return too_expensive(v->problem);
	memcpy(new->text, name, len);
	n->count++;
	return 0;
}

/* A problem of density[NAME]; ${name}: any bytes. */
static void blame(struct api_problem *p, const char *name, size_t len)
{
	char option[HEAD + MP_NAME_MAX + 1];

	if (len > MP_NAME_MAX)
		len = MP_NAME_MAX;
	memcpy(option, API_OPTION_FAMILY, HEAD);
	memcpy(option + HEAD, name, len);
	option[HEAD + len] = ']';
	(void)api_utf8_copy(p->option, sizeof p->option, option, HEAD + len + 1);
}

static struct api_ratio in_file_units(const struct api_options *o, uint32_t i)
{
	return api_units_convert(o->named.list[i].density, o->density_unit, API_DENSITY_FILE,
				 o->unit, o->mass_unit);
}

int api_named_check(const struct api_options *o, struct api_problem *p)
{
	const struct api_name *list = o->named.list;

	if (o->named.count > 0 && o->has_mass) {
		(void)api_problem_set(p, API_BAD_OPTION,
				      "mass and density[NAME] exclude each other: give one of "
				      "them.");
		blame(p, list[0].text, list[0].len);
		return -1;
	}
	if (o->named.count > 0 && o->checks == MP_CHECKS_CLOSED) {
		(void)api_problem_set(p, API_BAD_OPTION,
				      "checks=closed and density[NAME] exclude each other: the "
				      "faces of a name cannot be told apart without a table.");
		blame(p, list[0].text, list[0].len);
		return -1;
	}
	for (uint32_t i = 0; i < o->named.count; i++) {
		struct api_ratio density = in_file_units(o, i);

		if (isnormal(density.num / density.den))
			continue;
		(void)api_problem_set(p, API_BAD_OPTION,
				      "The density is out of range in these units.");
		blame(p, list[i].text, list[i].len);
		return -1;
	}
	return 0;
}

void api_named_request(const struct api_options *o, struct mp_request *out)
{
	const struct api_named *n = &o->named;

	for (uint32_t i = 0; i < n->count; i++) {
		struct api_ratio density = in_file_units(o, i);

		n->request[i] = (struct mp_named_density){n->list[i].text, n->list[i].len,
							  density.num, density.den, density.error};
	}
	out->named = n->request;
	out->named_count = n->count;
}

/* Names that were shown, so that none is shown twice. */
struct shown {
	const char *name[SHOWN_NAMES];
	size_t len[SHOWN_NAMES], count;
};

static bool is_shown(const struct shown *s, const char *name, size_t len)
{
	for (size_t i = 0; i < s->count; i++)
		if (s->len[i] == len && memcmp(s->name[i], name, len) == 0)
			return true;
	return false;
}

/* Add a name to ${text}; false where there were as many before. */
static bool show(struct shown *s, const char *name, size_t len, char *text, size_t cap)
{
	size_t at = strlen(text);
	char clean[SHOWN];

	if (len == 0 || is_shown(s, name, len))
		return true;
	if (s->count == SHOWN_NAMES)
		return false;
	(void)api_utf8_copy(clean, sizeof clean, name, len);
	(void)snprintf(text + at, cap - at, "%s%s", s->count == 0 ? " The names are: " : ", ",
		       clean);
	s->name[s->count] = name;
	s->len[s->count++] = len;
	return true;
}

/* Behind what ${text} says: the first names that there are. */
static void list_names(const struct mp_analysis *a, char *text, size_t cap)
{
	struct shown s = {.count = 0};
	uint64_t t = 0, end = 0;
	bool all = true;
	size_t at;

	do {
		t = end;
		for (int other = 0; other < 2 && all; other++) {
			size_t len;
			const char *name = mp_analysis_name(a, t, other, &len, &end);

			all = end == t || show(&s, name, len, text, cap);
		}
	} while (end > t && all);
	at = strlen(text);
	(void)snprintf(text + at, cap - at, "%s",
		       s.count == 0 ? " No faces have a name."
		       : all        ? "."
				    : ", and others.");
}

int api_named_refuse(const struct api_named *n, const struct mp_analysis *a,
		     const struct mp_error *err, struct api_problem *p)
{
	uint64_t end;
	size_t len;
	const char *name;

	if (err->limit < n->count) {
		(void)api_problem_set(p, API_BAD_OPTION, "%s",
				      err->actual == UINT64_MAX
					  ? "No faces are under this name."
					  : "The faces under this name are not a closed solid by "
					    "themselves, so they have no mass of their own.");
		blame(p, n->list[err->limit].text, n->list[err->limit].len);
		if (err->actual == UINT64_MAX)
			list_names(a, p->detail, sizeof p->detail);
		return -1;
	}
	name = mp_analysis_name(a, err->actual, true, &len, &end);
	if (len == 0)
		name = mp_analysis_name(a, err->actual, false, &len, &end);
	if (len == 0)
		return api_problem_option(p, API_BAD_OPTION, "density", strlen("density"),
					  "Some faces are under no name: give the density of all "
					  "faces without their own.");
	(void)api_problem_set(p, API_BAD_OPTION,
			      "The faces under this name have no density: give it, or density for "
			      "all names without their own.");
	blame(p, name, len);
	return -1;
}

void api_named_free(struct api_named *n)
{
	for (uint32_t i = 0; i < n->count; i++)
		free(n->list[i].text);
	free(n->list);
	free(n->request);
	memset(n, 0, sizeof *n);
}
