/*
 * The whole of core: the input is the file, and the sum of its bytes says how it is asked for
 * (options, chunks).  Whatever comes out is finite, and the same in one piece or in many.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../unit/draco_stub.h" /* libdraco's own troubles are not ours to find */
#include "core/analysis.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(int good)
{
	if (!good)
		abort();
}

static void check_finite(const double *x, size_t count)
{
	for (size_t i = 0; i < count; i++)
		check(isfinite(x[i]));
}

static void check_mass(const struct mp_mass *m)
{
	check_finite(&m->volume, 1);
	check_finite(&m->area, 1);
	check_finite(&m->mass, 1);
	check_finite(m->centroid, 3);
	check_finite(m->inertia[0], 9);
	check(m->mass >= 0 && m->area >= 0);
	check(!m->centroid_defined || !m->volume_defined || m->volume != 0);
	check(!m->inertia_defined || m->centroid_defined);
}

static void check_report(const struct mp_report *r)
{
	check_mass(&r->total);
	check_finite(r->surface_centroid, 3);
	check_finite(r->closure_defect, 3);
	check_finite(&r->density, 1);
	check_finite(r->inertia_origin[0], 9);
	check_finite(r->inertia_about[0], 9);
	check_finite(&r->axis.moment, 1);
	check_finite(&r->axis.radius_of_gyration, 1);
	check_finite(r->principal.moments, 3);
	check_finite(r->principal.axes[0], 9);
	check_finite(r->principal.quaternion, 4);
	check_finite(r->radii_of_gyration, 3);
	check_finite(r->box.min, 3);
	check_finite(r->box.max, 3);
	check(r->solid != MP_YES || r->topology.closed);
	check(r->warnings < UINT64_C(1) << MP_WARNINGS);
	for (uint32_t i = 0; i < r->bodies_listed; i++)
		check_mass(&r->body[i].mass);
}

static struct mp_request make_request(uint8_t how)
{
	struct mp_request request = {.limits = {.max_triangles = 100000},
				     .bodies = 10,
				     .defects = 10,
				     .flip = (how & 4) != 0};

	request.density_kind = (enum mp_density_kind)(how % 4 % 3);
	request.density = 2700;
	request.density_divisor = 1e9;
	if (how % 16 == 9) { /* a density of its own for what a is the name of, or for nothing */
		static const struct mp_named_density named[] = {{"a", 1, 7850, 1e9, 0}};

		request.density_kind = MP_DENSITY_GIVEN;
		request.named = named;
		request.named_count = 1;
	}
	request.has_about = request.has_axis = true;
	request.axis_direction[how % 3] = 1;
	return request;
}

/* -1 where there is no report. */
static int analyse(const struct mp_request *request, const uint8_t *data, size_t size, size_t step,
		   struct mp_report *r, struct mp_error *err)
{
	struct mp_analysis *a = mp_analysis_new(request, err);
	int ret = 0;

	memset(r, 0, sizeof *r);
	check(a != NULL || err->code == MP_NOMEM);
	if (a == NULL)
		return -1;
	for (size_t at = 0; at < size && ret == 0; at += step)
		ret = mp_analysis_push(a, data + at, size - at < step ? size - at : step, err);
	if (ret == 0)
		ret = mp_analysis_end(a, err);
	if (ret == 0)
		ret = mp_analysis_report(a, request, r, err);
	mp_analysis_free(a);
	check(ret == 0 || (err->code != MP_OK && err->code != MP_BUG && err->text[0] != '\0'));
	return ret;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct mp_request request;
	struct mp_report whole, split;
	struct mp_error err = {0}, other = {0};
	uint8_t how = 0;
	int ret;

	for (size_t i = 0; i < size; i++)
		how = (uint8_t)(how + data[i]);
	request = make_request(how);
	ret = analyse(&request, data, size, size + 1, &whole, &err);
	check(analyse(&request, data, size, 1 + how / 8, &split, &other) == ret);
	if (ret == 0) {
		check_report(&whole);
		check(memcmp(&whole.total.volume, &split.total.volume, sizeof(double)) == 0);
		check(memcmp(&whole.total.area, &split.total.area, sizeof(double)) == 0);
		check(whole.warnings == split.warnings && whole.solid == split.solid);
	} else {
		check(err.code == other.code);
	}
	mp_report_free(&whole);
	mp_report_free(&split);
	return 0;
}
