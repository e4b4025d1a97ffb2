#ifndef API_FORM_H
#define API_FORM_H

#include <stdbool.h>

#include "api/files.h"
#include "api/multipart.h"
#include "api/options.h"

/*
 * A form: its file parts go to ${files}, one after the other, its other parts to ${options}.
 *
 * A part is a file if it has a filename or its name is `file`.  Materials and pictures, known by
 * the filename's extension or the media type, are passed over wherever they stand: browsers sort
 * part.mtl before part.obj.  Every other part is an option, before the files or behind them; but a
 * format that comes behind a file must be the one that was found.
 */

enum { API_FORM_VALUE = 16 << 10 }; /* longest value of an option */

struct api_form;

/* ${options} and ${files} are kept by pointer.  NULL: memory is out. */
struct api_form *api_form_new(const char *boundary, struct api_options *options,
			      struct api_files *files);

/* Bytes of the form; -1 with ${p}: bad_multipart, an option's problem, or a file's. */
int api_form_push(struct api_form *, const uint8_t *bytes, size_t len, struct api_problem *p);

/* The form is over: -1 where it is cut off, or holds no file. */
int api_form_finish(struct api_form *, struct api_problem *p);

void api_form_free(struct api_form *); /* takes NULL */

#endif
