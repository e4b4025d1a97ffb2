#ifndef API_PART_H
#define API_PART_H

#include <stdbool.h>
#include <stddef.h>

/* The head of one part of a form (RFC 7578, 4). */

enum { API_PART_NAME = 512, API_PART_FILENAME = 1024, API_PART_TYPE = 128, API_PART_LINES = 64 };

struct api_part {
	char name[API_PART_NAME]; /* raw bytes without controls, not empty, NUL behind them */
	size_t name_len;
	bool has_filename;                /* the parameter is there, empty or not */
	char filename[API_PART_FILENAME]; /* the last component of a path; as the name */
	char type[API_PART_TYPE];         /* media type without parameters, lower case, "": none */
};

/*
 * Read the lines of ${head}, each ended by CRLF, the last one empty; no other control characters
 * than tabs are in it.  Folded lines are unfolded in place (RFC 5322, 2.2.3).  filename* counts
 * where there is no filename (RFC 7578, 4.2, forbids it; some clients send nothing else).
 * NULL, or a clause that says what is wrong.
 */
const char *api_part_read(char *head, size_t len, struct api_part *out);

#endif
