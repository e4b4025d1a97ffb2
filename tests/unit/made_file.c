#include "tests/unit/made_file.h"

#include <stdlib.h>
#include <string.h>

#include "core/analysis_state.h"

struct delivery {
	struct made_file file;
	const struct mp_sink *sink;
};

static int send_names(const struct delivery *d, struct mp_error *err)
{
	const struct mp_sink *s = d->sink;

	for (const struct made_range *r = d->file.parts; r != NULL && r->name != NULL; r++)
		if (s->part(s->self, r->first, r->name, strlen(r->name), err))
			return -1;
	for (const struct made_range *r = d->file.objects; r != NULL && r->name != NULL; r++)
		if (s->object(s->self, r->first, r->name, strlen(r->name), err))
			return -1;
	for (const struct made_range *r = d->file.materials; r != NULL && r->name != NULL; r++)
		if (s->material(s->self, r->first, r->name, strlen(r->name), err))
			return -1;
	return 0;
}

/* Places of numbers that no corner has are all 0; where there are too many, it says nothing. */
static void expect(const struct delivery *d)
{
	const struct mesh *m = d->file.mesh;
	size_t count = 0, corners = 3 * m->count;
	struct mp_points points = {.stride = 13}; /* nothing is aligned */
	unsigned char *data;

	for (size_t i = 0; i < corners; i++)
		if (d->file.index[i / 3][i % 3] >= count)
			count = d->file.index[i / 3][i % 3] + (size_t)1;
	data = count > corners ? NULL : calloc(count, points.stride);
	if (data == NULL)
		return;
	for (size_t i = 0; i < 3 * corners; i++) {
		float x = (float)m->tri[i / 9][i % 9];

		memcpy(data + d->file.index[i / 9][i / 3 % 3] * points.stride + i % 3 * sizeof x,
		       &x, sizeof x);
	}
	points.data = data;
	points.count = count;
	d->sink->expect(d->sink->self, m->count, &points);
	free(data);
}

static int send(const struct delivery *d, const double (*tri)[9], size_t count,
		struct mp_error *err)
{
	float xyz[9][MP_BLOCK];

	if (d->file.form == MADE_BLOCKS)
		return d->sink->block(d->sink->self, tri, count, err);
	for (size_t i = 0; i < 9 * count; i++)
		xyz[i % 9][i / 9] = (float)tri[i / 9][i % 9];
	return d->sink->floats(d->sink->self, (const float(*)[MP_BLOCK])xyz, count, err);
}

static int finish(void *state, struct mp_error *err)
{
	const struct delivery *d = state;
	const struct mesh *m = d->file.mesh;

	if (send_names(d, err))
		return -1;
	if (d->file.form == MADE_EXPECTED)
		expect(d);
	for (size_t at = 0, n; at < m->count; at += n) {
		n = m->count - at < MP_BLOCK ? m->count - at : MP_BLOCK;
		if (d->file.index != NULL &&
		    d->sink->indices(d->sink->self, d->file.index + at, n, err))
			return -1;
		if (send(d, (const double(*)[9])m->tri + at, n, err))
			return -1;
	}
	return 0;
}

static void end(void *state)
{
	(void)state;
}

static const struct mp_decoder_ops deliver = {"made", NULL, NULL, finish, end};

struct mp_analysis *made_analysis(const struct made_file *files, size_t count,
				  const struct mp_request *request, struct mp_error *err)
{
	struct mp_analysis *a = mp_analysis_new(request, err);
	int ret = 0;

	for (size_t i = 0; i < count && a != NULL && ret == 0; i++) {
		struct delivery d = {files[i], &a->sink};

		a->decoder = &deliver;
		a->state = &d;
		a->notes = (struct mp_notes){.format = MP_FORMAT_OBJ};
		ret = i + 1 < count ? mp_analysis_next(a, err) : mp_analysis_end(a, err);
		a->decoder = NULL;
	}
	if (ret) {
		mp_analysis_free(a);
		return NULL;
	}
	return a;
}

int made_report(const struct made_file *files, size_t count, const struct mp_request *request,
		struct mp_report *out, struct mp_error *err)
{
	struct mp_analysis *a = made_analysis(files, count, request, err);
	int ret = -1;

	memset(out, 0, sizeof *out);
	if (a != NULL)
		ret = mp_analysis_report(a, request, out, err);
	mp_analysis_free(a);
	return ret;
}
