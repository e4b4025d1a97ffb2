/*
 * Any bytes as a form of the boundary XX: cut in any way they are the same parts and the same
 * verdict, and the whole job gives the same answer.  The cuts hang on the bytes themselves.
 */
#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "api/job.h"
#include "api/multipart.h"
#include "api/utf8.h"
#include "cut.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct seen {
	struct api_problem problem;
	size_t parts, open;
	uint64_t hash;
};

static void must(bool truth)
{
	if (!truth)
		abort();
}

static void hash(struct seen *s, const void *bytes, size_t len)
{
	for (size_t i = 0; i < len; i++) /* FNV-1a, to which pieces are all one */
		s->hash = (s->hash ^ ((const uint8_t *)bytes)[i]) * 1099511628211u;
}

static int begin(void *self, const struct api_part *part, struct api_problem *p)
{
	struct seen *s = self;

	(void)p;
	must(s->open++ == 0 && ++s->parts <= API_MULTIPART_PARTS);
	must(part->name_len > 0 && part->name_len < sizeof part->name);
	must(memchr(part->name, '\0', sizeof part->name) == part->name + part->name_len);
	must(memchr(part->filename, '\0', sizeof part->filename) != NULL);
	must(memchr(part->type, '\0', sizeof part->type) != NULL);
	hash(s, part->name, part->name_len + 1);
	hash(s, part->filename, strlen(part->filename) + 1);
	hash(s, part->type, strlen(part->type) + 1);
	hash(s, &part->has_filename, 1);
	return 0;
}

static int bytes(void *self, const uint8_t *data, size_t len, struct api_problem *p)
{
	struct seen *s = self;

	(void)p;
	must(s->open == 1 && len > 0);
	hash(s, data, len);
	return 0;
}

static int end(void *self, struct api_problem *p)
{
	struct seen *s = self;

	(void)p;
	must(s->open-- == 1);
	hash(s, "end", 3);
	return 0;
}

static struct seen parse(const uint8_t *data, size_t size, size_t first, size_t step)
{
	struct seen s = {.hash = 14695981039346656037u};
	const struct api_multipart_sink sink = {begin, bytes, end, &s};
	struct api_multipart *m = malloc(sizeof *m);
	int ret = 0;

	must(m != NULL);
	api_multipart_begin(m, "XX", &sink);
	for (size_t at = 0, n = first; at < size && ret == 0; at += n, n = step) {
		uint8_t *copy;

		n = n < size - at ? n : size - at;
		if (n == 0)
			continue;
		copy = malloc(n);
		must(copy != NULL);
		memcpy(copy, data + at, n);
		ret = api_multipart_push(m, copy, n, &s.problem);
		free(copy);
	}
	if (ret == 0)
		ret = api_multipart_finish(m, &s.problem);
	must((ret == 0) == (s.problem.code == API_OK));
	must(ret != 0 || s.open == 0);
	free(m);
	return s;
}

static struct api_answer ask(const uint8_t *data, size_t size, size_t step)
{
	const struct api_job_head head = {.content_type = "multipart/form-data; boundary=XX",
					  .limits = {1 << 20, 10000}};
	struct api_job *job = api_job_new(&head);
	struct api_answer a;

	must(job != NULL);
	for (size_t at = 0; at < size; at += step)
		if (api_job_push(job, data + at, size - at < step ? size - at : step) != 0)
			break;
	api_job_answer(job, 0, 0, &a);
	api_job_free(job);
	must(strlen(a.body) == a.len && api_utf8_clean(a.body, a.len));
	return a;
}

static void must_answer_alike(const uint8_t *data, size_t size, size_t step)
{
	struct api_answer a = ask(data, size, size > 0 ? size : 1), b = ask(data, size, step);
	cJSON *json = cJSON_Parse(a.body);

	must(a.len == b.len && memcmp(a.body, b.body, a.len) == 0); /* no clock: no times */
	must(json != NULL);
	cJSON_Delete(json);
	api_answer_free(&a);
	api_answer_free(&b);
}

/* A whole job takes much longer than its form, so only every 32nd input becomes one. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const uint64_t dice = cut_dice(data, size);
	const struct cut cut = cut_of(dice, size);
	struct seen whole = parse(data, size, size, size);
	struct seen other = parse(data, size, cut.first, cut.step);

	must(memcmp(&whole, &other, sizeof whole) == 0);
	if ((dice >> 20) % 32 == 0)
		must_answer_alike(data, size, cut.step);
	return 0;
}
