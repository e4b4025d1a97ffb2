#include "api/form.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum kind { OPTION, MESH, ATTACHMENT };

struct api_form {
	struct api_multipart multipart;
	struct api_options *options;
	struct api_files *files;
	enum kind kind; /* of the part in work */
	size_t value_len;
	char value[API_FORM_VALUE]; /* of the option */
};

static bool is_one_of(const char *word, const char *const *words)
{
	for (; *words != NULL; words++)
		if (strcasecmp(word, *words) == 0)
			return true;
	return false;
}

static enum kind kind_of(const struct api_part *part)
{
	static const char *const meshes[] = {"stl", "obj", "drc", NULL};
	static const char *const attachments[] = {"mtl", "png", "jpg",  "jpeg", "bmp",
						  "tga", "tif", "tiff", "webp", "gif",
						  "ktx", "dds", "hdr",  "exr",  NULL};
	const char *dot = strrchr(part->filename, '.');

	if (!part->has_filename && strcmp(part->name, "file") != 0)
		return OPTION;
	if (dot != NULL && is_one_of(dot + 1, meshes))
		return MESH;
	if (dot != NULL && is_one_of(dot + 1, attachments))
		return ATTACHMENT;
	return strncmp(part->type, "image/", 6) == 0 || strcmp(part->type, "model/mtl") == 0
		   ? ATTACHMENT
		   : MESH;
}

static int begin_part(void *self, const struct api_part *part, struct api_problem *p)
{
	struct api_form *f = self;

	f->kind = kind_of(part);
	f->value_len = 0;
	if (f->kind == ATTACHMENT)
		f->options->sent.attachment = true;
	return f->kind == MESH ? api_files_begin(f->files, part->filename, p) : 0;
}

static int take_bytes(void *self, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	struct api_form *f = self;
	const struct api_part *part = &f->multipart.part;

	if (f->kind == MESH)
		return api_files_bytes(f->files, bytes, len, p);
	if (f->kind == ATTACHMENT)
		return 0;
	if (len > sizeof f->value - f->value_len) {
		(void)api_problem_option(p, API_BAD_OPTION, part->name, part->name_len,
					 "The option's value is longer than %d bytes.",
					 API_FORM_VALUE);
		p->limit = API_FORM_VALUE;
		p->actual = API_FORM_VALUE + 1;
		return -1;
	}
	memcpy(f->value + f->value_len, bytes, len);
	f->value_len += len;
	return 0;
}

static int end_part(void *self, struct api_problem *p)
{
	struct api_form *f = self;
	const struct api_part *part = &f->multipart.part;

	if (f->kind != OPTION)
		return 0;
	if (f->files->count > 0 && strcmp(part->name, "format") == 0)
		f->files->format_late = true;
	return api_options_set(f->options, part->name, part->name_len, f->value, f->value_len, p);
}

struct api_form *api_form_new(const char *boundary, struct api_options *options,
			      struct api_files *files)
{
	struct api_form *f = malloc(sizeof *f);
	const struct api_multipart_sink sink = {begin_part, take_bytes, end_part, f};

	if (f == NULL)
		return NULL;
	api_multipart_begin(&f->multipart, boundary, &sink);
	f->options = options;
	f->files = files;
	f->kind = OPTION;
	f->value_len = 0;
	files->several = true;
	return f;
}

int api_form_push(struct api_form *f, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	return api_multipart_push(&f->multipart, bytes, len, p);
}

int api_form_finish(struct api_form *f, struct api_problem *p)
{
	if (api_multipart_finish(&f->multipart, p))
		return -1;
	if (f->files->count > 0)
		return 0;
	if (f->options->sent.attachment)
		return api_problem_set(p, API_BAD_MULTIPART,
				       "The form has no mesh: by their names or media types its "
				       "files are materials or pictures.");
	return api_problem_set(p, API_BAD_MULTIPART,
			       "The form has no file: no part of it is named file or has a "
			       "filename.");
}

void api_form_free(struct api_form *f)
{
	free(f);
}
