#include "api/part.h"

#include <string.h>
#include <strings.h>

#include "api/header.h"

enum { DISPOSITION = 1, TYPE = 2, TRANSFER = 4 }; /* header lines of which there may be one */

static bool is_word(const char *text, size_t len, const char *word)
{
	return strlen(word) == len && strncasecmp(text, word, len) == 0;
}

/* What %-escapes stand for, where it is no control character. */
static void unescape(char *text)
{
	char *out = text;

	for (; *text != '\0'; text++) {
		int high = *text == '%' ? api_hex(text[1]) : -1;
		int low = high >= 0 ? api_hex(text[2]) : -1;

		if (low >= 0 && high * 16 + low >= 0x20 && high * 16 + low != 0x7f) {
			*out++ = (char)(high * 16 + low);
			text += 2;
		} else {
			*out++ = *text;
		}
	}
	*out = '\0';
}

/* Only the last component of a path, whichever system it is of. */
static void set_filename(struct api_part *part, const char *name)
{
	const char *last = name;

	for (; *name != '\0'; name++)
		if (*name == '/' || *name == '\\')
			last = name + 1;
	memmove(part->filename, last, strlen(last) + 1);
	part->has_filename = true;
}

/* charset'language'escaped (RFC 8187); what is no UTF-8 is shown as such. */
static void set_extended(struct api_part *part, char *value)
{
	char *quote = strchr(value, '\'');

	quote = quote != NULL ? strchr(quote + 1, '\'') : NULL;
	value = quote != NULL ? quote + 1 : value;
	unescape(value);
	set_filename(part, value);
}

static const char *take_param(const struct api_param *param, struct api_part *part, char *extended)
{
	char text[API_PART_FILENAME];

	if (api_param_is(param, "name")) {
		if (part->name_len > 0)
			return "it has two names";
		part->name_len = api_param_text(param, part->name, sizeof part->name);
		return part->name_len < sizeof part->name ? NULL
							  : "its name is longer than 511 bytes";
	}
	if (api_param_is(param, "filename")) {
		if (part->has_filename)
			return "it has two filenames";
		if (api_param_text(param, text, sizeof text) >= sizeof text)
			return "its filename is longer than 1023 bytes";
		set_filename(part, text);
	} else if (api_param_is(param, "filename*")) {
		if (extended[0] != '\0')
			return "it has two filenames";
		if (api_param_text(param, extended, API_PART_FILENAME) >= API_PART_FILENAME)
			return "its filename is longer than 1023 bytes";
	}
	return NULL;
}

static const char *read_disposition(const char *value, const char *end, struct api_part *part)
{
	size_t len = api_header_word(&value, ";");
	char extended[API_PART_FILENAME] = "";
	struct api_param param;
	int rc;

	if (!is_word(value, len, "form-data"))
		return "its Content-Disposition is not form-data";
	value += len;
	while ((rc = api_param_next(&value, end, &param)) > 0) {
		const char *wrong = take_param(&param, part, extended);

		if (wrong != NULL)
			return wrong;
	}
	if (rc < 0)
		return "its Content-Disposition is malformed";
	if (part->name_len == 0)
		return "it has no name";
	if (extended[0] != '\0' && !part->has_filename)
		set_extended(part, extended);
	return NULL;
}

static const char *read_type(const char *value, struct api_part *part)
{
	size_t len = api_header_word(&value, ";");

	if (len >= 10 && strncasecmp(value, "multipart/", 10) == 0)
		return "it is a form itself";
	if (len >= sizeof part->type) /* none that is known here */
		return NULL;
	for (size_t i = 0; i < len; i++)
		part->type[i] =
		    value[i] >= 'A' && value[i] <= 'Z' ? (char)(value[i] | 0x20) : value[i];
	part->type[len] = '\0';
	return NULL;
}

static const char *read_transfer(const char *value)
{
	size_t len = api_header_word(&value, "");

	if (is_word(value, len, "binary") || is_word(value, len, "8bit") ||
	    is_word(value, len, "7bit"))
		return NULL;
	return "its Content-Transfer-Encoding is not read; send the bytes as they are";
}

/* One line, unfolded, ended by a NUL at ${end}. */
static const char *read_line(char *line, char *end, unsigned *seen, struct api_part *part)
{
	char *colon = strchr(line, ':');
	size_t len = colon != NULL ? (size_t)(colon - line) : 0;
	unsigned which = 0;

	if (len == 0 || strcspn(line, " \t") < len)
		return "a line of its head is no header";
	if (is_word(line, len, "Content-Disposition"))
		which = DISPOSITION;
	else if (is_word(line, len, "Content-Type"))
		which = TYPE;
	else if (is_word(line, len, "Content-Transfer-Encoding"))
		which = TRANSFER;
	if ((*seen & which) != 0)
		return "a header of it is repeated";
	*seen |= which;
	switch (which) {
	case DISPOSITION:
		return read_disposition(colon + 1, end, part);
	case TYPE:
		return read_type(colon + 1, part);
	case TRANSFER:
		return read_transfer(colon + 1);
	default:
		return NULL; /* RFC 7578, 4.8: others are passed over */
	}
}

/* The end of the line at ${line}: blanks take the place of a CRLF that a blank follows. */
static char *unfold(char *line)
{
	for (;;) {
		line = strchr(line, '\r'); /* there is one: the empty line has it */
		if (line[2] != ' ' && line[2] != '\t')
			return line;
		line[0] = line[1] = ' ';
	}
}

const char *api_part_read(char *head, size_t len, struct api_part *out)
{
	char *end = head + len - 2; /* of the empty line */
	const char *wrong = NULL;
	unsigned seen = 0, lines = 0;

	memset(out, 0, sizeof *out);
	while (head < end && wrong == NULL) {
		char *stop = unfold(head);

		*stop = '\0';
		if (++lines > API_PART_LINES)
			return "it has more than 64 header lines";
		wrong = read_line(head, stop, &seen, out);
		head = stop + 2;
	}
	if (wrong == NULL && (seen & DISPOSITION) == 0)
		return "it has no Content-Disposition";
	return wrong;
}
