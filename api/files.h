#ifndef API_FILES_H
#define API_FILES_H

#include <stdbool.h>

#include "api/digest.h"
#include "api/json_build.h"
#include "api/options.h"
#include "api/problem.h"
#include "core/analysis.h"
#include "core/format.h"

/*
 * The files of a request, one after the other, on their way into one analysis: together they are
 * one solid.  Nothing but their names is kept.
 */
struct api_files { /* at first all 0, but for options, several, and key and limits of request */
	const struct api_options *options;
	bool several;     /* there may be: problems say which file they are about */
	bool format_late; /* the option format came when a file had begun */
	struct mp_request request;
	struct mp_analysis *analysis;
	size_t count;
	char *first, *current; /* names, clean UTF-8, NULL for none: of the first, of the last */
	struct api_text names; /* of all: a JSON array, open until api_files_end() */
	bool digest;           /* was asked for when the first file began */
	struct api_digest sha; /* of the file in work */
	char sha256[API_DIGEST_SIZE]; /* of the first */
	struct api_text digests;      /* of all, as names */
	uint64_t bytes;               /* of the file in work */
	uint8_t start[MP_SNIFF_BYTES];
	enum mp_format_wish found; /* what the first looks like */
	bool differ;               /* some other looks different */
};

/*
 * All of these return 0, or -1 with ${p}, after which only api_files_free() is legal.  Offsets and
 * lines in ${p} are those of one file.
 */

/* A file begins, so the one before it is over.  ${name}: any bytes, NULL or "" for none. */
int api_files_begin(struct api_files *, const char *name, struct api_problem *p);

int api_files_bytes(struct api_files *, const uint8_t *bytes, size_t len, struct api_problem *p);

/* The last file is over.  There was one. */
int api_files_end(struct api_files *, struct api_problem *p);

/* The mesh of all files, by what the options are now. */
int api_files_report(struct api_files *, struct mp_report *out, struct api_problem *p);

void api_files_free(struct api_files *); /* zeroes it */

#endif
