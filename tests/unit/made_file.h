#ifndef MADE_FILE_H
#define MADE_FILE_H

#include "core/analysis.h"
#include "tests/unit/mesh_make.h"

/*
 * Files with names and vertex numbers as a decoder delivers them, without one: what an analysis
 * makes of them does not depend on which format they came in.
 */
struct made_range {
	uint64_t first;
	const char *name; /* NULL behind the last one */
};

enum made_form {
	MADE_BLOCKS,  /* of doubles */
	MADE_FLOATS,  /* the same as floats; the coordinates have to be some */
	MADE_EXPECTED /* and its points, by their numbers, before the triangles */
};

struct made_file {
	const struct mesh *mesh;
	const uint32_t (*index)[3]; /* of every triangle; NULL: no numbers */
	const struct made_range *parts, *objects, *materials; /* NULL: none */
	enum made_form form;
};

/* All of it but the report.  NULL with ${err}. */
struct mp_analysis *made_analysis(const struct made_file *files, size_t count,
				  const struct mp_request *request, struct mp_error *err);

int made_report(const struct made_file *files, size_t count, const struct mp_request *request,
		struct mp_report *out, struct mp_error *err);

#endif
